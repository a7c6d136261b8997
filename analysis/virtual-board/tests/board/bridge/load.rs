//! The tests on a board with a load at its bridge, as they are flashed: with the load that they are written for they
//! pass, and with another one each of them says so.

use std::path::PathBuf;
use std::sync::OnceLock;

use analysis::toolchain::{BoardModel, Tools, TorqueOutput, prepare};
use virtual_board::chip::B_G431B_ESC1;
use virtual_board::motor::{Motor, Winding};
use virtual_board::power_stage::gate_log::any_high;
use virtual_board::power_stage::{Circuit, Supply};
use virtual_board::semihosting::{CallError, Guest};

/// The tests, as they are named in the file.
const NO_DUTY: &str = "outputs_at_half_give_no_current";
const PART: &str = "a_part_of_the_supply_gives_the_current_of_the_load";
const BREAK: &str = "a_break_takes_the_gates_away";
const ALL: [&str; 3] = [NO_DUTY, PART, BREAK];

/// Core clocks that a test may take: a quarter of a second.
const LONGEST: u64 = 170_000_000 / 4;

fn file() -> &'static PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| {
        let toolchain = prepare(Tools::Compiler, |step| eprintln!("{step}"));
        let toolchain = toolchain.unwrap_or_else(|error| panic!("{error}"));
        let built = toolchain.build_tests(BoardModel::BG431bEsc1, TorqueOutput::Bridge);
        built.unwrap_or_else(|error| panic!("{error}"))
    })
}

/// Resistor and coil, with a current that makes no torque.
fn load(resistance: f64) -> Motor {
    Motor::new(Winding::Brushed, resistance, 0.1e-3, 0.0)
}

/// What the circuit is that the tests are written for.
fn as_stated(circuit: &mut Circuit) {
    circuit.motor = Some(load(1.05));
    circuit.supply = Supply::stiff(12.0);
}

/// Runs a test in a circuit; whether it passes. The gates are low at its end, and switched in between only where they
/// may be.
fn passes(test: &str, change: fn(&mut Circuit)) -> bool {
    let name = format!("{}___{test}_entrypoint", test.len() + "___entrypoint".len());
    let probe = Guest::boot_command(file(), &B_G431B_ESC1, "").unwrap();
    let (address, _) = probe.machine().image().symbol_ending(&name).expect("the test has a name");
    let command: &'static str = format!("run_addr {}", address | 1).leak();
    let mut guest = Guest::boot_command(file(), &B_G431B_ESC1, command).unwrap();
    let board = guest.machine_mut().board_mut();
    board.gates = Some(Vec::new());
    as_stated(&mut board.power_stage.circuit);
    change(&mut board.power_stage.circuit);
    let end = loop {
        if let Err(error) = guest.run_to_call() {
            break error;
        }
    };
    let board = guest.machine().board();
    println!("{test}: {end}, {} clocks", board.now);
    assert!(!board.power_stage.timer.is_on(), "{test}: the gates are on at the end");
    assert!(board.now < LONGEST, "{test}: {} clocks", board.now);
    let gates = board.gates.as_deref().unwrap();
    let has_switched = any_high(gates, 0, u64::MAX);
    let passes = end == CallError::Ended(0);
    assert!(has_switched || !passes, "{test} has passed without switching a gate");
    passes
}

#[test]
fn they_pass_with_the_load_that_they_are_for() {
    for test in ALL {
        assert!(passes(test, |_| {}), "{test}");
    }
}

/// A test, and its deliberate fault.
type Cause = (&'static str, fn(&mut Circuit));

#[test]
fn each_finds_what_is_wrong_with_load_and_supply() {
    let causes: [Cause; 7] = [
        (PART, |circuit| circuit.motor = None),
        (PART, |circuit| circuit.motor = Some(load(2.5))),
        (PART, |circuit| circuit.motor = Some(load(0.4))),
        // Its wires are between the outputs 1 and 3.
        (PART, |circuit| circuit.motor.as_mut().unwrap().wires = [0, 2, 1]),
        // A short: the comparators take the gates away.
        (PART, |circuit| circuit.motor.as_mut().unwrap().short = Some((0.01, 1e-6))),
        (NO_DUTY, |circuit| circuit.supply = Supply::stiff(0.2)),
        (BREAK, |circuit| circuit.amplifier_errors[0] = 0.5),
    ];
    for (place, (test, cause)) in causes.into_iter().enumerate() {
        assert!(!passes(test, cause), "cause {place} of {test}");
    }
}
