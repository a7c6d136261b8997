//! Debian's packages: installed as root, or unpacked into a folder by any user. Neither ever removes a
//! package.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output, Stdio};

use super::output::last_lines;

/// The changes of an installation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// New packages.
    pub installed: Vec<NewPackage>,
    /// Packages that are replaced by another version.
    pub replaced: Vec<NewPackage>,
    /// Names of packages that would be removed.
    pub removed: Vec<String>,
}

/// A package at the version that would be installed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NewPackage {
    /// Its name.
    pub name: String,
    /// Its version, as Debian writes it.
    pub version: String,
}

/// The reason why packages were neither installed nor unpacked.
#[derive(Debug, thiserror::Error)]
pub enum AptError {
    /// A program could not be started.
    #[error("{program} could not be run: {source}")]
    Unrunnable {
        /// The program.
        program: String,
        /// The cause.
        source: io::Error,
    },
    /// A program failed.
    #[error("`{command}` ended with {status}:\n{output}")]
    Failed {
        /// The command.
        command: String,
        /// Its exit status.
        status: ExitStatus,
        /// The end of its output.
        output: String,
    },
    /// Only root may install packages.
    #[error("only root may install packages; as root: {0}")]
    NotRoot(String),
    /// Packages would be removed.
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
    /// The folder for unpacked packages could not be used.
    #[error("{path}: {source}")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
}

/// The programs of Debian that fetch, install and unpack packages.
#[derive(Clone, Debug)]
pub struct Apt {
    apt_get: PathBuf,
    dpkg_deb: PathBuf,
    /// The folder of lists of packages that the user has fetched, without root's rights.
    own_lists: Option<PathBuf>,
}

/// The command for the user to install packages as root, which asks for consent itself.
pub fn by_hand(packages: &[&str]) -> String {
    format!("apt-get install --no-install-recommends {}", packages.join(" "))
}

impl Apt {
    /// For root, who uses the machine's lists of packages, and for another user, who can fetch lists into
    /// `folder` only.
    pub fn of(is_root: bool, folder: &Path) -> Self {
        let own_lists = (!is_root).then(|| folder.join("apt"));
        Self { apt_get: "apt-get".into(), dpkg_deb: "dpkg-deb".into(), own_lists }
    }

    /// Fetches the lists of packages.
    ///
    /// # Errors
    /// If that fails.
    pub fn update(&self) -> Result<(), AptError> {
        if let Some(folder) = &self.own_lists {
            make(&folder.join("lists/partial"))?;
            make(&folder.join("cache/archives/partial"))?;
        }
        self.run(&["update"], &[], Path::new(".")).map(drop)
    }

    /// The options for the user's own lists of packages, if there are any.
    pub fn options(&self) -> Vec<String> {
        match &self.own_lists {
            Some(folder) if folder.join("lists").is_dir() => vec![
                "-o".into(),
                format!("Dir::State::Lists={}", folder.join("lists").display()),
                "-o".into(),
                format!("Dir::Cache={}", folder.join("cache").display()),
            ],
            _ => Vec::new(),
        }
    }

    /// The changes of installing packages.
    ///
    /// # Errors
    /// If a package does not exist, or cannot be installed.
    pub fn changes(&self, packages: &[&str]) -> Result<Changes, AptError> {
        let simulate = ["install", "--simulate", "--no-install-recommends"];
        let simulation = self.run(&simulate, packages, Path::new("."))?;
        Ok(Changes::of_simulation(&String::from_utf8_lossy(&simulation.stdout)))
    }

    /// Prints the changes, and installs the packages if that removes no other package.
    ///
    /// # Errors
    /// If it would remove a package, which changes nothing, or if it fails.
    pub fn install(&self, packages: &[&str], progress: impl Fn(&str)) -> Result<(), AptError> {
        let changes = self.changes(packages)?;
        let command = by_hand(packages);
        if !changes.removed.is_empty() {
            return Err(AptError::Removes { wanted: packages.join(" "), changes, command });
        }
        progress(&format!("{command}: {changes}"));
        // `--no-remove`, because the machine may have changed since the simulation.
        let arguments = ["install", "--yes", "--no-install-recommends", "--no-remove"];
        self.run(&arguments, packages, Path::new(".")).map(drop)
    }

