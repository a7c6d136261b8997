//! The scenes that differ in one number, and the nearest of them that passes.

use super::parameter::Parameter;
use super::posed::Posed;
use super::remedy::Relation;
use super::secant::{Bracket, Look, Search};
use crate::environment::Environment;
use crate::number::Format;
use crate::scene::{Coupling, Scene};

/// The factor by which a number is moved at most in the search for a value that passes.
const FARTHEST: f64 = 64.0;
/// How much farther than in proportion to what a scene lacks the first step goes: what it lacks is
/// about in proportion to its numbers, and a step past zero is worth more than one before it.
const FIRST_STEP: f64 = 1.25;
/// The factor of a step where next to nothing is lacking.
const LEAST_STEP: f64 = 1.01;
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

impl Varied<'_> {
    /// The nearest value that passes, to three digits on the side that passes, and certified.
    ///
    /// `own` is what the scene lacks as it is.
    pub const fn nearest(&self, own: Option<f64>) -> Option<f64> {
        let Some(bracket) = self.bracket(own) else { return None };
        let mut search = Search::new(bracket, self.relation);
        while let Some(value) = search.next() {
            search.learn(value, self.shortage(value.value()));
        }
        let mut digits = search.nearest();
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

    /// In a frame of its own, as what follows: a small board's stack has no room for two of them.
    #[inline(never)]
    const fn shortage(&self, value: f64) -> Option<f64> {
        match self.posed(value) {
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
