//! What would pass: each rejection's condition inverted for one number at a time.

use core::fmt;

use super::model::Numbers;
use super::parameter::Parameter;
use super::posed::Posed;
use super::rejection::Rejection;
use crate::environment::Environment;
use crate::number::Format;
use crate::scene::{Coupling, Scene};
use crate::text::Text;

/// On which side of its value a remedy holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// `<=`
    AtMost,
    /// `>=`
    AtLeast,
    /// `=`
    Exactly,
}

/// One number that, changed to `value`, makes the scene pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// Which number.
    pub parameter: Parameter,
    /// On which side of the value.
    pub relation: Relation,
    /// Three significant digits (all of them for [`Relation::Exactly`]), certified with this value.
    pub value: f64,
}

impl Remedy {
    const fn write<const N: usize>(&self, t: &mut Text<N>) {
        let (name, unit) = self.parameter.name_and_unit();
        t.push(name);
        t.push(match self.relation {
            Relation::AtMost => " <= ",
            Relation::AtLeast => " >= ",
            Relation::Exactly => " = ",
        });
        t.push_number(self.value);
        t.push(" ");
        t.push(unit);
    }
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = Text::<64>::new();
        self.write(&mut text);
        f.write_str(text.as_str())
    }
}

const CANDIDATES: usize = 6;

/// The remedies of a rejection, at most one a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedies {
    found: [Option<Remedy>; CANDIDATES],
}

impl Remedies {
    /// No remedy.
    pub const NONE: Self = Self { found: [None; CANDIDATES] };

    /// The remedies in order.
    pub fn iter(&self) -> impl Iterator<Item = &Remedy> {
        self.found.iter().flatten()
    }

    pub(super) const fn write<const N: usize>(&self, t: &mut Text<N>) {
        let mut written = 0;
        let mut i = 0;
        while i < CANDIDATES {
            if let Some(remedy) = &self.found[i] {
                t.push(if written == 0 { "; it would pass with " } else { ", or " });
                remedy.write(t);
                written += 1;
            }
            i += 1;
        }
    }
}

/// The rejection with the remedies that there are, where a remedy makes sense.
pub(super) const fn with_remedies(
    rejection: Rejection,
    scene: &Scene,
    format: Format,
) -> Rejection {
    let mut out = rejection;
    match &mut out {
        Rejection::Shortage { remedies, .. }
        | Rejection::Coupling { remedies, .. }
        | Rejection::Undecided { remedies, .. } => *remedies = search(scene, format),
        _ => {}
    }
    out
}

const fn search(scene: &Scene, format: Format) -> Remedies {
    const ORDER: [(Parameter, Relation); CANDIDATES] = [
        (Parameter::Stiffness, Relation::AtMost),
        (Parameter::Damping, Relation::AtMost),
        (Parameter::Residual, Relation::AtLeast),
        (Parameter::CouplingStiffness, Relation::Exactly),
        (Parameter::Period, Relation::AtMost),
        (Parameter::Passivity, Relation::AtLeast),
    ];
    let mut found = Remedies::NONE;
    let mut i = 0;
    while i < CANDIDATES {
        let (parameter, relation) = ORDER[i];
        found.found[i] = match relation {
            Relation::Exactly => standard_coupling(scene, format),
            _ => invert(scene, format, parameter, relation),
        };
        i += 1;
    }
    found
}

/// The standard coupling, `2 delta / T`, if that passes and is not what the scene has.
const fn standard_coupling(scene: &Scene, format: Format) -> Option<Remedy> {
    let numbers = Numbers::of(scene, format);
    if numbers.is_standard {
        return None;
    }
    let parameter = Parameter::CouplingStiffness;
    let value = numbers.delta.double().div(numbers.period).midpoint();
    if is_certified(scene, format, parameter, value) {
        Some(Remedy { parameter, relation: Relation::Exactly, value })
    } else {
        None
    }
}

/// How far a number is moved in the search for a value that passes: by halving or doubling.
const MAX_OCTAVES: u32 = 6;
/// Halvings of the last octave: finer than the three digits that are reported.
const REFINEMENTS: u32 = 10;

/// Looks for the nearest value of one number that passes, by bisection with the certificate
/// itself; rounds it to the safe side and certifies the rounded value.
const fn invert(
    scene: &Scene,
    format: Format,
    parameter: Parameter,
    relation: Relation,
) -> Option<Remedy> {
    let Some(start) = get(scene, parameter) else { return None };
    if start.is_nan() || start <= 0.0 {
        return None;
    }
    let factor = match relation {
        Relation::AtMost => 0.5,
        _ => 2.0,
    };
    // A residual that was not positive starts the search at a small one, which may pass at once.
    let (mut fails, mut passes) = (start, start);
    let mut octave = 0;
    while !is_certified(scene, format, parameter, passes) {
        if octave == MAX_OCTAVES {
            return None;
        }
        (fails, passes) = (passes, passes * factor);
        octave += 1;
        // The smallest numbers halve to zero, which has no digits to round to.
        if passes == 0.0 {
            return None;
        }
    }
    let mut i = 0;
    while i < REFINEMENTS && fails != passes {
        let middle = 0.5 * (fails + passes);
        if is_certified(scene, format, parameter, middle) {
            passes = middle;
        } else {
            fails = middle;
        }
        i += 1;
    }
    let value = three_digits(passes, relation);
    if is_certified(scene, format, parameter, value) {
        Some(Remedy { parameter, relation, value })
    } else {
        None
    }
}

const fn is_certified(scene: &Scene, format: Format, parameter: Parameter, value: f64) -> bool {
    match with(scene, parameter, value) {
        Some(changed) => match Posed::in_format(&changed, format) {
            Ok(posed) => posed.is_certified(),
            Err(_) => false,
        },
        None => false,
    }
}

/// Rounds to three significant digits, away from the values that fail.
const fn three_digits(value: f64, relation: Relation) -> f64 {
    let (mut power, mut scaled) = (1.0, value);
    while scaled < 100.0 {
        scaled *= 10.0;
        power *= 10.0;
    }
    let mut divisor = 1.0;
    while scaled >= 1000.0 {
        scaled /= 10.0;
        divisor *= 10.0;
    }
    let whole = match relation {
        Relation::AtMost => scaled as u64,
        _ => scaled as u64 + 1,
    };
    whole as f64 / power * divisor
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
        ) => Some(if *residual > 0.0 { *residual } else { scene.device.damping / 1024.0 }),
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
