//! Building programs for the board.

use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use haptic_servo::magnetic::Chip;
use haptic_servo::words;

use super::memory::Memory;
use super::output::last_lines;
use super::size::Sizes;
use super::sources::{Sources, SourcesError, workspace_root};
use super::{BoardModel, Target, TorqueOutput};

const TARGET: &str = Target::BOARD.name;

words! {
    /// The number format of a scene's program.
    #[derive(Hash, clap::ValueEnum)]
    NumberFormat {
    /// Single-precision floating point.
    F32 "f32",
    /// The scene's fixed-point format; a scene file's is I8F24.
    Fixed "fixed",
    }
}

impl fmt::Display for NumberFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// The reason why a program could not be built.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum BuildError {
    #[error(transparent)]
    Sources(#[from] SourcesError),
    /// A file could not be read or written, or has no valid content.
    #[error("{path}: {source}")]
    File { path: PathBuf, source: io::Error },
    #[error(
        "the board {board} has no bridge that this firmware drives; {} has",
        BoardModel::BG431bEsc1
    )]
    NoBridge { board: BoardModel },
    #[error(
        "the board {board} does not read the {chip} beside its {}: the {} reads {} beside its DAC, and the {} beside \
         its bridge, in a scene with the table [motor], or in an own copy of brushless_identify",
        match output { TorqueOutput::Bridge => "bridge", TorqueOutput::Dac => "DAC" },
        BoardModel::NucleoG474re,
        Chip::NAMES.join(", "),
        BoardModel::BG431bEsc1
    )]
    NoChip { board: BoardModel, output: TorqueOutput, chip: &'static str },
    #[error("cargo could not be started: {0}")]
    NoCargo(#[source] io::Error),
    #[error("{program} does not compile:\n{output}")]
    Compile { program: String, output: String },
    /// The linker's error, by its bytes.
    #[error(
        "{program} takes {} bytes of flash on the board {board}, {over} more than the {allowed} that it may: give \
         its tables of torques fewer values, or leave out `[anticogging]`, `[host]` or `encoder.chip`",
        allowed + over
    )]
    Flash { program: String, board: String, over: u64, allowed: u64 },
    /// The same of its variables.
    #[error(
        "{program} takes {} bytes of RAM on the board {board}, {over} more than the {allowed} that it may: build it \
         in f32, give its tables of torques fewer values, or leave out `[anticogging]` or `[host]`",
        allowed + over
    )]
    Ram { program: String, board: String, over: u64, allowed: u64 },
}

/// The compiler that builds for the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compiler {
    /// The toolchain of the rest of the workspace.
    Own,
    /// Debian's toolchain, which also builds `core` from source.
    Debian,
}

/// A toolchain that builds programs for the board, made by [`prepare`](super::prepare()).
#[derive(Clone, Debug)]
pub struct Toolchain {
    compiler: Compiler,
    workspace: Workspace,
}

/// A built program.
#[derive(Clone, Debug)]
pub struct Program {
    /// Its file.
    pub path: PathBuf,
    /// Its use of a board's memory.
    pub sizes: Sizes,
}

/// The folder of the source, and the folder of its builds.
#[derive(Clone, Debug)]
pub(super) struct Workspace {
    root: PathBuf,
    /// Cargo's folder for this machine's programs, and the folder for the boards' programs in it.
    target: PathBuf,
    output: PathBuf,
}

/// The programs of a package in one variant.
struct Variant<'a> {
    package: &'a str,
    features: String,
    /// The addition to the names of the programs' files.
    suffix: String,
    /// The file of the scene that [`SCENE_PACKAGE`] makes a program of.
    scene: Option<&'a Path>,
}

/// The package of a scene's file in another place than `firmware/src/bin`, and its program.
const SCENE_PACKAGE: &str = "haptic-scene";
/// The variable that names the scene or its file.
const SCENE_VARIABLE: &str = "HAPTIC_SCENE";

impl Variant<'static> {
    /// Scenes' programs in a number format.
    fn scene(features: &str, format: NumberFormat, suffix: &str) -> Self {
        let fixed = if format == NumberFormat::Fixed { ",fixed-point" } else { "" };
        let (features, suffix) = (format!("{features}{fixed}"), format!("-{format}{suffix}"));
        Self { package: "haptic-servo", features, suffix, scene: None }
    }

    /// The only program of a package.
    fn of(package: &'static str, features: &str) -> Self {
        Self { package, features: features.into(), suffix: String::new(), scene: None }
    }
}

