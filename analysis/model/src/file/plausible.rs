//! Warnings about numbers that no device has: most are right in another unit than that of their key.

use std::f64::consts::TAU;

use haptic_servo::current::{Winding, alignment_tolerance};

use super::key::{self, Key};
use super::scene::SceneFile;
use crate::quantity::significant;

/// The coarsest step of an encoder in rad: Hall sensors have 100 counts a turn and fewer, which is stated
/// exactly where it is meant.
const COARSEST_STEP: f64 = 0.15;
/// The most counts in a turn: those of the finest encoders, of 32 bits.
const MOST_COUNTS: f64 = 4_294_967_296.0;
/// The most noise of an encoder in counts, and the least that shows.
const MOST_NOISE: f64 = 100.0;
const LEAST_NOISE: f64 = 0.1;
/// The largest slope of an encoder's error: that of a magnet far beside its chip's middle.
const STEEPEST_ERROR: f64 = 0.3;
/// The longest period in s at which a hand feels anything but steps.
const LONGEST_PERIOD: f64 = 0.1;
/// The largest inertia in kg m^2 and friction in N m of a device that a hand moves, and the largest torque in
/// N m of a motor that it holds.
const LARGEST_INERTIA: f64 = 1.0;
const LARGEST_FRICTION: f64 = 100.0;
const LARGEST_TORQUE: f64 = 100.0;
/// The largest damping, in inertias per period: a device stops within a hundredth of a period.
const LARGEST_DAMPING: f64 = 100.0;
/// A slow turn in rad/s, against whose damping a motor turns its device.
const SLOW: f64 = 1.0;
/// The farthest face in rad, three turns away.
const FARTHEST_FACE: f64 = 3.0 * TAU;

/// A sentence for each implausible number of a file.
pub fn warnings(file: &SceneFile) -> Vec<String> {
    let doubts = [
        step, noise, linearity, alignment, period, inertia, damping, friction, cogging, full_scale,
        face,
    ]
    .map(|doubt| doubt(file));
    doubts.into_iter().flatten().collect()
}

/// `meant` is the value that was probably meant, and `of` its origin.
fn doubt(key: &Key, value: f64, why: &str, meant: f64, of: &str) -> String {
    let [value, meant] = [significant(value, 6), significant(meant, 3)];
    let Key { path, unit, .. } = key;
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    format!("`{path}` = {value}{unit} {why}: did you mean {meant}, of {value} {of}?")
}

fn step(file: &SceneFile) -> Option<String> {
    let counts = TAU / file.encoder_step?;
    if counts > MOST_COUNTS {
        let counts = significant(counts, 3);
        return Some(format!(
            "the encoder has {counts} counts a turn, and the finest have {MOST_COUNTS}"
        ));
    }
    let step = file.encoder_step.filter(|&step| step > COARSEST_STEP)?;
    let (meant, of) = match step > TAU {
        true => (TAU / step, "counts a turn"),
        false => (step.to_radians(), "degrees"),
    };
    // A file may state its counts in place of this key.
    let [counts, step, meant] =
        [(TAU / step, 2), (step, 6), (meant, 3)].map(|(it, to)| significant(it, to));
    let Key { path, unit, .. } = key::ENCODER_STEP;
    Some(format!(
        "the encoder has {counts} counts a turn, {step} {unit} each: did you mean `{path}` = {meant}, of {step} {of}?"
    ))
}

/// The noise is in counts, and data sheets have it as an angle.
fn noise(file: &SceneFile) -> Option<String> {
    let noise = file.scene.latency.encoder.noise;
    let (why, of, radians) = match noise {
        _ if noise > MOST_NOISE => (
            format!("is above {MOST_NOISE}, and no encoder is as noisy"),
            "arcseconds",
            noise.to_radians() / 3600.0,
        ),
        _ if noise > 0.0 && noise < LEAST_NOISE => {
            (format!("is below {LEAST_NOISE}, and counts hide it"), "degrees", noise.to_radians())
        }
        _ => return None,
    };
    Some(doubt(&key::NOISE, noise, &why, radians / file.encoder_step?, of))
}

/// A chip has an error over the angle, whether it is stated or not.
fn linearity(file: &SceneFile) -> Option<String> {
    let slope = file.scene.latency.encoder.linearity;
    if slope > STEEPEST_ERROR {
        let why = format!("is above {STEEPEST_ERROR}, and no encoder is as wrong");
        // Twice that of an error of one period in a turn.
        return Some(doubt(
            &key::LINEARITY,
            slope,
            &why,
            2.0 * slope.to_radians(),
            "degrees of INL",
        ));
    }
    let chip = file.chip.filter(|_| file.scene.latency.encoder.linearity == 0.0)?;
    Some(format!(
        "`{}` is not stated, and the certificate takes the readings of {} for free of any error over the angle",
        key::LINEARITY.path,
        chip.name
    ))
}

/// A motor may not be aligned by an encoder whose error is as large as that of another number of pole pairs.
fn alignment(file: &SceneFile) -> Option<String> {
    let motor = file.motor.filter(|motor| motor.index_offset.is_none())?;
    let Winding::Brushless { pole_pairs } = motor.motor.winding else { return None };
    let most = f64::from(alignment_tolerance(pole_pairs));
    let slope = file.scene.latency.encoder.linearity;
    (slope > most).then(|| {
        format!(
            "`{}` = {slope} is above {}, up to which an alignment tells {pole_pairs} pole pairs from one more: it may end \
             in the fault alignment-pole-pairs, unless `{}` is stated",
            key::LINEARITY.path,
            significant(most, 3),
            key::INDEX_OFFSET.path
        )
    })
}

