//! Remedies: changes with which a rejected scene would pass.

use core::fmt;

use crate::parameter::Parameter;
use crate::text::{Text, push};

/// One number that, changed to any value from `lowest` to `highest`, makes the scene pass.
///
/// The ends are certified with their printed digits, and all values between them are proved to pass. Without
/// such a proof both ends are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// Which number.
    pub parameter: Parameter,
    /// The least value. `None`: the scene passes down to 0; for a period, and for torque, end stops and
    /// number of repetitions of a torque profile, with all values greater than 0.
    pub lowest: Option<f64>,
    /// The greatest value. `None`: the scene passes with any larger value, up to the device's damping if that
    /// is a bound: no device has more passivity than damping, and a larger residual adds damping.
    pub highest: Option<f64>,
}

impl Remedy {
    pub(super) const fn exactly(parameter: Parameter, value: f64) -> Self {
        Self { parameter, lowest: Some(value), highest: Some(value) }
    }

    pub(super) const fn at_least(parameter: Parameter, value: f64) -> Self {
        Self { parameter, lowest: Some(value), highest: None }
    }

    pub(super) const fn write<const N: usize>(&self, t: &mut Text<N>) {
        let (name, unit) = self.parameter.name_and_unit();
        let is_one_value = matches!((self.lowest, self.highest), (Some(a), Some(b)) if a == b);
        match (self.lowest, self.highest) {
            (_, Some(highest)) if is_one_value => push!(*t, {name} " = " {highest}),
            (Some(lowest), Some(highest)) => push!(*t, {lowest} " <= " {name} " <= " {highest}),
            (None, Some(highest)) => push!(*t, {name} " <= " {highest}),
            (Some(lowest), None) => push!(*t, {name} " >= " {lowest}),
            (None, None) => t.push(name),
        }
        t.push_unit(unit);
    }
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = Text::<64>::new();
        self.write(&mut text);
        f.write_str(text.as_str())
    }
}

pub(super) const CANDIDATES: usize = 11;

/// The parameters of the search, in the order of printing. For the device it is the damping, if the passivity
/// is not declared. A torque profile, which has no residual, has its torque in that place; an environment
/// that cancels damping in a sum with a profile has the residual damping in the place of the damping.
pub(super) const ORDER: [Parameter; CANDIDATES] = [
    Parameter::Stiffness,
    Parameter::Damping,
    Parameter::Residual,
    Parameter::Count,
    Parameter::CouplingStiffness,
    Parameter::Period,
    Parameter::Passivity,
    Parameter::OutputDelay,
    Parameter::ActuatorLag,
    Parameter::SensorLag,
    Parameter::Anticogging,
];

/// The values of one number, infinite if a [`Remedy`] has no end.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    lowest: f64,
    highest: f64,
}

impl Range {
    const EMPTY: Self = Self { lowest: f64::INFINITY, highest: f64::NEG_INFINITY };
}

/// The remedies of a rejection, at most one per parameter. As small as possible, because a rejection is
/// returned through the deepest stack of a small board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedies {
    parameters: [Parameter; CANDIDATES],
    ranges: [Range; CANDIDATES],
    is_matched: bool,
}

/// The text for a scene that passes behind the matched coupling.
const MATCHED: &str = "behind the matched coupling";

impl Remedies {
    /// No remedy.
    pub const NONE: Self =
        Self { parameters: ORDER, ranges: [Range::EMPTY; CANDIDATES], is_matched: false };

    #[cfg(test)]
    pub(super) fn of(found: [Remedy; CANDIDATES]) -> Self {
        let mut all = Self::NONE;
        (0..CANDIDATES).for_each(|i| all.put(i, Some(found[i])));
        all.put_matched();
        all
    }

    /// The matched coupling as text, if the scene passes with it in place of its own coupling.
    pub const fn matched(&self) -> Option<&'static str> {
        if self.is_matched { Some(MATCHED) } else { None }
    }

    pub(super) const fn put_matched(&mut self) {
        self.is_matched = true;
    }

    /// The remedies that change a number, in order.
    pub fn iter(&self) -> impl Iterator<Item = Remedy> {
        (0..CANDIDATES).filter_map(|i| self.get(i))
    }

    const fn get(&self, i: usize) -> Option<Remedy> {
        let Range { lowest, highest } = self.ranges[i];
        if lowest > highest {
            return None;
        }
        Some(Remedy {
            parameter: self.parameters[i],
            lowest: if lowest.is_finite() { Some(lowest) } else { None },
            highest: if highest.is_finite() { Some(highest) } else { None },
        })
    }

    pub(super) const fn put(&mut self, i: usize, found: Option<Remedy>) {
        let Some(Remedy { parameter, lowest, highest }) = found else { return };
        self.parameters[i] = parameter;
        self.ranges[i] =
            Range { lowest: or!(lowest, f64::NEG_INFINITY), highest: or!(highest, f64::INFINITY) };
    }

    /// Appends the remedies; returns their number.
    pub(super) const fn write<const N: usize>(&self, t: &mut Text<N>) -> usize {
        let mut written = 0;
        if let Some(matched) = self.matched() {
            t.push("; it would pass ");
            t.push(matched);
            written += 1;
        }
        each!(i in 0..CANDIDATES => {
            if let Some(remedy) = self.get(i) {
                t.push(match (written, self.is_matched) {
                    (0, _) => "; it would pass with ",
                    (1, true) => ", or with ",
                    _ => ", or ",
                });
                remedy.write(t);
                written += 1;
            }
        });
        written
    }
}
