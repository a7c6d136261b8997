//! The sine of a sweep: what each means takes on the emulated board, and how far off it is.

use std::f64::consts::TAU;

use firmware_harness::bench_request::{BenchRequest, Output};
use firmware_harness::sines::Sine;

use super::{Axis, Comparison, Method, NUMBER, Tradeoff, TradeoffError};
use crate::table::Column;

/// The comparison.
pub static COMPARISON: Comparison = Comparison {
    name: "sine",
    title: "Sine of a sweep, of a part of a turn in f32, on the emulated Cortex-M4",
    cost: Axis::least(&["instructions"], "most instructions"),
    errors: &[Axis::least(&["error"], "largest error (1)")],
    others: &[Column { names: &["mean_instructions"], bound: NUMBER }],
};

/// Parts of a turn, spread evenly: those of a tone that is measured over as many samples.
const TURNS: u32 = 4000;

/// The parts of a turn that are tried.
pub fn turns() -> Vec<f32> {
    (0..TURNS).map(|part| part as f32 / TURNS as f32).collect()
}

/// Largest error of sines, one for each part of a turn.
pub fn error(sines: impl IntoIterator<Item = f64>) -> f64 {
    let pairs = turns().into_iter().zip(sines);
    pairs.fold(0.0, |most, (turn, sine)| (sine - exact(turn)).abs().max(most))
}

/// The sine in `f64`, of an angle within an eighth of a turn, to which parts of a turn are brought
/// without rounding.
fn exact(turn: f32) -> f64 {
    let eighths = (f64::from(turn) * 8.0).floor();
    let quarters = ((eighths + 1.0) / 2.0).floor();
    let angle = TAU * (f64::from(turn) - quarters / 4.0);
    match quarters as i64 % 4 {
        0 => angle.sin(),
        1 => angle.cos(),
        2 => -angle.sin(),
        _ => -angle.cos(),
    }
}

/// Measures all of them.
///
/// # Errors
/// Where the board cannot be built or fails.
pub fn measure() -> Result<Tradeoff, TradeoffError> {
    let mut board = super::board()?;
    let inputs: Vec<_> = turns().into_iter().map(f32::to_bits).collect();
    let mut methods = Vec::new();
    for sine in Sine::ALL {
        methods.push(row(sine, &board.compute(&BenchRequest::Sine(sine), &inputs)?));
    }
    board.finish()?;
    Ok(Tradeoff { comparison: &COMPARISON, methods })
}

fn row(sine: Sine, outputs: &[Output]) -> Method {
    let instructions = outputs.iter().map(|output| f64::from(output.instructions));
    let most = instructions.clone().fold(0.0, f64::max);
    let mean = instructions.sum::<f64>() / outputs.len() as f64;
    let family = match sine {
        Sine::Micromath => "micromath",
        Sine::Libm | Sine::LibmDouble => "libm",
        Sine::Table => "table",
        _ => "polynomials of our own",
    };
    let error = error(outputs.iter().map(|output| output.value));
    Method::new("sine", family, sine.name(), &[most, error, mean])
}

#[cfg(test)]
mod tests {
    use num_bigint::BigInt;
    use num_traits::ToPrimitive;

    use super::*;
    use crate::table::Table;

    /// The table that is kept.
    fn kept() -> Tradeoff {
        let kept = include_bytes!("../../../pictures/tradeoff/sine.csv");
        Tradeoff::read(&COMPARISON, Table::new("sine.csv", &kept[..]).unwrap()).unwrap()
    }

    /// Binary digits behind the point of the reference.
    const DIGITS: u32 = 160;

    fn one() -> BigInt {
        BigInt::from(1) << DIGITS
    }

    /// pi by Machin's formula.
    fn pi() -> BigInt {
        let arctan_of_one_over = |n: i32| {
            let (mut power, mut sum, mut k) = (one() / n, BigInt::from(0), 1);
            while power != BigInt::from(0) {
                sum += &power / k * (if k % 4 == 1 { 1 } else { -1 });
                power /= n * n;
                k += 2;
            }
            sum
        };
        (arctan_of_one_over(5) * 4 - arctan_of_one_over(239)) * 4
    }

    /// The sine of a part of a turn by its series, in whole numbers.
    fn series(turn: f32) -> f64 {
        // Below 2^-149 no `f32` has a digit.
        let turn = BigInt::from((f64::from(turn) * 2_f64.powi(52)) as i64) << (DIGITS - 52);
        let angle: BigInt = (turn * pi() * 2) >> DIGITS;
        let square: BigInt = (&angle * &angle) >> DIGITS;
        let (mut term, mut sum, mut k) = (angle.clone(), BigInt::from(0), 1);
        while term != BigInt::from(0) {
            sum += &term;
            term = -((term * &square) >> DIGITS) / ((k + 1) * (k + 2));
            // Division rounds to zero, the shift down: a last digit may not go away.
            if term == BigInt::from(-1) {
                break;
            }
            k += 2;
        }
        let shifted: BigInt = sum >> (DIGITS - 62);
        shifted.to_f64().unwrap() * 2_f64.powi(-62)
    }

    #[test]
    fn the_kept_errors_are_those_to_a_sine_of_forty_digits() {
        let kept = kept();
        assert_eq!(kept.methods.len(), Sine::ALL.len());
        let truth: Vec<_> = turns().into_iter().map(series).collect();
        for (sine, kept) in Sine::ALL.into_iter().zip(&kept.methods) {
            let off = turns().into_iter().zip(&truth);
            let error = off.fold(0.0, |most, (turn, truth)| {
                (f64::from(sine.of_turn(turn)) - truth).abs().max(most)
            });
            let kept_error = kept.error(0).unwrap();
            assert_eq!(sine.name(), kept.name);
            assert!((error / kept_error - 1.0).abs() < 1e-5, "{}: {error}", sine.name());
        }
    }

    /// No costlier method is used if the error of a cheaper one is below a DAC step.
    #[test]
    fn the_sweep_has_the_cheapest_sine_that_no_code_shows() {
        let kept = kept();
        let code = 0.5 / f64::from(firmware::dac::DacCode::CODES_TO_FULL_SCALE);
        let front = kept.front("sine", 0);
        let enough = front.iter().find(|method| method.error(0).unwrap() < code).unwrap();
        assert_eq!(enough.name, Sine::Quintic.name());
    }
}