    /// Prints which packages it fetches, unpacks them with the missing packages that they depend on into
    /// `root`, and returns all of them. This changes nothing outside this folder, and needs no rights.
    ///
    /// # Errors
    /// If a package does not exist, or cannot be fetched or unpacked.
    pub fn unpack(
        &self,
        packages: &[&str],
        root: &Path,
        progress: impl Fn(&str),
    ) -> Result<Vec<NewPackage>, AptError> {
        let wanted = self.changes(packages)?.unpackable();
        let names: Vec<_> = wanted.iter().map(|package| &*package.name).collect();
        let folder = root.display();
        progress(&format!("unpacks {} into {folder}: {}", names.len(), names.join(" ")));
        let archives = root.join("archives");
        let source = |source| AptError::Folder { path: archives.clone(), source };
        // An interrupted run has left archives, perhaps of other versions.
        if archives.exists() {
            fs::remove_dir_all(&archives).map_err(source)?;
        }
        make(&archives)?;
        let exact: Vec<_> =
            wanted.iter().map(|NewPackage { name, version }| format!("{name}={version}")).collect();
        let exact: Vec<_> = exact.iter().map(String::as_str).collect();
        self.run(&["download"], &exact, &archives)?;
        for archive in fs::read_dir(&archives).map_err(source)? {
            let archive = archive.map_err(source)?.path();
            if archive.extension().is_some_and(|extension| extension == "deb") {
                let mut command = Command::new(&self.dpkg_deb);
                finished(command.arg("-x").arg(&archive).arg(root))?;
            }
        }
        fs::remove_dir_all(&archives).map_err(source)?;
        Ok(wanted)
    }

    /// Runs `apt-get` without questions, in a folder; it waits for another one to finish.
    fn run(
        &self,
        arguments: &[&str],
        packages: &[&str],
        folder: &Path,
    ) -> Result<Output, AptError> {
        let mut command = Command::new(&self.apt_get);
        command.args(["-o", "DPkg::Lock::Timeout=600"]).args(self.options());
        finished(command.args(arguments).args(packages).current_dir(folder))
    }
}

fn make(folder: &Path) -> Result<(), AptError> {
    fs::create_dir_all(folder).map_err(|source| AptError::Folder { path: folder.into(), source })
}

/// The output of a program that succeeds.
fn finished(command: &mut Command) -> Result<Output, AptError> {
    let output = command
        // The parsed output must not depend on the user's language.
        .env("LC_ALL", "C")
        .env("DEBIAN_FRONTEND", "noninteractive")
        .stdin(Stdio::null())
        .output();
    let output = output.map_err(|source| {
        let program = command_line(command).next().unwrap_or_default();
        AptError::Unrunnable { program, source }
    })?;
    if output.status.success() {
        return Ok(output);
    }
    let said = [output.stdout, output.stderr].concat();
    Err(AptError::Failed {
        command: command_line(command).collect::<Vec<_>>().join(" "),
        status: output.status,
        output: last_lines(&String::from_utf8_lossy(&said), 20),
    })
}

fn command_line(command: &Command) -> impl Iterator<Item = String> {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().into_iter()
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
            if what == "Remv" || what == "Purg" {
                changes.removed.push(name.to_owned());
            }
            let mut words = words.peekable();
            let is_replaced = words.next_if(|word| word.starts_with('[')).is_some();
            let version = words.next().and_then(|word| word.strip_prefix('('));
            if let ("Inst", Some(version)) = (what, version) {
                let list = if is_replaced { &mut changes.replaced } else { &mut changes.installed };
                list.push(NewPackage { name: name.to_owned(), version: version.to_owned() });
            }
        }
        changes
    }

    /// The packages to unpack instead of installing them: all that are new or have another version, except
    /// the C library, whose loader starts every program and is the machine's.
    fn unpackable(self) -> Vec<NewPackage> {
        let all = self.installed.into_iter().chain(self.replaced);
        all.filter(|package| !package.name.starts_with("libc6")).collect()
    }
}