/// The features of a board's programs, which may read a chip, and the addition to the names of their files.
fn board_variant(
    board: BoardModel,
    output: TorqueOutput,
    chip: Option<&Chip>,
) -> Result<[String; 2], BuildError> {
    let [features, suffix] = match output {
        TorqueOutput::Dac => [board.to_string(), format!("-{board}")],
        TorqueOutput::Bridge if board.has_bridge() => {
            [format!("{board},bridge"), format!("-{board}-bridge")]
        }
        TorqueOutput::Bridge => return Err(BuildError::NoBridge { board }),
    };
    match chip {
        Some(&Chip { name: chip, .. }) if !board.reads_chips(output) => {
            Err(BuildError::NoChip { board, output, chip })
        }
        Some(_) => Ok([features + ",magnetic", suffix]),
        None => Ok([features, suffix]),
    }
}

impl Toolchain {
    pub(super) fn new(compiler: Compiler, workspace: Workspace) -> Self {
        Self { compiler, workspace }
    }

    /// Names of the programs in alphabetical order.
    pub fn scenes(&self) -> Result<Vec<String>, BuildError> {
        Ok(Sources::of(&self.workspace.root).programs()?)
    }

    /// The default torque output of a program: the board's bridge, if its scene is certified with the
    /// bridge's latency.
    pub fn output_of(&self, name: &str) -> Result<TorqueOutput, BuildError> {
        let bridge = Sources::of(&self.workspace.root).is_for_bridge(name)?;
        Ok(if bridge { TorqueOutput::Bridge } else { TorqueOutput::Dac })
    }

    /// Builds a scene's program for the emulated board, with its log, and returns its file.
    pub fn build_scene(&self, name: &str, format: NumberFormat) -> Result<PathBuf, BuildError> {
        Ok(self.build_scenes(&[name], format)?.swap_remove(0))
    }

    /// Builds several scenes' programs at the same time like [`build_scene`](Self::build_scene), and returns
    /// their files in the same order.
    pub fn build_scenes(
        &self,
        names: &[&str],
        format: NumberFormat,
    ) -> Result<Vec<PathBuf>, BuildError> {
        self.scenes_programs(names, &Variant::scene("board-qemu,log", format, ""))
    }

    /// Builds scenes' programs for the emulated board in `f32`, without log and measurements.
    pub fn build_bare(&self, names: &[&str]) -> Result<Vec<Program>, BuildError> {
        let bare = Variant::scene("board-qemu", NumberFormat::F32, "-bare");
        self.scenes_programs(names, &bare)?.into_iter().map(Program::at).collect()
    }

    /// Builds programs to be flashed, for a board and its torque output.
    ///
    /// # Errors
    /// Also if one does not fit, or if the board has no such output.
    pub fn build_for(
        &self,
        board: BoardModel,
        output: TorqueOutput,
        names: &[&str],
        format: NumberFormat,
    ) -> Result<Vec<Program>, BuildError> {
        let [features, suffix] = board_variant(board, output, None)?;
        let variant = Variant::scene(&features, format, &suffix);
        self.scenes_programs(names, &variant)?.into_iter().map(Program::at).collect()
    }

    /// Writes the program of a scene file below cargo's folder, and returns its file.
    pub fn write_scene(&self, name: &str, text: &str) -> Result<PathBuf, BuildError> {
        let folder = self.workspace.target.join("scenes");
        let path = folder.join(format!("{name}.rs"));
        // A program that is written again is built again.
        if fs::read_to_string(&path).is_ok_and(|before| before == text) {
            return Ok(path);
        }
        match fs::create_dir_all(&folder).and_then(|()| fs::write(&path, text)) {
            Ok(()) => Ok(path),
            Err(source) => Err(BuildError::File { path, source }),
        }
    }

    /// Builds the program in a file of [`write_scene`](Self::write_scene): for a board as if to be flashed,
    /// or for the emulated board with its log. The chip of a magnetic encoder is read by the board alone.
    pub fn build_written(
        &self,
        file: &Path,
        board: Option<(BoardModel, TorqueOutput)>,
        format: NumberFormat,
        chip: Option<&Chip>,
    ) -> Result<Program, BuildError> {
        let [features, suffix] = match board {
            Some((board, output)) => board_variant(board, output, chip)?,
            None => ["board-qemu,log".to_owned(), String::new()],
        };
        let name = file.file_stem().map(|name| name.to_string_lossy()).unwrap_or_default();
        let variant = Variant::scene(&features, format, &suffix);
        let suffix = format!("-{name}{}", variant.suffix);
        let variant = Variant { package: SCENE_PACKAGE, suffix, scene: Some(file), ..variant };
        Program::at(self.build(&[SCENE_PACKAGE], &variant)?.swap_remove(0))
    }

