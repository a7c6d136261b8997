//! Every program for one board, and one of each kind for the others: it builds, fits, and says which chip
//! it is for.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

use addr2line::Context;
use addr2line::gimli::{Dwarf, EndianSlice, LittleEndian};
use analysis::toolchain::{
    BoardModel, BuildError, NumberFormat, Program, Toolchain, Tools, TorqueOutput, prepare, probe,
};
use object::{Object, ObjectSection, SectionKind};

/// What a debug probe calls a board's chip (the names are those of the chips' data sheets).
fn chip(board: BoardModel) -> &'static str {
    match board {
        BoardModel::NucleoG474re => "STM32G474RETx",
        BoardModel::BG431bEsc1 => "STM32G431CBUx",
        BoardModel::FeatherStm32f405 => "STM32F405RGTx",
    }
}

fn check(toolchain: &Toolchain, board: BoardModel, name: &str, program: &Program) {
    let (sizes, memory) = (program.sizes, toolchain.memory().unwrap());
    // Not `println!`: sizes are to be seen of a test that passes, too.
    let mut output = io::stdout();
    writeln!(
        output,
        "board={board} program={name} flash={} of={} ram={} of={} fast={} of={} stack={}",
        sizes.flash(),
        memory.flash,
        sizes.ram(),
        memory.ram,
        sizes.fast,
        memory.fast,
        memory.stack
    )
    .unwrap();
    assert!(sizes.text > 0 && sizes.flash() <= memory.flash);
    // The map fits the smallest of the boards.
    assert!(memory.flash <= board.flash(), "{board}");
    assert!(sizes.bss > 0 && sizes.ram() <= memory.ram);
    assert!(sizes.fast <= memory.fast);
    let elf = std::fs::read(&program.path).unwrap();
    assert_eq!(probe::chip(&elf).unwrap(), chip(board));
}

/// Parts of a tick that a scene may do without: the beginning of their functions' names, and the scenes that
/// have them.
const PARTS: [(&str, &[&str]); 5] = [
    (
        "<haptic_servo::environment::wall_law::WallLaw<",
        &[
            "delayed_spring",
            "supervised_spring",
            "damper_wall",
            "undelayed_spring",
            "undelayed_wall",
        ],
    ),
    ("<haptic_servo::environment::velocity::Difference<", &["damper_wall", "undelayed_wall"]),
    // A canceller's, and a filtered wall's.
    ("<haptic_servo::environment::velocity::Washout<", &["free_mode", "undelayed_wall"]),
    ("<haptic_servo::environment::wall_law::Face<", &["damper_wall", "undelayed_wall"]),
    // Torques are later than positions on these boards.
    (
        "<haptic_servo::environment::delay_line::",
        &["delayed_spring", "supervised_spring", "damper_wall", "free_mode"],
    ),
];

/// The instructions of a scene's tick are of what the scene uses, and of nothing else.
fn check_parts(board: BoardModel, name: &str, program: &Program) {
    let found = parts_of_ticks(&program.path);
    for (part, (function, scenes)) in PARTS.iter().enumerate() {
        let is_there = found.contains(&part);
        assert_eq!(is_there, scenes.contains(&name), "{board}, {name}: {function}");
    }
}

