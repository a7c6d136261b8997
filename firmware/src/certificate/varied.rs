//! Scenes that differ in one number, and the search for the passing ones.

use super::between::{Between, between};
use super::digits::{Digits, Side};
use super::problem::PassivityProblem;
use super::remedy::Remedy;
use super::secant::{Bracket, Look, Search};
use crate::number::Format;
use crate::parameter::Parameter;
use crate::scene::Scene;

/// The factor by which a number is moved at most in the search for a value that passes.
pub(super) const FARTHEST: f64 = 64.0;
/// Factor on the first step, which is proportional to the missing passivity: the shortage is about linear in
/// the numbers, and a step beyond the root is more useful than one before it.
const FIRST_STEP: f64 = 1.25;
/// The factor of a step if almost no passivity is missing.
const LEAST_STEP: f64 = 1.01;
/// More repetitions than any turn has.
const MOST_REPETITIONS: f64 = 1e6;
/// Smallest share of the anticogging that is looked at, and halvings between two shares: three digits.
const LEAST_SHARE: f64 = 1e-3;
const HALVINGS: u32 = 12;
/// Number of values to certify at the end: the value found, and then with its last digit changed by one each
/// time, because close to a limit only the certificate decides.
const CANDIDATES: u32 = 3;

/// A scene with one variable number.
pub(super) struct Varied<'a> {
    pub scene: &'a Scene,
    pub format: Format,
    pub parameter: Parameter,
}

