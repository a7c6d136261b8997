//! Scene files: TOML, or JSON of the same shape.
//!
//! Every key is needed unless it is said to be optional here; an unknown key is an error. The
//! bounds on the values are in [`key`].
//!
//! ```toml
//! name = "delayed wall"
//! [device]
//! inertia = 2.2e-5              # kg m^2, for simulation
//! damping = 0.022               # N m s/rad
//! # passivity = 0.021           # optional: delta, where it is less than the damping
//! # friction = 0.003            # optional: N m, dry friction at the motor
//! [servo]
//! period = 0.001                # s
//! # worst_period = 0.002        # optional: s, longest tolerated time between two updates
//! [coupling]                    # optional: without it the connection is rigid
//! stiffness = 44.0              # N m/rad
//! [environment]
//! type = "damper-wall"          # stiffness, damping, delay; optional: filter, face, one_sided
//! stiffness = 22.0              # N m/rad
//! damping = 0.01                # N m s/rad
//! delay = 1                     # samples
//! ```
//!
//! The other types are `delayed-spring` (`stiffness`, `delay`), `free-mode` (`residual`; optional:
//! `delay`), `free-mode-wall` (`residual` and the keys of a wall) and `rational` (`numerator`,
//! `denominator`; optional: `delay`, `unit_zeros`; zeros at the denominator's end are delay as well).
//! A wall must say its delay, because a delay that is forgotten is one that is not accounted for.
//! `[simulation]`, `[human]` and `[limits]` are optional; `limits.torque` makes the torque limit part of
//! what is certified. With the angle of one encoder count, `limits.encoder_step`, with the torque at the
//! converter's largest code, `limits.full_scale`, and with `device.friction` the certificate says
//! whether the device comes to rest.
//!
//! ```toml
//! [simulation]
//! samples = 1000
//! position = 0.001              # optional: rad at sample 0
//! velocity = 0.0                # optional: rad/s at sample 0
//! torque_sine = { amplitude = 0.01, omega = 60.0, phase = 0.0 } # optional: N m, rad/s, rad
//! # torque = [0.1, 0.2]         # instead: N m, one a sample; or torque_file, numbers in a file
//! friction = 0.002              # optional: N m, where it is not `device.friction`
//! latency = 0.0002              # optional: s from sample to torque, less than the period
//! missed = { fraction = 0.01, seed = 1 } # optional: ticks without a servo; or { every = 2 }
//! ```
//!
//! A device that is not rigid is a chain of masses in place of `inertia` and `damping`, the motor's
//! mass first and the hand's last, with one link fewer than masses. A mass without `damping` has
//! none, a link likewise. Its passivity is computed ([`crate::chain`]).
//!
//! ```toml
//! [device]
//! # encoder = "hand"            # optional: on the last mass; "motor" without it
//! # actuator_lag = 0.0002       # optional: s, first-order lag of the amplifier
//! [[device.mass]]
//! inertia = 2.0e-5
//! damping = 0.02
//! [[device.mass]]
//! inertia = 3.0e-5
//! damping = 0.005
//! [[device.link]]
//! stiffness = 40.0              # N m/rad
//! damping = 0.015               # N m s/rad
//! ```

pub mod device;
pub mod key;
pub mod scene;
pub mod simulation;
pub mod write;

mod json;
mod problem;
mod section;
mod toml;
mod tree;

use std::io::Read;
use std::path::Path;

pub use device::{DeviceFile, Purpose};
pub use problem::{FileError, Problem, excerpt};
pub use scene::SceneFile;

use problem::Fault;
use tree::Node;

/// Longest scene file in bytes: a hundred times the longest that a person writes, and read in a
/// moment.
pub const MAX_BYTES: u64 = 4 << 20;

/// The two formats of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// TOML.
    Toml,
    /// JSON.
    Json,
}

impl Format {
    /// By the file's extension; where that says nothing, an object's brace means JSON.
    pub fn of(file: &str, text: &str) -> Self {
        match Path::new(file).extension().and_then(|extension| extension.to_str()) {
            Some("toml") => Self::Toml,
            Some("json") => Self::Json,
            _ if text.trim_start().starts_with('{') => Self::Json,
            _ => Self::Toml,
        }
    }
}

