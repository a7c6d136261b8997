//! The scenes that differ in one number, and the nearest of them that passes.

use super::digits::Digits;
use super::parameter::Parameter;
use super::posed::Posed;
use super::remedy::Relation;
use crate::environment::Environment;
use crate::number::Format;
use crate::scene::{Coupling, Scene};

/// The factor by which a number is moved at most in the search for a value that passes.
const FARTHEST: f64 = 64.0;
/// Looks inside of the last octave. A secant takes two or three; halving, as where there is no
/// index to draw one by, takes ten to the three digits that are reported.
const MAX_LOOKS: u32 = 14;
/// How much farther than in proportion to what a scene lacks the first step goes: what it lacks is
/// about in proportion to its numbers, and a step past zero is worth more than one before it.
const FIRST_STEP: f64 = 1.25;
/// The factor of a step where next to nothing is lacking.
const LEAST_STEP: f64 = 1.01;
/// Two looks this near to each other, relative to the value, draw a secant that needs no proof that
/// the next digit fails.
const NEAR: f64 = 0.03;
/// Values that are certified in the end: past the one that was found, one more of its last digit
/// each, for what is so near its limit that only the certificate tells.
const CANDIDATES: u32 = 3;

/// A scene with one of its numbers open.
pub(super) struct Varied<'a> {
    pub scene: &'a Scene,
    pub format: Format,
    pub parameter: Parameter,
    /// On which side of a value the scene may pass.
    pub relation: Relation,
}

/// A value of the number, and what the scene lacks with it.
#[derive(Clone, Copy)]
struct Look {
    value: f64,
    /// [`Posed::shortage`]; `None` where the scene cannot be posed, or has none.
    shortage: Option<f64>,
}

impl Look {
    const fn passes(&self) -> bool {
        matches!(self.shortage, Some(shortage) if shortage < 0.0)
    }

    /// Whether the scene lacks exactly as much with another value: the number has no part in it.
    const fn is_as_good_as(&self, other: &Self) -> bool {
        match (self.shortage, other.shortage) {
            (Some(own), Some(others)) => own == others,
            _ => false,
        }
    }
}

/// A value that fails and one that passes.
struct Bracket {
    fails: Look,
    passes: Look,
}

impl Bracket {
    const fn width(&self) -> f64 {
        (self.fails.value - self.passes.value).abs()
    }

    const fn middle(&self) -> f64 {
        0.5 * (self.fails.value + self.passes.value)
    }

    /// Where the straight line through two looks is zero, if the scene lacks more along it towards
    /// the value that fails: next to where it has no index, it can lack ever less.
    const fn zero_of_secant(&self, a: &Look, b: &Look) -> Option<f64> {
        let (Some(at_a), Some(at_b)) = (a.shortage, b.shortage) else { return None };
        let grows_upwards = (at_b > at_a) == (b.value > a.value);
        if at_a == at_b || grows_upwards != (self.fails.value > self.passes.value) {
            return None;
        }
        Some(b.value - at_b * (b.value - a.value) / (at_b - at_a))
    }

    /// Whether a value outside is on the side that passes.
    const fn is_behind(&self, value: f64) -> bool {
        (value <= self.passes.value) == (self.passes.value < self.fails.value)
    }

    const fn contains(&self, value: f64) -> bool {
        let (a, b) = (self.fails.value, self.passes.value);
        (a < value && value < b) || (b < value && value < a)
    }
}

