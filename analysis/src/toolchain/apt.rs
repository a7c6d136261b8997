//! Installs Debian packages: prints the changes to the machine first, and never removes another
//! package without the user's consent.

use std::fmt;
use std::io::{self, BufRead, IsTerminal, Write};
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Output, Stdio};

use super::output::last_lines;

/// The changes of an installation, by the packages' names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// New packages.
    pub installed: Vec<String>,
    /// Packages that are replaced by another version.
    pub replaced: Vec<String>,
    /// Packages that would be removed.
    pub removed: Vec<String>,
}

/// The reason why packages were not installed.
#[derive(Debug, thiserror::Error)]
pub enum AptError {
    /// `apt-get` could not be started.
    #[error("apt-get could not be run: {0}")]
    Unrunnable(#[source] io::Error),
    /// `apt-get` failed.
    #[error("`{command}` ended with {status}:\n{output}")]
    Failed {
        /// The command.
        command: String,
        /// Its exit status.
        status: ExitStatus,
        /// The end of its output.
        output: String,
    },
    /// Packages would be removed, without consent.
    #[error(
        "installing {wanted} would remove packages of this machine, so nothing was done: it \
         {changes}\ncheck these changes; if they are right, run this yourself:\n  {command}"
    )]
    Removes {
        /// The requested packages.
        wanted: String,
        /// The changes that installing them would make.
        changes: Changes,
        /// The command that installs them after asking.
        command: String,
    },
}

/// The program that installs; by default `apt-get`.
#[derive(Clone, Debug)]
pub struct Apt {
    program: PathBuf,
}

impl Default for Apt {
    fn default() -> Self {
        Self { program: "apt-get".into() }
    }
}

/// The command for the user to install packages as root, which asks for consent itself.
pub fn by_hand(packages: &[&str]) -> String {
    format!("apt-get install --no-install-recommends {}", packages.join(" "))
}

impl Apt {
    /// Fetches the lists of packages.
    ///
    /// # Errors
    /// If that fails.
    pub fn update(&self) -> Result<(), AptError> {
        self.run(&["update"], &[]).map(drop)
    }

    /// Prints the changes, and installs the packages. If others would be removed, calls `agrees`
    /// first.
    ///
    /// # Errors
    /// If it fails, or if consent is refused, which changes nothing.
    pub fn install(
        &self,
        packages: &[&str],
        progress: impl Fn(&str),
        agrees: impl Fn(&Changes) -> bool,
    ) -> Result<(), AptError> {
        let simulation =
            self.run(&["install", "--simulate", "--no-install-recommends"], packages)?;
        let changes = Changes::of_simulation(&String::from_utf8_lossy(&simulation.stdout));
        let command = by_hand(packages);
        progress(&format!("{command}: {changes}"));
        let mut arguments = vec!["install", "--yes", "--no-install-recommends"];
        if changes.removed.is_empty() {
            // In case the machine has changed since the simulation.
            arguments.push("--no-remove");
        } else if !agrees(&changes) {
            return Err(AptError::Removes { wanted: packages.join(" "), changes, command });
        }
        self.run(&arguments, packages).map(drop)
    }

    /// Runs `apt-get` without questions; it waits for another one to finish.
    fn run(&self, arguments: &[&str], packages: &[&str]) -> Result<Output, AptError> {
        let mut command = Command::new(&self.program);
        command
            .args(["-o", "DPkg::Lock::Timeout=600"])
            .args(arguments)
            .args(packages)
            // The parsed output must not depend on the user's language.
            .env("LC_ALL", "C")
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdin(Stdio::null());
        let output = command.output().map_err(AptError::Unrunnable)?;
        if output.status.success() {
            return Ok(output);
        }
        let said = [output.stdout, output.stderr].concat();
        Err(AptError::Failed {
            command: [&["apt-get"], arguments, packages].concat().join(" "),
            status: output.status,
            output: last_lines(&String::from_utf8_lossy(&said), 20),
        })
    }
}

impl Changes {
    /// The changes in the output of `apt-get install --simulate`: a line for each package that is unpacked
    /// (`Inst NAME [old version] (new version ...)`, the old version only if there is one), removed
    /// (`Remv NAME ...`) or removed with its settings (`Purg NAME ...`).
    fn of_simulation(text: &str) -> Self {
        let mut changes = Self::default();
        for line in text.lines() {
            let mut words = line.split_whitespace();
            let (Some(what), Some(name)) = (words.next(), words.next()) else { continue };
            let list = match what {
                "Inst" if words.next().is_some_and(|word| word.starts_with('[')) => {
                    &mut changes.replaced
                }
                "Inst" => &mut changes.installed,
                "Remv" | "Purg" => &mut changes.removed,
                _ => continue,
            };
            list.push(name.to_owned());
        }
        changes
    }
}

