//! The least energy of a periodic motion of a linear loop whose torques jitter in a pattern.
//!
//! A hand that varies in time can impose any motion, and gets what device and controller together do not take. So
//! this finds what no hand of masses, dampers and springs shows. Period and passivity are 1 here.

use std::f64::consts::PI;

use haptic_servo::certificate::{LoopTransfers, PassivityProblem};
use haptic_servo::number::Format;
use haptic_servo::passivity::polynomial::Polynomial;
use haptic_servo::passivity::transfer::Transfer;
use haptic_servo::scene::{Latency, Scene};
use nalgebra::{Complex, DMatrix};

/// Parts of a tick with a constant velocity each.
const CELLS: usize = 12;
/// Ticks of the pattern: torques are alternately late and early.
const TICKS: usize = 2;
/// Angles by which a motion turns from one repetition of the pattern to the next: from half a turn on, each this
/// part of the one before. Motions near rest and near half of the sampling rate matter most.
const ANGLES: i32 = 24;
const NEXT: f64 = 0.75;
/// Ticks that a torque may be late.
const LATEST: i32 = 12;

/// The least energy that device and controller take from a motion in an instant, over that of the device alone, for
/// a device of this passivity in N m s/rad. `None` where the loop is not linear or anything but the torques deviates.
pub fn least_energy(
    scene: &Scene,
    format: Format,
    latency: &Latency,
    passivity: f64,
) -> Option<f64> {
    if PassivityProblem::in_format(scene, format).ok()?.bound().is_some() {
        return None;
    }
    let period = scene.timing.period;
    let delay = latency.output_delay;
    let only = Latency { output_jitter: latency.output_jitter, ..Latency::delayed(delay.most) };
    let [delay, jitter] = [delay.most, latency.output_jitter].map(|time| time / period);
    if *latency != only || jitter == 0.0 || delay + jitter > f64::from(LATEST - 1) {
        return None;
    }
    let controller = LoopTransfers::in_format(scene, format).ok()?.controller;
    let begins = |tick: i32| {
        let late = if tick.rem_euclid(2) == 0 { jitter } else { -jitter };
        f64::from(tick) + delay + late
    };
    let held: Vec<_> = (-LATEST..TICKS as i32).map(|tick| (tick, held(tick, begins))).collect();
    (0..ANGLES)
        .map(|k| {
            let turn = PI * NEXT.powi(k);
            let gain = |z| at(&controller, z) * (period / passivity);
            energies(turn, &held, gain).symmetric_eigenvalues().min()
        })
        .reduce(f64::min)
}

/// The time in which a torque is that of a tick: until a later one begins.
fn held(tick: i32, begins: impl Fn(i32) -> f64) -> (f64, f64) {
    let end = (tick + 1..tick + 4).map(&begins).fold(f64::INFINITY, f64::min);
    (begins(tick), end)
}

/// The energy of velocities in the cells of a pattern, which turn by an angle with each repetition, as a Hermitian
/// form over the square of the velocities.
fn energies(
    turn: f64,
    held: &[(i32, (f64, f64))],
    gain: impl Fn(Complex<f64>) -> Complex<f64>,
) -> DMatrix<Complex<f64>> {
    let one = Complex::from(1.0);
    let turned = |times: i32| Complex::from_polar(1.0, turn * f64::from(times));
    // Of a sequence with this turn in two ticks: the two frequencies that it consists of.
    let z = Complex::from_polar(1.0, 0.5 * turn);
    let gains = [gain(z), gain(-z)];
    let width = 1.0 / CELLS as f64;
    let mut torques = DMatrix::zeros(TICKS * CELLS, TICKS * CELLS);
    for cell in 0..TICKS * CELLS {
        // Positions at the first two counts by a unit of velocity in this cell.
        let first = Complex::from(width) / (turned(1) - one);
        let second = if cell < CELLS { first + width } else { first };
        let parts = [(first + second / z) * 0.5, (first - second / z) * 0.5];
        let of_tick = |tick: i32| {
            let even = gains[0] * parts[0] + gains[1] * parts[1];
            let odd = z * (gains[0] * parts[0] - gains[1] * parts[1]);
            turned(tick.div_euclid(2)) * if tick.rem_euclid(2) == 0 { even } else { odd }
        };
        for &(tick, (from, to)) in held {
            let torque = of_tick(tick);
            for other in 0..TICKS * CELLS {
                let begin = other as f64 * width;
                let shared = (to.min(begin + width) - from.max(begin)).max(0.0) / width;
                torques[(other, cell)] += torque * shared;
            }
        }
    }
    let half = Complex::from(0.5);
    DMatrix::identity(TICKS * CELLS, TICKS * CELLS) + (&torques + torques.adjoint()) * half
}

/// A transfer function at a point.
pub fn at(f: &Transfer, z: Complex<f64>) -> Complex<f64> {
    let sum = |p: &Polynomial| {
        (0..p.len()).rev().fold(Complex::from(0.0), |sum, i| sum * z + p.coefficient(i).midpoint())
    };
    let powers = z.powi(f.shift) * (z - 1.0).powi(f.ones) * (z + 1.0).powi(f.minus_ones);
    powers * sum(&f.numerator) / sum(&f.denominator) * f.scale.midpoint()
}