impl Varied<'_> {
    /// The nearest value that passes, to three digits on the side that passes, and certified.
    ///
    /// `own` is what the scene lacks as it is.
    pub const fn nearest(&self, own: Option<f64>) -> Option<f64> {
        let Some(bracket) = self.bracket(own) else { return None };
        let mut digits = self.narrowed(bracket);
        let mut i = 0;
        while i < CANDIDATES {
            if self.is_certified(digits.value()) {
                return Some(digits.value());
            }
            digits = digits.further(self.relation);
            i += 1;
        }
        None
    }

    /// Moves the number by a step, then by octaves, until the scene passes. Both ends are the same
    /// where the first value passes, as that of a residual does that was none before.
    const fn bracket(&self, own: Option<f64>) -> Option<Bracket> {
        let mut passes = match (get(self.scene, self.parameter), self.parameter) {
            (Some(value), _) if value > 0.0 => Look { value, shortage: own },
            (Some(_), Parameter::Residual) => self.look(self.scene.device.damping / 1024.0),
            _ => return None,
        };
        let start = passes;
        let first = match start.shortage {
            Some(shortage) => (LEAST_STEP + FIRST_STEP * shortage).min(2.0),
            None => 2.0,
        };
        let mut fails = passes;
        let mut factor = first;
        while !passes.passes() {
            if factor > FARTHEST || factor > first && passes.is_as_good_as(&fails) {
                return None;
            }
            let value = match self.relation {
                Relation::AtMost => start.value / factor,
                _ => start.value * factor,
            };
            // The smallest numbers are divided to zero, which has no digits to round to.
            if value == 0.0 {
                return None;
            }
            (fails, passes) = (passes, self.look(value));
            factor = if factor < 2.0 { 2.0 } else { 2.0 * factor };
        }
        Some(Bracket { fails, passes })
    }

    /// Narrows a bracket down to neighbours of three digits, and gives the one that passes.
    ///
    /// What a scene lacks is nearly straight over most of its numbers: the secant of the last two
    /// looks meets zero next to where it is. Where two looks have not halved the bracket, it is
    /// halved from then on.
    const fn narrowed(&self, bracket: Bracket) -> Digits {
        let mut bracket = bracket;
        let (mut last, mut previous) = (bracket.passes, bracket.fails);
        // What passes is of three digits from the first look that passes.
        let mut nearest = Digits::of(bracket.passes.value, self.relation);
        let mut has_digits = false;
        let mut width = bracket.width();
        let mut bisects = false;
        let mut looks = 0;
        while looks < MAX_LOOKS {
            if looks % 2 == 0 {
                bisects = bisects || looks > 0 && bracket.width() > 0.5 * width;
                width = bracket.width();
            }
            let zero = if bisects { None } else { bracket.zero_of_secant(&previous, &last) };
            let guess = match zero {
                Some(zero) if bracket.is_behind(zero) => nearest.nearer(self.relation),
                Some(zero) if bracket.contains(zero) => Digits::of(zero, self.relation),
                Some(_) => Digits::of(bracket.fails.value, self.relation),
                None => Digits::of(bracket.middle(), self.relation),
            };
            let is_near = (last.value - previous.value).abs() <= NEAR * last.value;
            let guess = if bracket.contains(guess.value()) {
                guess
            } else if bracket.contains(guess.further(self.relation).value()) {
                guess.further(self.relation)
            } else if has_digits && is_near {
                break;
            } else {
                nearest.nearer(self.relation)
            };
            if !bracket.contains(guess.value()) {
                break;
            }
            (previous, last) = (last, self.look(guess.value()));
            if last.passes() {
                (nearest, has_digits) = (guess, true);
                bracket.passes = last;
            } else {
                bracket.fails = last;
            }
            looks += 1;
        }
        nearest
    }

    /// In a frame of its own, as what follows: a small board's stack has no room for two of them.
    #[inline(never)]
    const fn look(&self, value: f64) -> Look {
        let shortage = match self.posed(value) {
            Some(posed) => posed.shortage(),
            None => None,
        };
        Look { value, shortage }
    }

    /// Whether the scene is certified with this value.
    #[inline(never)]
    pub const fn is_certified(&self, value: f64) -> bool {
        match self.posed(value) {
            Some(posed) => posed.is_certified(),
            None => false,
        }
    }

    #[inline(never)]
    const fn posed(&self, value: f64) -> Option<Posed> {
        let Some(scene) = with(self.scene, self.parameter, value) else { return None };
        match Posed::in_format(&scene, self.format) {
            Ok(posed) => Some(posed),
            Err(_) => None,
        }
    }
}

const fn get(scene: &Scene, parameter: Parameter) -> Option<f64> {
    match (parameter, &scene.environment) {
        (
            Parameter::Stiffness,
            Environment::DelayedSpring(w)
            | Environment::DamperWall(w)
            | Environment::FreeModeWall { wall: w, .. },
        ) => Some(w.stiffness),
        (
            Parameter::Damping,
            Environment::DamperWall(w) | Environment::FreeModeWall { wall: w, .. },
        ) => Some(w.damping),
        (
            Parameter::Residual,
            Environment::FreeMode { residual, .. } | Environment::FreeModeWall { residual, .. },
        ) => Some(*residual),
        (Parameter::Period, _) => match scene.timing.worst_period {
            None => Some(scene.timing.period),
            Some(_) => None,
        },
        (Parameter::Passivity, _) => match scene.device.passivity {
            Some(passivity) => Some(passivity),
            None => Some(scene.device.damping),
        },
        _ => None,
    }
}

const fn with(scene: &Scene, parameter: Parameter, value: f64) -> Option<Scene> {
    let mut changed = *scene;
    match (parameter, &mut changed.environment) {
        (
            Parameter::Stiffness,
            Environment::DelayedSpring(w)
            | Environment::DamperWall(w)
            | Environment::FreeModeWall { wall: w, .. },
        ) => w.stiffness = value,
        (
            Parameter::Damping,
            Environment::DamperWall(w) | Environment::FreeModeWall { wall: w, .. },
        ) => w.damping = value,
        (
            Parameter::Residual,
            Environment::FreeMode { residual, .. } | Environment::FreeModeWall { residual, .. },
        ) => *residual = value,
        (Parameter::CouplingStiffness, _) => {
            changed.coupling = Coupling::Spring { stiffness: value }
        }
        (Parameter::Period, _) => changed.timing.period = value,
        (Parameter::Passivity, _) => changed.device.passivity = Some(value),
        _ => return None,
    }
    Some(changed)
}
