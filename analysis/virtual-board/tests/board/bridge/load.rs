//! The tests on a board with a load at its bridge, as they are flashed: with the load that they are written for they
//! pass, and with another one each of them says so.

use std::path::PathBuf;
use std::sync::OnceLock;

use analysis::toolchain::{BoardModel, Tools, TorqueOutput, prepare};
use unicorn_engine::RegisterARM;
use virtual_board::chip::B_G431B_ESC1;
use virtual_board::device::FixedDevice;
use virtual_board::error::BoardError;
use virtual_board::machine::Machine;
use virtual_board::motor::{Motor, Winding};
use virtual_board::peripheral::pins::Level;
use virtual_board::power_stage::gate_log::any_high;
use virtual_board::power_stage::{Circuit, Gates, Supply};

use super::bench::INSTANT;

/// The tests, as they are named in the file.
const GATES: &str = "step_4_each_gate_in_turn_without_a_bus";
const COMPARATORS: &str = "step_5_the_comparators_trip_without_a_current";
const NO_DUTY: &str = "step_7_outputs_at_half_give_no_current";
const PART: &str = "step_8_a_part_of_the_supply_gives_the_current_of_the_load";
const BREAK: &str = "step_8_a_break_takes_the_gates_away";
const SWEEP: &str = "step_9_a_sweep_of_the_duty_gives_equal_steps";
const NO_DUTY_OF_THREE: &str = "brushless_7_outputs_at_half_give_no_current";
const SWEEP_V_W: &str = "brushless_9_a_sweep_from_v_into_w_gives_equal_steps";
const SWEEP_W_U: &str = "brushless_9_a_sweep_from_w_into_u_gives_equal_steps";
const TRIP_U: &str = "step_10_a_current_from_v_into_u_trips";
const TRIP_V: &str = "step_10_a_current_from_u_into_v_trips";
const TRIP_W: &str = "step_10_a_current_from_v_into_w_trips";
const WITHOUT_BUS: [&str; 2] = [GATES, COMPARATORS];
const WITH_LOAD: [&str; 10] =
    [NO_DUTY, PART, BREAK, SWEEP, NO_DUTY_OF_THREE, SWEEP_V_W, SWEEP_W_U, TRIP_U, TRIP_V, TRIP_W];
/// The wires of a load between the outputs 2 and 3, and between 3 and 1.
const V_W: [usize; 3] = [2, 0, 1];
const W_U: [usize; 3] = [1, 2, 0];

/// Core clocks that a test may take: a quarter of a second.
const LONGEST: u64 = 170_000_000 / 4;

fn file() -> &'static PathBuf {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    FILE.get_or_init(|| {
        let toolchain = prepare(Tools::Compiler);
        let toolchain = toolchain.unwrap_or_else(|error| panic!("{error}"));
        let built = toolchain.build_tests(BoardModel::BG431bEsc1, TorqueOutput::Bridge);
        built.unwrap_or_else(|error| panic!("{error}"))
    })
}

/// Resistor and coil, with a current that makes no torque.
fn load(resistance: f64) -> Motor {
    Motor::new(Winding::Brushed, resistance, 0.1e-3, 0.0)
}

/// What the circuit is that a test is written for.
fn as_stated(test: &str, circuit: &mut Circuit) {
    let (wires, resistance, volts) = match test {
        GATES | COMPARATORS => return circuit.supply = Supply::stiff(0.0),
        TRIP_U | TRIP_V => ([0, 1, 2], 0.55, 15.0),
        TRIP_W => (V_W, 0.55, 15.0),
        SWEEP_V_W => (V_W, 1.05, 12.0),
        SWEEP_W_U => (W_U, 1.05, 12.0),
        _ => ([0, 1, 2], 1.05, 12.0),
    };
    let mut load = load(resistance);
    load.wires = wires;
    circuit.motor = Some(load);
    circuit.supply = Supply::stiff(volts);
}

/// Runs the test that begins at an address; whether it has ended with success.
fn passes(machine: &mut Machine, entry: u32) -> bool {
    // The program asks its debugger for the test's name, and gets there without it.
    assert!(call(machine).is_some(), "it does not ask for its test");
    machine.core_mut().set_register(RegisterARM::PC, entry | 1);
    call(machine) == Some(SUCCESS)
}

/// The next call of the debugger: the operation, and two words of its block; none where the board cannot continue.
fn call(machine: &mut Machine) -> Option<[u32; 3]> {
    let end = machine.run_for(LONGEST);
    let Err(BoardError::Breakpoint { .. }) = end else {
        println!("{end:?}");
        return None;
    };
    let core = machine.core();
    let block = core.register(RegisterARM::R1);
    let word = |place| core.word(place).unwrap_or(0);
    Some([core.register(RegisterARM::R0), word(block), word(block + 4)])
}

/// SYS_EXIT_EXTENDED for the reason ADP_Stopped_ApplicationExit, with the status 0 ("Semihosting for AArch32 and
/// AArch64", ARM, 2025Q1).
const SUCCESS: [u32; 3] = [0x20, 0x20026, 0];

/// What a test did.
struct Run {
    passes: bool,
    /// The changes of the gates.
    gates: Vec<(u64, Gates)>,
}