/// The indices of the parts that a program's ticks have instructions of, by its line tables: a tick is
/// compiled into the servo's interrupt as a whole. The innermost function that an instruction was inlined from
/// counts.
fn parts_of_ticks(path: &Path) -> BTreeSet<usize> {
    const TICK: (&str, &str) = ("<haptic_servo::servo::prepared_servo::PreparedServo<", "::tick");
    let is_tick = |name: &String| name.starts_with(TICK.0) && name.ends_with(TICK.1);
    let part = |name: &String| PARTS.iter().position(|part| name.starts_with(part.0));
    let elf = std::fs::read(path).unwrap();
    let file = object::File::parse(&*elf).unwrap();
    let tables = Dwarf::load(|id| -> Result<_, object::Error> {
        let section = file.section_by_name(id.name());
        let data = section.map_or(Ok(&[][..]), |section| section.data())?;
        Ok(EndianSlice::new(data, LittleEndian))
    });
    let context = Context::from_dwarf(tables.unwrap()).unwrap();
    let mut parts = BTreeSet::new();
    for section in file.sections().filter(|section| section.kind() == SectionKind::Text) {
        for address in (section.address()..section.address() + section.size()).step_by(2) {
            let mut frames = context.find_frames(address).skip_all_loads().unwrap();
            let mut names = Vec::new();
            while let Some(frame) = frames.next().unwrap() {
                names.extend(frame.function.map(|name| name.demangle().unwrap().into_owned()));
            }
            let tick = names.iter().position(is_tick).unwrap_or(0);
            parts.extend(names[..tick].iter().find_map(part));
        }
    }
    parts
}

/// They run by hand only, but shall not rot.
#[test]
#[ignore = "builds for minutes"]
fn the_tests_on_a_board_build() {
    let toolchain = toolchain();
    for (board, output) in [
        (BoardModel::NucleoG474re, TorqueOutput::Dac),
        (BoardModel::BG431bEsc1, TorqueOutput::Bridge),
    ] {
        let built = toolchain.build_tests(board, output).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(probe::chip(&std::fs::read(built).unwrap()).unwrap(), chip(board));
    }
    let none = toolchain.build_tests(BoardModel::NucleoG474re, TorqueOutput::Bridge);
    assert!(matches!(none, Err(BuildError::NoBridge { .. })), "{none:?}");
}

fn toolchain() -> Toolchain {
    prepare(Tools::Compiler).unwrap_or_else(|error| panic!("{error}"))
}

/// What the compiler says of a program for no board in particular.
#[test]
fn where_no_board_is_named_the_compiler_names_all_of_them() {
    let source = include_str!("../../../firmware/src/board/mod.rs");
    let messages = source.split("compile_error!(").skip(1);
    let messages = messages.map(|message| message.split(");").next().unwrap());
    let of_boards: Vec<_> = messages.filter(|message| message.contains("board-qemu")).collect();
    let [message] = of_boards[..] else { panic!("{of_boards:?}") };
    for board in BoardModel::ALL {
        assert!(message.contains(&board.to_string()), "{board} is not in {message}");
    }
    assert!(message.contains("board-qemu,log"), "{message}");
}

#[test]
#[ignore = "builds for minutes"]
fn programs_of_every_kind_build_for_every_board_and_fit() {
    let toolchain = toolchain();
    let programs = toolchain.scenes().unwrap();
    let is_for = |name: &&str, output| toolchain.output_of(name).unwrap() == output;
    let (bridged, programs): (Vec<_>, Vec<_>) =
        programs.iter().map(String::as_str).partition(|name| is_for(name, TorqueOutput::Bridge));
    let ours = ["damper_wall", "delayed_spring", "free_mode", "identify", "supervised_spring"];
    assert!(ours.iter().all(|name| programs.contains(name)), "{programs:?}");
    // What a board does for programs: torques that are latched or at a phase, a host's, and sweeps.
    let kinds = ["damper_wall", "undelayed_wall", "hosted_wall", "identify"];
    for (board, output, names) in [
        (BoardModel::NucleoG474re, TorqueOutput::Dac, &programs[..]),
        (BoardModel::BG431bEsc1, TorqueOutput::Dac, &kinds),
        (BoardModel::BG431bEsc1, TorqueOutput::Bridge, &bridged),
        (BoardModel::FeatherStm32f405, TorqueOutput::Dac, &kinds),
    ] {
        let built = toolchain.build_for(board, output, names, NumberFormat::F32);
        let built = built.unwrap_or_else(|error| panic!("{board}: {error}"));
        for (name, program) in names.iter().zip(&built) {
            check(&toolchain, board, name, program);
            // A user's own scene may have other parts.
            if ours.contains(name) {
                check_parts(board, name, program);
            }
        }
    }
}
