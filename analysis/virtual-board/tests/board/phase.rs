//! Torques at a phase of their own period: when they come, to the instruction, and what a late tick leaves.

use analysis::program::undelayed_wall;
use haptic_servo::fault::Fault;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::Outcome;
use unicorn_engine::RegisterARM;
use virtual_board::board::Event;
use virtual_board::chip::Chip;

use crate::bench::{Bench, MID_SCALE, on_both};

/// The program whose torques have one.
const NAME: &str = "undelayed_wall";
/// Counts into the wall, and a step that changes the code.
const INTO: i32 = 300;
const STEP: i32 = 40;
/// Samples after a step until the code stands still.
const SETTLING: u64 = 300;
/// Instructions from an update to after the count is read, and before a code is written.
const READ: u64 = 45;
/// Instructions by which the phase's timer is started behind the pacing timer.
const STARTED: u64 = 12;

/// Instructions of a chip up to the phase.
fn phase(chip: &Chip) -> u64 {
    (chip.core as f64 * undelayed_wall::Output::DELAY).round() as u64
}

/// A servo that runs and pushes, at rest in the wall.
fn pushing(chip: &'static Chip) -> Bench {
    let mut bench = Bench::running(chip, NAME);
    bench.turn(INTO);
    bench.run(SETTLING);
    assert_ne!(bench.board().torque(), Some(MID_SCALE), "no torque");
    bench
}

/// The code that was written last, and the one at the pin.
fn codes(bench: &Bench) -> (u16, u16) {
    let dac = &bench.board().dac;
    (dac.held(), dac.output().unwrap())
}

#[test]
fn a_torque_comes_its_phase_after_the_update_of_its_own_count() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        for _ in 0..20 {
            let (_, output) = codes(&bench);
            bench.turn(STEP);
            bench.run_to_update();
            let update = bench.now();
            // To the instruction before the phase nothing is put out, and the code waits.
            bench.run_for(phase(chip));
            let (held, before) = codes(&bench);
            assert_eq!(before, output, "put out early");
            assert_ne!(held, output, "not computed in time");
            bench.run_for(STARTED);
            assert_eq!(codes(&bench), (held, held), "put out late");
            let (at, event) = *bench.events().last().unwrap();
            assert_eq!(event, Event::Torque(Some(held)));
            let after = at - update;
            let phase = phase(chip);
            assert!((phase..=phase + STARTED).contains(&after), "{after}");
            bench.turn(-STEP);
            bench.run(SETTLING);
        }
    });
}

/// The time left up to the phase, every tick and at worst, in counts of the board's clock.
#[test]
fn the_slack_is_that_up_to_the_phase() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        let timer = bench.board().clock.timer_divider();
        let written = bench.board().meter.compute().most;
        let slack = u64::from(bench.status().worst_slack) * timer;
        let left = phase(chip) - written;
        // Around the measured code there are an interrupt's entry and the reading of the clock.
        assert!(slack < left && slack + 100 > left, "{slack} of {left}");
    });
}

/// Stopped by this fault; the torque goes from the one before to none and there was nothing between.
fn check_stopped(bench: &mut Bench, before: u16, from: u64) -> Fault {
    bench.run(2);
    assert_eq!(bench.status().state, State::Faulted);
    let torques: Vec<_> = bench.torques_after(from).collect();
    assert_eq!(torques, [MID_SCALE], "after {before}");
    let off = bench.amplifier_off(from).expect("the amplifier is off") - from;
    assert!(off < bench.period() / 20, "off after {off} instructions");
    let fault = bench.fault().unwrap();
    bench.run(20);
    assert_eq!(bench.arm(), Outcome::Done);
    fault
}

/// The core waits between count and code, as for a memory that does not answer.
#[test]
fn a_code_that_is_late_is_a_fault_and_never_at_the_motor() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        // A wait that leaves enough changes nothing.
        for (wait, is_late) in [(phase(chip) / 2, false), (phase(chip), true)] {
            let (_, before) = codes(&bench);
            bench.turn(STEP);
            bench.run_to_update();
            let update = bench.now();
            bench.run_for(READ);
            assert_eq!(codes(&bench).0, before, "written already");
            bench.board_mut().now += wait;
            if !is_late {
                bench.run(SETTLING);
                assert_eq!(bench.status().state, State::Running);
                continue;
            }
            let fault = check_stopped(&mut bench, before, update);
            let Fault::LateTick { late, allowed } = fault else { panic!("{fault:?}") };
            let divider = bench.board().clock.timer_divider();
            let phase = phase(chip) / divider;
            assert!((phase - 1..=phase).contains(&u64::from(allowed)), "{fault:?}");
            assert!(late > allowed, "{fault:?}");
        }
    });
}

/// Interrupts are masked through an update, for three microseconds behind it: the code would be in time,
/// but its count is not that of the period's beginning.
#[test]
fn a_count_that_is_read_late_is_a_fault_though_its_code_is_in_time() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        let (_, before) = codes(&bench);
        let (ahead, behind) = (500, 3 * chip.core / 1_000_000);
        bench.run_to_update();
        bench.run_for(bench.period() - ahead);
        let began = bench.now();
        bench.machine.core_mut().set_register(RegisterARM::PRIMASK, 1);
        bench.run_for(ahead + behind);
        bench.machine.core_mut().set_register(RegisterARM::PRIMASK, 0);
        let fault = check_stopped(&mut bench, before, began);
        let Fault::LateTick { late, allowed } = fault else { panic!("{fault:?}") };
        let divider = bench.board().clock.timer_divider();
        let microsecond = chip.core / 1_000_000 / divider;
        assert!(
            u64::from(allowed) <= microsecond && u64::from(late) < 5 * microsecond,
            "{fault:?}"
        );
    });
}
