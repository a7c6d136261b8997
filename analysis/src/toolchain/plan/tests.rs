//! The routes, machine by machine.

use super::super::host_environment::Debian;
use super::*;

const OLD: Version = Version { major: 1, minor: 85 };
const NEW: Version = Version { major: 1, minor: 96 };
const QEMU_7: Version = Version { major: 7, minor: 2 };
const QEMU_5: Version = Version { major: 5, minor: 2 };
const CMAKE: Version = Version { major: 3, minor: 25 };
const CLANG: Version = Version { major: 14, minor: 0 };
/// The packages' versions.
const VERSIONS: [Version; Package::ALL.len()] =
    [NEW, NEW, NEW, QEMU_7, QEMU_7, CMAKE, CMAKE, CMAKE, CMAKE, CLANG];
/// What the emulated board needs.
const FOR_EMULATOR: [Package; 5] =
    [Package::Rustc, Package::Cargo, Package::RustSource, Package::Lld, Package::Qemu];

fn rust(version: Version, has_target: bool) -> Option<Rust> {
    Some(Rust { version, has_target })
}

/// A machine with everything: rustup's toolchain with the target, and the emulator.
fn complete() -> HostEnvironment {
    HostEnvironment {
        rust: rust(NEW, true),
        rustup: true,
        fetching_forbidden: false,
        qemu: Some(QEMU_7),
        native: NativeBuildTools {
            cmake: true,
            make: true,
            cxx: true,
            pkg_config: true,
            libclang: true,
        },
        debian: None,
        root: false,
    }
}

/// A Debian whose packages are all to be had and not installed.
fn debian() -> Debian {
    let available = PackageState::Available;
    Debian { lists_are_fresh: false, packages: VERSIONS.map(available) }
}

fn installed() -> Debian {
    Debian { lists_are_fresh: false, packages: VERSIONS.map(PackageState::Present) }
}

/// A Debian container without rustup's target and without the emulator, as root.
fn bare_container() -> HostEnvironment {
    HostEnvironment {
        rust: rust(NEW, false),
        fetching_forbidden: true,
        qemu: None,
        debian: Some(debian()),
        root: true,
        ..complete()
    }
}

fn check(host: &HostEnvironment, expected: Plan) {
    assert_eq!(plan(host, Tools::CompilerAndEmulator), expected, "{host:?}");
}

#[test]
fn a_complete_machine_is_ready() {
    check(&complete(), Plan::Ready(Compiler::Own));
    // Also where fetching is forbidden, and without rustup: the installed tools serve.
    check(&HostEnvironment { fetching_forbidden: true, ..complete() }, Plan::Ready(Compiler::Own));
    check(&HostEnvironment { rustup: false, ..complete() }, Plan::Ready(Compiler::Own));
}

#[test]
fn rustup_adds_the_target_where_it_may() {
    let host = HostEnvironment { rust: rust(NEW, false), ..complete() };
    check(&host, Plan::Do(Step::AddTarget(Target::Board)));
    // Before Debian's packages, which would be a second compiler.
    check(
        &HostEnvironment { debian: Some(debian()), root: true, ..host },
        Plan::Do(Step::AddTarget(Target::Board)),
    );
}

#[test]
fn rustup_fetches_nothing_where_it_is_forbidden() {
    let compiler = Package::COMPILER.to_vec();
    let host = HostEnvironment { qemu: Some(QEMU_7), ..bare_container() };
    check(&host, Plan::Do(Step::Install(compiler)));
    check(&HostEnvironment { debian: Some(installed()), ..host }, Plan::Ready(Compiler::Debian));
}

#[test]
fn root_on_debian_installs_all_that_is_missing_at_once() {
    check(&bare_container(), Plan::Do(Step::Install(FOR_EMULATOR.to_vec())));
    let mut debian = debian();
    debian.packages[0] = PackageState::Present(NEW);
    let rest = FOR_EMULATOR[1..].to_vec();
    let host = HostEnvironment { debian: Some(debian), ..bare_container() };
    check(&host, Plan::Do(Step::Install(rest)));
}

#[test]
fn the_emulator_alone_is_installed_where_it_alone_is_missing() {
    let host = HostEnvironment { qemu: None, debian: Some(debian()), root: true, ..complete() };
    check(&host, Plan::Do(Step::Install(vec![Package::Qemu])));
    let host = HostEnvironment { rust: rust(NEW, false), ..host };
    // One step at a time: the target is added after that.
    check(&host, Plan::Do(Step::Install(vec![Package::Qemu])));
}

#[test]
fn a_user_who_is_not_root_gets_the_packages_unpacked() {
    let host = HostEnvironment { root: false, ..bare_container() };
    check(&host, Plan::Do(Step::Unpack(FOR_EMULATOR.to_vec())));
}

