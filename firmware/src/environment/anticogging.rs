//! Anticogging: the torque that opposes a motor's cogging, read from a learnt table over a turn of the encoder.
//!
//! It acts outside of the coupling, on the measured position: the coupling and the environment behind it know
//! nothing of it. It is a torque profile without ends, with the profile's arithmetic (theory, section 18.6, equation 71).

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

use super::delay_line::DelayLine;
use super::law::{Law, LawContext, LawOf};
use super::profile::{FULL_SCALE, Layout, NoSnap, Outline, Profile, ProfileLaw};
use super::turn::Turn;
use super::velocity::NoDamping;
use crate::build_error::BuildError;
use crate::coupling::Response;
use crate::number::Number;
use crate::parameter::Parameter;
use crate::text::{Sentence, sentences};
use crate::torque::{LimitReason, Limiter};

/// A table of a motor's cogging, which stays in flash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoggingMap<const ANGLES: usize> {
    units: [i16; ANGLES],
    numbers: Numbers,
}

/// The numbers of a table, computed once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
struct Numbers {
    /// Number of angles.
    angles: u32,
    /// The largest rise and the largest fall from one angle to the next, in units.
    steps: [i32; 2],
    /// Torque in N m of a knot at full scale.
    torque: f64,
    /// Bound on the magnitude of the mean of the table, clipped at any level, in its units.
    mean: u32,
    #[cfg_attr(feature = "wire", serde(skip))]
    checksum: u32,
}

impl<const ANGLES: usize> CoggingMap<ANGLES> {
    /// The cogging torque in N m, positive in the direction of the angle, at equally spaced angles of a turn of
    /// the encoder, the first at its zero. Their mean stays as it was learnt: the mean over the angle of the
    /// encoder is not that over the angle of the device.
    ///
    /// # Panics
    /// If there is no such map; in a constant this is a compile error.
    #[track_caller]
    pub const fn of(torques: &[f64; ANGLES]) -> Self {
        let mut units = [0; ANGLES];
        match Numbers::sample(torques, &mut units) {
            Ok(numbers) => Self { units, numbers },
            Err(error) => error.refuse(),
        }
    }
}

sentences! {
    /// The reason why torques are no map of a motor's cogging.
    CoggingError: Sentence {
    Angles { angles: usize, least: usize, most: usize } => (
        "a map has a power of two of torques, from " {least} " to " {most} ", and not " {angles}),
    NotFinite { angle: usize } => ("the torque at angle " {angle} " (from 0) is not finite"),
    Flat => ("all torques of the map are 0: leave it out"),
    }
}

impl Numbers {
    const LEAST: usize = 8;
    /// Places in a turn fit 32 bits.
    const MOST: usize = super::MOST_KNOTS as usize;

    const fn sample(torques: &[f64], units: &mut [i16]) -> Result<Self, CoggingError> {
        let angles = torques.len();
        if !angles.is_power_of_two() || angles < Self::LEAST || angles > Self::MOST {
            return Err(CoggingError::Angles { angles, least: Self::LEAST, most: Self::MOST });
        }
        let mut torque = 0.0;
        each!(angle in 0..angles => {
            if !torques[angle].is_finite() {
                return Err(CoggingError::NotFinite { angle });
            }
            torque = torques[angle].abs().max(torque);
        });
        if torque == 0.0 {
            return Err(CoggingError::Flat);
        }
        each!(angle in 0..angles => {
            let unit = torques[angle] / torque * FULL_SCALE as f64;
            units[angle] = (unit + if unit < 0.0 { -0.5 } else { 0.5 }) as i16;
        });
        let outline = Outline::of(units, true);
        let mean = if outline.is_odd { 0 } else { clipped_mean(units) };
        let steps = [outline.rise, outline.fall];
        Ok(Self { angles: angles as u32, steps, torque, mean, checksum: checksum(units) })
    }
}

