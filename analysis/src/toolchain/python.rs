//! A virtual environment of Python with packages from PyPI.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, Stdio};

pub use super::output::finished;
use super::prepare::{set_up_package, set_up_tool};
use super::{BuildError, target_folder};

/// A virtual environment.
#[derive(Clone, Debug)]
pub struct PythonEnvironment(PathBuf);

impl PythonEnvironment {
    /// The one beside the builds of this workspace. It is kept, so that nothing is fetched a second time.
    pub fn kept() -> Result<Self, BuildError> {
        Ok(Self(target_folder()?.join("tmp/python")))
    }

    /// A program of it, to be started; other programs of it are found, too.
    pub fn program(&self, name: &str) -> Command {
        let folder = self.0.join("bin");
        let mut path = OsString::from(&folder);
        if let Some(rest) = std::env::var_os("PATH") {
            path.push(":");
            path.push(rest);
        }
        let mut command = Command::new(folder.join(name));
        command.env("PATH", path).env("MPLBACKEND", "Agg").env("PYTHONDONTWRITEBYTECODE", "1");
        command.stdin(Stdio::null());
        command
    }

    /// `pip install`, without its arguments.
    pub fn pip_install(&self) -> Command {
        let mut pip = self.program("python");
        // One try: without a network every further one takes its time, and fails, too.
        pip.args(["-m", "pip", "--disable-pip-version-check", "--retries", "1"]);
        pip.args(["install", "--quiet"]);
        pip
    }

    /// Creates it unless it is there.
    ///
    /// # Errors
    /// The reason if there is no Python.
    pub fn set_up(&self) -> Result<(), String> {
        set_up_tool("python3")?;
        // Debian has the part that puts pip into an environment in a package of its own.
        set_up_package("python3-venv", "python3 -c 'import ensurepip'")?;
        if !self.0.join("pyvenv.cfg").exists() {
            let made = finished(Command::new("python3").args(["-m", "venv"]).arg(&self.0));
            made.inspect_err(|_| {
                // An incomplete environment would lack pip the next time, too.
                std::fs::remove_dir_all(&self.0).ok();
            })?;
        }
        Ok(())
    }
}
