//! The effect of set-up on a Debian machine that lacks the compiler for the board; the machine's programs are
//! scripts, of which `apt-get` writes down its arguments.

use std::fs;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::common::{complaint, program};

/// The messages of the simulated installation: a package to remove, and a new package.
const SIMULATION: &str =
    "Remv rust-of-another [1.90.0]\nInst rustc-web (1.96.0 Debian:12/oldstable [amd64])\n";

/// The machine's programs; nothing else is on its path.
struct Machine(TempDir);

impl Machine {
    fn new() -> Self {
        let machine = Self(tempfile::tempdir().unwrap());
        fs::write(machine.0.path().join("simulation"), SIMULATION).unwrap();
        let folder = machine.0.path().display();
        let apt = format!(
            "case \"$*\" in *--simulate*) /bin/cat '{folder}/simulation' ;; *) echo \"$*\" >> \
             '{folder}/done' ;; esac\ncase \"$*\" in *download*) : > rustc-web.deb ;; esac"
        );
        machine.has("apt-get", &apt);
        machine.has("dpkg-query", "exit 1");
        // Nothing is really unpacked, because this machine's compiler would then build.
        machine.has("dpkg-deb", "echo 'not an archive'; exit 1");
        machine.has("rustc", "test \"$1\" = --version && echo 'rustc 1.96.0' || echo /nowhere");
        // It may not add the target here.
        let rustup = format!("test \"$1\" = --version || echo rustup >> '{folder}/done'");
        machine.has("rustup", &rustup);
        machine
    }

    /// Another process writes the file: a file that this process had open could not be run.
    fn has(&self, name: &str, script: &str) {
        let (draft, file) = (self.0.path().join("draft"), self.0.path().join(name));
        fs::write(&draft, format!("#!/bin/sh\n{script}\n")).unwrap();
        let installed = Command::new("install").args(["-m", "755"]).arg(draft).arg(file).status();
        assert!(installed.unwrap().success());
    }

    fn command(&self) -> Command {
        let mut command =
            program(&["flash", "identify", "--board", "nucleo-g474re", "--build-only"]);
        command.env("PATH", self.0.path()).env("RUSTUP_AUTO_INSTALL", "0").env_remove("RUSTC");
        command.env("CARGO_TARGET_DIR", self.0.path().join("target"));
        command
    }

    /// The arguments of `apt-get` in calls that change the machine.
    fn done(&self) -> String {
        fs::read_to_string(self.0.path().join("done")).unwrap_or_default()
    }

    /// The messages of a set-up that fails, without a terminal.
    fn set_up(&self) -> String {
        complaint(self.command().stdin(Stdio::null()).output().unwrap())
    }
}

/// Without root, all is unpacked.
fn is_root() -> bool {
    nix::unistd::geteuid().is_root()
}

const PACKAGES: &str = "rustc-web cargo-web rust-web-src lld";

#[test]
fn what_would_remove_a_package_is_unpacked_in_the_target_folder() {
    let machine = Machine::new();
    let said = machine.set_up();
    let (done, folder) = (machine.done(), machine.0.path().join("target/packages"));
    if is_root() {
        let refused = format!("apt-get install --no-install-recommends {PACKAGES} installs 1");
        assert!(said.contains(&format!("set-up: {refused}")), "{said}");
        assert!(said.contains("REMOVES 1: rust-of-another: not done"), "{said}");
    }
    assert!(said.contains(&format!("unpacks 1 into {}: rustc-web", folder.display())), "{said}");
    assert!(said.contains("not an archive"), "{said}");
    assert!(done.contains("download rustc-web=1.96.0"), "{done}");
    assert!(!done.contains("install") && !done.contains("rustup"), "{done}");
}