/// Bound on the magnitude of the mean of a piecewise linear table, clipped at any level, in its units.
///
/// The means `A` above zero and `B` below it of the clipped table grow with the level and are concave. So between two
/// levels `A - B` is at most `A` on the line through the two levels before, less `B` on its chord: no more than at
/// the lower level, or than this line and `B` at the upper one.
const fn clipped_mean(units: &[i16]) -> u32 {
    /// From one level to the next; eight of them are above all units.
    const STEP: i64 = 2048;
    let mut here = [0, 0];
    let mut steps = steps_from_zero(units, STEP);
    let mut largest = 0;
    let mut level = 0;
    while level < FULL_SCALE as i64 {
        level += STEP;
        let next = clipped_means(units, level);
        let bounds = [
            here[0] - here[1],
            here[1] - here[0],
            here[0] + steps[0] - next[1],
            here[1] + steps[1] - next[0],
        ];
        each!(i in 0..bounds.len() => {
            largest = if bounds[i] > largest { bounds[i] } else { largest };
        });
        steps = [next[0] - here[0], next[1] - here[1]];
        here = next;
    }
    // Each mean is rounded down by less than two units, and two of them are added in a bound.
    largest as u32 + 4
}

/// The parts of a turn in which a table is above zero and below, times `step`, rounded up: no mean rises faster.
const fn steps_from_zero(units: &[i16], step: i64) -> [i64; 2] {
    let mut sums = [0, 0];
    each!(i in 0..units.len() => {
        let (from, to) = (units[i] as i64, units[(i + 1) % units.len()] as i64);
        let (low, high) = if from < to { (from, to) } else { (to, from) };
        sums[0] += above_zero(low, high, step);
        sums[1] += above_zero(-high, -low, step);
    });
    let angles = units.len() as i64;
    [sums[0] / angles + 1, sums[1] / angles + 1]
}

const fn above_zero(low: i64, high: i64, step: i64) -> i64 {
    if high <= 0 {
        0
    } else if low >= 0 {
        step
    } else {
        step * high / (high - low) + 1
    }
}

/// The means above and below zero of a table clipped at this level, rounded down.
const fn clipped_means(units: &[i16], level: i64) -> [i64; 2] {
    let mut sums = [0, 0];
    each!(i in 0..units.len() => {
        let (from, to) = (units[i] as i64, units[(i + 1) % units.len()] as i64);
        sums[0] += clipped(from, to, level);
        sums[1] += clipped(-from, -to, level);
    });
    let angles = units.len() as i64;
    [sums[0] / angles, sums[1] / angles]
}

/// Mean of a line from one value to another, clipped to `0..=level`, rounded down.
const fn clipped(from: i64, to: i64, level: i64) -> i64 {
    if from == to {
        return if from < 0 { 0 } else { min(from, level) };
    }
    let (low, high) = if from < to { (from, to) } else { (to, from) };
    (twice_area(high, level) - twice_area(low, level)) / (2 * (high - low))
}

/// Twice the integral from 0 to `value` of a number clipped to `0..=level`.
const fn twice_area(value: i64, level: i64) -> i64 {
    let inside = min(if value < 0 { 0 } else { value }, level);
    inside * inside + 2 * level * (if value > level { value - level } else { 0 })
}

const fn min(a: i64, b: i64) -> i64 {
    if a < b { a } else { b }
}

const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

const fn checksum(units: &[i16]) -> u32 {
    let mut digest = CRC.digest();
    each!(i in 0..units.len() => {
        digest.update(&units[i].to_le_bytes());
    });
    digest.finalize()
}

/// The part of a motor's cogging that the servo opposes.
///
/// ```
/// use haptic_servo::environment::{Anticogging, CoggingMap, Wall};
///
/// static COGGING: CoggingMap<8> =
///     CoggingMap::of(&[0.0, -1e-3, 0.0, 1e-3, 0.0, -1e-3, 0.0, 1e-3]);
/// let environment = Wall::spring(2.0, 1).alone().beside(Anticogging::of(&COGGING, 0.5));
/// assert_eq!(environment.parts().anticogging.unwrap().largest(), 0.5e-3);
/// ```
///
/// The wire does not carry its table, only the numbers that the certificate needs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Anticogging {
    #[cfg_attr(feature = "wire", serde(skip))]
    units: &'static [i16],
    numbers: Numbers,
    /// The share of the cogging that it opposes, from 0 to 1.
    pub share: f64,
}

