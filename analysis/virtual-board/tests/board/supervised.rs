//! A program's options, on the board: a host that has to be heard, and damping that is injected.

use analysis::program::{SUPERVISED, supervised_spring};
use haptic_servo::boot::Program;
use haptic_servo::fault::Fault;
use haptic_servo::servo::{Latched, RenderingOptions, Transducers};
use haptic_servo::servo_loop::{Options, State};
use haptic_servo::wire::message::Outcome;
use virtual_board::board::Event;
use virtual_board::device::FixedDevice;
use virtual_board::peripheral::pins::Level;

use crate::bench::{Bench, MID_SCALE, on_both};
use crate::device::{HandHeldDevice, Sample};
use crate::scenes::{on_the_host, width};

/// Samples of silence after which the host counts as lost.
const SILENCE: u64 = 1000;
/// Samples in which the clamp opens or closes, and a few for what begins and ends there.
const FADING: u64 = 110;
/// Samples between two words to a board that is looked after.
const NOW_AND_THEN: u64 = 200;

#[test]
fn a_host_that_falls_silent_lets_the_device_go() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, SUPERVISED.name, FixedDevice);
        bench.armed();
        // Beside the spring's rest, so that it pushes.
        bench.turn(300);
        for _ in 0..15 {
            bench.run(NOW_AND_THEN);
            assert_eq!(bench.status().state, State::Running);
        }
        let heard = bench.pins().samples.len();
        assert_ne!(bench.board().torque(), Some(MID_SCALE));
        bench.run(SILENCE + FADING);
        check_release(&bench, heard);
        assert_eq!(bench.machine.resets(), []);
        // The missing word requests it, and nothing starts by itself.
        let lost = Fault::LinkLost { allowed: SILENCE as u32 };
        assert_eq!(bench.fault(), Some(lost));
        assert_eq!(bench.status().state, State::Faulted);
        assert_eq!(bench.arm(), Outcome::Done);
        bench.run(FADING);
        assert_eq!(bench.status().state, State::Running);
    });
}

/// The amplifier went off after the silence and the fading, and the torque went step by step before.
fn check_release(bench: &Bench, heard: usize) {
    let pins = bench.pins();
    let off = pins.samples.iter().skip(heard).position(|sample| !sample.amplifier);
    let off = off.unwrap_or_else(|| panic!("it stays on")) as u64;
    // The spring's torque is less than the limit, and is met on the way down.
    assert!((SILENCE..SILENCE + FADING).contains(&(off + 5)), "{off} samples");
    let code = |sample: &Sample| i32::from(sample.code.unwrap_or(MID_SCALE));
    let codes: Vec<_> = pins.samples[heard..].iter().map(code).collect();
    let largest = codes.windows(2).map(|pair| (pair[1] - pair[0]).abs()).max();
    assert!(largest <= Some(11), "a step of {largest:?} codes");
    let last = bench.events().iter().rev().find(|(_, e)| matches!(e, Event::Amplifier(_)));
    assert!(last.is_some_and(|&(_, event)| event != Event::Amplifier(Level::High)));
}

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
