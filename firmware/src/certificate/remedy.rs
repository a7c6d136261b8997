//! What would pass: each rejection's condition inverted for one number at a time.

use core::fmt;

use super::model::Numbers;
use super::parameter::Parameter;
use super::posed::Posed;
use super::rejection::Rejection;
use super::varied::Varied;
use crate::number::Format;
use crate::scene::Scene;
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
    let own = shortage(scene, format);
    let mut found = Remedies::NONE;
    let mut i = 0;
    while i < CANDIDATES {
        let (parameter, relation) = ORDER[i];
        let varied = Varied { scene, format, parameter, relation };
        let value = match relation {
            Relation::Exactly => standard_coupling(&varied),
            _ => varied.nearest(own),
        };
        if let Some(value) = value {
            found.found[i] = Some(Remedy { parameter, relation, value });
        }
        i += 1;
    }
    found
}

/// What the scene lacks as it is.
#[inline(never)]
const fn shortage(scene: &Scene, format: Format) -> Option<f64> {
    match Posed::in_format(scene, format) {
        Ok(posed) => posed.shortage(),
        Err(_) => None,
    }
}

/// The standard coupling, `2 delta / T`, if that passes and is not what the scene has.
const fn standard_coupling(varied: &Varied) -> Option<f64> {
    let numbers = Numbers::of(varied.scene, varied.format);
    if numbers.is_standard {
        return None;
    }
    let value = numbers.delta.double().div(numbers.period).midpoint();
    if varied.is_certified(value) { Some(value) } else { None }
}
