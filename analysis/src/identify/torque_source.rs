//! The current loop of a board's own bridge as a source of torque (theory, section 3.3): its feedback leaves
//! a part of the current that motion induces, and its torque is as fine as its current.

use std::f64::consts::{FRAC_2_PI, PI};

use haptic_servo::current::TorqueSource;
use nalgebra::Complex;

/// Torque against the motion over its velocity, in N m s/rad, at an angular frequency in rad/s that is not 0.
///
/// Winding and back-EMF are continuous; the feedback samples the current, and its voltage is held for an
/// instant, one instant later (theory, section 15.2). Frequencies that sampling folds back from above its own
/// rate are left out.
pub fn impedance(source: &TorqueSource, omega: f64) -> Complex<f64> {
    let &TorqueSource { gain, resistance, inductance, feedback, instant, .. } = source;
    let decay = (-resistance * instant / inductance).exp();
    let step = Complex::from_polar(1.0, omega * instant);
    let winding = Complex::new(resistance, omega * inductance);
    // Voltage of the feedback at an instant, over the current that was sampled at it; and as it acts.
    let controller = feedback * resistance / (1.0 - decay) * (step - decay) / (step - 1.0);
    let acts = (step - 1.0) / (Complex::new(0.0, omega * instant) * step * step);
    // The current that a back-EMF of 1 V moves against itself, as it is sampled.
    let sampled = step * (step - 1.0) / (winding * (step * (step - 1.0) + feedback));
    gain * (1.0 - controller * acts * sampled) / winding
}

/// Part of a period in which, at each of the two zeros of a sine of torque, the dead time is given back with
/// the wrong sign: the induced current moves the zero of the current away from that of its model.
const WRONG_SIGN: f64 = 1.0 / 30.0;

/// Counts that both phases of a brushed motor are rounded alike by, in steps of half their difference.
const STEPS: f64 = 2.0;

/// Amplitude in N m that the zero crossings of a sine of torque add at a multiple of its angular frequency in
/// rad/s, 1 for the sine itself.
///
/// At each crossing the voltage of the dead time is wrong for a while, which the feedback takes out as its
/// derivative (theory, section 15.3): the voltage falls with the multiple, and its derivative rises as much.
pub fn crossing(source: &TorqueSource, omega: f64, multiple: usize) -> f64 {
    let &TorqueSource { resistance, inductance, feedback, instant, zero_crossing, .. } = source;
    let decay = (-resistance * instant / inductance).exp();
    let voltage = 2.0 * FRAC_2_PI * (multiple as f64 * PI * WRONG_SIGN).sin();
    voltage * zero_crossing * omega * instant / (feedback * (1.0 - decay))
}

/// Standard deviation in N m of a sine of torque of this amplitude, at an angular frequency in rad/s.
///
/// Besides its zero crossings, a current of whole counts is a staircase, of which each step has an error of
/// its own.
pub fn deviation(source: &TorqueSource, omega: f64, amplitude: f64) -> f64 {
    let step = STEPS * source.step;
    let steps = 4.0 * amplitude / step;
    crossing(source, omega, 1).hypot(step / (6.0 * steps.max(1.0)).sqrt())
}

/// The numbers of a source, as [`parse`] reads them.
pub fn numbers(source: &TorqueSource) -> String {
    let &TorqueSource { gain, resistance, inductance, feedback, instant, .. } = source;
    let &TorqueSource { loss, step, zero_crossing, .. } = source;
    [gain, resistance, inductance, feedback, instant, loss, step, zero_crossing]
        .map(|number| number.to_string())
        .join(",")
}

