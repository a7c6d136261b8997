//! Observes the tools on this machine.

use std::ffi::OsStr;
use std::fs::DirEntry;
use std::path::Path;
use std::process::{Command, Stdio};

use super::apt::Apt;
use super::host_environment::{
    Debian, HostEnvironment, NativeBuildTools, Package, PackageState, Rust,
};
use super::unpacked::Unpacked;
use super::{Target, Version};

/// What set-up has found out by its steps.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// The lists of packages have just been fetched.
    pub lists_are_fresh: bool,
    /// Packages whose installation would remove others.
    pub conflicting: Vec<Package>,
}

/// Whether this process has root's rights.
pub fn is_root() -> bool {
    nix::unistd::geteuid().is_root()
}

/// Observes the tools on this machine for building programs for `target`.
pub(super) fn observe(
    target: Target,
    unpacked: &Unpacked,
    apt: &Apt,
    findings: &Findings,
) -> HostEnvironment {
    HostEnvironment {
        rust: rust(target),
        rustup: output_of("rustup", &["--version"]).is_some(),
        fetching_forbidden: std::env::var_os("RUSTUP_AUTO_INSTALL").is_some_and(|v| v == "0"),
        qemu: output(unpacked.emulator().arg("--version")).as_deref().and_then(Version::find),
        native: NativeBuildTools {
            cmake: output_of("cmake", &["--version"]).is_some(),
            make: output_of("make", &["--version"]).is_some(),
            cxx: output_of("c++", &["--version"]).is_some(),
            pkg_config: output_of("pkg-config", &["--version"]).is_some(),
            libclang: has_libclang(),
        },
        debian: debian(unpacked, apt, findings),
        root: is_root(),
    }
}

fn rust(target: Target) -> Option<Rust> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let version = Version::find(&output_of(&rustc, &["--version"])?)?;
    let folder = output_of(&rustc, &["--print", "target-libdir", "--target", target.name()]);
    let has_target = folder.is_some_and(|folder| has_core(Path::new(folder.trim())));
    Some(Rust { version, has_target })
}

/// Whether the library is where the build of bindings looks for it: in the configured folder, among the
/// system's libraries, or in LLVM's folder.
fn has_libclang() -> bool {
    let listed = |libraries: String| {
        libraries.lines().filter_map(|line| line.split_whitespace().next()).any(is_libclang)
    };
    std::env::var_os("LIBCLANG_PATH").is_some()
        || output_of("ldconfig", &["-p"]).is_some_and(listed)
        || llvm_has_libclang()
}

/// Whether a file is the library, by its name: `libclang.so`, `libclang-14.so`, and these with a version
/// behind them. `libclang-cpp.so.14` is a different library.
fn is_libclang(file: &str) -> bool {
    let Some((name, version)) = file.split_once(".so") else { return false };
    let numbered = |text: &str| text.chars().all(|c| c.is_ascii_digit() || c == '.');
    let is_named = name == "libclang" || name.strip_prefix("libclang-").is_some_and(numbered);
    is_named && (version.is_empty() || version.starts_with('.'))
}

/// Debian keeps each version of LLVM in its own folder.
fn llvm_has_libclang() -> bool {
    let named = |entry: &DirEntry, start| entry.file_name().to_string_lossy().starts_with(start);
    let entries = |folder: &Path| folder.read_dir().into_iter().flatten().flatten();
    entries(Path::new("/usr/lib")).filter(|entry| named(entry, "llvm-")).any(|llvm| {
        entries(&llvm.path().join("lib"))
            .any(|library| is_libclang(&library.file_name().to_string_lossy()))
    })
}

/// Whether a folder of libraries holds a compiled `core`.
fn has_core(folder: &Path) -> bool {
    let Ok(entries) = folder.read_dir() else { return false };
    entries.flatten().any(|entry| {
        let name = entry.file_name();
        name.to_string_lossy().starts_with("libcore-") && name.to_string_lossy().ends_with(".rlib")
    })
}

fn debian(unpacked: &Unpacked, apt: &Apt, findings: &Findings) -> Option<Debian> {
    output_of("apt-get", &["--version"])?;
    output_of("dpkg-deb", &["--version"])?;
    let state = |package: Package| match state(package, unpacked, apt) {
        PackageState::Available(version) if findings.conflicting.contains(&package) => {
            PackageState::Conflicting(version)
        }
        state => state,
    };
    Some(Debian { lists_are_fresh: findings.lists_are_fresh, packages: Package::ALL.map(state) })
}

fn state(package: Package, unpacked: &Unpacked, apt: &Apt) -> PackageState {
    let name = package.name();
    let installed = output_of("dpkg-query", &["-W", "-f=${db:Status-Status} ${Version}", name])
        .and_then(|state| Version::find(state.strip_prefix("installed ")?));
    if let Some(version) = installed.or_else(|| unpacked.version(package)) {
        return PackageState::Present(version);
    }
    let mut policy = Command::new("apt-cache");
    let candidate = output(policy.args(apt.options()).args(["policy", name])).and_then(|policy| {
        let line = policy.lines().find_map(|line| line.trim().strip_prefix("Candidate:"))?;
        Version::find(line)
    });
    candidate.map_or(PackageState::Unknown, PackageState::Available)
}

/// The output of a program, if it exists and succeeds.
fn output_of(program: impl AsRef<OsStr>, arguments: &[&str]) -> Option<String> {
    output(Command::new(program).args(arguments))
}

fn output(command: &mut Command) -> Option<String> {
    let output = command
        // The output read here must not depend on the user's language.
        .env("LC_ALL", "C")
        .stdin(Stdio::null())
        .output()
        .ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::is_libclang;

    #[test]
    fn a_library_with_a_longer_name_is_another_one() {
        for file in ["libclang.so", "libclang-14.so", "libclang.so.1", "libclang-14.so.14.0.6"] {
            assert!(is_libclang(file), "{file}");
        }
        for file in ["libclang-cpp.so.14", "libclang-cpp.so", "libclangFormat.a", "libclang.a"] {
            assert!(!is_libclang(file), "{file}");
        }
    }
}