impl Run {
    /// Of a test in a circuit. The gates are off at its end.
    fn of(test: &str, change: fn(&mut Circuit)) -> Self {
        let name = format!("{}___{test}_entrypoint", test.len() + "___entrypoint".len());
        let mut machine = Machine::boot(file(), &B_G431B_ESC1, Box::new(FixedDevice)).unwrap();
        machine.debugged = true;
        let (entry, _) = machine.image().symbol_ending(&name).expect("the test has a name");
        let board = machine.board_mut();
        board.gates = Some(Vec::new());
        as_stated(test, &mut board.power_stage.circuit);
        change(&mut board.power_stage.circuit);
        let passes = passes(&mut machine, entry);
        let board = machine.board_mut();
        println!("{test}: {passes}, {} clocks", board.now);
        assert!(!board.power_stage.timer.is_on(), "{test}: the gates are on at the end");
        assert!(!board.power_stage.gates().contains(&Level::High), "{test}: a gate is high");
        assert!(board.now < LONGEST, "{test}: {} clocks", board.now);
        let gates = board.gates.take().unwrap();
        Self { passes, gates }
    }

    fn has_switched(&self) -> bool {
        any_high(&self.gates, 0, u64::MAX)
    }
}

#[test]
fn they_pass_with_the_load_that_they_are_for() {
    for test in WITH_LOAD {
        let run = Run::of(test, |_| {});
        assert!(run.passes && run.has_switched(), "{test}");
    }
    let run = Run::of(COMPARATORS, |_| {});
    assert!(run.passes && !run.has_switched());
}

/// For an instant, twenty times, and never two of them.
#[test]
fn each_gate_is_high_alone_and_in_turn() {
    const PULSES: usize = 20;
    let run = Run::of(GATES, |_| {});
    assert!(run.passes);
    let high = |gates: &Gates| {
        let high: Vec<_> = (0..6).filter(|&gate| gates[gate] == Level::High).collect();
        assert!(high.len() < 2, "{gates:?}");
        high.first().copied()
    };
    let mut pulses = Vec::new();
    for pair in run.gates.windows(2) {
        if let Some(gate) = high(&pair[0].1) {
            let clocks = pair[1].0 - pair[0].0;
            assert!(clocks <= 2 * INSTANT, "gate {gate}: {clocks} clocks");
            pulses.push(gate);
        }
    }
    let expected: Vec<_> = (0..6).flat_map(|gate| [gate; PULSES]).collect();
    assert_eq!(pulses, expected);
}

/// A test, and its deliberate fault.
type Cause = (&'static str, fn(&mut Circuit));

fn short(circuit: &mut Circuit) {
    circuit.motor.as_mut().unwrap().short = Some((0.01, 1e-6));
}

#[test]
fn each_finds_what_is_wrong_with_load_and_supply() {
    let causes: [Cause; 14] = [
        (PART, |circuit| circuit.motor = None),
        (SWEEP, |circuit| circuit.motor = Some(load(2.5))),
        (PART, |circuit| circuit.motor = Some(load(0.4))),
        // Its wires are between the outputs 1 and 3.
        (PART, |circuit| circuit.motor.as_mut().unwrap().wires = [0, 2, 1]),
        // The comparators take the gates away.
        (PART, short),
        (BREAK, |circuit| circuit.amplifier_errors[0] = 0.5),
        // Beyond a tenth, which the bounds of a single duty allow beside their dead time.
        (SWEEP, |circuit| circuit.motor = Some(load(1.3))),
        (SWEEP, short),
        // Of a brushless motor: the load has the resistance of a phase, or a wire is at another output.
        (SWEEP_V_W, |circuit| circuit.motor.as_mut().unwrap().resistance /= 2.0),
        (SWEEP_V_W, |circuit| circuit.motor.as_mut().unwrap().wires = W_U),
        (SWEEP_W_U, |circuit| circuit.motor.as_mut().unwrap().wires = [0, 1, 2]),
        (TRIP_U, |circuit| circuit.motor = Some(load(2.0))),
        (TRIP_V, short),
        (TRIP_W, |circuit| circuit.motor.as_mut().unwrap().wires = [0, 1, 2]),
    ];
    for (place, (test, cause)) in causes.into_iter().enumerate() {
        assert!(!Run::of(test, cause).passes, "cause {place} of {test}");
    }
}

/// No gate is switched for them.
#[test]
fn another_supply_and_a_broken_comparator_are_refused() {
    for test in WITHOUT_BUS {
        let run = Run::of(test, |circuit| circuit.supply = Supply::stiff(2.2));
        assert!(!run.passes && !run.has_switched(), "{test}");
    }
    let none = Run::of(NO_DUTY, |circuit| circuit.supply = Supply::stiff(0.2));
    assert!(!none.passes && !none.has_switched());
    for test in WITH_LOAD {
        let run = Run::of(test, |circuit| circuit.supply = Supply::stiff(17.0));
        assert!(!run.passes && !run.has_switched(), "{test}");
    }
    for test in [COMPARATORS, NO_DUTY] {
        let run = Run::of(test, |circuit| circuit.parts.senses[2].comparator_offset = 0.03);
        assert!(!run.passes && !run.has_switched(), "{test}");
    }
}
