//! The effect of set-up on a Debian machine that lacks the compiler for the board; the machine's programs are
//! scripts, of which `apt-get` writes down its arguments.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

use crate::common::program;

/// The messages of the simulated installation: a new package, and a package to remove.
const INSTALLS: &str = "Inst rustc-web (1.96.0 Debian:12/oldstable [amd64])\n";
const REMOVES: &str = "Remv rust-of-another [1.90.0]\n";

/// The machine's programs; nothing else is on its path.
struct Machine(TempDir);

impl Machine {
    fn new(simulation: &str) -> Self {
        let machine = Self(tempfile::tempdir().unwrap());
        fs::write(machine.0.path().join("simulation"), simulation).unwrap();
        let folder = machine.0.path().display();
        let apt = format!(
            "case \"$*\" in *--simulate*) /bin/cat '{folder}/simulation' ;; *--version*) ;; \
             *) echo \"$*\" >> '{folder}/done' ;; esac"
        );
        machine.has("apt-get", &apt);
        machine.has("dpkg-query", "exit 1");
        machine.has("apt-cache", "echo '  Candidate: 1.96.0'");
        machine.has("rustc", "test \"$1\" = --version && echo 'rustc 1.96.0' || echo /nowhere");
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
            program(&["flash", "damper_wall", "--board", "nucleo-g474re", "--build-only"]);
        command.env("PATH", self.0.path()).env("RUSTUP_AUTO_INSTALL", "0").env_remove("RUSTC");
        command
    }

    /// The arguments of `apt-get` in calls that change the machine.
    fn done(&self) -> String {
        fs::read_to_string(self.0.path().join("done")).unwrap_or_default()
    }

    /// Sets up without a terminal.
    fn set_up(&self) -> String {
        let output = self.command().stdin(Stdio::null()).output().unwrap();
        said(&output)
    }

    /// Sets up at a terminal with this answer of a user; returns the output there.
    fn set_up_and_answer(&self, answer: &str) -> String {
        let terminal = nix::pty::openpty(None, None).unwrap();
        let side = || Stdio::from(terminal.slave.try_clone().unwrap());
        let mut child = self.command().stdin(side()).stderr(side()).spawn().unwrap();
        drop(terminal.slave);
        let mut master = File::from(terminal.master as OwnedFd);
        master.write_all(answer.as_bytes()).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(2));
        let mut seen = Vec::new();
        // The end of a terminal whose other side is closed is an error.
        let _ = master.read_to_end(&mut seen);
        String::from_utf8(seen).unwrap()
    }
}

fn said(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Without root the command is printed, on any machine.
fn is_root() -> bool {
    nix::unistd::geteuid().is_root()
}

const BY_HAND: &str =
    "apt-get install --no-install-recommends rustc-web cargo-web rust-web-src lld";

#[test]
fn nothing_is_removed_where_nobody_can_be_asked() {
    let machine = Machine::new(&format!("{REMOVES}{INSTALLS}"));
    let said = machine.set_up();
    assert!(said.contains(BY_HAND), "{said}");
    assert!(!machine.done().contains("install"), "{}", machine.done());
    if is_root() {
        assert!(said.contains("set-up: ") && said.contains("installs 1: rustc-web"), "{said}");
        assert!(said.contains("REMOVES 1: rust-of-another"), "{said}");
    }
}

#[test]
#[cfg_attr(no_terminals, ignore = "this machine has no pseudo-terminals")]
fn a_person_at_a_terminal_is_asked_before_anything_is_removed() {
    if !is_root() {
        return nothing_is_removed_where_nobody_can_be_asked();
    }
    let machine = Machine::new(&format!("{REMOVES}{INSTALLS}"));
    for no in ["\n", "n\n", "well\n"] {
        let seen = machine.set_up_and_answer(no);
        assert!(seen.contains("remove rust-of-another? [y/N]"), "{seen}");
        assert!(!machine.done().contains("install"), "{no}: {}", machine.done());
    }
    machine.set_up_and_answer("y\n");
    assert!(machine.done().contains("install --yes --no-install-recommends rustc-web"));
}

#[test]
fn what_is_installed_is_said_before_and_may_not_remove() {
    let machine = Machine::new(INSTALLS);
    let said = machine.set_up();
    assert!(said.contains(BY_HAND), "{said}");
    if is_root() {
        assert!(said.contains("installs 1: rustc-web"), "{said}");
        let done = machine.done();
        assert!(done.contains("--yes --no-install-recommends --no-remove rustc-web"), "{done}");
    }
}