fn period(file: &SceneFile) -> Option<String> {
    let period = Some(file.scene.timing.period).filter(|&period| period > LONGEST_PERIOD)?;
    let (meant, of) = if period < 100.0 {
        (1e-3 * period, "ms")
    } else {
        (1.0 / period, "Hz, which is `servo.rate`")
    };
    let why = format!("is {} updates a second", significant(1.0 / period, 2));
    Some(doubt(&key::PERIOD, period, &why, meant, of))
}

fn inertia(file: &SceneFile) -> Option<String> {
    let inertia = Some(file.scene.device.inertia).filter(|&inertia| inertia > LARGEST_INERTIA)?;
    let why = "is more than a hand moves";
    Some(doubt(&key::INERTIA, inertia, why, 1e-7 * inertia, "g cm^2"))
}

fn damping(file: &SceneFile) -> Option<String> {
    let (device, period) = (&file.scene.device, file.scene.timing.period);
    let times = device.damping * period / device.inertia;
    let motor = file.full_scale.or(file.scene.torque_limit).unwrap_or(f64::INFINITY);
    let why = if times > LARGEST_DAMPING {
        format!(
            "is {} times inertia over period, so that the device stops within a hundredth of a period",
            significant(times, 2)
        )
    } else if device.damping * SLOW > motor {
        let motor = significant(motor, 3);
        format!("takes more than the {motor} N m of the motor at {SLOW} rad/s")
    } else {
        return None;
    };
    Some(doubt(&key::DEVICE_DAMPING, device.damping, &why, 1e-3 * device.damping, "mN m s/rad"))
}

fn friction(file: &SceneFile) -> Option<String> {
    beyond_motor(file, &key::DEVICE_FRICTION, file.friction?)
}

fn cogging(file: &SceneFile) -> Option<String> {
    let torques = file.cogging?.harmonics.iter().map(|it| it.torque);
    beyond_motor(file, &key::COGGING_TORQUE, torques.fold(0.0, f64::max))
}

/// A torque of the device itself that is more than the motor's.
fn beyond_motor(file: &SceneFile, key: &Key, torque: f64) -> Option<String> {
    let motor = file.scene.torque_limit.or(file.full_scale);
    if torque <= motor.unwrap_or(LARGEST_FRICTION) {
        return None;
    }
    let why = motor.map_or_else(
        || "is more than a hand moves".to_owned(),
        |motor| {
            format!(
                "is more than the {} N m of the motor, which then moves nothing",
                significant(motor, 3)
            )
        },
    );
    Some(doubt(key, torque, &why, 1e-3 * torque, "mN m"))
}

fn full_scale(file: &SceneFile) -> Option<String> {
    let torque = file.full_scale.filter(|&it| it > LARGEST_TORQUE)?;
    Some(doubt(&key::FULL_SCALE, torque, "is more than a hand holds", 1e-3 * torque, "mN m"))
}

fn face(file: &SceneFile) -> Option<String> {
    let face = file.scene.environment.wall()?.face();
    let why = "is more than three turns away";
    let is_far = face.abs() > FARTHEST_FACE;
    is_far.then(|| doubt(&key::FACE, face, why, face.to_radians(), "degrees"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disturbance::sine;
    use crate::fixture::file_on_paddle;

    #[test]
    fn numbers_in_other_units_are_named_with_the_value_that_was_meant() {
        let wall = "[environment]\ntype = \"damper-wall\"\nstiffness = 3\ndamping = 0\ndelay = 1\n";
        let plain = file_on_paddle(wall);
        assert_eq!(warnings(&plain), Vec::<String>::new());
        let changed = |change: fn(&mut SceneFile)| {
            let mut file = plain.clone();
            change(&mut file);
            let [warning] = &warnings(&file)[..] else { panic!("{:?}", warnings(&file)) };
            warning.clone()
        };
        for (warning, parts) in [
            (
                changed(|file| file.encoder_step = Some(4096.0)),
                ["4096 rad", "`limits.encoder_step` = 0.00153,"],
            ),
            (changed(|file| file.encoder_step = Some(0.36)), ["17 counts", "= 0.00628,"]),
            (
                changed(|file| file.encoder_step = Some(6.28e-30)),
                ["1e30 counts", "the finest have 4294967296"],
            ),
            (changed(|file| file.friction = Some(49_200.0)), ["49200 N m", "mN m"]),
            (
                changed(|file| file.cogging = Some(sine(5000.0, 84.0))),
                ["`device.cogging.torque` = 5000 N m", "mean 5,"],
            ),
            (changed(|file| file.full_scale = Some(300.0)), ["hand holds", "mean 0.3,"]),
            (changed(|file| file.scene.device.damping = 22.0), ["1000 times", "mean 0.022,"]),
            (
                changed(|file| {
                    (file.scene.device.damping, file.full_scale) = (1.0, Some(0.2));
                }),
                ["more than the 0.2 N m of the motor at 1 rad/s", "mean 0.001, of 1 mN m s/rad"],
            ),
            (changed(|file| file.scene.device.inertia = 220.0), ["hand", "mean 2.2e-5,"]),
        ] {
            assert!(parts.iter().all(|part| warning.contains(part)), "{warning}");
        }
        let mut slow = plain.clone();
        slow.scene.timing.period = 1000.0;
        slow.scene.device.damping = 1e-9;
        assert!(warnings(&slow)[0].contains("mean 0.001, of 1000 Hz"), "{:?}", warnings(&slow));
    }
}
