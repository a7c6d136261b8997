//! Pictures as files: SVG as drawn, PNG and PDF from the same drawing.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use png::{ColorType, Compression, Encoder, EncodingError, FilterType};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::{Database, Source};
use resvg::usvg::{Options, Tree};
use svg2pdf::{ConversionOptions, PageOptions, to_pdf};

use super::error::ChartError;

/// Pixels of a PNG for each pixel of the drawing: sharp in print and on dense screens.
const SCALE: f32 = 2.0;

/// Dots per inch of the pixels of a drawing on paper, as in CSS.
const DOTS_PER_INCH: f32 = 96.0;

/// A drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    svg: String,
}

/// The output file of a picture, with the kind given by its extension.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    path: PathBuf,
    format: Format,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Svg,
    Png,
    Pdf,
}

impl Output {
    /// By the file's extension, `.svg`, `.png` or `.pdf` in any case.
    ///
    /// # Errors
    /// If it has another extension or none.
    pub fn new(path: &Path) -> Result<Self, ChartError> {
        let extension = path.extension().map(|extension| extension.to_string_lossy());
        let format = match extension.as_deref().map(str::to_ascii_lowercase).as_deref() {
            Some("svg") => Format::Svg,
            Some("png") => Format::Png,
            Some("pdf") => Format::Pdf,
            _ => return Err(ChartError::Extension { path: path.to_owned() }),
        };
        Ok(Self { path: path.to_owned(), format })
    }

    /// Writes the picture.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, picture: &Picture) -> Result<(), ChartError> {
        self.write_scaled(picture, SCALE)
    }

    /// Writes the picture, a PNG with `scale` pixels for each pixel of the drawing.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write_scaled(&self, picture: &Picture, scale: f32) -> Result<(), ChartError> {
        let bytes = match self.format {
            Format::Svg => picture.svg.clone().into_bytes(),
            Format::Png => picture.png(scale)?,
            Format::Pdf => picture.pdf()?,
        };
        std::fs::write(&self.path, bytes)
            .map_err(|source| ChartError::Output { path: self.path.clone(), source })
    }
}

impl Picture {
    /// A picture from its SVG.
    pub(super) fn new(svg: String) -> Self {
        Self { svg }
    }

    /// As SVG.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// As PNG, with the same font on every machine, and `scale` pixels for each pixel of the drawing.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn png(&self, scale: f32) -> Result<Vec<u8>, ChartError> {
        let tree = self.tree()?;
        let size = tree.size().to_int_size();
        let size = size.scale_by(scale).unwrap_or(size);
        let mut pixels =
            Pixmap::new(size.width(), size.height()).ok_or_else(|| failed("it has no area"))?;
        let scale = Transform::from_scale(scale, scale);
        resvg::render(&tree, scale, &mut pixels.as_mut());
        encoded(&pixels).map_err(failed)
    }

    /// As PDF: vector lines, searchable text, and embedded fonts.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn pdf(&self) -> Result<Vec<u8>, ChartError> {
        let page = PageOptions { dpi: DOTS_PER_INCH };
        to_pdf(&self.tree()?, ConversionOptions::default(), page).map_err(failed)
    }

    /// The parsed drawing for the output libraries, with the same font on every machine.
    fn tree(&self) -> Result<Tree, ChartError> {
        let mut fonts = Database::new();
        fonts.load_font_source(Source::Binary(Arc::new(dejavu::sans::regular())));
        fonts.set_sans_serif_family("DejaVu Sans");
        let options = Options { fontdb: Arc::new(fonts), ..Options::default() };
        Tree::from_str(&self.svg, &options).map_err(failed)
    }
}

/// Pixels as a PNG. Drawings are opaque, so no alpha channel is needed; with it, files would be more than
/// twice as large.
fn encoded(pixels: &Pixmap) -> Result<Vec<u8>, EncodingError> {
    let colours: Vec<u8> = pixels
        .pixels()
        .iter()
        .flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
        .collect();
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, pixels.width(), pixels.height());
    encoder.set_color(ColorType::Rgb);
    // Lines on white have no gradients, so filters do not help.
    encoder.set_filter(FilterType::NoFilter);
    encoder.set_compression(Compression::Best);
    encoder.write_header()?.write_image_data(&colours)?;
    Ok(file)
}

fn failed(error: impl ToString) -> ChartError {
    ChartError::Drawing(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::growth::growth;

    #[test]
    fn the_extension_says_what_is_written() {
        let names = ["a.svg", "b.SVG", "c.png", "d.pdf"];
        assert_eq!(names.map(|name| Output::new(Path::new(name)).is_ok()), [true; 4]);
        for name in ["a.eps", "svg", ""] {
            let error = Output::new(Path::new(name)).unwrap_err().to_string();
            assert!(error.contains("must end in .svg, .png or .pdf"), "{error}");
        }
    }

    #[test]
    fn a_pdf_has_the_size_of_the_drawing_and_its_letters() {
        let picture = growth("A title to be seen", 1e-3, &[0.0, 1.0, -2.0]).unwrap();
        let pdf = picture.pdf().unwrap();
        let has = |words: &[u8]| pdf.windows(words.len()).any(|window| window == words);
        assert!(pdf.starts_with(b"%PDF-") && has(b"DejaVuSans"));
        // 820 by 560 pixels of 1/96 inch, in points of 1/72.
        assert!(has(b"/MediaBox [0 0 615 420]"));
        assert_eq!(pdf, picture.pdf().unwrap());
    }

    #[test]
    fn letters_are_in_the_png_without_any_font_on_the_machine() {
        // Only the bundled font is loaded; without it the rows of the title would be white.
        let picture = growth("A title to be seen", 1e-3, &[0.0, 1.0, -2.0]).unwrap();
        let pixels = Pixmap::decode_png(&picture.png(SCALE).unwrap()).unwrap();
        let rows = 24 * pixels.width() as usize..64 * pixels.width() as usize;
        let dark = pixels.pixels()[rows].iter().filter(|pixel| pixel.red() < 100).count();
        assert!(dark > 200, "{dark}");
    }
}
