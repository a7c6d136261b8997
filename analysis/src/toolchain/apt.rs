//! Debian's packages: installed as root, or unpacked into a folder by any user. Neither ever removes a
//! package.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use super::Version;
use super::output::finished;
use super::package::Package;
use super::unpacked::Unpacked;

/// The programs of Debian that fetch, install and unpack packages.
pub struct Apt<'a> {
    apt_get: PathBuf,
    dpkg_deb: PathBuf,
    is_root: bool,
    unpacked: &'a Unpacked,
    /// Gets each step before it is taken.
    progress: &'a dyn Fn(&str),
}

/// The changes of an installation.
#[derive(Debug, Default)]
struct Changes {
    /// Names and versions of packages that are new, or replace another version.
    installed: Vec<(String, String)>,
    /// Names of packages that would be removed.
    removed: Vec<String>,
}

fn command(packages: &[&str]) -> String {
    format!("apt-get install --no-install-recommends {}", packages.join(" "))
}

/// The error of packages that are not installed for a reason that new lists do not change.
fn not_done(why: &str) -> io::Error {
    io::Error::new(io::ErrorKind::Unsupported, why)
}

impl<'a> Apt<'a> {
    /// What cannot be installed is unpacked beside `unpacked`.
    pub fn new(unpacked: &'a Unpacked, progress: &'a dyn Fn(&str)) -> Self {
        let is_root = nix::unistd::geteuid().is_root();
        Self { apt_get: "apt-get".into(), dpkg_deb: "dpkg-deb".into(), is_root, unpacked, progress }
    }

    /// Provides packages: installs them, or, where that would remove another package and for a user who is
    /// not root, unpacks them.
    ///
    /// # Errors
    /// If one does not exist, is too old or has to be installed, or if a step fails.
    pub fn provide(&self, packages: &[Package]) -> io::Result<()> {
        let names: Vec<_> = packages.iter().map(|package| package.name).collect();
        let may_unpack = !packages.iter().any(|package| Package::NATIVE.contains(package));
        self.get(&names, packages, may_unpack)
    }

    /// Installs a package as root, if that removes no other package.
    ///
    /// # Errors
    /// If it would remove a package, which changes nothing, or if it fails.
    pub fn install(&self, name: &str) -> io::Result<()> {
        self.get(&[name], &[], false)
    }

    fn get(&self, names: &[&str], checked: &[Package], may_unpack: bool) -> io::Result<()> {
        if !self.is_root && !may_unpack {
            return Err(not_done("only root may install packages"));
        }
        self.with_fresh_lists(|| {
            let changes = self.changes(names)?;
            changes.serve(checked)?;
            if self.is_root && changes.removed.is_empty() {
                return self.install_with(names, &changes);
            }
            if !may_unpack {
                let why = format!("this would remove packages; check these changes: {changes}");
                return Err(not_done(&why));
            }
            if self.is_root {
                (self.progress)(&format!("{} {changes}: not done", command(names)));
            }
            self.unpack(names, &changes)
        })
    }

    /// Gets packages, with new lists if that fails: a new machine has none, and a mirror may have dropped the
    /// versions that old lists name.
    fn with_fresh_lists(&self, get: impl Fn() -> io::Result<()>) -> io::Result<()> {
        match get() {
            Err(error) if error.kind() == io::ErrorKind::Other => {}
            result => return result,
        }
        (self.progress)("apt-get update");
        if let Some(own) = self.own_lists() {
            fs::create_dir_all(own.join("lists/partial"))?;
            fs::create_dir_all(own.join("cache/archives/partial"))?;
        }
        self.apt_get(&["update"], &[], Path::new("."))?;
        get()
    }

    /// The folder of lists of packages of a user who is not root and cannot fetch the machine's.
    fn own_lists(&self) -> Option<PathBuf> {
        (!self.is_root).then(|| self.unpacked.folder().join("apt"))
    }

    fn changes(&self, names: &[&str]) -> io::Result<Changes> {
        let simulate = ["install", "--simulate", "--no-install-recommends"];
        let simulation = self.apt_get(&simulate, names, Path::new("."))?;
        Ok(Changes::of_simulation(&String::from_utf8_lossy(&simulation.stdout)))
    }

    /// Prints the changes, and installs the packages.
    fn install_with(&self, names: &[&str], changes: &Changes) -> io::Result<()> {
        (self.progress)(&format!("{}: {changes}", command(names)));
        // `--no-remove`, because the machine may have changed since the simulation.
        let arguments = ["install", "--yes", "--no-install-recommends", "--no-remove"];
        self.apt_get(&arguments, names, Path::new("."))?;
        Ok(())
    }

