//! Simulated devices measured by a simulated rig, and invalid records.

use haptic_servo::scene::Device;

use super::record::parse;
use super::rig::{MeasuredDevice, Sensing};
use super::*;
use crate::simulation::plant::Plant;

const PADDLE: Device = Device { inertia: 0.05, damping: 0.5, passivity: None };
const KNOB: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };

const SENSING: Sensing = Sensing::ideal(1e-3, 61_440.0);

/// One sine: its frequency in Hz, its amplitude in N m, its duration in s.
#[derive(Clone, Copy, Debug)]
struct Excitation {
    frequency: f64,
    amplitude: f64,
    duration: f64,
}

/// A rig with a rigid device, and an amplifier with a lag in s.
struct Rig {
    device: Device,
    actuator_lag: f64,
    sensing: Sensing,
}

impl Rig {
    /// Applies one sine after the other, from rest, and records.
    fn measure(&self, sines: &[Excitation]) -> Record {
        self.play(sines, |sine, phase| sine.amplitude * phase.sin())
    }

    /// The same; `felt` is the torque in N m that the device gets at a phase in rad of a sine.
    fn play(&self, sines: &[Excitation], felt: impl Fn(&Excitation, f64) -> f64) -> Record {
        let (rigid, lag, period) =
            (Plant::rigid(self.device), self.actuator_lag, self.sensing.period);
        let plant = if lag > 0.0 { rigid.with_actuator_lag(lag) } else { rigid };
        let mut device = MeasuredDevice::new(&plant, &self.sensing).unwrap();
        let (mut torque, mut counts, mut frequency) = (vec![], vec![], vec![]);
        for sine in sines {
            for tick in 0..(sine.duration / period).round() as usize {
                let phase = std::f64::consts::TAU * sine.frequency * (tick as f64 * period);
                torque.push(sine.amplitude * phase.sin());
                counts.push(f64::from(device.count()));
                frequency.push(sine.frequency);
                device.hold(felt(sine, phase));
            }
        }
        Record { period, torque, counts, frequency: Some(frequency) }
    }
}

/// A rig with an amplifier without lag.
fn rig(device: Device, sensing: Sensing) -> Rig {
    Rig { device, actuator_lag: 0.0, sensing }
}

/// Sines that move the device by `amplitude` rad, whatever the frequency.
fn sines(device: Device, frequencies: &[f64], amplitude: f64) -> Vec<Excitation> {
    let sine = |&frequency: &f64| {
        let omega = std::f64::consts::TAU * frequency;
        let impedance = device.damping.hypot(device.inertia * omega);
        let duration = (20.0 / frequency).max(4.0);
        Excitation { frequency, amplitude: impedance * omega * amplitude, duration }
    };
    frequencies.iter().map(sine).collect()
}

