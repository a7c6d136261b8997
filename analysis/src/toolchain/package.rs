//! The packages that programs for boards may need: one list, and the observation whether each is there.

use std::env;
use std::process::{Command, Stdio};

use super::Version;
use super::unpacked::Unpacked;

/// A package of Debian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Package {
    /// Its name.
    pub name: &'static str,
    /// Its oldest sufficient version.
    oldest: Option<Version>,
    sign: Sign,
}

/// The sign that a package, or a tool like it from elsewhere, is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    /// Debian has installed it, or it is unpacked.
    Package,
    /// This program runs.
    Runs(&'static str),
    /// The emulator runs, installed or unpacked.
    Emulator,
    /// The library is where the build of bindings looks for it.
    Libclang,
}

const fn package(name: &'static str, oldest: Option<Version>, sign: Sign) -> Package {
    Package { name, oldest, sign }
}

impl Package {
    /// The linker of programs for a board.
    pub const LLD: Self = package("lld", None, Sign::Package);
    /// A compiler for the target, where rustup does not provide it; its last but one is the source of `core`.
    pub const COMPILER: [Self; 4] = [
        package("rustc-web", Some(Version::RUST), Sign::Package),
        package("cargo-web", Some(Version::RUST), Sign::Package),
        package("rust-web-src", Some(Version::RUST), Sign::Package),
        Self::LLD,
    ];
    /// The emulator.
    pub const EMULATOR: Self = package("qemu-system-arm", Some(Version::QEMU), Sign::Emulator);
    /// The tools that build the virtual board's processor. They look for their parts where they are
    /// installed, so they do not run from another folder.
    pub const NATIVE: [Self; 5] = [
        package("cmake", None, Sign::Runs("cmake")),
        package("make", None, Sign::Runs("make")),
        package("g++", None, Sign::Runs("c++")),
        package("pkg-config", None, Sign::Runs("pkg-config")),
        package("libclang-dev", None, Sign::Libclang),
    ];

    pub(super) fn is_served_by(self, version: Version) -> bool {
        self.oldest.is_none_or(|oldest| version >= oldest)
    }

    /// Whether it, or a tool like it from elsewhere, is installed or unpacked.
    pub(super) fn is_there(self, unpacked: &Unpacked) -> bool {
        let serves = |version: Option<Version>| version.is_some_and(|it| self.is_served_by(it));
        match self.sign {
            Sign::Package => serves(self.installed()) || serves(unpacked.version(self.name)),
            Sign::Runs(program) => output(Command::new(program).arg("--version")).is_some(),
            Sign::Emulator => {
                let said = output(unpacked.emulator().arg("--version"));
                serves(said.and_then(|said| Version::find(&said)))
            }
            Sign::Libclang => {
                let libraries = || output(Command::new("/sbin/ldconfig").arg("-p"));
                env::var_os("LIBCLANG_PATH").is_some()
                    || libraries().unwrap_or_default().lines().any(is_libclang)
            }
        }
    }

    fn installed(self) -> Option<Version> {
        let query = ["-W", "-f=${db:Status-Status} ${Version}", self.name];
        let said = output(Command::new("dpkg-query").args(query))?;
        Version::find(said.strip_prefix("installed ")?)
    }
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

/// The output of a program, if it exists and succeeds.
pub(super) fn output(command: &mut Command) -> Option<String> {
    // The output read here must not depend on the user's language.
    let output = command.env("LC_ALL", "C").stdin(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// How a user gets packages, or what serves in their place. Other systems than Debian have packages of
/// similar names.
pub fn by_hand(packages: &[Package], target: &str) -> String {
    let (compiler, others): (Vec<_>, Vec<Package>) =
        packages.iter().copied().partition(|package| Package::COMPILER.contains(package));
    let mut text = String::new();
    if !compiler.is_empty() {
        let oldest = Version::RUST;
        text += &format!(
            "\n- Rust {oldest} or later with the target {target}: from https://rustup.rs, rustup \
             update stable, then rustup target add {target}"
        );
    }
    if others.is_empty() {
        return text;
    }
    let tool = |package: &Package| match package.oldest {
        Some(oldest) => format!("{} {oldest} or later", package.name),
        None => package.name.to_owned(),
    };
    let names: Vec<_> = others.iter().map(|package| package.name).collect();
    let tools = others.iter().map(tool).collect::<Vec<_>>().join(", ");
    text + &format!(
        "\n- {tools}:\n  sudo apt-get install --no-install-recommends {} (Debian, Ubuntu)\n  or the \
         same tools from the packages of your system",
        names.join(" ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_name_tools_versions_and_commands() {
        let packages = [Package::COMPILER[0], Package::LLD, Package::EMULATOR, Package::NATIVE[2]];
        let expected = "
- Rust 1.95 or later with the target wasm32-unknown-unknown: from https://rustup.rs, rustup update stable, \
                        then rustup target add wasm32-unknown-unknown
- qemu-system-arm 7.2 or later, g++:
  sudo apt-get install --no-install-recommends qemu-system-arm g++ (Debian, Ubuntu)
  or the same tools from the packages of your system";
        assert_eq!(by_hand(&packages, "wasm32-unknown-unknown"), expected);
    }

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