/// The numbers of a source, as the board sends them and as `--current-loop` takes them.
pub fn parse(text: &str) -> Option<TorqueSource> {
    let numbers: Vec<f64> = text.split(',').map(str::parse).collect::<Result<_, _>>().ok()?;
    let &[gain, resistance, inductance, feedback, instant, loss, step, zero_crossing] =
        numbers.as_slice()
    else {
        return None;
    };
    let is_positive = |number: f64| number > 0.0 && number.is_finite();
    let are_positive =
        [gain, resistance, inductance, feedback, instant, step, zero_crossing].map(is_positive);
    // An infinite loss stands for a loss without a known bound.
    let are_numbers = are_positive == [true; 7] && feedback < 1.0 && loss >= 0.0;
    are_numbers.then_some(TorqueSource {
        gain,
        resistance,
        inductance,
        feedback,
        instant,
        loss,
        step,
        zero_crossing,
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// The paddle of `bridge_identify`.
    const PADDLE: TorqueSource = TorqueSource {
        gain: 0.0841,
        resistance: 0.6,
        inductance: 0.12e-3,
        feedback: 0.25,
        instant: 25e-6,
        loss: 0.00253,
        step: 0.00427,
        zero_crossing: 0.115,
    };

    /// The same loop from instant to instant, with exact currents of a back-EMF that turns with `omega`: the
    /// part of the torque at that frequency.
    fn simulated(source: &TorqueSource, omega: f64) -> Complex<f64> {
        let TorqueSource { gain, resistance, inductance, feedback, instant, .. } = *source;
        let decay = (-resistance * instant / inductance).exp();
        let step_gain = (1.0 - decay) / resistance;
        let winding = Complex::new(resistance, omega * inductance);
        let turn = |time: f64| Complex::from_polar(1.0, omega * time);
        let (mut current, mut before, mut voltage, mut next) =
            (Complex::from(0.0), Complex::from(0.0), Complex::from(0.0), Complex::from(0.0));
        let (settle, measured) = (20_000_u32, 40_000_u32);
        let mut sum = Complex::from(0.0);
        for k in 0..settle + measured {
            let time = f64::from(k) * instant;
            // The current is the sum of three parts: one follows the back-EMF, one is that of the voltage,
            // one decays.
            let follows = -turn(time) / winding;
            let rests = voltage / resistance;
            let rest = current - follows - rests;
            if k >= settle {
                // Integrals over the instant of the three, each times `e^(-j omega t)`.
                let back = |rate: Complex<f64>| ((rate * instant).exp() - 1.0) / rate;
                let j_omega = Complex::new(0.0, omega);
                let decays = back(-j_omega - resistance / inductance);
                let held = back(-j_omega);
                sum += -instant / winding + turn(-time) * (rests * held + rest * decays);
            }
            let sampled = -current;
            next += feedback / step_gain * (sampled - decay * before);
            before = sampled;
            current = -turn(time + instant) / winding + rests + rest * decay;
            // It acts from the next instant on.
            voltage = next;
        }
        -gain * sum / (f64::from(measured) * instant)
    }

    #[test]
    fn it_is_that_of_a_loop_that_runs() {
        for hertz in [40.0, 240.0, 2000.0] {
            let omega = TAU * hertz;
            let (found, expected) = (impedance(&PADDLE, omega), simulated(&PADDLE, omega));
            let off = (found - expected).norm() / expected.norm();
            assert!(off < 1e-3, "{hertz} Hz: {found} in place of {expected}");
        }
    }

    #[test]
    fn no_motion_is_given_more_than_the_loss() {
        let highest = PI / PADDLE.instant;
        for part in 1..1000 {
            let found = impedance(&PADDLE, highest * f64::from(part) / 1000.0);
            assert!(found.re > -PADDLE.loss, "{part}: {found}");
        }
    }

    #[test]
    fn only_eight_numbers_of_a_loop_are_one() {
        assert_eq!(parse(&numbers(&PADDLE)), Some(PADDLE));
        assert!(parse("0.0841,0.6,0.00012,0.25,0.000025,inf,0.004,0.1").is_some());
        for wrong in [
            "",
            "1,2,3",
            "0.0841,0.6,0.00012,0.25,0.000025,0.1,0.004,0.1,7",
            "0,0.6,0.00012,0.25,0.000025,0,0.004,0.1",
            "0.0841,0.6,0.00012,1,0.000025,0,0.004,0.1",
            "0.0841,0.6,NaN,0.25,0.000025,0,0.004,0.1",
            "0.0841,0.6,0.00012,0.25,0.000025,NaN,0.004,0.1",
            "0.0841,0.6,0.00012,0.25,0.000025,-1,0.004,0.1",
            "0.0841,inf,0.00012,0.25,0.000025,0,0.004,0.1",
            "0.0841,0.6,0.00012,0.25,0.000025,0,0,0.1",
            "0.0841,0.6,0.00012,0.25,0.000025,0,0.004,inf",
        ] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }
}
