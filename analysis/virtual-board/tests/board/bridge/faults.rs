//! Every fault of the bridge and of what surrounds it, provoked from outside, and how soon no gate is high.

use unicorn_engine::RegisterARM;
use virtual_board::chip::{B_G431B_ESC1, CONVERSION_INTERRUPT, TICK_INTERRUPT};
use virtual_board::core::exceptions::NON_MASKABLE;
use virtual_board::power_stage::Supply;
use virtual_board::power_stage::gate_log::off_since;

use super::bench::{INSTANT, circuit, gates, run_to_valley};
use super::bridge_wall::CURRENT_LOOP;
use super::gates::pushing;
use super::index::{comes_elsewhere, leaning};
use crate::bench::Bench;
use crate::faults::{disable, panics};
use crate::provoked::{Case, check_kept, run_on};
use crate::stub::{Masks, hold_up};

/// Registers that the current interrupt uses.
const CAPTURED_COUNT: u32 = 0x4000_0840;
const CURRENT_OF_U: u32 = 0x5000_0080;
const COMPARE_OF_U: u32 = 0x4001_2C34;
const BREAK_CONTROL: u32 = 0x4001_2C44;

/// Periods of the modulation in one of the servo.
const SERVO: f64 = CURRENT_LOOP.updates() as f64;

const fn case(
    fault: &'static str,
    cause: &'static str,
    bound: f64,
    provoke: fn(&mut Bench),
) -> Case<()> {
    Case::new(|_| pushing(), fault, cause, bound, provoke)
}

/// Bounds are in periods of the modulation.
const CASES: &[Case<()>] = &[
    case("over-current", "a short between the motor's wires", 2.0, |bench| {
        motor(bench).short = Some((0.01, 0.5e-6));
    }),
    case("over-voltage", "the supply rises to 27 V", 3.0, |bench| {
        circuit(bench).supply = Supply::stiff(27.0);
    }),
    case("under-voltage", "the supply falls to 15 V", 3.0, |bench| {
        circuit(bench).supply = Supply::stiff(15.0);
    }),
    case("over-temperature", "the power stage is at 95 degrees", 3.0, |bench| {
        circuit(bench).temperature = 95.0;
    }),
    case(
        "current-not-following",
        "a wire of the motor breaks while it has current",
        2.0 * SERVO,
        |bench| motor(bench).open[0] = true,
    ),
    // The feedback of a motor without that contact takes the voltage to its limit first.
    case(
        "saturated-duty",
        "a bad contact in a wire of the motor takes more than the supply has",
        4.0 * SERVO,
        |bench| takes_volts(bench, 20.0),
    )
    .on(|_| with_bad_contact()),
    case("over-current", "an amplifier's output goes to its rail", 2.0, |bench| {
        circuit(bench).amplifier_errors[0] = 3.3;
    }),
    case(
        "encoder-jump",
        "the encoder jumps by more than the device's largest speed",
        2.0 * SERVO,
        |bench| bench.turn(20_000),
    ),
    case(
        "index-mismatch",
        "the index of a brushless motor's encoder comes behind lost counts",
        2.0,
        comes_elsewhere,
    )
    .on(|_| leaning().bench),
    // Over no second update: the servo's next period would begin an instant late.
    case(
        "current-interrupt-late",
        "all interrupts are masked over an update, for five sixths of a period of the modulation",
        3.0,
        |bench| _ = hold_up(bench, INSTANT * 5 / 6, Masks::All),
    )
    .on(|_| within_a_period()),
    case(
        "late-tick",
        "all interrupts are masked for two periods of the modulation",
        4.0,
        |bench| {
            hold_up(bench, 2 * INSTANT, Masks::All);
        },
    ),
    case("watchdog", "the servo's interrupt is disabled", 9.0 * SERVO, |bench| {
        disable(bench, TICK_INTERRUPT);
    })
    .resetting(),
    case("watchdog", "the current loop's interrupt is disabled", 9.0 * SERVO, |bench| {
        disable(bench, CONVERSION_INTERRUPT);
    })
    .resetting(),
    case(
        "non-maskable",
        "a non-maskable interrupt comes of which the chip says nothing",
        1.0,
        |bench| bench.board_mut().system.exceptions.pend(NON_MASKABLE),
    )
    .resetting(),
    case("clock-lost", "the crystal stops", 1.0, |bench| {
        bench.board_mut().clock.crystal_runs = false;
    })
    .resetting(),
    case("panic", "the core is sent into a panic of line 12, column 34", 1.0, |bench| {
        panics(bench);
    })
    .resetting(),
    case("hard-fault", "the core goes to where no memory is", 1.0, goes_astray).resetting(),
    case("hard-fault", "the bus has an error at the captured count", 2.0, |bench| {
        bench.board_mut().broken = Some(CAPTURED_COUNT);
    })
    .resetting(),
    case("hard-fault", "the bus has an error at a converter", 2.0, |bench| {
        bench.board_mut().broken = Some(CURRENT_OF_U);
    })
    .resetting(),
    case("hard-fault", "the bus has an error at a compare value", 2.0, |bench| {
        bench.board_mut().broken = Some(COMPARE_OF_U);
    })
    .resetting(),
    // It is to write the register by which the gates are taken away.
    case("watchdog", "the core is locked up: the handler of a fault has a fault", 2.0, |bench| {
        bench.board_mut().broken = Some(BREAK_CONTROL);
        goes_astray(bench);
    })
    .resetting(),
];

/// A servo that pushes with a wire that takes most of the voltage already.
fn with_bad_contact() -> Bench {
    let mut bench = pushing();
    takes_volts(&mut bench, 11.0);
    bench.run(20);
    assert!(bench.is_on());
    bench
}

/// The motor's current takes so many volts from here on: of 24 V the modulation leaves 17 V.
fn takes_volts(bench: &mut Bench, volts: f64) {
    let current = circuit(bench).mean_torque() / CURRENT_LOOP.torque_per_amp();
    motor(bench).resistance = volts / current.abs();
}

/// Some instants behind the begin of a period of the servo.
fn within_a_period() -> Bench {
    let mut bench = pushing();
    bench.run_for(10 * INSTANT);
    bench
}

fn goes_astray(bench: &mut Bench) {
    bench.machine.core_mut().set_register(RegisterARM::PC, 0x6000_0001);
}

fn motor(bench: &mut Bench) -> &mut virtual_board::motor::Motor {
    circuit(bench).motor.as_mut().unwrap()
}

/// Provokes a fault on a servo that pushes; gives the periods of the modulation until the gates were off.
fn run(case: &Case<()>) -> f64 {
    let what = case.what();
    let mut bench = (case.begin)(&B_G431B_ESC1);
    run_to_valley(&mut bench);
    let began = bench.now();
    (case.provoke)(&mut bench);
    run_on(&mut bench, began + 420 * INSTANT);
    let off = off_since(gates(&bench)).unwrap_or_else(|| panic!("{what}: a gate is high"));
    let periods = case.check_bound(off.saturating_sub(began), INSTANT);
    assert_eq!(circuit(&mut bench).currents(), [0.0; 3], "{what}");
    case.check_told(&mut bench);
    periods
}

#[test]
fn every_fault_takes_the_gates_away_in_time_and_is_told() {
    let measured = CASES.iter().map(run).collect();
    check_kept(include_str!("../../../bridge-faults.md"), CASES, &[("measured", measured)], 1);
}