/// `qemu-utils` of a later release is installed: the emulator would replace it by an older one.
#[test]
fn a_package_that_would_remove_another_one_is_unpacked() {
    let mut conflict = debian();
    conflict.packages[4] = PackageState::Conflicting(QEMU_7);
    let host = HostEnvironment { debian: Some(conflict.clone()), ..bare_container() };
    // The others first, installed as usual.
    check(&host, Plan::Do(Step::Install(Package::COMPILER.to_vec())));
    conflict.packages[..4].fill(PackageState::Present(NEW));
    let host = HostEnvironment { debian: Some(conflict.clone()), ..host };
    check(&host, Plan::Do(Step::Unpack(vec![Package::Qemu])));
    // It is then found, and its state does not matter.
    check(&HostEnvironment { qemu: Some(QEMU_7), ..host }, Plan::Ready(Compiler::Debian));
}

/// They look for their parts where they are installed.
#[test]
fn the_tools_of_the_virtual_board_are_not_unpacked() {
    let native = NativeBuildTools { cmake: false, ..complete().native };
    let mut conflict = debian();
    conflict.packages[5] = PackageState::Conflicting(CMAKE);
    let host = HostEnvironment { native, debian: Some(conflict), root: true, ..complete() };
    let expected = Plan::Ask(vec![ManualStep::Packages(vec![Package::Cmake])]);
    assert_eq!(plan(&host, Tools::CompilerAndVirtualBoard), expected);
}

#[test]
fn lists_are_fetched_before_a_package_is_given_up() {
    let unknown = [PackageState::Unknown; Package::ALL.len()];
    let stale = Debian { lists_are_fresh: false, packages: unknown };
    let fresh = Debian { lists_are_fresh: true, packages: unknown };
    let host = HostEnvironment { debian: Some(stale.clone()), ..bare_container() };
    check(&host, Plan::Do(Step::FetchLists));
    let compiler = ManualStep::Compiler { found: Some(NEW), rustup: false, target: Target::Board };
    let both = vec![compiler, ManualStep::Emulator { found: None }];
    check(&HostEnvironment { debian: Some(fresh), ..host.clone() }, Plan::Ask(both));
    // Any user can fetch lists of their own.
    check(&HostEnvironment { root: false, ..host }, Plan::Do(Step::FetchLists));
}

#[test]
fn packages_that_are_too_old_do_not_serve() {
    let mut old = debian();
    old.lists_are_fresh = true;
    old.packages[0] = PackageState::Available(OLD);
    let host =
        HostEnvironment { qemu: Some(QEMU_7), debian: Some(old.clone()), ..bare_container() };
    let request = ManualStep::Compiler { found: Some(NEW), rustup: false, target: Target::Board };
    check(&host, Plan::Ask(vec![request.clone()]));
    old.packages[0] = PackageState::Present(OLD);
    check(&HostEnvironment { debian: Some(old), ..host }, Plan::Ask(vec![request]));
}

#[test]
fn elsewhere_the_person_is_told_what_to_get() {
    let host = HostEnvironment { rust: None, rustup: false, qemu: None, ..complete() };
    let requests = vec![
        ManualStep::Compiler { found: None, rustup: false, target: Target::Board },
        ManualStep::Emulator { found: None },
    ];
    check(&host, Plan::Ask(requests));
    let host = HostEnvironment { rust: rust(OLD, true), ..complete() };
    check(
        &host,
        Plan::Ask(vec![ManualStep::Compiler {
            found: Some(OLD),
            rustup: true,
            target: Target::Board,
        }]),
    );
    let host = HostEnvironment { qemu: Some(QEMU_5), ..complete() };
    check(&host, Plan::Ask(vec![ManualStep::Emulator { found: Some(QEMU_5) }]));
}

#[test]
fn both_kinds_of_request_are_made_together() {
    let mut packages = debian();
    packages.packages[5] = PackageState::Unknown;
    packages.packages[0] = PackageState::Unknown;
    packages.lists_are_fresh = true;
    let native = NativeBuildTools { cmake: false, ..complete().native };
    let host = HostEnvironment { debian: Some(packages), native, ..bare_container() };
    let requests = vec![
        ManualStep::Compiler { found: Some(NEW), rustup: false, target: Target::Board },
        ManualStep::NativeBuildTools(native),
    ];
    assert_eq!(plan(&host, Tools::CompilerAndVirtualBoard), Plan::Ask(requests));
}

#[test]
fn requests_are_commands() {
    assert_eq!(
        ManualStep::Packages(vec![Package::Lld, Package::Qemu]).to_string(),
        "install packages: sudo apt-get install --no-install-recommends lld qemu-system-arm"
    );
    assert_eq!(
        ManualStep::Compiler { found: Some(OLD), rustup: true, target: Target::Board }.to_string(),
        "install Rust 1.95 or later with the target thumbv7em-none-eabihf: this is Rust 1.85; \
         rustup update stable, then rustup target add thumbv7em-none-eabihf"
    );
}

