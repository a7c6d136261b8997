//! Sweeps as they are played.

use super::*;
use crate::test_scene::PADDLE as MOTOR;

const LOW: Tone = Tone { frequency: 4.0, amplitude: 0.5, settle: 2, measured: 6 };
const HIGH: Tone = Tone { frequency: 240.0, amplitude: 2.0, settle: 6, measured: 24 };

fn played<const N: usize>(sweep: &Sweep<N>) -> Vec<Excitation> {
    let mut exciter = Exciter::new(sweep);
    (0..sweep.ticks()).map(|_| exciter.next()).collect()
}

#[test]
fn each_tone_is_a_sine_over_whole_samples() {
    let sweep = Sweep::planned(1e-3, &MOTOR, [LOW, HIGH]);
    let samples = played(&sweep);
    assert_eq!(samples.len(), 500 + 1500 + 25 + 100);
    for (index, tone) in [LOW, HIGH].into_iter().enumerate() {
        let measured: Vec<_> = samples.iter().filter(|s| s.measured == Some(index)).collect();
        assert_eq!(measured.len(), [1500, 100][index]);
        let peak = tone.amplitude / 2.0 * 1791.0;
        for (sample, excitation) in measured.iter().enumerate() {
            let phase = core::f64::consts::TAU * tone.frequency * 1e-3 * sample as f64;
            let error = f64::from(excitation.code.offset()) - peak * phase.sin();
            assert!(error.abs() < 0.5 + 7e-5 * peak, "{tone:?} {sample} {error}");
        }
        // The sine begins anew after the settling as if it went on, and has no mean.
        assert_eq!(measured[0].code, DacCode::MID_SCALE);
        let mean: i64 = measured.iter().map(|s| i64::from(s.code.offset())).sum();
        assert!(mean.abs() <= 2, "{tone:?} {mean}");
    }
}

#[test]
fn there_is_no_torque_after_the_end() {
    let sweep = Sweep::planned(1e-3, &MOTOR, [HIGH]);
    let mut exciter = Exciter::new(&sweep);
    for _ in 0..sweep.ticks() {
        exciter.next();
    }
    let nothing = Excitation { code: DacCode::MID_SCALE, measured: None };
    assert!((0..1000).all(|_| exciter.next() == nothing));
    assert_eq!(Exciter::new(&Sweep::planned(1e-3, &MOTOR, [])).next(), nothing);
}

#[test]
fn what_cannot_be_played_is_refused_with_its_numbers() {
    let refused = |tone: Tone| Sweep::new(1e-3, &MOTOR, [LOW, tone]).unwrap_err().to_string();
    for (tone, words) in [
        (Tone { frequency: 500.0, ..LOW }, "tone 1 has a frequency of 500 Hz; it must be above 0"),
        (Tone { frequency: f64::NAN, ..LOW }, "tone 1 has a frequency of NaN Hz"),
        (Tone { amplitude: 2.001, ..LOW }, "an amplitude of 2.001 N m; the DAC gives"),
        (Tone { amplitude: 0.0, ..LOW }, "an amplitude of 0 N m"),
        (Tone { measured: 3, ..LOW }, "a measured part of 3 periods; it must be at least 4"),
        (Tone { settle: 1, ..HIGH }, "a part of 1 periods, which take 4.166666667 samples"),
        (Tone { frequency: 1e-6, ..LOW }, "and at most 1048576"),
    ] {
        assert!(refused(tone).contains(words), "{}", refused(tone));
    }
    let error = |period, torque| {
        let motor = Transducers { full_scale_torque: torque, ..MOTOR };
        Sweep::new(period, &motor, [LOW]).unwrap_err().to_string()
    };
    assert!(error(0.0, 2.0).starts_with("the period is 0"));
    assert!(error(1e-3, f64::INFINITY).starts_with("the full-scale torque is inf"));
}

#[test]
fn the_plan_says_how_long_it_takes() {
    let plan = Sweep::planned(1e-3, &MOTOR, [LOW, HIGH]).to_string();
    assert!(plan.contains("240 Hz          2 N m      0.025 s      0.100 s"), "{plan}");
    assert!(plan.ends_with("2125 ticks of 0.001 s, 2.125 s in all\n"), "{plan}");
}
