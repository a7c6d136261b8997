//! Any proper rational environment.

use super::delay_line::{DelayLine, VariableDelay};
use super::law::{Discretize, Law, LawContext};
use super::{MAX_DEGREE, MAX_DELAY};
use crate::build_error::BuildError;
use crate::coupling::{Response, Slopes};
use crate::number::Number;

/// Any proper rational `E(z)` up to degree 8, with up to 8 additional samples of delay:
/// `E(z) = z^-delay (z - 1)^unit_zeros numerator(z) / denominator(z)`.
///
/// Zeros at the end of the denominator are also delay, and count as delay if the degree of the numerator is
/// lower by as many.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Rational {
    /// Numerator, descending powers of z.
    pub numerator: Coefficients,
    /// Denominator, descending powers of z.
    pub denominator: Coefficients,
    /// Delay in whole samples.
    pub delay: usize,
    /// Zeros at `z = 1` that multiply the numerator. Declared zeros are exact, even if the coefficients of
    /// the product would not sum to zero in binary.
    pub unit_zeros: usize,
}

/// A polynomial's coefficients in descending powers, at most `MAX_DEGREE + 1` of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Coefficients {
    values: [f64; MAX_DEGREE + 1],
    len: usize,
}

impl Coefficients {
    /// Takes descending coefficients; `None` if there are none or more than `MAX_DEGREE + 1`.
    pub const fn new(descending: &[f64]) -> Option<Self> {
        if descending.is_empty() || descending.len() > MAX_DEGREE + 1 {
            return None;
        }
        let mut values = [0.0; MAX_DEGREE + 1];
        each!(i in 0..descending.len() => {
            values[i] = descending[i];
        });
        Some(Self { values, len: descending.len() })
    }

    /// The coefficients in descending powers.
    pub const fn as_slice(&self) -> &[f64] {
        self.values.split_at(self.len).0
    }

    /// The quotient by `z - root`, with `root` 1 or -1; `None` unless the remainder is zero and nothing was
    /// rounded.
    const fn over_unit_root(&self, root: f64) -> Option<Self> {
        let mut quotient = Self { values: [0.0; MAX_DEGREE + 1], len: self.len - 1 };
        let mut carry = 0.0;
        each!(i in 0..self.len => {
            let Some(sum) = exact_sum(self.values[i], root * carry) else { return None };
            if i < quotient.len {
                quotient.values[i] = sum;
            }
            carry = sum;
        });
        if carry == 0.0 && quotient.len > 0 { Some(quotient) } else { None }
    }

    /// Whether all of them are zero.
    const fn is_zero(&self) -> bool {
        each!(i in 0..self.len => {
            if self.values[i] != 0.0 {
                return false;
            }
        });
        true
    }

    /// The degree; 0 for the zero polynomial.
    const fn degree(&self) -> usize {
        let mut i = 0;
        while i < self.len && self.values[i] == 0.0 {
            i += 1;
        }
        (self.len - i).saturating_sub(1)
    }

    /// The coefficients without leading zeros.
    fn without_leading_zeros(&self) -> &[f64] {
        let leading = self.as_slice().iter().position(|c| *c != 0.0).unwrap_or(self.len);
        self.as_slice().get(leading..).unwrap_or(&[])
    }
}

/// `a + b`; `None` if the sum needs rounding.
const fn exact_sum(a: f64, b: f64) -> Option<f64> {
    let sum = a + b;
    let b_seen = sum - a;
    let error = (a - (sum - b_seen)) + (b - b_seen);
    if error == 0.0 { Some(sum) } else { None }
}

/// The law of a [`Rational`]: direct form II transposed, whose state is one sum per degree.
///
/// With the denominator's leading coefficient divided out and both polynomials in powers of
/// `1/z`: `y = b_0 x + s_1`, then `s_i = b_i x - a_i y + s_(i+1)`.
#[derive(Clone, Debug)]
pub struct RationalLaw<N: Number> {
    feedthrough: N::Coefficient,
    /// `b_i`, `a_i` and `s_i` for i = 1 and up; the first `degree` are used.
    sections: [Section<N>; MAX_DEGREE],
    degree: usize,
    delay: VariableDelay<N>,
}

