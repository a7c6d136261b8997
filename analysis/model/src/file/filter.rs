//! Rational environments as the design tools of filters print them: second-order sections, or zeros, poles
//! and a gain.
//!
//! Their product is formed exactly and each coefficient is rounded once, to the double that is certified,
//! simulated and run. Zeros that are exactly 1 are declared, since rounded coefficients would not sum to 0.

use haptic_servo::environment::{Coefficients, MAX_DEGREE, Rational};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

use super::faults::Read;
use super::key::{self, Key};
use super::section::{Found, Section};
use super::tree::Span;

/// Difference of a complex root and its conjugate as they are printed, relative to the larger part.
const CONJUGATE: f64 = 1e-9;

/// The environment of `environment.sections`.
pub fn sections(section: &mut Section<'_>) -> Read<Rational> {
    let delay = section.whole(&key::DELAY_SAMPLES);
    let rows = section.rows(&key::SECTIONS, &[6], "six finite numbers, [b0, b1, b2, a0, a1, a2]");
    let Some(rows) = rows? else { return Err(section.missing(&key::SECTIONS)) };
    let mut function = Function::default();
    for row in &rows {
        let values: Vec<f64> = row.value.iter().map(|number| number.value).collect();
        if values[3] == 0.0 {
            let reason = "has an a0 of 0: its output would precede its input";
            return Err(section.conflict_at(&key::SECTIONS, &row.span, reason));
        }
        // Of a lower order, both end in 0, which is a common factor z.
        let (b, a) = values.split_at(3);
        let len = (1..=3).rev().find(|&len| len == 1 || b[len - 1] != 0.0 || a[len - 1] != 0.0);
        let len = len.unwrap_or(1);
        function.multiply_numerator(&exactly(&b[..len]));
        function.multiply_denominator(&exactly(&a[..len]));
    }
    function.rational(section, &key::SECTIONS, delay?)
}

/// The environment of `environment.zeros`, `poles` and `gain`.
pub fn zeros_poles_gain(section: &mut Section<'_>) -> Read<Rational> {
    let delay = section.whole(&key::DELAY_SAMPLES);
    let (zeros, poles) = (roots(section, &key::ZEROS), roots(section, &key::POLES));
    let gain = section.number(&key::GAIN);
    let (zeros, poles) = (zeros?, poles?);
    let mut function = Function::default();
    function.multiply_numerator(&exactly(&[gain?]));
    zeros.iter().for_each(|factor| function.multiply_numerator(factor));
    poles.iter().for_each(|factor| function.multiply_denominator(factor));
    function.rational(section, &key::POLES, delay?)
}

/// A polynomial in descending powers of z.
type Polynomial = Vec<BigRational>;

fn exactly(values: &[f64]) -> Polynomial {
    // A number of a file is finite.
    values.iter().map(|&value| BigRational::from_float(value).unwrap_or_default()).collect()
}

/// The factors of real coefficients of some roots.
fn roots(section: &mut Section<'_>, key: &Key) -> Read<Vec<Polynomial>> {
    let bound = "a finite number, or two, [real part, imaginary part]";
    let Some(roots) = section.rows(key, &[1, 2], bound)? else {
        return Err(section.missing(key));
    };
    let mut left: Vec<(f64, f64, Span)> = roots
        .into_iter()
        .map(|Found { value, span }| {
            (value[0].value, value.get(1).map_or(0.0, |im| im.value), span)
        })
        .collect();
    let mut factors = Vec::new();
    while let Some((real, imaginary, span)) = left.pop() {
        if imaginary == 0.0 {
            factors.push(exactly(&[1.0, -real]));
            continue;
        }
        let near = CONJUGATE * real.abs().max(imaginary.abs());
        let is_conjugate = |(other, of, _): &(f64, f64, Span)| {
            (other - real).abs() <= near && (of + imaginary).abs() <= near
        };
        let Some(place) = left.iter().position(is_conjugate) else {
            let reason = "is complex, and its conjugate is not in the list";
            return Err(section.conflict_at(key, &span, reason));
        };
        left.swap_remove(place);
        let [re, im] = [real, imaginary].map(|part| exactly(&[part]).remove(0));
        let twice = BigRational::from_integer(BigInt::from(-2)) * &re;
        factors.push(vec![BigRational::one(), twice, &re * &re + &im * &im]);
    }
    Ok(factors)
}

/// A rational function as an exact product.
struct Function {
    numerator: Polynomial,
    denominator: Polynomial,
    /// Zeros that are exactly 1, which the numerator does not have.
    unit_zeros: usize,
}

impl Default for Function {
    fn default() -> Self {
        let one = || vec![BigRational::one()];
        Self { numerator: one(), denominator: one(), unit_zeros: 0 }
    }
}

impl Function {
    fn multiply_numerator(&mut self, factor: &[BigRational]) {
        let mut factor = factor.to_vec();
        let is_zero = factor.iter().all(Zero::is_zero);
        while !is_zero && factor.iter().sum::<BigRational>().is_zero() {
            // Divided by z - 1: each coefficient is the sum of those up to it.
            factor.pop();
            let sums = factor.iter().scan(BigRational::zero(), |sum, c| {
                *sum += c;
                Some(sum.clone())
            });
            factor = sums.collect();
            self.unit_zeros += 1;
        }
        self.numerator = product(&self.numerator, &factor);
    }

    fn multiply_denominator(&mut self, factor: &[BigRational]) {
        self.denominator = product(&self.denominator, factor);
    }

    /// Rounded, in the form that the servo runs.
    fn rational(mut self, section: &Section<'_>, key: &Key, delay: usize) -> Read<Rational> {
        let leading = self.numerator.iter().position(|c| !c.is_zero());
        self.numerator.drain(..leading.unwrap_or(self.numerator.len() - 1));
        let unit_zeros = if leading.is_some() { self.unit_zeros } else { 0 };
        let above = self.numerator.len() - 1 + unit_zeros;
        let below = self.denominator.len() - 1;
        if above.max(below) > MAX_DEGREE {
            let reason = format!(
                "have a product with {above} zeros and {below} poles; there may be at most {MAX_DEGREE} of \
                 each"
            );
            return Err(section.conflict(key, reason));
        }
        let first = self.denominator[0].clone();
        let rounded = |p: &Polynomial| -> Option<Coefficients> {
            let values = p.iter().map(|c| (c / &first).to_f64().filter(|c| c.is_finite()));
            Coefficients::new(&values.collect::<Option<Vec<_>>>()?)
        };
        match (rounded(&self.numerator), rounded(&self.denominator)) {
            (Some(numerator), Some(denominator)) => {
                Ok(Rational { numerator, denominator, delay, unit_zeros })
            }
            _ => {
                let reason = "have a product with a coefficient beyond the range of doubles";
                Err(section.conflict(key, reason))
            }
        }
    }
}

fn product(a: &[BigRational], b: &[BigRational]) -> Polynomial {
    let mut out = vec![BigRational::zero(); a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            out[i + j] += x * y;
        }
    }
    out
}
