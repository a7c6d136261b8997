//! Whether the motor gave the commanded torques: an amplifier that clips makes harmonics that the
//! command does not have.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::error::IdentifyError;
use super::fit::Identification;
use super::record::Record;
use super::response::{Correction, fitted_sines};
use super::step::Step;
use super::torque_source;

/// Largest part of a sine's torque that may be in its second or third harmonic. A sine that is cut
/// off at nine tenths of its peak has 3 % in its third; whole codes have less than 1 %.
const LARGEST: f64 = 0.025;
/// Factor by which the harmonic must exceed those of sines of less than half of the largest torque: friction
/// has harmonics too, of the same size in all sines.
const ABOVE_FRICTION: f64 = 2.0;
/// Smallest ratio of a harmonic of the motion to the standard deviation of its noise.
const OUT_OF_NOISE: f64 = 4.0;

/// A sine's torque beside its harmonics, in N m.
#[derive(Clone, Copy, Debug)]
struct Distortion {
    frequency: f64,
    amplitude: f64,
    /// The larger of the second and the third harmonic that the device felt, less the parts that were
    /// commanded or come from friction or the zero crossings of a bridge's current.
    harmonic: f64,
}

/// Refuses a record in which the torque that moved the device was clipped.
pub fn check(
    record: &Record,
    steps: &[Step],
    correction: &Correction,
    found: &Identification,
) -> Result<(), IdentifyError> {
    let all: Vec<Distortion> =
        steps.iter().filter_map(|step| distortion(record, step, correction, found)).collect();
    let most = all.iter().map(|sine| sine.amplitude).fold(0.0, f64::max);
    let is_loud = |sine: &&Distortion| sine.amplitude >= 0.5 * most;
    let friction =
        all.iter().filter(|sine| !is_loud(sine)).map(|sine| sine.harmonic).fold(0.0, f64::max);
    let is_clipped = |sine: &&Distortion| {
        sine.harmonic > LARGEST * sine.amplitude && sine.harmonic > ABOVE_FRICTION * friction
    };
    match all.iter().filter(is_loud).find(is_clipped) {
        None => Ok(()),
        Some(sine) => Err(IdentifyError::Clipped {
            frequency: sine.frequency,
            amplitude: sine.amplitude,
            part: sine.harmonic / sine.amplitude,
        }),
    }
}

fn distortion(
    record: &Record,
    step: &Step,
    correction: &Correction,
    found: &Identification,
) -> Option<Distortion> {
    let rows = step.settled(correction.settle);
    let angle = step.omega * record.period;
    let (torque, _) = harmonics(&record.torque[rows.clone()], angle)?;
    let (counts, deviation) = harmonics(&record.counts[rows], angle)?;
    let amplitude = torque[0].norm();
    // The harmonics of Coulomb friction, of which the third is the largest.
    let friction = friction(found) * 4.0 / (3.0 * PI);
    // Torque that moves the device by so many counts at a multiple of the frequency.
    let felt = |order: usize, counts: f64| {
        let omega = order as f64 * step.omega;
        counts * correction.count_angle * omega * found.model.device(omega).norm()
    };
    let known = |order: usize| {
        correction.source.map_or(0.0, |source| torque_source::crossing(&source, step.omega, order))
    };
    let harmonic = (2..=ORDERS)
        .filter(|order| *order as f64 * angle < 0.95 * PI)
        .filter(|order| counts[order - 1].norm() > OUT_OF_NOISE * deviation)
        .map(|order| {
            let third = if order == 3 { friction } else { 0.0 };
            felt(order, counts[order - 1].norm()) - torque[order - 1].norm() - known(order) - third
        })
        .fold(0.0, f64::max);
    let frequency = step.omega / TAU;
    Some(Distortion { frequency, amplitude, harmonic })
}

/// Friction in N m: where it cannot be told from damping, there may be as much as the upper end.
fn friction(found: &Identification) -> f64 {
    if found.tells_friction { found.friction.value } else { found.friction.hi }
}

/// Number of harmonics that are examined, the fundamental included.
const ORDERS: usize = 3;

/// The phasors of a sine and its harmonics, and the standard deviation of one of them.
fn harmonics(samples: &[f64], angle: f64) -> Option<(Vec<Complex<f64>>, f64)> {
    // Harmonics above half the sampling rate would alias.
    let orders = (1..=ORDERS).filter(|order| *order as f64 * angle < PI).count();
    let (phasors, residual) = fitted_sines(samples, angle, orders)?;
    // At least the error of whole counts, which is repeated from period to period.
    let n = samples.len();
    let distinct = (n as f64).min(TAU / angle);
    let noise = (2.0 * residual.norm_squared() / (n * n) as f64).sqrt();
    Some((phasors, noise.max((1.0 / (6.0 * distinct)).sqrt())))
}
