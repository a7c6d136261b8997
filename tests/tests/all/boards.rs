//! Every program for every board that can be flashed: it builds, fits, and says which chip it is
//! for.

use std::io::{self, Write};

use analysis::studies::tick_parts::{Part, Share, TickParts};
use analysis::toolchain::{
    BoardModel, BuildError, NumberFormat, Program, Toolchain, Tools, TorqueOutput, prepare, probe,
};

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

/// Parts of a tick that a scene may do without: which of them are in a program.
fn has(name: &str) -> &'static [Part] {
    match name {
        "delayed_spring" | "supervised_spring" => &[Part::Spring, Part::Delay],
        "damper_wall" => &[Part::Spring, Part::Damper, Part::Face, Part::Delay],
        // Torques are later than positions on these boards.
        "free_mode" => &[Part::Canceller, Part::Delay],
        // Free motion that ends at a wall, neither of them late.
        "undelayed_spring" => &[Part::Spring],
        "undelayed_wall" => &[Part::Spring, Part::Damper, Part::Face, Part::Canceller],
        // It measures a device, and renders no scene.
        _ => &[],
    }
}

/// The instructions of a scene's tick are of what the scene uses, and of nothing else.
fn check_parts(board: BoardModel, name: &str, program: &Program) {
    let tick = TickParts::of_file(&program.path).unwrap_or_else(|error| panic!("{error}"));
    let parts =
        [Part::Spring, Part::Damper, Part::Filter, Part::Canceller, Part::Face, Part::Delay];
    for part in parts {
        let Share { instructions, multiplications, .. } = tick.share(part);
        let should = has(name).contains(&part);
        assert_eq!(instructions > 0, should, "{board}, {name}: {instructions} of {part:?}");
        // A face and a delay move numbers and compare them.
        let multiplies = should && !matches!(part, Part::Face | Part::Delay);
        assert_eq!(
            multiplications > 0,
            multiplies,
            "{board}, {name}: {multiplications} of {part:?}"
        );
    }
    // Every servo has an angle and a deflection of its coupling.
    for part in [Part::Encoder, Part::Coupling] {
        let multiplies = tick.share(part).multiplications > 0;
        assert_eq!(multiplies, !has(name).is_empty(), "{board}, {name}: {part:?}");
    }
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
    prepare(Tools::Compiler, |step| eprintln!("{step}")).unwrap_or_else(|error| panic!("{error}"))
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
fn every_program_builds_for_every_board_and_fits() {
    let toolchain = toolchain();
    let programs = toolchain.scenes().unwrap();
    let is_for = |name: &&str, output| toolchain.output_of(name).unwrap() == output;
    let (bridged, programs): (Vec<_>, Vec<_>) =
        programs.iter().map(String::as_str).partition(|name| is_for(name, TorqueOutput::Bridge));
    let ours = ["damper_wall", "delayed_spring", "free_mode", "identify", "supervised_spring"];
    assert!(ours.iter().all(|name| programs.contains(name)), "{programs:?}");
    for board in BoardModel::ALL {
        let built = toolchain.build_for(board, TorqueOutput::Dac, &programs, NumberFormat::F32);
        let built = built.unwrap_or_else(|error| panic!("{board}: {error}"));
        for (name, program) in programs.iter().zip(&built) {
            check(&toolchain, board, name, program);
            // A user's own scene may have other parts.
            if ours.contains(name) {
                check_parts(board, name, program);
            }
        }
    }
    let (board, output) = (BoardModel::BG431bEsc1, TorqueOutput::Bridge);
    let built = toolchain.build_for(board, output, &bridged, NumberFormat::F32);
    let built = built.unwrap_or_else(|error| panic!("{board}: {error}"));
    for (name, program) in bridged.iter().zip(&built) {
        check(&toolchain, board, name, program);
    }
}