    /// Builds the tests that run on a board, like a user, and returns their file: a board's own bridge has
    /// other tests than its DAC.
    pub fn build_tests(
        &self,
        board: BoardModel,
        output: TorqueOutput,
    ) -> Result<PathBuf, BuildError> {
        let [features, suffix] = board_variant(board, output, None)?;
        let name = match output {
            TorqueOutput::Dac => "on_target",
            TorqueOutput::Bridge => "bridge_load",
        };
        let build = ["--release", "--package", "board-tests", "--target", TARGET];
        let tests = ["--features", &features, "--test", name];
        let _lock = self.workspace.lock("build")?;
        let mut cargo = self.cargo(Target::BOARD);
        // Cargo chooses the name of a test's file, and prints it.
        cargo.args(build).args(tests).arg("--message-format=json-render-diagnostics");
        let printed = output_of(name, &mut cargo)?;
        let built = printed.lines().find_map(|line| executable(line, name));
        let built = built.ok_or_else(|| BuildError::Compile {
            program: name.into(),
            output: "cargo has built no such test".into(),
        })?;
        self.workspace.keep(&built, &format!("{name}{suffix}"))
    }

    /// Builds a foreign package, in a folder outside the workspace, for the boards, like programs to be
    /// flashed, and returns the program of this name.
    pub fn build_foreign(&self, folder: &Path, name: &str) -> Result<Program, BuildError> {
        let _lock = self.workspace.lock("build")?;
        let mut cargo = self.cargo(Target::BOARD);
        cargo.current_dir(folder).args(["--release", "--bin", name, "--target", TARGET]);
        output_of(name, &mut cargo)?;
        let built = self.target_folder().join(TARGET).join("release").join(name);
        Program::at(self.workspace.keep(&built, &format!("foreign-{name}"))?)
    }

    /// The memory that a board's program may use, from the linker's map.
    pub fn memory(&self) -> Result<Memory, BuildError> {
        let path = self.workspace.root.join("memory.x");
        let map = fs::read_to_string(&path);
        let memory = map.and_then(|map| Memory::of_map(&map).map_err(io::Error::other));
        memory.map_err(|source| BuildError::File { path, source })
    }

    /// Builds a program without a scene for the emulated board: the server of a client in
    /// [`emulator`](crate::emulator).
    pub fn build_harness(&self, name: &str) -> Result<PathBuf, BuildError> {
        let variant = Variant::of("firmware-harness", "emulated");
        Ok(self.build(&[name], &variant)?.swap_remove(0))
    }

    /// Builds the program of the foreign environment for the emulated board, with its log.
    pub fn build_own_environment(&self, format: NumberFormat) -> Result<PathBuf, BuildError> {
        let variant = Variant::scene("board-qemu,log", format, "");
        let variant = Variant { package: "own-environment", ..variant };
        Ok(self.build(&["pedal"], &variant)?.swap_remove(0))
    }

    /// Builds the program of the foreign board, for that board.
    pub fn build_own_board(&self) -> Result<Program, BuildError> {
        let variant = Variant::of("own-board", "");
        Program::at(self.build(&["own-board"], &variant)?.swap_remove(0))
    }

    /// Builds the virtual board: a separate program for this machine.
    pub fn build_virtual_board(&self) -> Result<PathBuf, BuildError> {
        const NAME: &str = "virtual-board";
        let target = &self.workspace.target;
        let mut cargo = own_cargo(&self.workspace.root);
        for name in INHERITED {
            cargo.env_remove(name);
        }
        // With the features that this program's package wants of the crates of both, which are built for it.
        let build = ["build", "--package", NAME, "--package", "analysis", "--bin", NAME];
        cargo.env("CARGO_TARGET_DIR", target).args(build);
        output_of(NAME, &mut cargo)?;
        Ok(target.join("debug").join(NAME))
    }

    /// Builds the WebAssembly module of the page of `haptic explore`.
    pub fn build_browser_module(&self) -> Result<PathBuf, BuildError> {
        const PACKAGE: &str = "haptic-explore";
        let _lock = self.workspace.lock("build")?;
        let mut cargo = self.cargo(Target::BROWSER);
        let target = Target::BROWSER.name;
        cargo.args(["--profile", "browser", "--package", PACKAGE, "--lib", "--target", target]);
        output_of(PACKAGE, &mut cargo)?;
        let name = "haptic_explore.wasm";
        let built = self.target_folder().join(target).join("browser").join(name);
        self.workspace.keep(&built, name)
    }

