//! From count to torque: one whole sample, to the instruction.

use virtual_board::board::Event;

use crate::bench::{Bench, on_both};

/// Counts into the wall, and further steps that each change the code by some.
const INTO: i32 = 300;
const STEP: i32 = 40;
/// Samples after a step until the code stands still: the wall's damping and the coupling let an
/// alternation decay by a factor of 0.96 a sample.
const SETTLING: u64 = 300;

/// A thousandth of a second is a whole number of counts of either chip's timer, with a prescaler that
/// divides it.
#[test]
fn the_pacing_timer_s_period_is_the_scene_s() {
    on_both(|chip| {
        let bench = Bench::running(chip, "damper_wall");
        assert_eq!(bench.board().clock.core(), chip.core);
        assert_eq!(bench.period(), chip.core / 1000);
    });
}

#[test]
fn a_count_reaches_the_dac_within_its_sample_and_the_motor_exactly_at_the_next() {
    on_both(|chip| {
        let mut bench = Bench::running(chip, "damper_wall");
        bench.turn(INTO);
        bench.run(SETTLING);
        let codes = |bench: &Bench| {
            let dac = &bench.board().dac;
            (dac.held(), dac.output().unwrap())
        };
        let (held, output) = codes(&bench);
        assert_eq!(held, output, "at rest");
        bench.turn(STEP);
        bench.run_to_update();
        let update = bench.now() + bench.period();
        // Instruction by instruction, as long as the servo's interrupt takes and some more.
        let mut written = None;
        for _ in 0..1000 {
            bench.run_for(1);
            let (now_held, now_output) = codes(&bench);
            assert_eq!(now_output, output, "put out early");
            if now_held != held {
                written.get_or_insert(bench.now());
            }
        }
        let computed = bench.board().meter.interrupt().most;
        let written = written.expect("a code is written") - (update - bench.period());
        assert!(written <= computed, "{written} of {computed}");
        // To the last instruction before the update, and then one more.
        bench.run_to_update();
        assert_eq!(bench.now(), update);
        assert_eq!(codes(&bench).1, output, "put out early");
        bench.run_for(1);
        let (held, new) = codes(&bench);
        assert!(new != output && new == held);
        assert_eq!(bench.events().last(), Some(&(update, Event::Torque(Some(new)))));
    });
}
