//! Parts of a record that are not used, and why.

use std::f64::consts::TAU;

use crate::quantity::significant;

/// Fewest periods of a stretch of sine that is used.
pub const LEAST_PERIODS: usize = 4;

/// A tone that is not used, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// In Hz.
    pub frequency: f64,
    /// Its first row, counted from 1.
    pub row: usize,
    /// Why it is not used.
    pub reason: Reason,
}

/// Why a tone is not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// Its frequency is above half the sampling rate.
    Aliased { half_rate: f64 },
    /// It has only so many periods.
    FewPeriods(f64),
    /// Its frequency changes by this factor from its first half to its second.
    Sweep(f64),
    /// It has no torque, or nothing moves.
    Still,
    /// This part of its torque, as a root mean square, is not the sine.
    NotOneSine(f64),
    /// Its motion in counts does not stand out of quantisation and noise.
    Noise(f64),
    /// Friction takes this part of its torque.
    Friction(f64),
}

impl LeftOut {
    /// A tone of this angular frequency in rad/s from this row on, counted from 0.
    pub fn new(omega: f64, row: usize, reason: Reason) -> Self {
        Self { frequency: omega / TAU, row: row + 1, reason }
    }

    fn number(&self) -> f64 {
        match self.reason {
            Reason::Aliased { half_rate } => half_rate,
            Reason::Still => 0.0,
            Reason::NotOneSine(part) | Reason::Friction(part) => 100.0 * part,
            Reason::FewPeriods(number) | Reason::Sweep(number) | Reason::Noise(number) => number,
        }
    }
}

/// Largest number of frequencies that a sentence names.
const MOST: usize = 6;

/// One sentence for each kind of reason, with the frequencies, the first row and the range of its number.
pub fn grouped(left_out: &[LeftOut]) -> Vec<String> {
    let kind = |one: &LeftOut| std::mem::discriminant(&one.reason);
    let mut groups: Vec<Vec<LeftOut>> = Vec::new();
    for one in left_out {
        match groups.iter_mut().find(|group| kind(&group[0]) == kind(one)) {
            Some(group) => group.push(*one),
            None => groups.push(vec![*one]),
        }
    }
    groups.iter().map(|group| sentence(group)).collect()
}

/// The sentence on tones with the same kind of reason.
fn sentence(all: &[LeftOut]) -> String {
    let mut hertz: Vec<f64> = all.iter().map(|one| one.frequency).collect();
    hertz.sort_by(f64::total_cmp);
    hertz.dedup_by(|a, b| significant(*a, 4) == significant(*b, 4));
    let named: Vec<String> = hertz.iter().map(|hertz| significant(*hertz, 4)).collect();
    let (count, row) = (all.len(), all[0].row);
    let tones = match named.as_slice() {
        [only] if count == 1 => format!("the tone of {only} Hz (row {row}) is left out"),
        few if few.len() <= MOST => {
            let names = few.join(", ");
            format!("{count} tones of {names} Hz (the first in row {row}) are left out")
        }
        many => {
            let (least, most) = (&many[0], &many[many.len() - 1]);
            format!("{count} tones from {least} to {most} Hz (the first in row {row}) are left out")
        }
    };
    let numbers = || all.iter().map(LeftOut::number);
    let least = significant(numbers().fold(f64::INFINITY, f64::min), 2);
    let most = significant(numbers().fold(f64::NEG_INFINITY, f64::max), 2);
    let number = if least == most { most } else { format!("{least} to {most}") };
    let reason = match all[0].reason {
        Reason::Aliased { half_rate } => {
            format!("half the sampling rate is {} Hz", significant(half_rate, 4))
        }
        Reason::FewPeriods(_) => {
            format!("{number} of its periods are fewer than {LEAST_PERIODS}")
        }
        Reason::Sweep(_) => format!(
            "its frequency changes by a factor of {number} from its first half to its second; a sweep \
             (chirp) is not a steady sine. Record one frequency after the other"
        ),
        Reason::Still => "it has no torque, or nothing moves".to_owned(),
        Reason::NotOneSine(_) => format!(
            "{number} % of its torque is not this sine; friction acts on the whole motion, so record one \
             sine after the other, not several at once"
        ),
        Reason::Noise(_) => format!(
            "its motion of {number} counts is below quantisation and noise: use a larger torque, or a \
             longer tone"
        ),
        Reason::Friction(_) => {
            format!("friction takes {number} % of its torque: use a larger torque")
        }
    };
    format!("{tones}: {reason}")
}