    fn scenes_programs(
        &self,
        names: &[&str],
        variant: &Variant<'_>,
    ) -> Result<Vec<PathBuf>, BuildError> {
        let scenes = self.scenes()?;
        match names.iter().find(|name| !scenes.iter().any(|scene| scene == *name)) {
            Some(name) => Err(SourcesError::NoScene { name: (*name).into(), scenes }.into()),
            None => self.build(names, variant),
        }
    }

    /// One call of cargo for all programs of a package: it links on all cores. Without the package's name,
    /// the dependencies would have the features of other packages of the workspace, and be built again for
    /// them.
    fn build(&self, names: &[&str], variant: &Variant<'_>) -> Result<Vec<PathBuf>, BuildError> {
        // Cargo puts every variant of a program in the same place; the lock keeps it there until it is
        // copied.
        let _lock = self.workspace.lock("build")?;
        let Variant { package, features, suffix, scene } = variant;
        let mut cargo = self.cargo(Target::BOARD);
        cargo.envs(scene.map(|scene| (SCENE_VARIABLE, scene)));
        cargo.args(["--release", "--package", package, "--target", TARGET]);
        cargo.args(names.iter().flat_map(|name| ["--bin", name])).args(["--features", features]);
        let built = output_of(&names.join(", "), &mut cargo);
        built.map_err(|error| self.by_memory(error, features))?;
        let folder = self.target_folder().join(TARGET).join("release");
        let keep =
            |name: &&str| self.workspace.keep(&folder.join(name), &format!("{name}{suffix}"));
        names.iter().map(keep).collect()
    }

    /// An error of a program with these features, of which the first is its board: in bytes, where it is that the
    /// program does not fit. What the flash lacks is mostly more, so that it is told first.
    fn by_memory(&self, error: BuildError, features: &str) -> BuildError {
        let (program, output, memory) = match (error, self.memory()) {
            (BuildError::Compile { program, output }, Ok(memory)) => (program, output, memory),
            (error, _) => return error,
        };
        let board = features.split(',').next().unwrap_or_default().into();
        if let Some(over) = overflow_of("FLASH", &output) {
            return BuildError::Flash { program, board, over, allowed: memory.flash };
        }
        match overflow_of("RAM", &output) {
            Some(over) => BuildError::Ram { program, board, over, allowed: memory.ram },
            None => BuildError::Compile { program, output },
        }
    }

    /// Each compiler has its own folder: in a common folder each would rebuild the other's output.
    fn target_folder(&self) -> PathBuf {
        self.workspace.output.join(match self.compiler {
            Compiler::Own => "own",
            Compiler::Debian => "debian",
        })
    }

    /// Cargo, without the environment of a command that may have started this program.
    fn cargo(&self, target: Target) -> Command {
        let root = &self.workspace.root;
        let mut command = match self.compiler {
            Compiler::Own => own_cargo(root),
            Compiler::Debian => Command::new("/usr/bin/cargo"),
        };
        command.current_dir(root);
        for name in INHERITED {
            command.env_remove(name);
        }
        command.env("CARGO_TARGET_DIR", self.target_folder()).arg("build");
        if self.compiler == Compiler::Debian {
            // Debian has no compiled `core` for these targets; its source is built with the program, which
            // needs unstable features of cargo.
            command.env_remove("RUSTUP_TOOLCHAIN");
            command.env("RUSTC", "/usr/bin/rustc").env("RUSTC_BOOTSTRAP", "1");
            let (variable, linker) = target.linker;
            command.env(variable, linker).args(target.libraries);
            command.envs(target.flags);
        }
        command
    }
}

/// Builds the program `haptic` with one more scene, and returns its file. It is built like this program, for
/// this machine, so that their common parts are reused.
pub fn build_haptic_with(scene: &str) -> Result<PathBuf, BuildError> {
    let workspace = Workspace::find()?;
    let _lock = workspace.lock("scene")?;
    let mut cargo = own_cargo(&workspace.root);
    cargo.args(["build", "--package", SCENE_PACKAGE]);
    cargo.env("CARGO_TARGET_DIR", &workspace.target).env(SCENE_VARIABLE, scene);
    output_of(scene, &mut cargo)?;
    workspace.keep(&workspace.target.join("debug").join(SCENE_PACKAGE), &format!("haptic-{scene}"))
}

/// The file of a test, if a line of cargo's messages reports that it was built.
fn executable(message: &str, name: &str) -> Option<PathBuf> {
    let message: serde_json::Value = serde_json::from_str(message).ok()?;
    let is_it = message["target"]["name"] == name && message["target"]["kind"][0] == "test";
    is_it.then(|| message["executable"].as_str().map(PathBuf::from)).flatten()
}

