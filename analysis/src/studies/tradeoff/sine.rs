//! The sine of a sweep, and sine and cosine of a motor's phase: the cost of each method on the emulated
//! board, and its error.
//!
//! Two cases: for the sine of a sweep, with a part of a turn in `f32`, the error is that of the sine; for a
//! phase in 32 bits, that of the torque (`torque_error`).
//!
//! The G4's CORDIC unit is not measured, because no emulator has it. With the unit, the running code would
//! not be the tested code, and would need a board that has it.

use std::f64::consts::TAU;

use firmware_harness::bench_request::{BenchRequest, Output};
use firmware_harness::rotations::{Rotation, unpacked};
use firmware_harness::sines::Sine;

use super::{Axis, Comparison, Method, Tradeoff};
use crate::studies::error::StudyError;
use crate::studies::number_format::Cost;

pub(crate) static COMPARISON: Comparison = Comparison {
    name: "sine",
    title: "Sine of a sweep, and sine and cosine of a phase, on the emulated Cortex-M4",
    cost: Axis::new("instructions", "most instructions"),
    errors: &[Axis::new("error", "largest error (1)")],
    others: &["mean_instructions"],
    kept: include_bytes!("../../../pictures/tradeoff/sine.csv"),
};

/// The number of evenly spread parts of a turn: those of a tone measured over as many samples.
const TURNS: u32 = 4000;

/// The tested parts of a turn.
pub fn turns() -> Vec<f32> {
    (0..TURNS).map(|part| part as f32 / TURNS as f32).collect()
}

/// Largest error of sines, one for each part of a turn, beside those of `f64`.
pub fn error(sines: impl IntoIterator<Item = f64>) -> f64 {
    let pairs = turns().into_iter().zip(sines);
    pairs.fold(0.0, |most, (turn, sine)| (sine - (TAU * f64::from(turn)).sin()).abs().max(most))
}

pub(crate) fn measure() -> Result<Tradeoff, StudyError> {
    let mut board = super::board()?;
    let inputs: Vec<_> = turns().into_iter().map(f32::to_bits).collect();
    let mut methods = Vec::new();
    for sine in Sine::ALL {
        let outputs = board.compute(&BenchRequest::Sine(sine), &inputs)?;
        let family = match sine {
            Sine::Micromath => "micromath",
            Sine::Libm | Sine::LibmDouble => "libm",
            _ => POLYNOMIALS,
        };
        let error = error(outputs.iter().map(|output| output.value));
        methods.push(row("sine", family, sine.as_str(), &outputs, error));
    }
    for rotation in Rotation::ALL {
        let outputs = board.compute(&BenchRequest::Rotation(rotation), &angles())?;
        let family = match rotation {
            Rotation::Micromath => "micromath",
            Rotation::Libm => "libm",
            Rotation::Table => "table",
            Rotation::Cubic | Rotation::Quintic | Rotation::Septic => POLYNOMIALS,
        };
        let error = largest_torque_error(outputs.iter().map(|output| unpacked(output.value)));
        methods.push(row(PHASE, family, rotation.as_str(), &outputs, error));
    }
    board.finish()?;
    Ok(Tradeoff { comparison: &COMPARISON, methods })
}

fn row(case: &str, family: &str, name: &str, outputs: &[Output], error: f64) -> Method {
    let Cost { most, mean } = Cost::of(outputs);
    Method::new(case, family, name, [most.into(), error, mean])
}

const POLYNOMIALS: &str = "polynomials of our own";

/// The case of a motor's phase.
const PHASE: &str = "phase";

/// The tested phases: spread over a turn, at irregular distances from a table's entries.
fn angles() -> Vec<u32> {
    (0..TURNS).map(|k| k.wrapping_mul(2_654_435_769)).collect()
}

/// Largest error of the torque for sines and cosines, one pair for each tested phase.
fn largest_torque_error(pairs: impl IntoIterator<Item = [f32; 2]>) -> f64 {
    let pairs = angles().into_iter().zip(pairs);
    pairs.fold(0.0, |most, (angle, pair)| torque_error(angle, pair).max(most))
}

/// Relative error of the torque of a current loop with this sine and cosine of an angle: it controls the
/// current to be the commanded one across the magnets, as it sees them. With an error of the angle `x` and
/// one of the magnitude `y` it is `cos x/(1 + y) - 1`.
fn torque_error(angle: u32, [sine, cosine]: [f32; 2]) -> f64 {
    let [sine, cosine] = [sine, cosine].map(f64::from);
    let exact = TAU * f64::from(angle) / 2_f64.powi(32);
    let seen = sine * sine + cosine * cosine;
    ((sine * exact.sin() + cosine * exact.cos()) / seen - 1.0).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kept errors are those of the same code here, beside a sine in `f64`.
    #[test]
    fn the_kept_errors_are_those_of_the_host() {
        let sines = Sine::ALL.map(|sine| {
            let error = error(turns().into_iter().map(|turn| f64::from(sine.of_turn(turn))));
            ("sine", sine.as_str(), error)
        });
        let rotations = Rotation::ALL.map(|rotation| {
            let pairs = angles().into_iter().map(|angle| rotation.of_angle(angle));
            (PHASE, rotation.as_str(), largest_torque_error(pairs))
        });
        let here: Vec<_> = sines.into_iter().chain(rotations).collect();
        let kept = Tradeoff::kept(&COMPARISON).unwrap().methods;
        assert_eq!(kept.len(), here.len());
        for ((case, name, here), kept) in here.into_iter().zip(kept) {
            assert_eq!((case, name), (&*kept.case, &*kept.name));
            let there = kept.error(0).unwrap();
            assert!((here / there - 1.0).abs() < 1e-5, "{name}: {here}, {there}");
        }
    }

    /// No costlier method is used if the error of a cheaper one is below a step of the DAC: half a code at
    /// full scale.
    #[test]
    fn the_cheapest_sine_that_no_code_shows_is_used() {
        let kept = Tradeoff::kept(&COMPARISON).unwrap();
        let code = 0.5 / f64::from(haptic_servo::dac::DacCode::CODES_TO_FULL_SCALE);
        for (case, used) in [("sine", Sine::Quintic.as_str()), (PHASE, Rotation::Table.as_str())] {
            let front = kept.front(case, 0);
            let enough = front.iter().find(|method| method.error(0).unwrap() < code).unwrap();
            assert_eq!(enough.name, used);
        }
    }
}
