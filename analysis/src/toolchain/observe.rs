//! Observes the tools on this machine.

use std::env;
use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Stdio};

use super::needs::Own;
use super::package::Package;
use super::unpacked::Unpacked;
use super::{Target, Version};

/// The toolchain that cargo runs here, for building programs for `target`.
pub(super) fn own(target: Target) -> Own {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let rust = output_of(&rustc, &["--version"]).and_then(|version| Version::find(&version));
    let folder = output_of(&rustc, &["--print", "target-libdir", "--target", target.name()]);
    Own {
        rust,
        has_target: folder.is_some_and(|folder| has_core(Path::new(folder.trim()))),
        rustup: output_of("rustup", &["--version"]).is_some(),
        fetching_forbidden: env::var_os("RUSTUP_AUTO_INSTALL").is_some_and(|value| value == "0"),
    }
}

/// Whether a package, or a tool like it from elsewhere, is installed or unpacked.
pub(super) fn is_there(package: Package, unpacked: &Unpacked) -> bool {
    let runs = |program: &str| output_of(program, &["--version"]).is_some();
    let serves = |version| package.is_served_by(version);
    match package {
        Package::Cmake | Package::Make | Package::PkgConfig => runs(package.name()),
        Package::Cxx => runs("c++"),
        Package::Libclang => has_libclang(),
        Package::Qemu => {
            let said = output(unpacked.emulator().arg("--version"));
            said.and_then(|said| Version::find(&said)).is_some_and(serves)
        }
        _ => {
            installed(package).is_some_and(serves) || unpacked.version(package).is_some_and(serves)
        }
    }
}

fn installed(package: Package) -> Option<Version> {
    let query = ["-W", "-f=${db:Status-Status} ${Version}", package.name()];
    Version::find(output_of("dpkg-query", &query)?.strip_prefix("installed ")?)
}

/// Whether the library is where the build of bindings looks for it: in the configured folder, or among the
/// system's libraries.
fn has_libclang() -> bool {
    let libraries = || output_of("/sbin/ldconfig", &["-p"]).unwrap_or_default();
    env::var_os("LIBCLANG_PATH").is_some() || libraries().lines().any(is_libclang)
}

/// Whether a line lists the library: `libclang.so.1`, or `libclang-14.so.14` as Debian names it.
/// `libclang-cpp.so.14` is a different library.
fn is_libclang(line: &str) -> bool {
    let is_number = |rest: &str| rest.starts_with(|c: char| c.is_ascii_digit());
    let version = line.trim_start().strip_prefix("libclang");
    version.is_some_and(|rest| {
        rest.starts_with(".so") || rest.strip_prefix('-').is_some_and(is_number)
    })
}

/// Whether a folder of libraries holds a compiled `core`.
fn has_core(folder: &Path) -> bool {
    let Ok(entries) = folder.read_dir() else { return false };
    entries.flatten().any(|entry| entry.file_name().to_string_lossy().starts_with("libcore-"))
}

/// The output of a program, if it exists and succeeds.
fn output_of(program: impl AsRef<OsStr>, arguments: &[&str]) -> Option<String> {
    output(Command::new(program).args(arguments))
}

fn output(command: &mut Command) -> Option<String> {
    // The output read here must not depend on the user's language.
    let output = command.env("LC_ALL", "C").stdin(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::is_libclang;

    #[test]
    fn a_library_with_a_longer_name_is_another_one() {
        let line = |file| format!("\t{file} (libc6,x86-64) => /lib/x86_64-linux-gnu/{file}");
        for file in ["libclang.so", "libclang.so.1", "libclang-14.so.14.0.6"] {
            assert!(is_libclang(&line(file)), "{file}");
        }
        for file in ["libclang-cpp.so.14", "libclangFormat.so", "liblibclang.so"] {
            assert!(!is_libclang(&line(file)), "{file}");
        }
    }
}