/// The bytes that a program has more than a region of the linker's map, in the linker's output: it names each section
/// that ends beyond.
fn overflow_of(region: &str, output: &str) -> Option<u64> {
    let beyond = format!("will not fit in region '{region}': overflowed by ");
    let ends = output.split(&beyond).skip(1);
    ends.filter_map(|end| end.split(' ').next()?.parse().ok()).max()
}

/// Builds a program with cargo; returns cargo's output.
fn output_of(program: &str, cargo: &mut Command) -> Result<String, BuildError> {
    let output = cargo.output().map_err(BuildError::NoCargo)?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let output = last_lines(&String::from_utf8_lossy(&output.stderr), 60);
    Err(BuildError::Compile { program: program.into(), output })
}

/// Variables that would change the build, or that belong to a build that started this program.
const INHERITED: [&str; 9] = [
    "RUSTFLAGS",
    "CARGO_ENCODED_RUSTFLAGS",
    "CARGO_BUILD_TARGET",
    "CARGO_BUILD_RUSTFLAGS",
    "CARGO_BUILD_TARGET_DIR",
    "CARGO_INCREMENTAL",
    "CARGO_MAKEFLAGS",
    "RUSTC_WORKSPACE_WRAPPER",
    "DEFMT_LOG",
];

impl Program {
    /// The program in a file.
    fn at(path: PathBuf) -> Result<Self, BuildError> {
        let sizes = fs::read(&path).and_then(|elf| Sizes::of_elf(&elf).map_err(io::Error::other));
        match sizes {
            Ok(sizes) => Ok(Self { path, sizes }),
            Err(source) => Err(BuildError::File { path, source }),
        }
    }
}

impl Workspace {
    /// The folder of packages that are unpacked for this workspace.
    pub(super) fn packages(&self) -> PathBuf {
        self.target.join("packages")
    }

    /// The workspace that this program was built from.
    pub(super) fn find() -> Result<Self, BuildError> {
        let root = workspace_root()?;
        let target = variable("CARGO_TARGET_DIR").map_or_else(|| "target".into(), PathBuf::from);
        // Relative to the workspace for cargo's own default, and to where cargo was started
        // otherwise; an absolute path replaces either.
        let target = root.join(target);
        Ok(Self { output: target.join("thumb"), target, root })
    }

    /// Waits for and takes a lock that other programs respect; closing the file releases it.
    pub(super) fn lock(&self, name: &str) -> Result<File, BuildError> {
        let path = self.output.join(name).with_extension("lock");
        let locked = fs::create_dir_all(&self.output).and_then(|()| {
            let file = File::create(&path)?;
            file.lock()?;
            Ok(file)
        });
        locked.map_err(|source| BuildError::File { path, source })
    }

    /// Copies a program to its own name. A running emulator may have the old file open, so it is replaced and
    /// not overwritten.
    fn keep(&self, built: &Path, name: &str) -> Result<PathBuf, BuildError> {
        let folder = self.output.join("programs");
        let kept = folder.join(name);
        let fresh = kept.with_extension("new");
        let copied = fs::create_dir_all(&folder)
            .and_then(|()| fs::copy(built, &fresh))
            .and_then(|_| fs::rename(&fresh, &kept));
        match copied {
            Ok(()) => Ok(kept),
            Err(source) => Err(BuildError::File { path: kept, source }),
        }
    }
}

/// Cargo's folder for this machine's programs.
pub fn target_folder() -> Result<PathBuf, BuildError> {
    Ok(Workspace::find()?.target)
}

/// The cargo that has built this program, in a folder.
fn own_cargo(folder: &Path) -> Command {
    let mut cargo = Command::new(variable("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(folder);
    cargo
}

fn variable(name: &str) -> Option<OsString> {
    std::env::var_os(name).filter(|value| !value.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_by_how_much_a_program_overflows_a_memory() {
        let output = "  = note: rust-lld: error: section '.text' will not fit in region 'FLASH': overflowed by 7 \
                      bytes\n          rust-lld: error: section '.rodata' will not fit in region 'FLASH': \
                      overflowed by 2307 bytes\n          rust-lld: error: section '.bss' will not fit in region \
                      'RAM': overflowed by 9000 bytes\n";
        let over = |output| ["FLASH", "RAM"].map(|region| overflow_of(region, output));
        assert_eq!(over(output), [Some(2307), Some(9000)]);
        assert_eq!(over("error: could not compile"), [None; 2]);
    }
}
