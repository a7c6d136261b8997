//! The effect of set-up on a Debian machine that lacks the compiler for the board; the machine's programs are
//! scripts, of which `apt-get` writes down its arguments.

use std::fs;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::common::{complaint, program};

/// A message of the simulated installation: a new package.
const INSTALLS: &str = "Inst rustc-web (1.96.0 Debian:12/oldstable [amd64])\n";

/// The machine's programs; nothing else is on its path.
struct Machine(TempDir);

impl Machine {
    fn new(simulation: &str) -> Self {
        let machine = Self(tempfile::tempdir().unwrap());
        fs::write(machine.0.path().join("simulation"), simulation).unwrap();
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

    /// Sets up without a terminal; gives its messages.
    fn set_up(&self) -> String {
        let mut command =
            program(&["flash", "damper_wall", "--board", "nucleo-g474re", "--build-only"]);
        command.env("PATH", self.0.path()).env("RUSTUP_AUTO_INSTALL", "0").env_remove("RUSTC");
        command.env("CARGO_TARGET_DIR", self.0.path().join("target")).stdin(Stdio::null());
        complaint(command.output().unwrap())
    }
}

#[test]
fn what_is_installed_is_said_before_and_may_not_remove() {
    let machine = Machine::new(INSTALLS);
    let said = machine.set_up();
    // Without root, all is unpacked.
    if nix::unistd::geteuid().is_root() {
        let by_hand =
            "apt-get install --no-install-recommends rustc-web cargo-web rust-web-src lld";
        assert!(said.contains(&format!("{by_hand}: installs 1: rustc-web")), "{said}");
        let done = fs::read_to_string(machine.0.path().join("done")).unwrap();
        assert!(done.contains("--yes --no-install-recommends --no-remove rustc-web"), "{done}");
        assert!(!done.contains("rustup"), "{done}");
    }
}
