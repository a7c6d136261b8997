//! The tables of a scene file that only simulation uses: checked like all others, so that a file
//! that certifies also simulates.

use std::path::PathBuf;

use crate::device::Hand;
use crate::missed::Missed;

use super::faults::Read;
use super::key::{self, Key};
use super::section::Section;

/// The settings of a simulation, with the torque of the hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Number of samples.
    pub samples: usize,
    /// Position in rad at sample 0.
    pub position: f64,
    /// Velocity in rad/s at sample 0.
    pub velocity: f64,
    /// Torque of the hand on the device.
    pub torque: HandTorque,
    /// Dry friction of the device in N m.
    pub friction: f64,
    /// Time in s from a sample to its torque, less than the period.
    pub latency: f64,
    /// Ticks in which the servo does not run.
    pub missed: Missed,
    /// Readings of the encoder that fail.
    pub dropped: Missed,
    /// Torques in N m that a host wants, one a sample.
    pub host: Option<Vec<f64>>,
}

/// Torque in N m that the hand puts on the device, positive in the direction of the angle.
#[derive(Clone, Debug, PartialEq)]
pub enum HandTorque {
    /// None.
    Free,
    /// One value a sample, held over it.
    Held(Vec<f64>),
    /// The same, in a file.
    File(PathBuf),
    /// `amplitude * sin(omega t + phase)`, continuous in time.
    Sine {
        /// Amplitude in N m.
        amplitude: f64,
        /// Angular frequency in rad/s.
        omega: f64,
        /// Phase in rad at sample 0.
        phase: f64,
        /// Whether the value at a sample is held until the next instead.
        held: bool,
    },
    /// `amplitude` for the first `length` of every `every` samples.
    Pulses {
        /// Height in N m.
        amplitude: f64,
        /// Samples from the start of one pulse to the next.
        every: usize,
        /// Samples that a pulse lasts.
        length: usize,
    },
}

/// Reads `[simulation]` of a servo with this period in s.
pub fn simulation(mut section: Section<'_>, period: f64, friction: f64) -> Read<Simulation> {
    let samples = section.whole(&key::SAMPLES);
    let [position, velocity] = [&key::POSITION, &key::VELOCITY].map(|key| section.number(key));
    let torque = torque(&mut section);
    let host = section.list(&key::HOST_TORQUES);
    let own_friction = section.optional(&key::FRICTION);
    let latency = latency(&mut section, period);
    let [missed, dropped] =
        [(&key::MISSED, key::OF_MISSED), (&key::FAILED, key::OF_FAILED)].map(|(key, keys)| {
            section
                .table(key)
                .and_then(|table| table.map_or(Ok(Missed::None), |it| missed_of(it, keys)))
        });
    section.finish();
    Ok(Simulation {
        samples: samples?,
        position: position?,
        velocity: velocity?,
        torque: torque?,
        friction: own_friction?.unwrap_or(friction),
        latency: latency?,
        missed: missed?,
        dropped: dropped?,
        host: host?,
    })
}

fn latency(section: &mut Section<'_>, period: f64) -> Read<f64> {
    let latency = section.number(&key::LATENCY)?;
    if latency < period {
        return Ok(latency);
    }
    let reason = format!(
        "is not shorter than {} = {period} s; whole ticks are `{}`",
        section.stated(&key::PERIOD),
        key::DELAY_SAMPLES.path
    );
    Err(section.conflict(&key::LATENCY, reason))
}

/// Reads a table with these keys: every so many and how many of them, a fraction and the seed of its chance.
fn missed_of(mut table: Section<'_>, keys: [&'static Key; 4]) -> Read<Missed> {
    let [every, length, fraction, seed] = keys.map(|key| table.optional(key));
    let (every, length, fraction, seed) = match (every, length, fraction, seed) {
        // Before `finish`, so that a misspelt `fraction` is reported with the intended key.
        (Ok(None), Ok(_), Ok(None), Ok(_)) => {
            let reported = table.missing(keys[2]);
            table.finish();
            return Err(reported);
        }
        (every, length, fraction, seed) => {
            table.finish();
            (every?, length?, fraction?, seed?)
        }
    };
    match (every, fraction) {
        (Some(every), None) if seed.is_none() => {
            let (count, length) = (every as u32, length.unwrap_or(1.0) as u32);
            if length < count {
                return Ok(Missed::Every { count, length });
            }
            let reason = format!("is not less than `{}` = {count}", keys[0].path);
            Err(table.conflict(keys[1], reason))
        }
        (Some(_), _) => {
            let reason = "cannot stand beside `fraction` or `seed`: set one or the other";
            Err(table.conflict(keys[0], reason))
        }
        (None, _) if length.is_some() => {
            let reason = format!("stands without `{}`", keys[0].path);
            Err(table.conflict(keys[1], reason))
        }
        (None, fraction) => Ok(Missed::Random {
            fraction: fraction.unwrap_or(0.0),
            seed: seed.unwrap_or(0.0) as u64,
        }),
    }
}

/// Reads `[human]`.
pub fn hand(mut section: Section<'_>) -> Read<Hand> {
    let [inertia, damping, stiffness] =
        [&key::HUMAN_INERTIA, &key::HUMAN_DAMPING, &key::HUMAN_STIFFNESS]
            .map(|key| section.number(key));
    section.finish();
    Ok(Hand { inertia: inertia?, damping: damping?, stiffness: stiffness? })
}

fn torque(section: &mut Section<'_>) -> Read<HandTorque> {
    let held = section.list(&key::TORQUE);
    let file = section.text(&key::TORQUE_FILE);
    let sine = section.table(&key::TORQUE_SINE);
    let pulses = section.table(&key::TORQUE_PULSES);
    let (held, file, sine, pulses) = (held?, file?, sine?, pulses?);
    let given = [
        (&key::TORQUE, held.is_some()),
        (&key::TORQUE_FILE, file.is_some()),
        (&key::TORQUE_SINE, sine.is_some()),
        (&key::TORQUE_PULSES, pulses.is_some()),
    ];
    if let Some((key, _)) = given.into_iter().filter(|(_, is_given)| *is_given).nth(1) {
        let names = given.map(|(key, _)| key.name()).join(", ");
        let reason = format!("stands beside another torque; the hand has one of {names}");
        return Err(section.conflict(key, reason));
    }
    match (held, file, sine, pulses) {
        (Some(torques), ..) => Ok(HandTorque::Held(torques)),
        (_, Some(file), ..) => Ok(HandTorque::File(file.into())),
        (_, _, Some(table), _) => sine_torque(table),
        (_, _, _, Some(table)) => pulses_of_torque(table),
        _ => Ok(HandTorque::Free),
    }
}

fn sine_torque(mut table: Section<'_>) -> Read<HandTorque> {
    let [amplitude, omega, phase] =
        [&key::SINE_AMPLITUDE, &key::SINE_OMEGA, &key::SINE_PHASE].map(|key| table.number(key));
    let held = table.boolean(&key::SINE_HELD);
    table.finish();
    Ok(HandTorque::Sine {
        amplitude: amplitude?,
        omega: omega?,
        phase: phase?,
        held: held?.unwrap_or(false),
    })
}

fn pulses_of_torque(mut table: Section<'_>) -> Read<HandTorque> {
    let amplitude = table.number(&key::PULSE_AMPLITUDE);
    let [every, length] = [&key::PULSE_EVERY, &key::PULSE_LENGTH].map(|key| table.whole(key));
    table.finish();
    Ok(HandTorque::Pulses { amplitude: amplitude?, every: every?, length: length? })
}
