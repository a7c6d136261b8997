//! From power-on to the first torque.

use virtual_board::board::Event;
use virtual_board::device::Still;
use virtual_board::peripheral::pins::Level;

use crate::bench::{Bench, MID_SCALE, on_both};

/// Counts from the face into the damper wall at which it pushes harder than its torque limit of
/// 1 N m: two springs in a row, of 44 and 22 N m/rad, and 61,440 counts a turn.
const DEEP: i32 = 900;
/// Codes of that limit, with 2047 codes for 2 N m; the clamp opens to it in a hundred ticks.
const LIMIT: f64 = 1023.5;
const OPENING: f64 = LIMIT / 100.0;

#[test]
fn nothing_is_driven_before_the_amplifier_is_off_and_that_is_on_only_once_it_is_armed() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", Still);
        bench.pins().turns.push_back(DEEP);
        bench.run(300);
        let events: Vec<_> = bench.events().iter().map(|&(_, event)| event).collect();
        // The driver switches the converter on before anybody has written to it: at the lowest code,
        // which the amplifier, off, does not pass on.
        let order =
            [Event::Amplifier(Level::Low), Event::Torque(Some(0)), Event::Torque(Some(MID_SCALE))];
        assert_eq!(events, order, "{}", chip.name);
        assert!(bench.machine.board().watchdog.due().is_some(), "{}", chip.name);
        bench.armed();
        let (on, event) = bench.events()[3];
        assert_eq!(event, Event::Amplifier(Level::High), "{}", chip.name);
        // In a tick, and in none of the program's other moments.
        let most = bench.machine.board().meter.interrupt().most;
        let since =
            bench.period() - (bench.machine.board().pacer.due().unwrap() - on) % bench.period();
        assert!(since <= most, "{}: {since} of {most}", chip.name);
    });
}

#[test]
fn where_the_encoder_stands_at_power_on_is_zero() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", Still);
        // Turned while the driver has set the counter up and the servo does not run yet.
        while !bench.machine.board().encoder.counts_encoder() {
            bench.run_for(100);
        }
        assert_eq!(bench.machine.board().samples, 0, "{}", chip.name);
        bench.machine.board_mut().turn(12_345);
        bench.armed();
        bench.run(200);
        assert_eq!(bench.status().count, 0, "{}", chip.name);
        assert!(bench.pins().samples.iter().all(|sample| sample.code == Some(MID_SCALE)));
    });
}

#[test]
fn the_clamp_opens_step_by_step() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", Still);
        // The device is pushed into the wall in the first sample and held there.
        bench.pins().turns.push_back(DEEP);
        bench.run(2);
        let armed = bench.armed();
        bench.run(130);
        let samples = bench.pins().samples[armed..].to_vec();
        let torque = |sample: usize| f64::from(MID_SCALE - samples[sample].code.unwrap());
        // That tick arms, and each one's code appears at the second update from its own.
        for (step, sample) in (0..=100).zip(2..) {
            let expected = OPENING * f64::from(step);
            assert!(
                (torque(sample) - expected).abs() <= 1.0,
                "{}, sample {sample}: {} codes, not {expected}",
                chip.name,
                torque(sample)
            );
        }
        assert_eq!(torque(125), LIMIT.round(), "{}", chip.name);
    });
}