impl Anticogging {
    /// A share of the cogging of a map.
    pub const fn of<const ANGLES: usize>(map: &'static CoggingMap<ANGLES>, share: f64) -> Self {
        Self { units: &map.units, numbers: map.numbers, share }
    }

    /// All of the cogging of these torques, as [`CoggingMap::of`], in a table that lives as long as the program and
    /// has as many units.
    ///
    /// # Errors
    /// If they are no map.
    pub fn learnt(torques: &[f64], units: &'static mut [i16]) -> Result<Self, CoggingError> {
        let numbers = Numbers::sample(torques, units)?;
        Ok(Self { units, numbers, share: 1.0 })
    }

    /// The same with another share, from 0 to 1.
    pub const fn sharing(self, share: f64) -> Self {
        Self { share, ..self }
    }

    /// Largest torque in N m.
    pub const fn largest(&self) -> f64 {
        self.share * self.numbers.torque
    }

    /// Bound in N m on its mean over a turn of the encoder, with its torque clipped at any level.
    pub const fn mean(&self) -> f64 {
        self.largest() * (self.numbers.mean as f64 / FULL_SCALE as f64)
    }

    /// The cogging in N m at the angles of its map; empty if it came over the wire.
    pub fn torques(&self) -> impl Iterator<Item = f64> {
        let torque = self.numbers.torque;
        // In this order the largest is that of the map to the last bit.
        self.units.iter().map(move |unit| f64::from(*unit) / f64::from(FULL_SCALE) * torque)
    }

    /// The same structure with this number.
    #[inline(always)]
    pub(crate) fn with_numbers(&self, number: impl Fn(Parameter) -> Option<f64>) -> Self {
        Self { share: number(Parameter::Anticogging).unwrap_or(self.share), ..*self }
    }

    /// The profile of its torque: the motor applies `-F`, and so `F` has the sign of the cogging.
    pub(crate) const fn profile(&self, delay: usize) -> Profile {
        let Numbers { angles: knots, steps: [rise, fall], .. } = self.numbers;
        // Its mean has a bound of its own.
        let outline = Outline { knots, rise, fall, wraps: true, sum: 0, is_odd: false };
        let layout =
            Layout { torque: self.largest(), count: 1.0, centre: 0.0, ends: None, snap: None };
        Profile::of_table(self.units, &[], outline, layout, delay)
    }

    /// Checks the table in flash.
    fn check(&self) -> Result<(), BuildError> {
        // The compiler knows the table of a program, and has to read it here all the same.
        let found = checksum(core::hint::black_box(self.units));
        let expected = self.numbers.checksum;
        if found == expected { Ok(()) } else { Err(BuildError::CoggingMap { found, expected }) }
    }
}

/// The anticogging of a servo, or none: [`NoAnticogging`] has no code in a tick.
pub trait Compensation<N: Number>: Clone + core::fmt::Debug + Sized {
    /// Of an environment, late by as many whole samples, with an encoder of as many counts in a turn.
    ///
    /// # Errors
    /// If the table in flash has changed, or the number format cannot represent it.
    fn of(
        anticogging: Option<(Anticogging, usize)>,
        context: &LawContext,
        counts_per_turn: f64,
    ) -> Result<Self, BuildError>;
    /// A tick at a position in counts, of which only the low 32 bits matter. If the torque is `latched`, it is that
    /// of the next tick.
    fn tick(&mut self, count: i32, scale: N::Coefficient, latched: bool, limiter: &Limiter<N>);
    /// A tick at an angle in rad, whose torque is not latched.
    fn tick_at(&mut self, angle: f64, limiter: &Limiter<N>);
    /// The torque of the scene with that of this tick added, in N m.
    fn add_to(&self, torque: N) -> N;
    /// The larger magnitude of both, in N m.
    fn or_larger(&self, torque: N) -> N;
    /// As if the device had always been at this position, without a held torque.
    fn rest_at(&mut self, count: i64, scale: N::Coefficient);
}

/// No anticogging.
#[derive(Clone, Copy, Debug)]
pub struct NoAnticogging;