/// One power of `1/z`.
#[derive(Clone, Copy, Debug)]
struct Section<N: Number> {
    numerator: N::Coefficient,
    denominator: N::Coefficient,
    sum: N,
}

impl<N: Number> RationalLaw<N> {
    #[inline]
    fn torque(&self, x: N) -> N {
        let line = x.times(self.feedthrough);
        match self.sections.first() {
            Some(section) => line.plus(section.sum),
            None => line,
        }
    }
}

impl<N: Number> Law<N> for RationalLaw<N> {
    fn evaluate(&self, x: N) -> Response<N> {
        match self.delay.due() {
            Some(torque) => Response::Held(torque),
            None => Response::Line(self.torque(x)),
        }
    }

    fn update(&mut self, x_e: N) {
        let torque = self.torque(x_e);
        let mut next = N::ZERO;
        for section in self.sections.iter_mut().take(self.degree).rev() {
            let change = x_e.times(section.numerator).minus(torque.times(section.denominator));
            let sum = change.plus(next);
            next = core::mem::replace(&mut section.sum, sum);
        }
        self.delay.push(torque);
    }

    /// At rest at zero for any position of the device: another position would need the gain at rest, a
    /// division that a tick does not have. Boards do not render rational environments, because no known bound
    /// covers their fading in.
    fn rest_at(&mut self, _: N) {
        for section in &mut self.sections {
            section.sum = N::ZERO;
        }
        self.delay.fill(N::ZERO);
    }

    fn slopes(&self) -> Slopes {
        match self.delay.due() {
            Some(_) => Slopes::default(),
            None => Slopes { line: N::coefficient_to_f64(self.feedthrough), wall: 0.0 },
        }
    }
}

impl<N: Number> Discretize<N> for Rational {
    type Law = RationalLaw<N>;

    fn law(&self, _: &LawContext) -> Result<Self::Law, BuildError> {
        let cancelled = self.cancelled();
        let (numerator, above) = cancelled.multiplied_out();
        let denominator = cancelled.denominator.without_leading_zeros();
        let degree = denominator.len().saturating_sub(1);
        let improper = BuildError::Improper { numerator: above, denominator: degree };
        let leading = *denominator.first().ok_or(improper)?;
        if above > degree {
            return Err(improper);
        }
        // Coefficient of z^(degree - i), over the leading one.
        let of = |i: usize| {
            let over = |c: Option<&f64>| c.map_or(0.0, |c| c / leading);
            let b = over(numerator.get(degree.wrapping_sub(i)));
            (b, over(denominator.get(i)))
        };
        let section = |i: usize| -> Result<Section<N>, BuildError> {
            let (b, a) = of(i);
            Ok(Section {
                numerator: BuildError::coefficient::<N>("numerator coefficient", b)?,
                denominator: BuildError::coefficient::<N>("denominator coefficient", a)?,
                sum: N::ZERO,
            })
        };
        let mut sections = [section(MAX_DEGREE + 1)?; MAX_DEGREE];
        for (i, place) in sections.iter_mut().enumerate() {
            *place = section(i + 1)?;
        }
        Ok(RationalLaw {
            feedthrough: BuildError::coefficient::<N>("numerator coefficient", of(0).0)?,
            sections,
            degree,
            delay: VariableDelay::at_rest(cancelled.delay)?,
        })
    }
}

impl Rational {
    /// The quotient of polynomials with these descending coefficients, without a delay; `None` if one has no
    /// coefficients or too many: see [`Coefficients::new`].
    pub const fn of(numerator: &[f64], denominator: &[f64]) -> Option<Self> {
        let (numerator, denominator) =
            (some!(Coefficients::new(numerator)), some!(Coefficients::new(denominator)));
        Some(Self { numerator, denominator, delay: 0, unit_zeros: 0 })
    }

    /// The same transfer function without common factors `z - 1` and `z + 1` of numerator and denominator,
    /// and with its delay separate: this form is certified and runs.
    ///
    /// A common factor is invisible in the transfer function, but in the difference equation it is an
    /// undamped mode that rounding excites.
    pub(crate) const fn cancelled(&self) -> Self {
        let mut out = *self;
        out.cancel(1.0);
        out.cancel(-1.0);
        out.move_delay();
        out
    }