impl fmt::Display for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds = [
            ("installs", &self.installed),
            ("replaces", &self.replaced),
            ("REMOVES", &self.removed),
        ];
        let some: Vec<_> = kinds
            .iter()
            .filter(|(_, packages)| !packages.is_empty())
            .map(|(does, packages)| format!("{does} {}: {}", packages.len(), packages.join(" ")))
            .collect();
        f.write_str(if some.is_empty() { "changes nothing" } else { "" })?;
        f.write_str(&some.join("; "))
    }
}

/// Asks the user at the terminal; without a terminal the answer is no.
pub fn person_agrees(changes: &Changes) -> bool {
    if !io::stdin().is_terminal() || !io::stderr().is_terminal() {
        return false;
    }
    eprint!("remove {}? [y/N] ", changes.removed.join(" "));
    let _ = io::stderr().flush();
    let mut answer = String::new();
    let answered = io::stdin().lock().read_line(&mut answer).is_ok();
    answered && ["y", "yes"].contains(&answer.trim().to_lowercase().as_str())
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    const REMOVES: &str = "\
Reading package lists...
The following packages will be REMOVED:
  gcc-old
Remv gcc-old [4:12.2.0-3]
Inst lld-14 (1:14.0.6-12 Debian:12.11/oldstable [amd64])
Inst libc6 [2.36-9] (2.36-10 Debian:12.11/oldstable [amd64]) []
Inst lld (1:14.0-55.7 Debian:12.11/oldstable [amd64])
Conf lld (1:14.0-55.7 Debian:12.11/oldstable [amd64])
";

    #[test]
    fn a_simulation_says_what_would_be_installed_replaced_and_removed() {
        let changes = Changes::of_simulation(REMOVES);
        assert_eq!(changes.installed, ["lld-14", "lld"]);
        assert_eq!(changes.replaced, ["libc6"]);
        assert_eq!(changes.removed, ["gcc-old"]);
        assert_eq!(
            changes.to_string(),
            "installs 2: lld-14 lld; replaces 1: libc6; REMOVES 1: gcc-old"
        );
        let purged = Changes::of_simulation("Purg libfoo:i386 [1.0]\nnonsense\nInst\n");
        assert_eq!(purged.removed, ["libfoo:i386"]);
        assert_eq!(Changes::of_simulation("").to_string(), "changes nothing");
    }

    /// An `apt-get` that prints this where it simulates and writes down what else it is asked.
    fn fake(folder: &std::path::Path, simulation: &str) -> Apt {
        fs::write(folder.join("simulation"), simulation).unwrap();
        let program = folder.join("apt-get");
        let script = "#!/bin/sh\ncase \"$*\" in *--simulate*) cat \"$(dirname \"$0\")/simulation\" ;; \
                      *) echo \"$*\" >> \"$(dirname \"$0\")/done\" ;; esac\n";
        fs::write(&program, script).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        Apt { program }
    }

    fn done(folder: &std::path::Path) -> String {
        fs::read_to_string(folder.join("done")).unwrap_or_default()
    }

    #[test]
    fn what_removes_is_done_after_a_yes_only() {
        let folder = tempfile::tempdir().unwrap();
        let apt = fake(folder.path(), REMOVES);
        let said = RefCell::new(Vec::new());
        let progress = |step: &str| said.borrow_mut().push(step.to_owned());

        let error = apt.install(&["lld"], progress, |_| false).unwrap_err().to_string();
        assert_eq!(done(folder.path()), "");
        assert!(error.contains("REMOVES 1: gcc-old"), "{error}");
        assert!(error.ends_with("\n  apt-get install --no-install-recommends lld"), "{error}");
        // It was said before it was asked.
        assert!(said.borrow()[0].ends_with("REMOVES 1: gcc-old"), "{said:?}");

        let asked = RefCell::new(Vec::new());
        let yes = |changes: &Changes| {
            asked.borrow_mut().push(changes.clone());
            true
        };
        apt.install(&["lld"], progress, yes).unwrap();
        assert_eq!(asked.borrow()[..], [Changes::of_simulation(REMOVES)]);
        assert!(done(folder.path()).contains("install --yes --no-install-recommends lld"));
    }

    #[test]
    fn what_removes_nothing_is_said_and_done_and_may_not_remove() {
        let folder = tempfile::tempdir().unwrap();
        let apt = fake(folder.path(), "Inst lld (1:14.0-55.7 Debian:12.11/oldstable [amd64])\n");
        let said = RefCell::new(String::new());
        let progress = |step: &str| said.borrow_mut().push_str(step);
        apt.install(&["lld"], progress, |_| panic!("there is nothing to ask")).unwrap();
        assert!(said.borrow().ends_with("installs 1: lld"), "{said:?}");
        let done = done(folder.path());
        assert!(done.contains("install --yes --no-install-recommends --no-remove lld"), "{done}");
    }

    /// Tests have no terminal to ask at.
    #[test]
    fn nobody_agrees_where_there_is_no_terminal() {
        if !io::stdin().is_terminal() {
            assert!(!person_agrees(&Changes::of_simulation(REMOVES)));
        }
    }
}
