//! Debian's packages that are unpacked into a folder of the workspace, and the programs in them.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::Version;

/// The emulator's program.
pub const QEMU: &str = "qemu-system-arm";

/// The folder of unpacked packages.
#[derive(Clone, Debug)]
pub struct Unpacked {
    folder: PathBuf,
}

impl Unpacked {
    /// The unpacked packages beside the builds in cargo's folder `target`.
    pub(super) fn beside(target: &Path) -> Self {
        Self { folder: target.join("packages") }
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The version of a package, if it is unpacked.
    pub(super) fn version(&self, name: &str) -> Option<Version> {
        Version::find(&fs::read_to_string(self.stamp(name)).ok()?)
    }

    /// The file with the version of an unpacked package.
    pub(super) fn stamp(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.version"))
    }

    /// A program: the unpacked one, or `installed`.
    pub(super) fn program(&self, name: &str, installed: &str) -> OsString {
        let unpacked = self.folder.join("usr/bin").join(name);
        if unpacked.exists() { unpacked.into() } else { installed.into() }
    }

    /// Lets a command, and what it starts, find the libraries of unpacked programs.
    pub(super) fn add_libraries(&self, command: &mut Command) {
        // Debian names the folder by the processor.
        let folder = format!("lib/{}-linux-gnu", env::consts::ARCH);
        let own = [self.folder.join("usr").join(&folder), self.folder.join(folder)];
        if !own.iter().any(|folder| folder.exists()) {
            return;
        }
        let inherited = env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
        let inherited = env::split_paths(&inherited).filter(|path| !path.as_os_str().is_empty());
        if let Ok(paths) = env::join_paths(own.into_iter().chain(inherited)) {
            command.env("LD_LIBRARY_PATH", paths);
        }
    }

    /// The emulator, to be started.
    pub(super) fn emulator(&self) -> Command {
        let mut command = Command::new(self.program(QEMU, QEMU));
        let data = self.folder.join("usr/share/qemu");
        if data.exists() {
            command.arg("-L").arg(data);
        }
        self.add_libraries(&mut command);
        command
    }
}
