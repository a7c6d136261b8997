//! The programs' sources: one file each in `firmware/src/bin`.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use haptic_servo::magnetic::Chip;

use crate::file::program::option_of;

/// The module of the examples' paddle, in the file of a program for it.
const PADDLE: &str = "mod paddle;";
/// The call in the file of a scene's program; a file without it is another kind of program.
const SCENE: &str = "scene_program!";
/// The call in the file of a sweep's program.
const SWEEP: &str = "sweep_program!";

/// The options of a sweep that are not followed by a chip.
const SWEEP_OPTIONS: &str = "sweep_program!(SWEEP, TRANSDUCERS, LIMITS";

/// A device in place of the paddle.
#[derive(Clone, Debug)]
pub struct OtherDevice {
    /// Its module.
    pub module: String,
    /// The chip of its magnetic encoder.
    pub chip: Option<&'static Chip>,
}

/// The folder of the programs' files.
#[derive(Clone, Debug)]
pub struct Sources {
    folder: PathBuf,
}

/// Errors of the programs' sources.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum SourcesError {
    /// The sources are not where they were when this program was built.
    #[error("the workspace is no longer at {0}: run `cargo haptic` in the workspace")]
    NoWorkspace(PathBuf),
    #[error("{path}: {source}")]
    File { path: PathBuf, source: io::Error },
    #[error("there is no scene {name}; there are {}", .scenes.join(", "))]
    NoScene { name: String, scenes: Vec<String> },
    #[error("there is no program {name}; there are {}", .programs.join(", "))]
    NoProgram { name: String, programs: Vec<String> },
    #[error("{name} has its device in its own file, {}: only programs for the paddle take another", .path.display())]
    OwnDevice { name: String, path: PathBuf },
    #[error(
        "the scene of {name} does not cover the readings of the device's `encoder.chip` = \"{chip}\": write a scene \
         file with that device"
    )]
    NoReading { name: String, chip: &'static str },
    #[error("`{name}` is not a valid name of a scene: {why}")]
    Name { name: String, why: String },
    #[error("{} exists already; nothing was changed", .0.display())]
    Exists(PathBuf),
}

/// Longest name of a scene in bytes: a board sends its scene's name in one message.
const LONGEST: usize = 32;

/// Names that a scene's module or program must not have: words of the language, crates that a scene's file
/// uses, the programs and tests of the workspace, and cargo's own folders.
const TAKEN: &str = "\
    abstract adversary analysis as async await become bench_all bench_programs board box break \
    bridge_load build certify_server clap const continue core corpus crate deps device do dyn else enum \
    examples extern false final fixed fn for gen haptic haptic_servo harness if impl in incremental let \
    loop macro main match mod move mut on_target override paddle priv program pub raw ref refusals \
    return safe self static std struct super test tests trait try type typeof union unsafe \
    unsized use virtual where while yield";

/// The root of the workspace that this program was built from.
pub(super) fn workspace_root() -> Result<PathBuf, SourcesError> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    root.canonicalize().map_err(|_| SourcesError::NoWorkspace(root))
}

impl Sources {
    /// The sources of the workspace that this program was built from.
    pub fn find() -> Result<Self, SourcesError> {
        Ok(Self::of(&workspace_root()?))
    }

    /// The sources of a workspace.
    pub(super) fn of(root: &Path) -> Self {
        Self { folder: root.join("firmware/src/bin") }
    }