const LOW_TO_HIGH: &[f64] = &[0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

fn identified(rig: &Rig, frequencies: &[f64], amplitude: f64) -> Identification {
    let record = rig.measure(&sines(rig.device, frequencies, amplitude));
    identify(&record, &Correction::of_encoder(rig.sensing.counts_per_turn)).unwrap()
}

fn assert_near(found: &Estimate, wanted: f64, part: f64) {
    assert!((found.value - wanted).abs() < part * wanted, "{found:?} {wanted}");
}

#[test]
fn damping_and_inertia_through_counts_and_noise() {
    for (device, noise) in [(PADDLE, 0.02), (KNOB, 2e-4)] {
        for seed in 0..4 {
            let rig = rig(device, Sensing { torque_noise: noise, seed, ..SENSING });
            let found = identified(&rig, LOW_TO_HIGH, 0.02);
            assert_near(&found.damping, device.damping, 0.02);
            assert_near(&found.inertia, device.inertia, 0.01);
            assert!(found.is_rigid(), "{}", found.misfit);
            let passivity = found.passivity().unwrap();
            assert!(
                (0.95 * device.damping..1.005 * device.damping).contains(&passivity),
                "{found:?}"
            );
        }
    }
}

#[test]
fn ten_microseconds_of_skew_are_found_and_taken_out() {
    let rig = rig(PADDLE, Sensing { skew: 1e-5, torque_noise: 0.02, ..SENSING });
    let found = identified(&rig, &[1.0, 5.0, 20.0, 50.0, 80.0, 100.0], 0.02);
    assert!(found.mean_delay.is_significant(), "{found:?}");
    assert_near(&found.mean_delay, 1e-5, 0.1);
    assert_near(&found.damping, PADDLE.damping, 0.02);
    // Theory, section 3.3: 0.5 becomes 0.30 at 100 Hz.
    assert!((found.disk.delta - 0.30).abs() < 0.01, "{:?}", found.disk);
    assert!((found.bias + 0.20).abs() < 0.01, "{}", found.bias);
    // A declared delay is not a skew.
    let record = rig.measure(&sines(PADDLE, LOW_TO_HIGH, 0.02));
    let correction =
        Correction { count_delay: 1e-5, ..Correction::of_encoder(rig.sensing.counts_per_turn) };
    let declared = identify(&record, &correction).unwrap();
    assert!(declared.mean_delay.value.abs() < 1e-6, "{:?}", declared.mean_delay);
    assert_near(&declared.damping, PADDLE.damping, 0.02);
}

#[test]
fn without_noise_only_the_counts_are_left() {
    // The finest encoder for its counter: only the method's own error is left.
    for device in [PADDLE, KNOB] {
        let rig = rig(device, Sensing { counts_per_turn: 2f64.powi(30), ..SENSING });
        let found = identified(&rig, LOW_TO_HIGH, 0.02);
        assert_near(&found.damping, device.damping, 1e-5);
        assert_near(&found.inertia, device.inertia, 1e-5);
        assert!(found.mean_delay.value.abs() < 1e-8, "{:?}", found.mean_delay);
    }
}

#[test]
fn steps_are_found_without_labels() {
    let rig = rig(PADDLE, Sensing { torque_noise: 0.02, ..SENSING });
    let record = rig.measure(&sines(PADDLE, LOW_TO_HIGH, 0.02));
    let blind = Record { frequency: None, ..record.clone() };
    let (labelled, found) = (step::steps(&record).0, step::steps(&blind).0);
    assert_eq!(found.len(), labelled.len());
    for (a, b) in labelled.iter().zip(&found) {
        assert!((a.omega / b.omega - 1.0).abs() < 2e-3, "{a:?} {b:?}");
    }
    let found = identify(&blind, &Correction::of_encoder(rig.sensing.counts_per_turn)).unwrap();
    assert_near(&found.damping, PADDLE.damping, 0.02);
}

#[test]
fn too_little_motion_is_said_to_be_so() {
    let rig = rig(PADDLE, SENSING);
    let record = rig.measure(&sines(PADDLE, LOW_TO_HIGH, 1e-5));
    let error =
        identify(&record, &Correction::of_encoder(rig.sensing.counts_per_turn)).unwrap_err();
    assert!(error.to_string().contains("use a larger torque"), "{error}");
    let still =
        Record { torque: vec![0.0; 100], counts: vec![0.0; 100], period: 1e-3, frequency: None };
    assert!(matches!(
        identify(&still, &Correction::of_encoder(4096.0)),
        Err(IdentifyError::NoSteps(_))
    ));
}

#[test]
fn malformed_rows_are_named() {
    let rows = |bad: &str| {
        let good = |k: usize| format!("{:.4},{},{k}\n", k as f64 * 1e-3, 0.5);
        let rows: String = (0..20).map(|k| if k == 7 { bad.to_owned() } else { good(k) }).collect();
        parse("x.csv", format!("time,torque,counts\n{rows}").as_bytes(), 1e-4)
    };
    let good = rows("0.007,0.5,7\n").unwrap();
    assert!((good.period - 1e-3).abs() < 1e-12 && good.counts.len() == 20);
    for (bad, named) in [
        ("0.007,much,7\n", "x.csv:9: column 2, `torque`: `much`"),
        ("0.007,inf,7\n", "x.csv:9: column 2, `torque`: `inf`"),
        ("0.007,0.5,7.5\n", "x.csv:9: column 3, `counts`: `7.5`"),
        ("0.0074,0.5,7\n", "x.csv:9: column 1, `time`: `0.0074`"),
        ("0.005,0.5,7\n", "x.csv:9: column 1, `time`: `0.005`"),
        ("", "x.csv:9: the time goes from 0.006 s to 0.008 s"),
        ("NaN,0.5,7\n", "x.csv:9: column 1, `time`: `NaN`"),
        ("0.007,0.5\n", "x.csv:9: 2 fields"),
        (",,\n", "x.csv:9: column 1, `time`: ``"),
    ] {
        let error = rows(bad).unwrap_err().to_string();
        assert!(error.starts_with(named), "{error}");
    }
    let error = |text: &str| parse("x.csv", text.as_bytes(), 1e-4).unwrap_err().to_string();
    assert!(error("time,torque\n").contains("no column `counts`"));
    assert!(error("time,torque,counts\n0,0,0\n").contains("1 rows"));
    assert!(error("time,torque,counts\n1,0,0\n1,0,0\n").contains("x.csv:3: column 1"));
    assert!(error("").contains("no column"));
}

#[test]
fn units_separators_and_decimal_commas_are_read() {
    let record = |header: &str, row: &dyn Fn(f64) -> String| {
        let rows: String = (0..20).map(|k| row(f64::from(k)) + "\n").collect();
        parse("x.csv", format!("{header}\n{rows}").as_bytes(), 1e-3)
            .map_err(|error| error.to_string())
    };
    let si = record("time,torque,counts", &|k| format!("{},{},{k}", 1e-3 * k, 0.25 * k)).unwrap();
    let comma = |number: f64| format!("{number}").replace('.', ",");
    for (header, separator) in [
        ("time [ms];torque (mNm);angle [mrad]", ';'),
        ("Time (ms)\tTorque [mN m]\tposition (mrad)", '\t'),
        ("time_ms;torque_mNm;angle_mrad", ';'),
    ] {
        let row =
            |k: f64| format!("{}{separator}{}{separator}{}", comma(k), comma(250.0 * k), comma(k));
        let read = record(header, &row).unwrap();
        assert!((read.period - si.period).abs() < 1e-15, "{header}");
        for (a, b) in read.torque.iter().zip(&si.torque).chain(read.counts.iter().zip(&si.counts)) {
            assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{header}: {a} {b}");
        }
    }
    for (header, said) in [
        (
            "time,torque [MNm],counts",
            "x.csv:1: the column `torque [MNm]` has the unit `MNm`; the units of `torque`",
        ),
        ("time,torque,angle", "x.csv:1: the column `angle` has no unit: name it `angle (rad)`"),
        (
            "time,torque,torque (mNm),counts",
            "x.csv:1: `torque` and `torque (mNm)` are both `torque`",
        ),
        ("time;torque,counts", "x.csv:1: `time;torque,counts` has `;` beside `,`"),
    ] {
        let error = record(header, &|k| format!("{k},{k},{k},{k}")).unwrap_err();
        assert!(error.starts_with(said), "{error}");
    }
    let mixed = |k: f64| format!("{k};{};{k}", if k < 9.0 { "0,5" } else { "0.5" });
    let error = record("time [ms];torque;counts", &mixed).unwrap_err();
    let said = "x.csv:11: column 2, `torque`: `0.5` is out of bounds; it must be a finite number in N m with";
    assert!(error.starts_with(said), "{error}");
}

#[test]
fn rows_that_are_missing_are_counted_together() {
    let times = [0, 1, 2, 3, 7, 8, 9, 10, 12, 13, 14, 15, 16, 17, 18, 19, 20];
    let rows: String =
        times.iter().map(|k| format!("{},0.5,{k}\n", 1e-3 * f64::from(*k))).collect();
    let error = parse("x.csv", format!("time,torque,counts\n{rows}").as_bytes(), 1e-3).unwrap_err();
    let said = error.to_string();
    assert!(said.starts_with("x.csv:6: the time goes from 0.003 s to 0.007 s"), "{said}");
    assert!(said.contains("(4 rows in 2 gaps in the file)"), "{said}");
}

#[test]
fn a_header_within_a_record_is_named() {
    let rows: String = (0..20).map(|k| format!("{},0.5,{k}\n", 1e-3 * f64::from(k))).collect();
    let text = format!("time,torque,counts\n{rows}time, torque,counts\n{rows}");
    let said = parse("x.csv", text.as_bytes(), 1e-3).unwrap_err().to_string();
    assert!(said.starts_with("x.csv:22: the header of line 1 is repeated here"), "{said}");
}

/// An encoder whose error has a slope shows another damping over the small angle of a sine.
#[test]
fn the_intervals_hold_the_truth_behind_an_encoder_with_a_slope() {
    for slope in [-0.03, 0.03] {
        let device = Device {
            inertia: KNOB.inertia / (1.0 + slope),
            damping: KNOB.damping / (1.0 + slope),
            ..KNOB
        };
        let record = rig(device, SENSING).measure(&sines(device, LOW_TO_HIGH, 0.02));
        let found = identify(&record, &Correction::of_encoder(61_440.0)).unwrap();
        let holds = |it: &Identification| {
            let is_in = |e: &Estimate, truth: f64| e.lo <= truth && truth <= e.hi;
            [is_in(&it.damping, KNOB.damping), is_in(&it.inertia, KNOB.inertia)]
        };
        assert_eq!(holds(&found), [false; 2], "{found:?}");
        assert_eq!(holds(&found.with_linearity(0.03)), [true; 2], "{slope}");
    }
}

/// A paddle's counts under a torque, both over time at 1 kHz.
fn moved(torque: impl Fn(f64) -> f64, seconds: f64) -> Record {
    let torque: Vec<f64> =
        (0..(1e3 * seconds) as usize).map(|row| torque(1e-3 * row as f64)).collect();
    let (mut speed, mut angle, mut counts) = (0.0, 0.0, Vec::new());
    for held in &torque {
        counts.push(f64::round(angle * 61_440.0 / std::f64::consts::TAU));
        speed += 1e-3 * (held - PADDLE.damping * speed) / PADDLE.inertia;
        angle += 1e-3 * speed;
    }
    Record { period: 1e-3, torque, counts, frequency: None }
}

#[test]
fn a_sweep_is_called_one() {
    use std::f64::consts::TAU;
    let refused = |torque: &dyn Fn(f64) -> f64| {
        let record = moved(torque, 20.0);
        identify(&record, &Correction::of_encoder(61_440.0)).unwrap_err().to_string()
    };
    // From 1 to 21 Hz: slowly enough that each period is like the previous one.
    let said = refused(&|t| (TAU * (t + 0.5 * t * t)).sin());
    assert!(said.contains("a sweep (chirp) is not a steady sine"), "{said}");
    assert!(!said.contains("larger torque"), "{said}");
}

#[test]
fn a_tone_that_is_left_out_is_named_with_the_reason() {
    let rig = rig(PADDLE, SENSING);
    let mut tones = sines(PADDLE, LOW_TO_HIGH, 0.02);
    tones[2].duration = 1.0;
    tones[7].amplitude *= 5e-3;
    let record = rig.measure(&tones);
    let found = identify(&record, &Correction::of_encoder(61_440.0)).unwrap();
    let said = left_out::grouped(&found.left_out);
    assert_eq!(said.len(), 2, "{said:?}");
    assert_eq!(
        said[0],
        "the tone of 2 Hz (row 60001) is left out: 2 of its periods are fewer than 4"
    );
    assert!(said[1].starts_with("the tone of 64 Hz") && said[1].contains("counts"), "{said:?}");
}

mod clipping;
mod friction;
mod latency;