    /// Its total delay in whole samples, in the denominator and declared: the same as of
    /// [`Rational::cancelled`], because cancelled factors add no delay.
    pub(crate) const fn whole_delay(&self) -> usize {
        self.delay + self.poles_at_zero()
    }

    /// Moves poles at `z = 0` from the denominator to the delay, one sample each.
    const fn move_delay(&mut self) {
        let poles = self.poles_at_zero();
        self.denominator.len -= poles;
        self.delay += poles;
    }

    /// The number of poles at `z = 0` that are delay: without them the rest is proper, and the delay can be
    /// stored.
    const fn poles_at_zero(&self) -> usize {
        let zeros = if self.numerator.is_zero() { 0 } else { self.unit_zeros };
        let above =
            self.denominator.degree().saturating_sub(self.numerator.degree().saturating_add(zeros));
        let mut poles = 0;
        while self.delay + poles < MAX_DELAY
            && poles < above
            && self.denominator.values[self.denominator.len - 1 - poles] == 0.0
        {
            poles += 1;
        }
        poles
    }

    const fn cancel(&mut self, root: f64) {
        while !self.numerator.is_zero() {
            let Some(denominator) = self.denominator.over_unit_root(root) else { return };
            if root == 1.0 && self.unit_zeros > 0 {
                self.unit_zeros -= 1;
            } else if let Some(numerator) = self.numerator.over_unit_root(root) {
                self.numerator = numerator;
            } else {
                return;
            }
            self.denominator = denominator;
        }
    }

    /// `(z - 1)^unit_zeros numerator(z)` in *ascending* powers, up to twice the degree that can
    /// run, and its degree.
    fn multiplied_out(&self) -> ([f64; 2 * MAX_DEGREE + 1], usize) {
        let mut product = [0.0; 2 * MAX_DEGREE + 1];
        let given = self.numerator.without_leading_zeros();
        for (place, c) in product.iter_mut().zip(given.iter().rev()) {
            *place = *c;
        }
        let zeros = if given.is_empty() { 0 } else { self.unit_zeros };
        for _ in 0..zeros.min(MAX_DEGREE) {
            // Multiplied by z - 1: the coefficient one power lower, less the coefficient itself.
            let mut lower = 0.0;
            for place in &mut product {
                lower = core::mem::replace(place, lower - *place);
            }
        }
        (product, given.len().saturating_sub(1).saturating_add(zeros))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Rejection, certify};
    use crate::environment::Environment;
    use crate::scene::{Coupling, Scene};
    use crate::test_scene;

    fn rational(numerator: &[f64], denominator: &[f64], unit_zeros: usize) -> Rational {
        Rational { delay: 1, unit_zeros, ..Rational::of(numerator, denominator).unwrap() }
    }

    fn scene(rational: Rational) -> Scene {
        test_scene::scene(Environment::Rational(rational))
    }

    #[test]
    fn common_factors_on_the_circle_are_not_run() {
        let four = rational(&[3.0, 12.0, 18.0, 12.0, 3.0], &[1.0, 4.0, 6.0, 4.0, 1.0], 0);
        assert_eq!(four.cancelled(), rational(&[3.0], &[1.0], 0));
        // A virtual mass: (z - 1)^2 over z (z - 1).
        let mass = rational(&[0.02, -0.04, 0.02], &[1e-6, -1e-6, 0.0], 0);
        assert_eq!(mass.cancelled(), rational(&[0.02, -0.02], &[1e-6, 0.0], 0));
        // A zero that is declared goes first.
        let declared = rational(&[1.0], &[1.0, -1.5, 0.5], 2);
        assert_eq!(declared.cancelled(), rational(&[1.0], &[1.0, -0.5], 1));
        // Nothing is cancelled that is not common, or not to the last bit.
        for kept in [
            rational(&[1.0, -1.0], &[1.0, 1.0], 0),
            rational(&[0.1, 0.8, 0.7], &[1.0, 1.5, 0.5], 0),
            rational(&[0.0], &[1.0, -1.0], 0),
        ] {
            assert_eq!(kept.cancelled(), kept);
        }
        for environment in [four, mass, declared] {
            let law = Discretize::<f64>::law(&environment, &setting()).unwrap();
            assert!(
                law.sections[..law.degree]
                    .iter()
                    .all(|section| { section.denominator.abs() <= 0.5 })
            );
        }
    }

