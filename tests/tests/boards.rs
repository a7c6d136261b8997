//! Every program for every board that can be flashed: it builds, fits, and says which chip it is
//! for.

use analysis::toolchain::{Board, NumberFormat, Toolchain, Tools, prepare, probe};

/// What a debug probe calls a board's chip (the names are those of the chips' data sheets).
fn chip(board: Board) -> &'static str {
    match board {
        Board::NucleoG474re => "STM32G474RETx",
        Board::BG431bEsc1 => "STM32G431CBUx",
        Board::Stm32f405 => "STM32F405RGTx",
    }
}

fn check(toolchain: &Toolchain, board: Board, name: &str) {
    let program = toolchain
        .build_for(board, name, NumberFormat::F32)
        .unwrap_or_else(|error| panic!("{name} for {board}: {error}"));
    let (sizes, memory) = (program.sizes, toolchain.memory().unwrap());
    println!(
        "board={board} program={name} flash={} of={} ram={} of={} fast={} of={} stack={}",
        sizes.flash(),
        memory.flash,
        sizes.ram(),
        memory.ram,
        sizes.fast,
        memory.fast,
        memory.stack
    );
    assert!(sizes.text > 0 && sizes.flash() <= memory.flash);
    assert!(sizes.bss > 0 && sizes.ram() <= memory.ram);
    assert!(sizes.fast <= memory.fast);
    let elf = std::fs::read(&program.path).unwrap();
    assert_eq!(probe::chip(&elf).unwrap(), chip(board));
}

#[test]
fn every_program_builds_for_every_board_and_fits() {
    let toolchain = prepare(Tools::Compiler, |step| eprintln!("{step}"));
    let toolchain = toolchain.unwrap_or_else(|error| panic!("{error}"));
    let programs = toolchain.scenes().unwrap();
    assert_eq!(programs, ["damper_wall", "delayed_spring", "free_mode", "identify"]);
    for board in Board::ALL {
        for program in &programs {
            check(&toolchain, board, program);
        }
    }
}
