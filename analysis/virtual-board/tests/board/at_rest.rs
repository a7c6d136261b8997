//! The stiffest spring in closed loop: a hand leans against it and lets go, with the encoder's real steps,
//! the torque at its phase, and the amplifier's lag.

use analysis::program::{STIFFEST, undelayed_spring};
use analysis::studies::bench::at_rest::{self, AtRest, FREE, LEANING, TICKS, TORQUE};
use haptic_servo::servo::Transducers;

use crate::bench::{Bench, on_both};
use crate::device::HandHeldDevice;
use crate::scenes::{width, with_the_same_cycle};

/// Stiffness at rest in N m/rad that is promised.
const PROMISED: f64 = 40.7;
/// What the numbers of the scene give: a spring of 2400 N m/rad behind the coupling's 41.468 N m/rad.
const PREDICTED: f64 = 40.76;

/// Counts of a turn of the encoder, and codes of a newton metre.
const COUNTS: f64 = 61_440.0;
const CODES: f64 = 1791.0 / 2.0;

/// With the Coulomb friction that the certificate asks for the device stands still, where the promised
/// stiffness has it; without any it stays within edges of its encoder around the same angle.
#[test]
fn the_stiffest_spring_comes_to_rest_where_its_stiffness_has_it() {
    let friction = at_rest::friction_to_rest(&STIFFEST);
    on_both(|chip| {
        for friction in [0.0, friction] {
            let device = HandHeldDevice::with(at_rest::device(&STIFFEST, friction));
            let mut bench = Bench::boot(chip, STIFFEST.name, device);
            let armed = bench.armed();
            bench.run(TICKS as u64 + 1);
            let samples = bench.pins().samples[armed..].to_vec();
            let transducers = Transducers { counter: width(chip), ..STIFFEST.transducers };
            let codes = with_the_same_cycle::<_, undelayed_spring::Output>(
                undelayed_spring::SCENE,
                &transducers,
                &samples[..TICKS],
            );
            // A code is put out in the sample that its count begins.
            for (tick, &code) in codes.iter().enumerate() {
                assert_eq!(samples[tick + 1].code, Some(code), "tick {tick}");
            }
            let ticks: Vec<_> = samples.iter().map(|sample| sample.count).zip(codes).collect();
            let [leaning, free] = [LEANING, FREE].map(|range| AtRest::of(&STIFFEST, &ticks[range]));
            println!(
                "friction of {friction:.5} N m: {:.2} N m/rad at rest, {} and {} counts of motion",
                leaning.stiffness(),
                leaning.counts,
                free.counts
            );
            let most = if friction > 0.0 { 0 } else { 4 };
            assert!(leaning.counts <= most && free.counts <= most, "{leaning:?} {free:?}");
            assert!(leaning.stiffness() >= PROMISED, "{leaning:?}");
            let count = std::f64::consts::TAU / COUNTS;
            let off = TORQUE / PREDICTED - (leaning.angle + 0.5 * count);
            let moved = 0.5 * f64::from(1 + leaning.counts) * count;
            assert!(off.abs() <= moved + friction / PREDICTED, "{off} {leaning:?}");
            let torque = leaning.torque - PREDICTED * leaning.angle;
            assert!(torque.abs() <= 0.5 / CODES, "{torque} {leaning:?}");
            assert!(free.angle.abs() <= count + friction / PREDICTED, "{free:?}");
        }
    });
}