impl fmt::Display for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = |packages: &[NewPackage]| {
            packages.iter().map(|package| package.name.clone()).collect::<Vec<_>>()
        };
        let kinds = [
            ("installs", names(&self.installed)),
            ("replaces", names(&self.replaced)),
            ("REMOVES", self.removed.clone()),
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

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
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
        let package =
            |name: &str, version: &str| NewPackage { name: name.into(), version: version.into() };
        let new = [package("lld-14", "1:14.0.6-12"), package("lld", "1:14.0-55.7")];
        assert_eq!(changes.installed, new);
        assert_eq!(changes.replaced, [package("libc6", "2.36-10")]);
        assert_eq!(changes.removed, ["gcc-old"]);
        assert_eq!(
            changes.to_string(),
            "installs 2: lld-14 lld; replaces 1: libc6; REMOVES 1: gcc-old"
        );
        // The loader of programs stays the machine's.
        assert_eq!(changes.unpackable(), new);
        let purged = Changes::of_simulation("Purg libfoo:i386 [1.0]\nnonsense\nInst\n");
        assert_eq!(purged.removed, ["libfoo:i386"]);
        assert_eq!(Changes::of_simulation("").to_string(), "changes nothing");
    }

    /// Programs that write down what they are asked; `apt-get` prints `simulation` where it simulates, and
    /// makes a file for each package that it downloads.
    fn fake(folder: &Path, simulation: &str) -> Apt {
        fs::write(folder.join("simulation"), simulation).unwrap();
        let script = |name: &str, text: &str| {
            let program = folder.join(name);
            fs::write(&program, format!("#!/bin/sh\nset -e\nhere={}\n{text}", folder.display()))
                .unwrap();
            fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
            program
        };
        let apt_get = "case \"$*\" in *--simulate*) cat $here/simulation ;; *) echo \"$*\" >> $here/done ;; \
                       esac\nfor p in \"$@\"; do case $p in *=*=*) ;; lld*=*) : > $p.deb ;; esac; done\n";
        Apt {
            apt_get: script("apt-get", apt_get),
            dpkg_deb: script("dpkg-deb", "echo \"dpkg-deb $1 $(basename $2) $3\" >> $here/done\n"),
            own_lists: None,
        }
    }

    fn done(folder: &Path) -> String {
        fs::read_to_string(folder.join("done")).unwrap_or_default()
    }

    #[test]
    fn what_would_remove_a_package_is_not_installed() {
        let folder = tempfile::tempdir().unwrap();
        let apt = fake(folder.path(), REMOVES);
        let error = apt.install(&["lld"], |_| {}).unwrap_err().to_string();
        assert_eq!(done(folder.path()), "");
        assert!(error.contains("REMOVES 1: gcc-old"), "{error}");
        assert!(error.ends_with("\n  apt-get install --no-install-recommends lld"), "{error}");
    }

    #[test]
    fn what_would_remove_a_package_can_be_unpacked() {
        let folder = tempfile::tempdir().unwrap();
        let apt = fake(folder.path(), REMOVES);
        let root = folder.path().join("root");
        let said = RefCell::new(String::new());
        // What an interrupted one has left is not unpacked with it.
        make(&root.join("archives")).unwrap();
        fs::write(root.join("archives/lld=1:14.0-55.6.deb"), "half of it").unwrap();
        apt.unpack(&["lld"], &root, |step| said.borrow_mut().push_str(step)).unwrap();
        assert!(said.borrow().ends_with(": lld-14 lld"), "{said:?}");
        let done = done(folder.path());
        let lines: Vec<_> = done.lines().collect();
        assert!(lines[0].ends_with("download lld-14=1:14.0.6-12 lld=1:14.0-55.7"), "{done}");
        let mut unpacked: Vec<_> = lines[1..].to_vec();
        unpacked.sort_unstable();
        let root = root.display();
        assert_eq!(
            unpacked,
            [
                format!("dpkg-deb -x lld-14=1:14.0.6-12.deb {root}"),
                format!("dpkg-deb -x lld=1:14.0-55.7.deb {root}"),
            ]
        );
        assert!(!folder.path().join("root/archives").exists());
        // Nothing was asked to be installed or removed.
        assert!(!done.contains("install"), "{done}");
    }

    #[test]
    fn what_removes_nothing_is_said_and_done_and_may_not_remove() {
        let folder = tempfile::tempdir().unwrap();
        let apt = fake(folder.path(), "Inst lld (1:14.0-55.7 Debian:12.11/oldstable [amd64])\n");
        let said = RefCell::new(String::new());
        apt.install(&["lld"], |step| said.borrow_mut().push_str(step)).unwrap();
        assert!(said.borrow().ends_with("installs 1: lld"), "{said:?}");
        let done = done(folder.path());
        assert!(done.contains("install --yes --no-install-recommends --no-remove lld"), "{done}");
    }

    #[test]
    fn a_user_without_rights_has_lists_of_their_own() {
        let folder = tempfile::tempdir().unwrap();
        let apt = Apt { own_lists: Some(folder.path().join("apt")), ..fake(folder.path(), "") };
        // The machine's lists serve until others are fetched.
        assert!(apt.options().is_empty());
        apt.update().unwrap();
        let lists = format!("Dir::State::Lists={}", folder.path().join("apt/lists").display());
        assert!(done(folder.path()).contains(&lists), "{}", done(folder.path()));
    }
}
