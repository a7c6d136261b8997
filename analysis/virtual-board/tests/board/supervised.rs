//! A program's options, on the board: damping that is injected.

use analysis::program::{SUPERVISED, supervised_spring};
use haptic_servo::boot::Program;
use haptic_servo::servo::{Latched, RenderingOptions, Transducers};
use haptic_servo::servo_loop::Options;

use crate::bench::{Bench, on_both};
use crate::device::HandHeldDevice;
use crate::scenes::{on_the_host, width};

/// Samples between two words to a board that is looked after.
const NOW_AND_THEN: u64 = 200;

/// The same counts on the host, with and without the damping.
#[test]
fn damping_is_injected_where_there_is_a_deficit() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, SUPERVISED.name, HandHeldDevice::of(&SUPERVISED));
        let on = bench.armed();
        let mut worst = 0;
        for _ in 0..15 {
            bench.run(NOW_AND_THEN);
            worst = bench.status().worst_deficit;
        }
        assert!(worst > 0, "no deficit");
        let samples = &bench.pins().samples[on..];
        let given: Vec<_> = samples[2..].iter().map(|sample| sample.code.unwrap()).collect();
        let options = [supervised_spring::PROGRAM.rendering, RenderingOptions::DEFAULT];
        let [injected, watched] = options.map(|rendering| {
            let transducers =
                Transducers { counter: width(chip), ..supervised_spring::PROGRAM.transducers };
            // Without a link.
            let options = Options::DEFAULT;
            let program = Program { transducers, rendering, options, ..supervised_spring::PROGRAM };
            let mut codes = on_the_host::<_, Latched>(program, samples);
            codes.truncate(given.len());
            codes
        });
        assert!(given == injected, "other codes than the host's");
        let differ = given.iter().zip(&watched).filter(|(given, watched)| given != watched).count();
        assert!(differ > 50, "only {differ} codes of {}", given.len());
    });
}