    /// Prints which packages it fetches, and unpacks them. This changes nothing outside their folder, and
    /// needs no rights.
    fn unpack(&self, names: &[&str], changes: &Changes) -> io::Result<()> {
        let root = self.unpacked.folder();
        // Not the C library, whose loader starts every program and is the machine's.
        let packages = changes.installed.iter().filter(|(name, _)| !name.starts_with("libc6"));
        let packages: Vec<_> = packages.collect();
        let all: Vec<_> = packages.iter().map(|(name, _)| &**name).collect();
        let (count, folder) = (all.len(), root.display());
        (self.progress)(&format!("unpacks {count} into {folder}: {}", all.join(" ")));
        let archives = root.join("archives");
        // An interrupted run has left archives, perhaps of other versions.
        fs::remove_dir_all(&archives).ok();
        fs::create_dir_all(&archives)?;
        let exact = packages.iter().map(|(name, version)| format!("{name}={version}"));
        let exact: Vec<_> = exact.collect();
        let exact: Vec<_> = exact.iter().map(String::as_str).collect();
        self.apt_get(&["download"], &exact, &archives)?;
        for archive in fs::read_dir(&archives)? {
            let archive = archive?.path();
            if archive.extension().is_some_and(|extension| extension == "deb") {
                finished(Command::new(&self.dpkg_deb).arg("-x").arg(archive).arg(root))?;
            }
        }
        fs::remove_dir_all(&archives)?;
        // Last, so that packages whose unpacking was interrupted do not count.
        for (name, version) in packages.iter().filter(|(name, _)| names.contains(&&**name)) {
            fs::write(self.unpacked.stamp(name), version)?;
        }
        Ok(())
    }

    /// Runs `apt-get` without questions, in a folder; it waits for another one to finish.
    fn apt_get(&self, does: &[&str], packages: &[&str], folder: &Path) -> io::Result<Output> {
        let mut command = Command::new(&self.apt_get);
        // The parsed output must not depend on the user's language.
        command.env("LC_ALL", "C").env("DEBIAN_FRONTEND", "noninteractive").current_dir(folder);
        command.args(["-o", "DPkg::Lock::Timeout=600"]);
        if let Some(own) = self.own_lists().filter(|own| own.join("lists").is_dir()) {
            let (lists, cache) = (own.join("lists"), own.join("cache"));
            command.arg("-o").arg(format!("Dir::State::Lists={}", lists.display()));
            command.arg("-o").arg(format!("Dir::Cache={}", cache.display()));
        }
        finished(command.args(does).args(packages))
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
            match (words.next(), words.next()) {
                (Some("Remv" | "Purg"), Some(name)) => changes.removed.push(name.to_owned()),
                (Some("Inst"), Some(name)) => {
                    let version = words.find_map(|word| word.strip_prefix('('));
                    let version = version.unwrap_or_default();
                    changes.installed.push((name.to_owned(), version.to_owned()));
                }
                _ => {}
            }
        }
        changes
    }

    /// Refuses packages that are too old.
    fn serve(&self, packages: &[Package]) -> io::Result<()> {
        for package in packages {
            let new = self.installed.iter().find(|(name, _)| name == package.name);
            let version = new.and_then(|(_, version)| Version::find(version));
            if let Some(old) = version.filter(|version| !package.is_served_by(*version)) {
                let why = format!("the package {} is too old: {old}", package.name);
                return Err(not_done(&why));
            }
        }
        Ok(())
    }
}

