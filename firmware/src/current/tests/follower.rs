//! Model, feed-forward and feedback without counts, against the plant in doubles.

use super::super::current_loop::Law;
use super::super::follower::Follower;
use super::*;

/// A winding between instants: `i(k+1) = a i(k) + b v(k-1)`, by the rate of its decay.
struct Winding {
    resistance: f64,
    inductance: f64,
    current: f64,
    voltage: f64,
}

impl Winding {
    fn pass(&mut self, next: f64) {
        let end = self.voltage / self.resistance;
        let part = -(-self.resistance / self.inductance * INSTANT).exp_m1();
        self.current += (end - self.current) * part;
        self.voltage = next;
    }
}

fn run(
    design: &CurrentLoop,
    motor: Motor,
    reference: impl Fn(usize) -> i16,
    instants: usize,
) -> Vec<f64> {
    let Motor { resistance, inductance, .. } = motor;
    let law: &Law = &design.law;
    let (mut follower, mut winding) =
        (Follower::AT_REST, Winding { resistance, inductance, current: 0.0, voltage: 0.0 });
    (0..instants)
        .map(|instant| {
            let current = winding.current;
            let reference = law.amps_per_code * f32::from(reference(instant));
            let wanted = follower.follow(law, reference, current as f32);
            follower.integrate(law, wanted.deviation, false);
            winding.pass(wanted.volts.into());
            current
        })
        .collect()
}

#[test]
fn a_step_is_that_of_the_model_to_rounding() {
    for bandwidth in [20.0, 300.0, 1000.0] {
        let drive = Drive { bandwidth, ..DRIVE };
        let design = CurrentLoop::checked(&drive, &STAGE, &TRANSDUCERS, PERIOD);
        let steps = [(2, FULL_SCALE), (50, -FULL_SCALE), (90, 17)];
        let code =
            |instant| steps.iter().rev().find(|step| step.0 <= instant).map_or(0, |step| step.1);
        for (instant, current) in run(&design, DRIVE.motor, code, 1000).into_iter().enumerate() {
            let off = (current - certified_current(&design, &steps, instant)).abs();
            assert!(off < 2e-5, "{bandwidth} Hz, {instant}: {off}");
        }
    }
}

/// The response to an error of the measurement is `K/(z^2 - z + K)`: never negative, and of the sum 1.
#[test]
fn an_error_of_the_measurement_does_not_come_out_larger() {
    for bandwidth in [20.0, 300.0, 1000.0, 1060.0] {
        let drive = Drive { bandwidth, ..DRIVE };
        let design = CurrentLoop::checked(&drive, &STAGE, &TRANSDUCERS, PERIOD);
        let (mut follower, mut sum) = (Follower::AT_REST, 0.0);
        let Motor { resistance, inductance, .. } = DRIVE.motor;
        let mut winding = self::Winding { resistance, inductance, current: 0.0, voltage: 0.0 };
        for instant in 0..5000 {
            let error = if instant == 0 { 1.0 } else { 0.0 };
            let wanted = follower.follow(&design.law, 0.0, winding.current as f32 + error);
            follower.integrate(&design.law, wanted.deviation, false);
            winding.pass(wanted.volts.into());
            assert!(winding.current < 1e-5, "{bandwidth}: {}", winding.current);
            sum -= winding.current;
        }
        assert!((sum - 1.0).abs() < 1e-3, "{bandwidth}: {sum}");
    }
}