    /// The file of the program of this name, which need not exist.
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.rs"))
    }

    /// Whether the program of this name is for a board's bridge: its call then has a current loop. False if
    /// there is no such program.
    pub fn is_for_bridge(&self, name: &str) -> Result<bool, SourcesError> {
        let path = self.file(name);
        match fs::read_to_string(&path) {
            Ok(text) => Ok([SCENE, SWEEP].into_iter().any(|program| {
                text.split_once(program).is_some_and(|(_, call)| call.contains("bridge:"))
            })),
            Err(source) if source.kind() == io::ErrorKind::NotFound => Ok(false),
            Err(source) => Err(SourcesError::File { path, source }),
        }
    }

    /// Names of all programs in alphabetical order.
    pub fn programs(&self) -> Result<Vec<String>, SourcesError> {
        let failed = |source| SourcesError::File { path: self.folder.clone(), source };
        let mut programs = Vec::new();
        for entry in self.folder.read_dir().map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if let (Some(name), Some("rs")) =
                (path.file_stem(), path.extension().and_then(|extension| extension.to_str()))
            {
                programs.push(name.to_string_lossy().into_owned());
            }
        }
        programs.sort();
        Ok(programs)
    }

    /// Names of the programs that render a scene, in the same order.
    pub fn scenes(&self) -> Result<Vec<String>, SourcesError> {
        let mut programs = self.programs()?;
        programs.retain(|name| {
            fs::read_to_string(self.file(name)).is_ok_and(|text| text.contains(SCENE))
        });
        Ok(programs)
    }

    /// The text of a scene that begins as a copy of another, without the comment at the top of that file, and
    /// perhaps [with another device](Self::on_device).
    ///
    /// # Errors
    /// If the scene to copy does not exist, or is for another device than the paddle.
    pub fn copied(
        &self,
        name: &str,
        from: &str,
        device: Option<&OtherDevice>,
    ) -> Result<String, SourcesError> {
        let scenes = self.scenes()?;
        if !scenes.iter().any(|scene| scene == from) {
            return Err(SourcesError::NoScene { name: from.into(), scenes });
        }
        let text = match device {
            Some(device) => self.on_device(from, device)?,
            None => self.text(from)?,
        };
        let rest = text.lines().skip_while(|line| line.starts_with("//!"));
        let head = format!("//! The scene {name}, begun as a copy of {from}.");
        Ok(std::iter::once(head.as_str()).chain(rest).flat_map(|line| [line, "\n"]).collect())
    }

    /// The text of a program for the paddle of the examples, with another module of a device in its place.
    ///
    /// # Errors
    /// If there is no such program, if it is for another device, or if it has a scene and the device a chip, whose
    /// readings no scene of the examples covers.
    pub fn on_device(&self, name: &str, device: &OtherDevice) -> Result<String, SourcesError> {
        let programs = self.programs()?;
        if !programs.iter().any(|program| program == name) {
            return Err(SourcesError::NoProgram { name: name.into(), programs });
        }
        let text = self.text(name)?;
        if !self.takes_device(name) {
            return Err(SourcesError::OwnDevice { name: name.into(), path: self.file(name) });
        }
        let text = text.replace(PADDLE, device.module.trim_end()).replace("paddle::", "device::");
        match device.chip {
            None => Ok(text),
            Some(chip) if text.contains(SWEEP_OPTIONS) => {
                let options = format!("{SWEEP_OPTIONS}, {}", option_of(chip));
                Ok(text.replace(SWEEP_OPTIONS, &options))
            }
            Some(chip) => Err(SourcesError::NoReading { name: name.into(), chip: chip.name }),
        }
    }

    /// Whether [another device](Self::on_device) may take the place of a program's.
    pub fn takes_device(&self, name: &str) -> bool {
        self.text(name).is_ok_and(|text| text.contains(PADDLE))
    }

    fn text(&self, name: &str) -> Result<String, SourcesError> {
        let path = self.file(name);
        fs::read_to_string(&path).map_err(|source| SourcesError::File { path, source })
    }

    /// Creates a scene with this text, and returns its file.
    ///
    /// # Errors
    /// If the name is invalid or in use.
    pub fn begin(&self, name: &str, text: &str) -> Result<PathBuf, SourcesError> {
        check(name).map_err(|why| SourcesError::Name { name: name.into(), why })?;
        let path = self.file(name);
        // Never overwrites a file, even one created meanwhile.
        match File::create_new(&path).and_then(|mut file| file.write_all(text.as_bytes())) {
            Ok(()) => Ok(path),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                Err(SourcesError::Exists(path))
            }
            Err(source) => Err(SourcesError::File { path, source }),
        }
    }
}