impl Varied<'_> {
    /// The passing values, from the nearest on: to three digits on the passing side, and certified.
    ///
    /// `own` is the scene's shortage.
    pub const fn remedy(&self, own: Option<f64>) -> Option<Remedy> {
        let parameter = self.parameter;
        let side = match parameter {
            Parameter::Residual => Side::Above,
            _ => Side::Below,
        };
        let Some(bracket) = self.bracket(own, side) else { return None };
        let Some(nearest) = self.searched(bracket, side) else { return None };
        let other = self.other_end(nearest);
        Some(match side {
            Side::Below => Remedy { parameter, lowest: other, highest: Some(nearest) },
            Side::Above => Remedy { parameter, lowest: Some(nearest), highest: other },
        })
    }

    /// The other end of the range that is proved to pass, from the nearest value on; `None` if the range has
    /// no other end, and the same value if nothing else is proved.
    pub const fn other_end(&self, nearest: f64) -> Option<f64> {
        let last = match (between(self.scene, self.format, self.parameter, nearest), self.parameter)
        {
            (Between::Unknown, _) => return Some(nearest),
            (Between::PassesDownToZero, _) => return None,
            (Between::PassesDownToZeroWithoutStiffness, _) => {
                let soft = Self { parameter: Parameter::Stiffness, ..*self };
                if soft.is_certified(0.0) {
                    return None;
                }
                nearest / FARTHEST
            }
            (Between::Passes, Parameter::Period) => nearest / FARTHEST,
            // A residual above the device's damping would add damping.
            (Between::Passes, Parameter::Residual) if nearest >= self.scene.device.damping => {
                return Some(nearest);
            }
            (Between::Passes, Parameter::Residual) => self.scene.device.damping,
            (Between::Passes, _) => 0.0,
        };
        if matches!(self.parameter, Parameter::Period) {
            let digits = Digits::of(last, Side::Above);
            if self.is_certified(digits.value()) {
                return Some(digits.value());
            }
        } else if self.is_certified(last) {
            return None;
        }
        let (fails, passes) = (self.look(last), self.look(nearest));
        if fails.passes() || !passes.passes() {
            return Some(nearest);
        }
        let side = if last < nearest { Side::Above } else { Side::Below };
        match self.searched(Bracket { fails, passes }, side) {
            Some(end) if (end < nearest) == (last < nearest) => Some(end),
            _ => Some(nearest),
        }
    }

    /// The largest passing number of repetitions in a turn. With fewer a profile is less steep, so it passes
    /// with all smaller numbers.
    pub const fn fewer_repetitions(&self) -> Option<Remedy> {
        let Some(profile) = self.scene.environment.profile() else { return None };
        if !profile.outline().wraps || profile.count > MOST_REPETITIONS {
            return None;
        }
        let mut fails = profile.count as u32;
        let mut passes = (profile.count / FARTHEST) as u32;
        if passes == 0 {
            passes = 1;
        }
        if !self.is_certified(passes as f64) {
            return None;
        }
        while fails > passes + 1 {
            let middle = passes + (fails - passes) / 2;
            if self.is_certified(middle as f64) { passes = middle } else { fails = middle }
        }
        if passes as f64 >= profile.count {
            return None;
        }
        Some(Remedy { parameter: self.parameter, lowest: None, highest: Some(passes as f64) })
    }

    /// The largest passing share of the anticogging, bisected by verdicts: behind a coupling the shortage does not tell
    /// how near a share is. With less of it more passivity is left for the scene, and less of a mean torque.
    pub const fn smaller_share(&self) -> Option<f64> {
        let mut fails = some!(self.scene.get(self.parameter));
        let mut passes = 0.5 * fails;
        while !self.is_certified(passes) {
            if passes < LEAST_SHARE {
                return None;
            }
            (fails, passes) = (passes, 0.5 * passes);
        }
        each!(_i in 0..HALVINGS => {
            let middle = 0.5 * (fails + passes);
            if self.is_certified(middle) { passes = middle } else { fails = middle }
        });
        self.certified(Digits::of(passes, Side::Below), Side::Below)
    }

    /// The passing value in a bracket that is nearest to the failing values, to three digits and certified.
    const fn searched(&self, bracket: Bracket, side: Side) -> Option<f64> {
        let mut search = Search::new(bracket, side);
        while let Some(value) = search.next() {
            search.learn(value, self.shortage(value.value()));
        }
        self.certified(search.nearest(), side)
    }

    /// The first certified value from these digits on, moving to the passing side.
    pub const fn certified(&self, digits: Digits, side: Side) -> Option<f64> {
        let mut digits = digits;
        let mut i = 0;
        while i < CANDIDATES && digits.are_read_back() {
            if self.is_certified(digits.value()) {
                return Some(digits.value());
            }
            digits = digits.further(side);
            i += 1;
        }
        None
    }

    /// Moves the number by a step, then by octaves, until the scene passes. Both ends are equal if the first
    /// value passes, like that of a new residual.
    const fn bracket(&self, own: Option<f64>, side: Side) -> Option<Bracket> {
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
            let value = match side {
                Side::Below => start.value / factor,
                Side::Above => start.value * factor,
            };
            // The smallest numbers are divided down to zero, which has no digits.
            if value == 0.0 {
                return None;
            }
            (fails, passes) = (passes, self.look(value));
            factor = if factor < 2.0 { 2.0 } else { 2.0 * factor };
        }
        Some(Bracket { fails, passes })
    }

    /// Not inlined, like the next functions: a small board's stack has no room for two such frames.
    #[inline(never)]
    const fn shortage(&self, value: f64) -> Option<f64> {
        match &self.posed(value) {
            Some(posed) => posed.shortage(),
            None => None,
        }
    }

    const fn look(&self, value: f64) -> Look {
        Look { value, shortage: self.shortage(value) }
    }

    /// Whether the scene is certified with this value.
    #[inline(never)]
    pub const fn is_certified(&self, value: f64) -> bool {
        match &self.posed(value) {
            Some(posed) => posed.is_certified(),
            None => false,
        }
    }

    #[inline(never)]
    const fn posed(&self, value: f64) -> Option<PassivityProblem> {
        let Some(scene) = self.scene.with(self.parameter, value) else { return None };
        let Ok(posed) = PassivityProblem::in_format(&scene, self.format) else { return None };
        Some(posed)
    }
}

/// The starting value of a search; `None` if a change of the number would change other numbers, like a period
/// with a worst period.
const fn get(scene: &Scene, parameter: Parameter) -> Option<f64> {
    match (parameter, scene.timing.worst_period) {
        (Parameter::Period, Some(_)) => None,
        _ => scene.get(parameter),
    }
}
