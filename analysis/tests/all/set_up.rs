//! The effect of set-up on a Debian machine that lacks tools; the machine's programs are scripts, of which
//! `apt-get` writes down its arguments.

use std::fs;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::common::{complaint, program};

const INSTALLS: &str = "Inst lld-14 (1:14.0.6-12 Debian:12/oldstable [amd64])\n\
                        Inst libc6 [2.36-9] (2.36-10 Debian:12/oldstable [amd64]) []\n\
                        Conf lld-14 (1:14.0.6-12 Debian:12/oldstable [amd64])\n";
const REMOVES: &str = "Remv of-another [1.90.0]\n";

/// The machine's programs, which are found before the real ones.
struct Machine(TempDir);

impl Machine {
    /// Its `apt-get` prints this simulation, and makes an archive of what it downloads.
    fn new(user: u32, simulation: &str) -> Self {
        let machine = Self(tempfile::tempdir().unwrap());
        fs::write(machine.0.path().join("simulation"), simulation).unwrap();
        let here = machine.0.path().display();
        machine.has("id", &format!("echo {user}"));
        machine.has(
            "apt-get",
            &format!(
                "case \"$*\" in *--simulate*) cat '{here}/simulation' ;; *) echo \"$*\" >> \
                 '{here}/done' ;; esac\ncase \"$*\" in *download*) : > lld-14.deb ;; esac"
            ),
        );
        machine.has("dpkg-query", "exit 1");
        machine.has("dpkg-deb", &format!("echo \"dpkg-deb $*\" >> '{here}/done'"));
        machine.has("rustc", "echo /nowhere");
        machine.has("ld.lld", "exit 1");
        machine.has("qemu-system-arm", "exit 1");
        // It may not add the target here.
        machine.has("rustup", &format!("test \"$1\" = --version || echo rustup >> '{here}/done'"));
        machine
    }

    /// Another process writes the file: a file that this process had open could not be run.
    fn has(&self, name: &str, script: &str) {
        let (draft, file) = (self.0.path().join("draft"), self.0.path().join(name));
        fs::write(&draft, format!("#!/bin/sh\n{script}\n")).unwrap();
        let installed = Command::new("install").args(["-m", "755"]).arg(draft).arg(file).status();
        assert!(installed.unwrap().success());
    }

    /// The messages of a set-up that fails, without a terminal.
    fn set_up(&self, arguments: &[&str]) -> String {
        let mut command = program(arguments);
        let path = std::env::var("PATH").unwrap();
        command.env("PATH", format!("{}:{path}", self.0.path().display()));
        command.env("RUSTUP_AUTO_INSTALL", "0").env_remove("RUSTC");
        command.env("CARGO_TARGET_DIR", self.0.path().join("target"));
        complaint(command.stdin(Stdio::null()).output().unwrap())
    }

    /// The lines that `apt-get`, `dpkg-deb` and `rustup` have written, which change the machine.
    fn done(&self) -> Vec<String> {
        let done = fs::read_to_string(self.0.path().join("done")).unwrap_or_default();
        done.lines().map(str::to_owned).collect()
    }
}

const FLASH: [&str; 5] = ["flash", "damper_wall", "--board", "nucleo-g474re", "--build-only"];
const COMPILER: &str =
    "apt-get install --no-install-recommends rustc-web cargo-web rust-web-src lld";

#[test]
fn root_installs_what_removes_nothing() {
    let machine = Machine::new(0, INSTALLS);
    let said = machine.set_up(&FLASH);
    assert!(said.contains(&format!("set-up: {COMPILER}: installs lld-14 libc6\n")), "{said}");
    let done = machine.done();
    assert_eq!(done.len(), 2, "{done:?}");
    assert!(done[0].ends_with(" update"), "{done:?}");
    let install = "--yes --no-install-recommends --no-remove rustc-web cargo-web rust-web-src lld";
    assert!(done[1].ends_with(install), "{done:?}");
    // It has installed nothing.
    let missing = "error: tools to build for thumbv7em-none-eabihf are missing: ";
    assert!(said.contains(missing) && said.trim_end().ends_with(COMPILER), "{said}");
}

#[test]
fn no_package_is_removed_and_without_root_none_is_installed() {
    let machine = Machine::new(0, &format!("{REMOVES}{INSTALLS}"));
    let said = machine.set_up(&FLASH);
    assert!(said.contains("set-up: not done, because it REMOVES of-another\n"), "{said}");
    assert!(said.trim_end().ends_with(COMPILER), "{said}");
    assert_eq!(machine.done().len(), 1, "{:?}", machine.done());

    let machine = Machine::new(1000, INSTALLS);
    let said = machine.set_up(&FLASH);
    assert!(said.contains("set-up: not installed here, only as root on Debian\n"), "{said}");
    assert!(said.trim_end().ends_with(COMPILER), "{said}");
    assert!(machine.done().is_empty(), "{:?}", machine.done());
}

#[test]
fn an_emulator_that_would_remove_a_package_is_unpacked() {
    let machine = Machine::new(0, &format!("{REMOVES}{INSTALLS}"));
    // The compiler has the target.
    let libraries = machine.0.path().join("libraries");
    fs::create_dir(&libraries).unwrap();
    fs::write(libraries.join("libcore-1.rlib"), "").unwrap();
    machine.has("rustc", &format!("echo '{}'", libraries.display()));
    let said = machine.set_up(&["run", "damper_wall", "--target", "qemu"]);
    let packages = machine.0.path().join("target/packages");
    assert!(said.contains(&format!("into {}\n", packages.display())), "{said}");
    let done = machine.done();
    assert_eq!(done.len(), 3, "{done:?}");
    // The loader of programs stays the machine's.
    assert!(done[1].ends_with(" download lld-14"), "{done:?}");
    assert_eq!(done[2], "dpkg-deb -x lld-14.deb ..");
    // Nothing was really unpacked.
    assert!(said.trim_end().ends_with("or the same tools of your system"), "{said}");
    assert!(packages.join("qemu-system-arm").exists());
    assert!(!packages.join("archives").exists());
}
