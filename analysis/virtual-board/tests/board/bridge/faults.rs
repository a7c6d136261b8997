//! Every fault of the bridge and of what surrounds it, provoked from outside, and how soon no gate is high.

use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::FaultCode;
use unicorn_engine::RegisterARM;
use virtual_board::chip::{CONVERSION_INTERRUPT, TICK_INTERRUPT};
use virtual_board::core::exceptions::{FIRST_INTERRUPT, NON_MASKABLE};
use virtual_board::power_stage::Supply;
use virtual_board::power_stage::gate_log::off_since;

use super::bench::{INSTANT, circuit, gates, run_to_valley};
use super::bridge_wall::CURRENT_LOOP;
use super::gates::pushing;
use super::index::{comes_elsewhere, leaning};
use crate::bench::Bench;
use crate::faults::panics;
use crate::stub::{Masks, hold_up};

/// Registers that the current interrupt uses.
const CAPTURED_COUNT: u32 = 0x4000_0840;
const CURRENT_OF_U: u32 = 0x5000_0080;
const COMPARE_OF_U: u32 = 0x4001_2C34;
const BREAK_CONTROL: u32 = 0x4001_2C44;

/// Periods of the modulation in one of the servo.
const SERVO: f64 = CURRENT_LOOP.updates() as f64;

/// A way to provoke a fault.
struct Case {
    fault: &'static str,
    cause: &'static str,
    /// Periods of the modulation from the cause within which no gate is high any more.
    bound: f64,
    /// A servo that pushes.
    begin: fn() -> Bench,
    provoke: fn(&mut Bench),
    /// Whether the watchdog has to reset the board, which then says what it was.
    resets: bool,
}

const CASES: &[Case] = &[
    Case {
        fault: "over-current",
        cause: "a short between the motor's wires",
        bound: 2.0,
        begin: pushing,
        provoke: |bench| motor(bench).short = Some((0.01, 0.5e-6)),
        resets: false,
    },
    Case {
        fault: "over-voltage",
        cause: "the supply rises to 27 V",
        bound: 3.0,
        begin: pushing,
        provoke: |bench| circuit(bench).supply = Supply::stiff(27.0),
        resets: false,
    },
    Case {
        fault: "under-voltage",
        cause: "the supply falls to 15 V",
        bound: 3.0,
        begin: pushing,
        provoke: |bench| circuit(bench).supply = Supply::stiff(15.0),
        resets: false,
    },
    Case {
        fault: "over-temperature",
        cause: "the power stage is at 95 degrees",
        bound: 3.0,
        begin: pushing,
        provoke: |bench| circuit(bench).temperature = 95.0,
        resets: false,
    },
    Case {
        fault: "current-not-following",
        cause: "a wire of the motor breaks while it has current",
        bound: 2.0 * SERVO,
        begin: pushing,
        provoke: |bench| motor(bench).open[0] = true,
        resets: false,
    },
    Case {
        fault: "saturated-duty",
        cause: "a bad contact in a wire of the motor takes more than the supply has",
        // The feedback of a motor without that contact takes the voltage to its limit first.
        bound: 4.0 * SERVO,
        begin: with_bad_contact,
        provoke: |bench| takes_volts(bench, 20.0),
        resets: false,
    },
    Case {
        fault: "over-current",
        cause: "an amplifier's output goes to its rail",
        bound: 2.0,
        begin: pushing,
        provoke: |bench| circuit(bench).amplifier_errors[0] = 3.3,
        resets: false,
    },
    Case {
        fault: "encoder-jump",
        cause: "the encoder jumps by more than the device's largest speed",
        bound: 2.0 * SERVO,
        begin: pushing,
        provoke: |bench| bench.pins().turns.push_back(20_000),
        resets: false,
    },
    Case {
        fault: "index-mismatch",
        cause: "the index of a brushless motor's encoder comes behind lost counts",
        bound: 2.0,
        begin: || leaning().bench,
        provoke: comes_elsewhere,
        resets: false,
    },
    Case {
        fault: "current-interrupt-late",
        cause: "all interrupts are masked over an update, for five sixths of a period of the modulation",
        bound: 3.0,
        begin: within_a_period,
        // Over no second update: the servo's next period would begin an instant late.
        provoke: |bench| {
            hold_up(bench, INSTANT * 5 / 6, Masks::All);
        },
        resets: false,
    },
    Case {
        fault: "late-tick",
        cause: "all interrupts are masked for two periods of the modulation",
        bound: 4.0,
        begin: pushing,
        provoke: masks_interrupts,
        resets: false,
    },
    Case {
        fault: "watchdog",
        cause: "the servo's interrupt is disabled",
        bound: 9.0 * SERVO,
        begin: pushing,
        provoke: |bench| {
            let exceptions = &mut bench.machine.board_mut().system.exceptions;
            exceptions.enable(FIRST_INTERRUPT + TICK_INTERRUPT, false);
        },
        resets: true,
    },
    Case {
        fault: "watchdog",
        cause: "the current loop's interrupt is disabled",
        bound: 9.0 * SERVO,
        begin: pushing,
        provoke: |bench| {
            let exceptions = &mut bench.machine.board_mut().system.exceptions;
            exceptions.enable(FIRST_INTERRUPT + CONVERSION_INTERRUPT, false);
        },
        resets: true,
    },
    Case {
        fault: "non-maskable",
        cause: "a non-maskable interrupt comes of which the chip says nothing",
        bound: 1.0,
        begin: pushing,
        provoke: |bench| bench.machine.board_mut().system.exceptions.pend(NON_MASKABLE),
        resets: true,
    },
    Case {
        fault: "clock-lost",
        cause: "the crystal stops",
        bound: 1.0,
        begin: pushing,
        provoke: |bench| bench.machine.board_mut().clock.crystal_runs = false,
        resets: true,
    },
    Case {
        fault: "panic",
        cause: "the core is sent into a panic of line 12, column 34",
        bound: 1.0,
        begin: pushing,
        provoke: |bench| {
            panics(bench);
        },
        resets: true,
    },
    Case {
        fault: "hard-fault",
        cause: "the core goes to where no memory is",
        bound: 1.0,
        begin: pushing,
        provoke: |bench| bench.machine.core_mut().set_register(RegisterARM::PC, 0x6000_0001),
        resets: true,
    },
    Case {
        fault: "hard-fault",
        cause: "the bus has an error at the captured count",
        bound: 2.0,
        begin: pushing,
        provoke: |bench| bench.machine.board_mut().broken = Some(CAPTURED_COUNT),
        resets: true,
    },
    Case {
        fault: "hard-fault",
        cause: "the bus has an error at a converter",
        bound: 2.0,
        begin: pushing,
        provoke: |bench| bench.machine.board_mut().broken = Some(CURRENT_OF_U),
        resets: true,
    },
    Case {
        fault: "hard-fault",
        cause: "the bus has an error at a compare value",
        bound: 2.0,
        begin: pushing,
        provoke: |bench| bench.machine.board_mut().broken = Some(COMPARE_OF_U),
        resets: true,
    },
    Case {
        fault: "watchdog",
        cause: "the core is locked up: the handler of a fault has a fault",
        bound: 2.0,
        begin: pushing,
        provoke: locks_up,
        resets: true,
    },
];

