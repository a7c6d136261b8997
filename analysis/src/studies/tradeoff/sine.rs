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

use super::{Axis, Comparison, Method, NUMBER, Tradeoff, TradeoffError};
use crate::table::Column;

/// The comparison.
pub static COMPARISON: Comparison = Comparison {
    name: "sine",
    title: "Sine of a sweep, and sine and cosine of a phase, on the emulated Cortex-M4",
    cost: Axis::least(&["instructions"], "most instructions"),
    errors: &[Axis::least(&["error"], "largest error (1)")],
    others: &[Column { names: &["mean_instructions"], bound: NUMBER }],
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

/// Measures all methods.
///
/// # Errors
/// If the board's program cannot be built or the board fails.
pub fn measure() -> Result<Tradeoff, TradeoffError> {
    let mut board = super::board()?;
    let inputs: Vec<_> = turns().into_iter().map(f32::to_bits).collect();
    let mut methods = Vec::new();
    for sine in Sine::ALL {
        methods.push(row(sine, &board.compute(&BenchRequest::Sine(sine), &inputs)?));
    }
    for rotation in Rotation::ALL {
        let outputs = board.compute(&BenchRequest::Rotation(rotation), &angles())?;
        methods.push(phase_row(rotation, &outputs));
    }
    board.finish()?;
    Ok(Tradeoff { comparison: &COMPARISON, methods })
}

fn row(sine: Sine, outputs: &[Output]) -> Method {
    let [most, mean] = instructions(outputs);
    let family = match sine {
        Sine::Micromath => "micromath",
        Sine::Libm | Sine::LibmDouble => "libm",
        _ => POLYNOMIALS,
    };
    let error = error(outputs.iter().map(|output| output.value));
    Method::new("sine", family, sine.name(), &[most, error, mean])
}

fn phase_row(rotation: Rotation, outputs: &[Output]) -> Method {
    let [most, mean] = instructions(outputs);
    let family = match rotation {
        Rotation::Micromath => "micromath",
        Rotation::Libm => "libm",
        Rotation::Table => "table",
        Rotation::Cubic | Rotation::Quintic | Rotation::Septic => POLYNOMIALS,
    };
    let pairs = angles().into_iter().zip(outputs.iter().map(|output| unpacked(output.value)));
    let error = pairs.fold(0.0, |most, (angle, pair)| torque_error(angle, pair).max(most));
    Method::new(PHASE, family, rotation.name(), &[most, error, mean])
}

const POLYNOMIALS: &str = "polynomials of our own";

/// The case of a motor's phase.
const PHASE: &str = "phase";

/// Largest number of instructions, and their mean.
fn instructions(outputs: &[Output]) -> [f64; 2] {
    let instructions = outputs.iter().map(|output| f64::from(output.instructions));
    let most = instructions.clone().fold(0.0, f64::max);
    [most, instructions.sum::<f64>() / outputs.len() as f64]
}

/// The tested phases: spread over a turn, at irregular distances from a table's entries.
fn angles() -> Vec<u32> {
    (0..TURNS).map(|k| k.wrapping_mul(2_654_435_769)).collect()
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

    fn kept() -> Tradeoff {
        Tradeoff::kept(&COMPARISON).unwrap()
    }

    /// The kept errors are those of the same code here, beside a sine in `f64`.
    #[test]
    fn the_kept_errors_of_a_sweep_are_those_of_the_host() {
        let kept = kept();
        assert_eq!(kept.methods.len(), Sine::ALL.len() + Rotation::ALL.len());
        for (sine, kept) in Sine::ALL.into_iter().zip(&kept.methods) {
            let here = error(turns().into_iter().map(|turn| f64::from(sine.of_turn(turn))));
            let there = kept.error(0).unwrap();
            assert_eq!(sine.name(), kept.name);
            assert!((here / there - 1.0).abs() < 1e-5, "{}: {here}, {there}", sine.name());
        }
    }

    /// No costlier method is used if the error of a cheaper one is below a DAC step.
    #[test]
    fn the_sweep_has_the_cheapest_sine_that_no_code_shows() {
        let kept = kept();
        let code = 0.5 / f64::from(haptic_servo::dac::DacCode::CODES_TO_FULL_SCALE);
        let front = kept.front("sine", 0);
        let enough = front.iter().find(|method| method.error(0).unwrap() < code).unwrap();
        assert_eq!(enough.name, Sine::Quintic.name());
    }

    /// The kept errors of the torque are those of the same code here.
    #[test]
    fn the_kept_errors_of_a_phase_are_those_of_the_host() {
        let kept = kept();
        for (rotation, kept) in Rotation::ALL.into_iter().zip(&kept.methods[Sine::ALL.len()..]) {
            let here = angles()
                .into_iter()
                .fold(0.0, |most, angle| torque_error(angle, rotation.of_angle(angle)).max(most));
            let there = kept.error(0).unwrap();
            assert_eq!((rotation.name(), PHASE), (&*kept.name, &*kept.case));
            assert!((here / there - 1.0).abs() < 1e-5, "{}: {here}, {there}", rotation.name());
        }
    }

    /// As for the sweep: half a code at full scale.
    #[test]
    fn a_phase_has_the_cheapest_sine_that_no_code_shows() {
        let kept = kept();
        let code = 0.5 / f64::from(haptic_servo::dac::DacCode::CODES_TO_FULL_SCALE);
        let front = kept.front(PHASE, 0);
        let enough = front.iter().find(|method| method.error(0).unwrap() < code).unwrap();
        assert_eq!(enough.name, Rotation::Table.name());
    }
}
