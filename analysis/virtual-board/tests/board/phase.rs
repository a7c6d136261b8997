//! Torques at a phase of their own period: when they come, to the instruction, and what a late tick leaves.

use analysis::program::undelayed_wall;
use haptic_servo::fault::Fault;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::{FaultCode, Outcome};
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
    bench.pins().turns.push_back(INTO);
    bench.run(SETTLING);
    assert_ne!(bench.machine.board().torque(), Some(MID_SCALE), "{}: no torque", chip.name);
    bench
}

/// The code that was written last, and the one at the pin.
fn codes(bench: &Bench) -> (u16, u16) {
    let dac = &bench.machine.board().dac;
    (dac.held(), dac.output().unwrap())
}

#[test]
fn a_torque_comes_its_phase_after_the_update_of_its_own_count() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        for _ in 0..20 {
            let (_, output) = codes(&bench);
            bench.pins().turns.push_back(STEP);
            bench.run_to_update();
            let update = bench.machine.board().now;
            // To the instruction before the phase nothing is put out, and the code waits.
            bench.run_for(phase(chip));
            let (held, before) = codes(&bench);
            assert_eq!(before, output, "{}: put out early", chip.name);
            assert_ne!(held, output, "{}: not computed in time", chip.name);
            bench.run_for(STARTED);
            assert_eq!(codes(&bench), (held, held), "{}: put out late", chip.name);
            let (at, event) = *bench.events().last().unwrap();
            assert_eq!(event, Event::Torque(Some(held)));
            let after = at - update;
            let phase = phase(chip);
            assert!((phase..=phase + STARTED).contains(&after), "{}: {after}", chip.name);
            bench.pins().turns.push_back(-STEP);
            bench.run(SETTLING);
        }
    });
}

/// The time left up to the phase, every tick and at worst, in counts of the board's clock.
#[test]
fn the_slack_is_that_up_to_the_phase() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        let timer = bench.machine.board().clock.timer_divider();
        let written = bench.machine.board().meter.compute().most;
        let slack = u64::from(bench.status().worst_slack) * timer;
        let left = phase(chip) - written;
        // Around the measured code there are an interrupt's entry and the reading of the clock.
        assert!(slack < left && slack + 100 > left, "{}: {slack} of {left}", chip.name);
    });
}

/// Stopped by this fault; the torque goes from the one before to none and there was nothing between.
fn check_stopped(bench: &mut Bench, chip: &Chip, before: u16, from: u64) -> Fault {
    bench.run(2);
    let status = bench.status();
    assert_eq!(status.state, State::Faulted, "{}", chip.name);
    let torques: Vec<_> = bench.torques_after(from).collect();
    assert_eq!(torques, [MID_SCALE], "{}: after {before}", chip.name);
    let off = bench.amplifier_off(from).expect("the amplifier is off") - from;
    assert!(off < bench.period() / 20, "{}: off after {off} instructions", chip.name);
    let fault = status.fault.and_then(FaultCode::fault).unwrap();
    bench.run(20);
    assert_eq!(bench.arm(), Outcome::Done, "{}", chip.name);
    fault
}

/// The program ends between a code and its phase: the code is not put out in place of mid-scale, also not
/// for the moment in which the DAC loses its trigger.
#[test]
fn a_code_that_waits_for_its_phase_when_the_program_ends_is_never_at_the_motor() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        let (_, before) = codes(&bench);
        bench.run_to_waiting_code(STEP);
        let (held, output) = codes(&bench);
        assert_eq!(output, before, "{}", chip.name);
        let ended = bench.machine.board().now;
        let (panic, _) = bench.symbol("9panicking5panic");
        let core = bench.machine.core_mut();
        core.set_register(RegisterARM::PRIMASK, 1);
        core.set_register(RegisterARM::PC, panic | 1);
        bench.run_for(bench.period() / 2);
        let torques: Vec<_> = bench.torques_after(ended).collect();
        assert_eq!(torques, [MID_SCALE], "{}: {before}, then {held}", chip.name);
        assert!(bench.amplifier_off(ended).is_some(), "{}", chip.name);
    });
}

/// The core waits between count and code, as for a memory that does not answer.
#[test]
fn a_code_that_is_late_is_a_fault_and_never_at_the_motor() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        // A wait that leaves enough changes nothing.
        for (wait, is_late) in [(phase(chip) / 2, false), (phase(chip), true)] {
            let (_, before) = codes(&bench);
            bench.pins().turns.push_back(STEP);
            bench.run_to_update();
            let update = bench.machine.board().now;
            bench.run_for(READ);
            assert_eq!(codes(&bench).0, before, "{}: written already", chip.name);
            bench.machine.board_mut().now += wait;
            if !is_late {
                bench.run(SETTLING);
                assert_eq!(bench.status().state, State::Running, "{}", chip.name);
                continue;
            }
            let fault = check_stopped(&mut bench, chip, before, update);
            let Fault::LateTick { late, allowed } = fault else { panic!("{fault:?}") };
            let divider = bench.machine.board().clock.timer_divider();
            let phase = phase(chip) / divider;
            assert!((phase - 1..=phase).contains(&u64::from(allowed)), "{}: {fault:?}", chip.name);
            assert!(late > allowed, "{}: {fault:?}", chip.name);
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
        let began = bench.machine.board().now;
        bench.machine.core_mut().set_register(RegisterARM::PRIMASK, 1);
        bench.run_for(ahead + behind);
        bench.machine.core_mut().set_register(RegisterARM::PRIMASK, 0);
        let fault = check_stopped(&mut bench, chip, before, began);
        let Fault::LateTick { late, allowed } = fault else { panic!("{fault:?}") };
        let divider = bench.machine.board().clock.timer_divider();
        let microsecond = chip.core / 1_000_000 / divider;
        assert!(
            u64::from(allowed) <= microsecond && u64::from(late) < 5 * microsecond,
            "{fault:?}"
        );
    });
}