/// A servo that pushes with a wire that takes most of the voltage already.
fn with_bad_contact() -> Bench {
    let mut bench = pushing();
    takes_volts(&mut bench, 11.0);
    bench.run(20);
    assert!(bench.machine.board().power_stage.timer.is_on());
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

fn masks_interrupts(bench: &mut Bench) {
    hold_up(bench, 2 * INSTANT, Masks::All);
}

/// A fault whose handler has a fault: it is to write the register by which the gates are taken away.
fn locks_up(bench: &mut Bench) {
    bench.machine.board_mut().broken = Some(BREAK_CONTROL);
    bench.machine.core_mut().set_register(RegisterARM::PC, 0x6000_0001);
}

fn motor(bench: &mut Bench) -> &mut virtual_board::motor::Motor {
    circuit(bench).motor.as_mut().unwrap()
}

impl Case {
    /// Provokes it on a servo that pushes; gives the periods of the modulation until the gates were off.
    fn run(&self) -> f64 {
        let what = format!("{}: {}", self.fault, self.cause);
        let mut bench = (self.begin)();
        run_to_valley(&mut bench);
        let began = bench.machine.board().now;
        (self.provoke)(&mut bench);
        while bench.machine.board().now < began + 420 * INSTANT {
            bench.run_for(1000);
            if !bench.machine.resets().is_empty() {
                // What was broken is repaired before it is used again.
                let board = bench.machine.board_mut();
                (board.broken, board.clock.crystal_runs) = (None, true);
            }
        }
        let off = off_since(gates(&bench)).unwrap_or_else(|| panic!("{what}: a gate is high"));
        let periods = off.saturating_sub(began) as f64 / INSTANT as f64;
        println!("{what}: {periods:.3} periods");
        assert!(periods <= self.bound, "{what}: {periods} periods");
        assert_eq!(circuit(&mut bench).currents(), [0.0; 3], "{what}");
        self.check_told(&mut bench, &what);
        periods
    }

    fn check_told(&self, bench: &mut Bench, what: &str) {
        bench.run(50);
        assert_eq!(!bench.machine.resets().is_empty(), self.resets, "{what}");
        let status = bench.status();
        let told = status.fault.and_then(FaultCode::fault).unwrap_or_else(|| panic!("{what}"));
        assert_eq!(told.as_str(), self.fault, "{what}: {told}");
        let state = if self.resets { State::Disarmed } else { State::Faulted };
        assert_eq!(status.state, state, "{what}");
    }
}

/// The table of what was measured, in periods of the modulation, rounded up to tenths.
fn table(measured: &[f64]) -> String {
    let mut table =
        String::from("| fault | provoked by | promised | measured |\n|---|---|---|---|\n");
    for (Case { fault, cause, bound, .. }, periods) in CASES.iter().zip(measured) {
        table +=
            &format!("| {fault} | {cause} | {bound} | {:.1} |\n", (periods * 10.0).ceil() / 10.0);
    }
    table
}

#[test]
fn every_fault_takes_the_gates_away_in_time_and_is_told() {
    let measured: Vec<_> = CASES.iter().map(Case::run).collect();
    let (table, kept) = (table(&measured), include_str!("../../../bridge-faults.md"));
    assert!(kept.ends_with(&table), "bridge-faults.md has another table than\n{table}");
}
