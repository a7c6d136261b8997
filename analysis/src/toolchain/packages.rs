//! The packages of Debian that programs for boards and their tests need, and how root installs them.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use super::build::Workspace;

/// The emulator's program.
pub const QEMU: &str = "qemu-system-arm";

/// A package of Debian, and a command of the shell that succeeds if it, or a tool like it from elsewhere, is
/// there.
pub(super) type Package<'a> = (&'a str, &'a str);

/// A compiler for targets for which the workspace's own has no libraries: it builds them from source.
pub(super) const COMPILER: [Package<'_>; 4] = [
    ("rustc-web", "dpkg-query -W -f='${db:Status-Abbrev}' rustc-web | grep ^ii"),
    ("cargo-web", "dpkg-query -W -f='${db:Status-Abbrev}' cargo-web | grep ^ii"),
    ("rust-web-src", "dpkg-query -W -f='${db:Status-Abbrev}' rust-web-src | grep ^ii"),
    ("lld", "ld.lld --version"),
];

/// The emulator.
pub(super) const EMULATOR: Package<'_> = (QEMU, "\"$EMULATOR\" --version");

/// The tools that build the virtual board's processor. The bindings need `libclang.so.1`, which Debian calls
/// `libclang-14.so.14`; `libclang-cpp.so.14` is another library.
pub(super) const NATIVE: [Package<'_>; 5] = [
    ("cmake", "cmake --version"),
    ("make", "make --version"),
    ("g++", "c++ --version"),
    ("pkg-config", "pkg-config --version"),
    (
        "libclang-dev",
        "test -n \"$LIBCLANG_PATH\" || /sbin/ldconfig -p | grep -E '\\slibclang(-[0-9]+)?\\.so'",
    ),
];

/// The emulator's file: unpacked beside the builds, or else found on the path.
pub fn emulator() -> PathBuf {
    let unpacked = Workspace::find().map(|found| found.packages().join(QEMU));
    unpacked.ok().filter(|file| file.exists()).unwrap_or_else(|| QEMU.into())
}

/// The names of the packages that are not there.
pub(super) fn missing<'a>(packages: &[Package<'a>]) -> Vec<&'a str> {
    let is_missing = |&&(_, check): &&Package<'_>| {
        let mut shell = Command::new("sh");
        shell.args(["-c", check]).env("LC_ALL", "C").env("EMULATOR", emulator());
        shell.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        !shell.status().is_ok_and(|status| status.success())
    };
    packages.iter().filter(is_missing).map(|(name, _)| *name).collect()
}

/// Installs the packages that are not there, as root on Debian; the machine prints the steps.
///
/// # Errors
/// The names of those that are still not there.
pub(super) fn install<'a>(packages: &[Package<'a>], folder: PathBuf) -> Result<(), Vec<&'a str>> {
    let names = missing(packages);
    if names.is_empty() {
        return Ok(());
    }
    let script = include_str!("install.sh");
    let mut shell = Command::new("sh");
    shell.args(["-c", script, "install.sh"]).arg(folder).args(names).stdin(Stdio::null());
    // Its failure leaves packages missing.
    shell.status().ok();
    let names = missing(packages);
    if names.is_empty() { Ok(()) } else { Err(names) }
}