/// Checks the name of a new scene; the error is the reason why it is invalid.
fn check(name: &str) -> Result<(), String> {
    let begins_well = name.starts_with(|c: char| c.is_ascii_lowercase());
    let is_of = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if !begins_well || !name.chars().all(is_of) {
        Err("expected lower-case letters, digits and underscores, with a letter first, for example \
             soft_wall"
            .into())
    } else if name.len() > LONGEST {
        Err(format!("it has {} bytes, and at most {LONGEST} are allowed", name.len()))
    } else if TAKEN.split(' ').any(|taken| taken == name) {
        Err("the name is reserved by the compiler or the firmware".into())
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_for_the_paddle_takes_another_device() {
        let root = tempfile::tempdir().unwrap();
        let sources = Sources::of(root.path());
        fs::create_dir_all(&sources.folder).unwrap();
        fs::write(sources.file("wall"), "mod paddle;\nuse paddle::DEVICE;\n").unwrap();
        fs::write(sources.file("bridge"), "mod bridge_paddle;\n").unwrap();
        let sweep = "mod paddle;\nsweep_program!(SWEEP, TRANSDUCERS, LIMITS);\n";
        fs::write(sources.file("sweep"), sweep).unwrap();
        let with = |name, chip| {
            let device = OtherDevice { module: "mod device {}".to_owned(), chip };
            sources.on_device(name, &device).map_err(|error| error.to_string())
        };
        let on = |name| with(name, None);
        let chip = Chip::find("mt6701");
        let options = "LIMITS, encoder: haptic_servo::magnetic::MT6701);";
        assert!(with("sweep", chip).unwrap().ends_with(&format!("{options}\n")));
        assert!(with("wall", chip).unwrap_err().contains("`encoder.chip` = \"mt6701\""));
        assert_eq!(on("wall").unwrap(), "mod device {}\nuse device::DEVICE;\n");
        assert!(on("bridge").unwrap_err().contains("has its device in its own file"));
        assert!(on("wrist").unwrap_err().contains("there is no program wrist"));
    }

    #[test]
    fn a_scene_is_called_what_a_module_and_a_program_can_be_called() {
        for name in ["soft_wall", "a", "wall2", &"w".repeat(LONGEST)] {
            assert_eq!(check(name), Ok(()), "{name}");
        }
        for name in ["", "2walls", "_wall", "soft-wall", "Wall", "wall.rs", "../wall", "wällchen"]
        {
            assert!(check(name).unwrap_err().contains("letters, digits"), "{name}");
        }
        assert!(check(&"w".repeat(LONGEST + 1)).unwrap_err().contains("it has 33 bytes"));
        for name in TAKEN.split(' ') {
            assert!(check(name).unwrap_err().contains("reserved"), "{name}");
        }
    }

    #[test]
    fn a_scene_begins_as_a_copy_and_never_over_a_file() {
        let root = tempfile::tempdir().unwrap();
        let sources = Sources::of(root.path());
        fs::create_dir_all(&sources.folder).unwrap();
        let other =
            "//! A wall\n//! of the paper.\n#![no_std]\n\nhaptic_servo::scene_program! {}\n";
        fs::write(sources.file("wall"), other).unwrap();
        fs::write(sources.file("identify"), "haptic_servo::sweep_program!(SWEEP);\n").unwrap();

        let path = sources.begin("soft", &sources.copied("soft", "wall", None).unwrap()).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        let head = "//! The scene soft, begun as a copy of wall.\n";
        assert_eq!(text, format!("{head}#![no_std]\n\nhaptic_servo::scene_program! {{}}\n"));
        assert_eq!(sources.scenes().unwrap(), ["soft", "wall"]);
        assert_eq!(sources.programs().unwrap(), ["identify", "soft", "wall"]);

        let said = |name| sources.begin(name, "").unwrap_err().to_string();
        fs::write(&path, "mine").unwrap();
        assert!(said("soft").ends_with("soft.rs exists already; nothing was changed"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
        assert!(said("match").starts_with("`match` is not a valid name of a scene: "));
        assert!(!sources.file("match").exists());
        let copied = sources.copied("x", "identify", None).unwrap_err().to_string();
        // The other file is no program of a scene any more.
        assert_eq!(copied, "there is no scene identify; there are wall");
    }
}