/// Whatever the machine, following the plan ends: each step changes the facts that asked for it.
#[test]
fn following_the_plan_ends() {
    for bits in 0..16384_u32 {
        let bit = |n: u32| bits >> n & 1 == 1;
        let mut host = HostEnvironment {
            rust: bit(0).then_some(Rust { version: NEW, has_target: bit(1) }),
            rustup: bit(2),
            fetching_forbidden: bit(3),
            qemu: bit(4).then_some(QEMU_7),
            debian: bit(5).then(debian),
            root: bit(6),
            native: NativeBuildTools {
                cmake: bit(8),
                make: bit(10),
                cxx: bit(11),
                pkg_config: bit(12),
                libclang: bit(9),
            },
        };
        if bit(13)
            && let Some(debian) = &mut host.debian
        {
            debian.packages[4] = PackageState::Conflicting(QEMU_7);
        }
        if bit(7) {
            host.debian = host
                .debian
                .map(|d| Debian { packages: [PackageState::Unknown; Package::ALL.len()], ..d });
        }
        for tools in
            [Tools::CompilerAndEmulator, Tools::CompilerAndVirtualBoard, Tools::CompilerForBrowser]
        {
            let mut host = host.clone();
            let mut steps = 0;
            while let Plan::Do(step) = plan(&host, tools) {
                assert!(!matches!(step, Step::AddTarget(_)) || !host.fetching_forbidden);
                take(&mut host, step);
                steps += 1;
                assert!(steps <= 4, "{host:?}");
            }
        }
    }
}

/// What a step does to the machine.
fn take(host: &mut HostEnvironment, step: Step) {
    match (step, &mut host.debian) {
        (Step::AddTarget(_), _) => host.rust = rust(NEW, true),
        (Step::FetchLists, Some(debian)) => debian.lists_are_fresh = true,
        (Step::Install(packages) | Step::Unpack(packages), Some(debian)) => {
            for package in packages {
                let index = Package::ALL.iter().position(|p| *p == package).unwrap();
                debian.packages[index] = PackageState::Present(NEW);
                match package {
                    Package::Qemu => host.qemu = Some(QEMU_7),
                    Package::Cmake => host.native.cmake = true,
                    Package::Make => host.native.make = true,
                    Package::Cxx => host.native.cxx = true,
                    Package::PkgConfig => host.native.pkg_config = true,
                    Package::Libclang => host.native.libclang = true,
                    _ => {}
                }
            }
        }
        (step, None) => panic!("{step} without Debian"),
    }
}

#[test]
fn whoever_only_flashes_needs_no_emulator() {
    let host = HostEnvironment { qemu: None, ..complete() };
    assert_eq!(plan(&host, Tools::Compiler), Plan::Ready(Compiler::Own));
    assert!(matches!(plan(&host, Tools::CompilerAndEmulator), Plan::Ask(_)));
}

#[test]
fn a_virtual_board_is_built_with_cmake_and_libclang_and_needs_no_emulator() {
    let tools = Tools::CompilerAndVirtualBoard;
    let none = NativeBuildTools {
        cmake: false,
        make: false,
        cxx: false,
        pkg_config: false,
        libclang: false,
    };
    let host = HostEnvironment {
        native: none,
        qemu: None,
        debian: Some(debian()),
        root: true,
        ..complete()
    };
    let all =
        vec![Package::Cmake, Package::Make, Package::Cxx, Package::PkgConfig, Package::Libclang];
    assert_eq!(plan(&host, tools), Plan::Do(Step::Install(all)));
    let half = HostEnvironment {
        native: NativeBuildTools { libclang: false, ..complete().native },
        ..host.clone()
    };
    assert_eq!(plan(&half, tools), Plan::Do(Step::Install(vec![Package::Libclang])));
    let person = HostEnvironment { debian: None, root: false, ..host };
    assert_eq!(plan(&person, tools), Plan::Ask(vec![ManualStep::NativeBuildTools(none)]));
    assert_eq!(plan(&person, Tools::Compiler), Plan::Ready(Compiler::Own));
    let sentence =
        ManualStep::NativeBuildTools(NativeBuildTools { cmake: false, ..complete().native })
            .to_string();
    assert!(sentence.starts_with("install cmake, to build"), "{sentence}");
}

#[test]
fn a_page_is_built_for_a_browser_and_needs_no_emulator() {
    let tools = Tools::CompilerForBrowser;
    let host = HostEnvironment { rust: rust(NEW, false), qemu: None, ..complete() };
    assert_eq!(plan(&host, tools), Plan::Do(Step::AddTarget(Target::Browser)));
    assert_eq!(
        Step::AddTarget(Target::Browser).to_string(),
        "rustup target add wasm32-unknown-unknown"
    );
    let compiler = Package::COMPILER.to_vec();
    assert_eq!(plan(&bare_container(), tools), Plan::Do(Step::Install(compiler)));
    let debian = HostEnvironment { debian: Some(installed()), ..bare_container() };
    assert_eq!(plan(&debian, tools), Plan::Ready(Compiler::Debian));
}
