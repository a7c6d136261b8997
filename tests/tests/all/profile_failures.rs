//! The cases of `haptic failures` about torque profiles, computed here once more by recursions of their own.

use std::f64::consts::{FRAC_2_PI, TAU};

use analysis::simulation::plant::Plant;
use analysis::simulation::{Integration, simulate};
use analysis::studies::failures::method_result::MethodVerdict;
use analysis::studies::failures::profiles::{CERTIFIED, DETENTS, HUMMING, MEAN, SWING, TEETH};
use analysis::studies::failures::setting::{KNOB, PADDLE, PERIOD};
use analysis::studies::failures::{Case, CaseResult};
use haptic_servo::scene::Device;

fn case(name: &str) -> CaseResult {
    Case::find(name).unwrap().evaluate().unwrap()
}

/// Torque of the detents at an angle in rad.
fn detents(torque: f64, angle: f64) -> f64 {
    torque * FRAC_2_PI * (f64::from(DETENTS) * angle).sin().asin()
}

/// How far the paddle moves to and fro in the last of four seconds: its torque held for a period, and that of
/// the sample before, or by semi-implicit Euler in steps of a period with the torque of the step itself.
fn left(torque: f64, speed: f64, is_held_and_late: bool) -> f64 {
    let (mut x, mut v, mut last) = (0.0, speed, 0.0);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    let gone = -(-PADDLE.damping * PERIOD / PADDLE.inertia).exp_m1();
    for k in 0..4000 {
        let now = detents(torque, x);
        if is_held_and_late {
            let end = -last / PADDLE.damping;
            x += end * PERIOD + (v - end) * gone * PADDLE.inertia / PADDLE.damping;
            v += (end - v) * gone;
            last = now;
        } else {
            v += PERIOD / PADDLE.inertia * (-now - PADDLE.damping * v);
            x += PERIOD * v;
        }
        if k >= 3000 {
            (least, most) = (least.min(x), most.max(x));
        }
    }
    most - least
}

#[test]
fn detents_that_rest_in_a_simulation_hum_where_the_torque_is_held_and_late() {
    let result = case("fine-detents");
    let pitch = TAU / f64::from(DETENTS);
    for speed in [1.0, 5.0, 20.0, 40.0] {
        let hum = left(HUMMING, speed, true);
        assert!(hum > 0.4 * pitch, "{speed}: {hum}");
        assert!(left(HUMMING, speed, false) < 1e-12, "{speed}");
        assert!(left(CERTIFIED, speed, true) < 1e-12, "{speed}");
    }
    let hum = result.truth.figure.unwrap();
    assert!(hum > 0.4 * pitch && hum < 2.0 * pitch, "{hum}");
    // `T (L/2 + M)`: the torque is a sample late, and no coupling is in front of it.
    let slope = |torque: f64| 4.0 * f64::from(DETENTS) * torque / TAU;
    assert!(1.5 * PERIOD * slope(HUMMING) > PADDLE.damping);
    assert!(1.5 * PERIOD * slope(CERTIFIED) < PADDLE.damping);
    let [hums, rests] = &result.runs[..] else { panic!("two runs") };
    assert!(hums.experiment.scene.certify().is_err() && rests.experiment.scene.certify().is_ok());
    assert!(result.certificate.reason.contains("profile torque <="), "{:?}", result.certificate);
}

/// At any damping: the more of it, the nearer its mean speed is to that of a device without inertia, whose
/// time for a tooth is the integral of `b / torque`.
#[test]
fn a_profile_whose_mean_is_not_zero_turns_on_at_any_damping() {
    let result = case("ratchet");
    assert_eq!(result.certificate.verdict, MethodVerdict::Unsafe);
    assert!((result.certificate.figure.unwrap() / MEAN - 1.0).abs() < 1e-12);
    assert!(result.certificate.reason.contains("the mean of the torque over a period is 3 N m"));
    for times in [1.0, 10.0, 100.0] {
        let damping = times * KNOB.damping;
        let mut experiment = result.runs[0].experiment.clone();
        experiment.plant = Plant::rigid(Device { damping, ..KNOB });
        // As many teeth, however slowly it turns.
        experiment.samples = 6000 * times as usize;
        let position = simulate(&experiment, Integration::default()).unwrap().position;
        let half = experiment.samples / 2;
        let (seconds, turned) = (half as f64 * PERIOD, position[half] - position[2 * half - 1]);
        let tooth = TAU / f64::from(TEETH);
        assert!(turned > 10.0 * tooth, "{times}: {turned}");
        if times == 100.0 {
            let speed = 2.0 * SWING / (damping * ((MEAN + SWING) / (MEAN - SWING)).ln());
            assert!((turned / (speed * seconds) - 1.0).abs() < 0.02, "{turned} {speed}");
        }
    }
}
