//! Torques at a phase of their own period: when they come, to the instruction.

use analysis::program::undelayed_wall;
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
