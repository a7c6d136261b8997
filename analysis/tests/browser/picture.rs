//! Pixels of a PNG.

use std::io::{BufRead, Seek};

/// Its size, and its pixels as red, green and blue; and the text that is kept with it under a word.
pub struct Picture {
    pub size: [u32; 2],
    pub pixels: Vec<[u8; 3]>,
    pub words: String,
}

impl Picture {
    pub fn read(source: impl BufRead + Seek, word: &str) -> Self {
        let mut reader = png::Decoder::new(source).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size()];
        let frame = reader.next_frame(&mut bytes).unwrap();
        let samples = frame.color_type.samples();
        assert!(samples >= 3 && frame.bit_depth == png::BitDepth::Eight, "{frame:?}");
        bytes.truncate(frame.buffer_size());
        let pixels = bytes.chunks_exact(samples).map(|one| [one[0], one[1], one[2]]).collect();
        let words = reader.info().utf8_text.iter().find(|text| text.keyword == word);
        let words = words.map_or_else(String::new, |text| text.get_text().unwrap());
        Self { size: [frame.width, frame.height], pixels, words }
    }
}