/// Reads a scene file to certify; `-` is standard input.
pub fn load(file: &str) -> Result<SceneFile, FileError> {
    load_for(Purpose::Certify, file)
}

/// Reads a scene file; `-` is standard input.
pub fn load_for(purpose: Purpose, file: &str) -> Result<SceneFile, FileError> {
    load_with(file, |root, text| scene::read(text, root, purpose))
}

/// Reads the device of a file, which has nothing else or is a scene; `-` is standard input.
pub fn load_device(file: &str) -> Result<DeviceFile, FileError> {
    load_with(file, |root, text| device::read(text, root))
}

/// Parses the text of a device file that is called `file`.
pub fn parse_device(file: &str, format: Format, text: &str) -> Result<DeviceFile, FileError> {
    parse_with(file, 1, format, text, |root, text| device::read(text, root))
}

fn load_with<T>(
    file: &str,
    read: impl FnOnce(Node, &str) -> Result<T, Fault>,
) -> Result<T, FileError> {
    let (file, bytes) = match file {
        "-" => ("<stdin>", bounded(std::io::stdin().lock())),
        _ => (file, std::fs::File::open(file).map_err(unreadable).and_then(bounded)),
    };
    let bytes = bytes.map_err(|problem| FileError::whole(file, 1, 1, problem))?;
    let text = text_of(file, 1, &bytes)?;
    parse_with(file, 1, Format::of(file, text), text, read)
}

/// Parses the text of a scene file that is called `file`, to certify it.
pub fn parse(file: &str, format: Format, text: &str) -> Result<SceneFile, FileError> {
    parse_at(file, 1, format, text)
}

/// Parses the text of a scene file that is called `file`.
pub fn parse_for(
    purpose: Purpose,
    file: &str,
    format: Format,
    text: &str,
) -> Result<SceneFile, FileError> {
    parse_with(file, 1, format, text, |root, text| scene::read(text, root, purpose))
}

/// Parses a text that begins at a line of a longer file.
pub fn parse_at(
    file: &str,
    first_line: usize,
    format: Format,
    text: &str,
) -> Result<SceneFile, FileError> {
    let to_certify = |root: Node, text: &str| scene::read(text, root, Purpose::Certify);
    parse_with(file, first_line, format, text, to_certify)
}

fn parse_with<T>(
    file: &str,
    first_line: usize,
    format: Format,
    text: &str,
    read: impl FnOnce(Node, &str) -> Result<T, Fault>,
) -> Result<T, FileError> {
    let root = root(format, text);
    let found = root.and_then(|root| read(root, text));
    found.map_err(|fault| FileError::new(file, text, first_line, fault))
}

/// The bytes of a file as text, or the place of the first byte that is not.
pub fn text_of<'b>(file: &str, first_line: usize, bytes: &'b [u8]) -> Result<&'b str, FileError> {
    std::str::from_utf8(bytes).map_err(|error| {
        let offset = error.valid_up_to();
        let before = &bytes[..offset];
        let line = first_line + before.iter().filter(|&&byte| byte == b'\n').count();
        let column = 1 + before.iter().rev().take_while(|&&byte| byte != b'\n').count();
        let byte = bytes.get(offset).copied().unwrap_or_default();
        FileError::whole(file, line, column, Problem::NotText { byte, offset })
    })
}

fn root(format: Format, text: &str) -> Result<Node, Fault> {
    let root = match format {
        Format::Toml => toml::parse(text)?,
        Format::Json => json::parse(text)?,
    };
    if scene::is_empty(&root) {
        return Err(Fault { span: 0..0, problem: Problem::Empty });
    }
    Ok(root)
}

fn bounded(source: impl Read) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    source.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(Problem::TooLong { bound: MAX_BYTES });
    }
    Ok(bytes)
}

fn unreadable(error: std::io::Error) -> Problem {
    Problem::Unreadable(error.to_string())
}
