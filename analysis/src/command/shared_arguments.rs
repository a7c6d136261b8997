//! Arguments of several commands: a scene, a method and its steps, a number format, a number of ticks, and
//! output as text or as one JSON object.

use std::io::{self, Write};
use std::path::Path;

use clap::Args;
use haptic_servo::number::Format;
use serde::Serialize;

use super::status::CommandError;
use crate::file::{self, Purpose, SceneFile};
use crate::number;
use crate::simulation::Integration;
use crate::simulation::method::Method;
use crate::verdict::{VerdictReport, judge_file};

#[derive(Debug, Args)]
pub struct SceneArgument {
    /// Scene file, TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE")]
    pub file: String,
}

impl SceneArgument {
    /// Reads it for a certificate.
    pub fn load(&self) -> Result<SceneFile, CommandError> {
        Ok(warned(file::load(&self.file)?))
    }

    /// Reads it for a simulation.
    pub fn load_to_simulate(&self) -> Result<SceneFile, CommandError> {
        Ok(warned(file::load_for(Purpose::Simulate, &self.file)?))
    }

    /// The folder of the files that it names.
    pub fn folder(&self) -> &Path {
        folder(&self.file)
    }
}

/// The scene of a file, whose implausible numbers standard error names.
pub fn warned(file: SceneFile) -> SceneFile {
    for warning in file::warnings(&file) {
        // If the terminal is gone, the warning is lost.
        let _ = writeln!(io::stderr(), "warning: {warning}");
    }
    file
}

/// The folder of a file; the current folder for standard input.
pub fn folder(file: &str) -> &Path {
    Path::new(file).parent().unwrap_or(Path::new(""))
}

/// Integration method of the device and its substeps.
#[derive(Debug, Args)]
pub struct IntegrationArguments {
    /// Method of integration of the device; the servo is computed tick by tick in every method
    #[arg(long, value_enum, default_value_t)]
    pub method: Method,
    /// Steps of the method in each tick
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub substeps: u32,
}

impl IntegrationArguments {
    pub fn integration(&self) -> Integration {
        Integration { method: self.method, substeps: self.substeps }
    }
}

/// Number format of the servo's coefficients.
#[derive(Debug, Args)]
pub struct CoefficientFormat {
    /// Certify with the coefficients as this number format rounds them: f32, or 32-bit fixed point
    /// such as i8f24; f64 does not round them
    #[arg(long, default_value = "f64", value_parser = number::format)]
    pub format: Format,
}

impl CoefficientFormat {
    /// The verdict on a file's scene.
    pub fn judge(&self, file: &SceneFile) -> Result<VerdictReport, CommandError> {
        number::fits(&file.scene, self.format)?;
        Ok(judge_file(file, self.format))
    }
}

pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<(), CommandError> {
    let written = std::fs::write(path, content);
    written.map_err(|source| CommandError::Unwritable { path: path.to_owned(), source })
}

/// Default number of ticks of a run: the trajectory of the hand and some time to come to rest.
pub const DEFAULT_TICKS: usize = 5000;

/// Largest number of ticks of a run, which keeps all of them until its end: hours at a kilohertz, and half a
/// gigabyte.
pub const MAX_TICKS: u64 = 10_000_000;

/// Whether a result is printed as JSON.
#[derive(Debug, Args)]
pub struct JsonOption {
    /// Print JSON
    #[arg(long, global = true)]
    pub json: bool,
}

impl JsonOption {
    /// Prints the result as JSON or as text.
    pub fn print<A: Serialize>(
        &self,
        answer: &A,
        text: impl FnOnce(&A) -> String,
    ) -> Result<(), CommandError> {
        let mut out = io::BufWriter::new(io::stdout().lock());
        if self.json {
            json(&mut out, answer)?;
        } else {
            write!(out, "{}", text(answer))?;
        }
        Ok(out.flush()?)
    }
}

/// Writes a result as one JSON object on a line.
pub fn json(mut out: impl Write, answer: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut out, answer)?;
    writeln!(out)
}