impl fmt::Display for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (new, removed) = (&self.installed, &self.removed);
        write!(f, "installs {}:", new.len())?;
        new.iter().try_for_each(|(name, _)| write!(f, " {name}"))?;
        match removed.len() {
            0 => Ok(()),
            count => write!(f, "; REMOVES {count}: {}", removed.join(" ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    const INSTALLS: &str = "Inst lld (1:14.0-55.7 Debian:12.11/oldstable [amd64])\n";
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
    fn a_simulation_says_what_would_be_installed_and_removed() {
        let changes = Changes::of_simulation(REMOVES);
        assert_eq!(changes.to_string(), "installs 3: lld-14 libc6 lld; REMOVES 1: gcc-old");
        assert_eq!(changes.installed[1], ("libc6".to_owned(), "2.36-10".to_owned()));
        let purged = Changes::of_simulation("Purg libfoo:i386 [1.0]\nnonsense\nInst\n");
        assert_eq!(purged.to_string(), "installs 0:; REMOVES 1: libfoo:i386");
    }

    #[test]
    fn packages_that_are_too_old_do_not_serve() {
        let rustc = |version| Changes::of_simulation(&format!("Inst rustc-web ({version}.0 x)\n"));
        assert!(rustc("1.95").serve(&Package::COMPILER).is_ok());
        let error = rustc("1.85").serve(&Package::COMPILER).unwrap_err().to_string();
        assert_eq!(error, "the package rustc-web is too old: 1.85");
    }

    /// A machine whose `apt-get` and `dpkg-deb` write down their arguments.
    struct Machine {
        folder: tempfile::TempDir,
        unpacked: Unpacked,
    }

    impl Machine {
        /// `apt-get` prints `simulation` where it simulates, and makes a file for each package that it
        /// downloads.
        fn new(simulation: &str) -> Self {
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("simulation"), simulation).unwrap();
            let unpacked = Unpacked::beside(folder.path());
            let machine = Self { folder, unpacked };
            machine.has(
                "apt-get",
                "case \"$*\" in *--simulate*) cat $here/simulation ;; *) echo \"$*\" >> $here/done ;; \
                 esac\nfor p in \"$@\"; do case $p in *=*=*) ;; lld*=*) : > $p.deb ;; esac; done\n",
            );
            machine.has("dpkg-deb", "echo \"dpkg-deb $1 $(basename $2) $3\" >> $here/done\n");
            machine
        }

        fn has(&self, name: &str, text: &str) {
            let (folder, draft) = (self.folder.path(), self.folder.path().join("draft"));
            let script = format!("#!/bin/sh\nset -e\nhere={}\n{text}", folder.display());
            fs::write(&draft, script).unwrap();
            // Another process writes the file: a file that this process had open could not be run.
            let mut install = Command::new("install");
            finished(install.args(["-m", "755"]).arg(draft).arg(folder.join(name))).unwrap();
        }

        /// Has packages provided; returns the result, the messages, and the arguments of the programs.
        fn provide(&self, is_root: bool, package: Package) -> (io::Result<()>, String, String) {
            let said = RefCell::new(String::new());
            let progress = |step: &str| said.borrow_mut().push_str(step);
            let (apt_get, dpkg_deb) =
                (self.folder.path().join("apt-get"), self.folder.path().join("dpkg-deb"));
            let unpacked = &self.unpacked;
            let apt = Apt { apt_get, dpkg_deb, is_root, unpacked, progress: &progress };
            let result = apt.provide(&[package]);
            let done = fs::read_to_string(self.folder.path().join("done")).unwrap_or_default();
            (result, said.take(), done)
        }
    }

    #[test]
    fn root_installs_what_removes_nothing() {
        let (result, said, done) = Machine::new(INSTALLS).provide(true, Package::LLD);
        result.unwrap();
        assert!(said.ends_with("lld: installs 1: lld"), "{said}");
        assert!(
            done.ends_with("install --yes --no-install-recommends --no-remove lld\n"),
            "{done}"
        );
    }

    #[test]
    fn a_package_that_would_remove_another_one_is_unpacked() {
        for is_root in [true, false] {
            let machine = Machine::new(REMOVES);
            let root = machine.unpacked.folder();
            // What an interrupted one has left is not unpacked with it.
            fs::create_dir_all(root.join("archives")).unwrap();
            fs::write(root.join("archives/lld=1:14.0-55.6.deb"), "half of it").unwrap();
            let (result, said, done) = machine.provide(is_root, Package::LLD);
            result.unwrap();
            assert_eq!(said.contains("REMOVES 1: gcc-old: not done"), is_root, "{said}");
            // The loader of programs stays the machine's.
            assert!(said.ends_with(": lld-14 lld"), "{said}");
            let mut lines: Vec<_> = done.lines().collect();
            lines.sort_unstable();
            assert!(lines[0].ends_with("download lld-14=1:14.0.6-12 lld=1:14.0-55.7"), "{done}");
            let unpacks = |name| format!("dpkg-deb -x {name}.deb {}", root.display());
            let unpacked = [unpacks("lld-14=1:14.0.6-12"), unpacks("lld=1:14.0-55.7")];
            assert_eq!(lines[1..], unpacked);
            assert!(!root.join("archives").exists());
            assert!(machine.unpacked.version("lld").is_some());
        }
    }

    /// They look for their parts where they are installed.
    #[test]
    fn the_tools_of_the_virtual_board_are_not_unpacked() {
        for is_root in [true, false] {
            let (result, _, done) = Machine::new(REMOVES).provide(is_root, Package::NATIVE[0]);
            let error = result.unwrap_err().to_string();
            assert_eq!(error.contains("REMOVES 1: gcc-old"), is_root, "{error}");
            assert_eq!(done, "");
        }
    }

    #[test]
    fn lists_are_fetched_before_a_package_is_given_up() {
        for is_root in [true, false] {
            let machine = Machine::new("");
            machine.has(
                "apt-get",
                "echo \"$*\" >> $here/done; case \"$*\" in *update) ;; *) exit 1; esac",
            );
            let (result, said, done) = machine.provide(is_root, Package::LLD);
            assert!(result.unwrap_err().to_string().contains("install --simulate"));
            assert_eq!(said, "apt-get update");
            let lists = format!("={}", machine.unpacked.folder().join("apt/lists").display());
            let lines: Vec<_> = done.lines().collect();
            assert!(lines.len() == 3 && lines[1].ends_with("update"), "{done}");
            // The machine's lists serve a user without rights until others are fetched.
            let own: Vec<_> = lines.iter().map(|line| line.contains(&lists)).collect();
            assert_eq!(own, [false, !is_root, !is_root]);
        }
    }
}