    #[test]
    fn zeros_at_the_end_of_the_denominator_are_delay() {
        let written = |zeros: usize, delay| {
            let mut denominator = vec![1.0, -0.5];
            denominator.resize(2 + zeros, 0.0);
            Rational { delay, ..rational(&[8.0, -2.0], &denominator, 0) }
        };
        for (zeros, delay, left, whole) in [
            (0, 0, 0, 0),
            (1, 0, 0, 1),
            (3, 2, 0, 5),
            (7, 1, 0, 8),
            // What cannot be stored stays where it is.
            (7, 8, 7, 8),
            (5, 5, 2, 8),
        ] {
            assert_eq!(written(zeros, delay).cancelled(), written(left, whole));
            let environment = Environment::Rational(written(zeros, delay));
            assert_eq!((environment.delay(), environment.is_late()), (whole, whole > 0));
        }
        // As many degrees as the numerator has stay, declared zeros among them.
        let proper = rational(&[8.0, -2.0], &[1.0, 0.0, 0.0, 0.0], 1);
        let left = Rational { delay: 2, ..rational(&[8.0, -2.0], &[1.0, 0.0, 0.0], 1) };
        assert_eq!(proper.cancelled(), left);
    }

    /// Any degree up to eight, and any delay on top of it, in the denominator or beside it.
    #[test]
    fn eight_samples_of_delay_fit_on_top_of_degree_eight() {
        let mut poles = [0.0; MAX_DEGREE + 1];
        (poles[0], poles[MAX_DEGREE]) = (1.0, 1e-3);
        let zeros = [0.4, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.05];
        for coupling in [44.0, 30.0, 60.0] {
            for delay in 0..=MAX_DELAY {
                let environment = Rational { delay, ..rational(&zeros, &poles, 0) };
                let scene = Scene {
                    coupling: Coupling::Spring { stiffness: coupling },
                    ..scene(environment)
                };
                assert_eq!(certify(&scene).map(|_| ()), Ok(()), "{coupling}, {delay}");
                assert!(Discretize::<f32>::law(&environment, &setting()).is_ok());
            }
        }
    }

    fn setting() -> LawContext {
        test_scene::scene(()).context()
    }

    /// A high-pass filter holds nothing at rest: coefficients that sum to 0 are a zero at 1, declared or not,
    /// behind any coupling.
    #[test]
    fn a_zero_at_one_needs_no_declaration() {
        let written = rational(&[0.7547627247472144, -0.7547627247472144], &[1.0, -0.51], 0);
        let declared = rational(&[0.7547627247472144], &[1.0, -0.51], 1);
        for coupling in [Coupling::Rigid, Coupling::Spring { stiffness: 30.0 }, Coupling::Matched] {
            for environment in [written, declared] {
                for delay in [0, 1] {
                    let scene = Scene { coupling, ..scene(Rational { delay, ..environment }) };
                    assert_eq!(certify(&scene).map(|_| ()), Ok(()), "{scene:?}");
                }
            }
        }
        // They do not sum to 0 in binary: the pole at 1 stays, with a residue that may have either sign.
        let near = rational(&[0.1, 0.2, -0.3], &[1.0, -0.5, 0.0], 0);
        assert!(certify(&scene(near)).is_err());
    }

    #[test]
    fn a_common_pair_on_the_circle_is_refused() {
        let pair = rational(&[2.5, -3.125, 2.5], &[1.0, -1.25, 1.0], 0);
        let rejection = certify(&scene(pair)).unwrap_err();
        assert!(matches!(rejection, Rejection::HiddenMode { .. }), "{rejection}");
        assert_eq!(rejection.reason(), "residue_angle");
        assert!(rejection.to_string().contains("divide both by that factor"), "{rejection}");
        // The same without it is a spring.
        assert!(certify(&scene(rational(&[2.5], &[1.0], 0))).is_ok());
    }
}