impl<N: Number> Compensation<N> for NoAnticogging {
    fn of(
        anticogging: Option<(Anticogging, usize)>,
        _: &LawContext,
        _: f64,
    ) -> Result<Self, BuildError> {
        if anticogging.is_none() { Ok(Self) } else { Err(BuildError::Structure) }
    }

    #[inline(always)]
    fn tick(&mut self, _: i32, _: N::Coefficient, _: bool, _: &Limiter<N>) {}

    #[inline(always)]
    fn tick_at(&mut self, _: f64, _: &Limiter<N>) {}

    #[inline(always)]
    fn add_to(&self, torque: N) -> N {
        torque
    }

    #[inline(always)]
    fn or_larger(&self, torque: N) -> N {
        torque
    }

    #[inline(always)]
    fn rest_at(&mut self, _: i64, _: N::Coefficient) {}
}

/// The law of an [`Anticogging`].
#[derive(Clone, Debug)]
pub struct AnticoggingLaw<N: Number, D> {
    profile: ProfileLaw<N, &'static [i16], NoDamping, D, NoSnap>,
    /// Torque of this tick.
    torque: N,
}

impl<N: Number, D: DelayLine<N>> AnticoggingLaw<N, D> {
    /// The angle in rad within a turn of a position in counts.
    #[inline(always)]
    fn angle(&mut self, count: i32, scale: N::Coefficient) -> N {
        let within = self.profile.turn().and_then(|turn| turn.within(count));
        let (count, _) = within.unwrap_or((count, 0));
        N::angle(count, scale).0
    }

    #[inline(always)]
    fn keep(&mut self, limiter: &Limiter<N>, x: N) {
        if let Response::Held(torque) = self.profile.evaluate(x) {
            // Limited like the scene's own, so that it fades with it.
            (self.torque, _) = limiter.limit(torque, LimitReason::None);
        }
    }
}

impl<N: Number, D: DelayLine<N>> Compensation<N> for Option<AnticoggingLaw<N, D>> {
    fn of(
        anticogging: Option<(Anticogging, usize)>,
        context: &LawContext,
        counts_per_turn: f64,
    ) -> Result<Self, BuildError> {
        let Some((anticogging, delay)) = anticogging else { return Ok(None) };
        anticogging.check()?;
        let mut profile =
            ProfileLaw::<_, &'static [i16], _, _, _>::law_of(&anticogging.profile(delay), context)?;
        profile.turn().map_or(Ok(()), |turn: &mut Turn<N>| turn.set_counts(counts_per_turn))?;
        Ok(Some(AnticoggingLaw { profile, torque: N::ZERO }))
    }

    #[inline(always)]
    fn tick(&mut self, count: i32, scale: N::Coefficient, latched: bool, limiter: &Limiter<N>) {
        let Some(law) = self else { return };
        let x = law.angle(count, scale);
        if latched {
            law.profile.update(x);
            law.keep(limiter, x);
        } else {
            law.keep(limiter, x);
            law.profile.update(x);
        }
    }

    fn tick_at(&mut self, angle: f64, limiter: &Limiter<N>) {
        let Some(law) = self else { return };
        let within = law.profile.turn().map_or(angle, |turn| turn.wrapped(angle));
        // A turn fits the format.
        let x = N::from_f64(within).unwrap_or(N::ZERO);
        law.keep(limiter, x);
        law.profile.update(x);
    }

    #[inline(always)]
    fn add_to(&self, torque: N) -> N {
        self.as_ref().map_or(torque, |law| torque.plus(law.torque))
    }

    #[inline(always)]
    fn or_larger(&self, torque: N) -> N {
        self.as_ref().map_or(torque, |law| {
            let [own, torque] = [law.torque, torque].map(|it| it.larger(it.negated()));
            own.larger(torque)
        })
    }

    fn rest_at(&mut self, count: i64, scale: N::Coefficient) {
        let Some(law) = self else { return };
        if let Some(turn) = law.profile.turn() {
            turn.start_at(count);
        }
        let x = law.angle(count as i32, scale);
        law.profile.rest_at(x);
        law.torque = N::ZERO;
    }
}

#[cfg(test)]
mod tests;
