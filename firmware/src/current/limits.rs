//! The largest numbers with which a drive passes every check of its design, as the checks themselves judge
//! them, and the design of a current loop or its refusal with these numbers.

use super::current_loop::CurrentLoop;
use super::design::Design;
use super::drive::{Drive, DriveError, DriveLimits, Regeneration};
use super::power_stage::PowerStage;
use crate::certificate::digits::{Digits, Side};
use crate::text::or_refuse;
use crate::transducers::Transducers;

/// Octaves of a search around a stated number.
const OCTAVES: u32 = 24;
/// Halvings of an octave: more than three digits need.
const HALVINGS: u32 = 20;
/// Numbers of three digits that are tried.
const TRIES: u32 = 4;

/// A drive with its device's transducers, on a power stage.
#[derive(Clone, Copy)]
struct Case<'a> {
    drive: Drive,
    stage: &'a PowerStage,
    transducers: Transducers,
    period: f64,
}

impl CurrentLoop {
    /// Designs the loop of a drive on a power stage, for a servo with these transducers and this period in s.
    ///
    /// # Errors
    /// If the drive cannot run there: the value and its bound.
    pub const fn design(
        drive: &Drive,
        stage: &PowerStage,
        transducers: &Transducers,
        period: f64,
    ) -> Result<Self, DriveError> {
        let design = ok!(Design::of(drive, stage, transducers, period));
        match design.check() {
            Ok(()) => Ok(design.current_loop()),
            Err(error) => {
                Err(error.with_limits(DriveLimits::of(drive, stage, transducers, period)))
            }
        }
    }

    /// For constants: a compile error if the drive cannot run.
    #[track_caller]
    pub const fn checked(
        drive: &Drive,
        stage: &PowerStage,
        transducers: &Transducers,
        period: f64,
    ) -> Self {
        or_refuse!(Self::design(drive, stage, transducers, period))
    }
}

impl DriveLimits {
    /// The bounds of a drive on a power stage, for a servo with these transducers and this period in s.
    pub const fn of(
        drive: &Drive,
        stage: &PowerStage,
        transducers: &Transducers,
        period: f64,
    ) -> Self {
        let case = Case { drive: *drive, stage, transducers: *transducers, period };
        let stated = case.numbers();
        Self {
            bandwidth: case.largest(stated[0], [true, false, false]),
            torque: case.largest(stated[1], [false, true, false]),
            speed: case.largest(stated[2], [false, false, true]),
            supply: case.least_supply(),
            together: match case.largest(1.0, [true; 3]) {
                Some(part) => Some([
                    Digits::of(part * stated[0], Side::Below).value(),
                    Digits::of(part * stated[1], Side::Below).value(),
                    Digits::of(part * stated[2], Side::Below).value(),
                ]),
                None => None,
            },
        }
    }
}

impl Case<'_> {
    /// Bandwidth, torque and speed.
    const fn numbers(&self) -> [f64; 3] {
        let Transducers { full_scale_torque, largest_speed, .. } = self.transducers;
        [self.drive.bandwidth, full_scale_torque, largest_speed]
    }

    const fn passes(&self) -> bool {
        match Design::of(&self.drive, self.stage, &self.transducers, self.period) {
            Ok(design) => design.check().is_ok(),
            Err(_) => false,
        }
    }

    /// Whether it passes with some of the numbers times a factor.
    const fn passes_with(&self, factor: f64, which: [bool; 3]) -> bool {
        let mut case = *self;
        if which[0] {
            case.drive.bandwidth *= factor;
        }
        if which[1] {
            case.transducers.full_scale_torque *= factor;
        }
        if which[2] {
            case.transducers.largest_speed *= factor;
        }
        case.passes()
    }

    /// The largest multiple of `stated` with which it passes, the numbers being changed by the same factor.
    const fn largest(&self, stated: f64, which: [bool; 3]) -> Option<f64> {
        if !(stated > 0.0 && stated.is_finite()) {
            return None;
        }
        let (mut inside, mut outside, mut octaves) = (1.0, 1.0, 0);
        while !self.passes_with(inside, which) {
            (outside, inside) = (inside, 0.5 * inside);
            octaves += 1;
            if octaves > OCTAVES {
                return None;
            }
        }
        while inside == outside || self.passes_with(outside, which) {
            (inside, outside) = (outside, 2.0 * outside);
            octaves += 1;
            if octaves > OCTAVES {
                return None;
            }
        }
        each!(_i in 0..HALVINGS => {
            let middle = 0.5 * (inside + outside);
            *(if self.passes_with(middle, which) { &mut inside } else { &mut outside }) = middle;
        });
        let mut digits = Digits::of(stated * inside, Side::Below);
        each!(_i in 0..TRIES => {
            if self.passes_with(digits.value() / stated, which) {
                return Some(digits.value());
            }
            digits = digits.further(Side::Below);
        });
        None
    }

    /// The least voltage of the lowest supply with which it passes.
    const fn least_supply(&self) -> Option<f64> {
        let Ok(design) = Design::of(&self.drive, self.stage, &self.transducers, self.period) else {
            return None;
        };
        let mut digits = Digits::of(design.enough_voltage(), Side::Above);
        each!(_i in 0..TRIES => {
            let lowest = digits.value();
            let mut case = *self;
            let supply = &mut case.drive.supply;
            supply.lowest = lowest;
            supply.highest = supply.highest.max(lowest);
            if let Regeneration::Stores { voltage, .. } = &mut supply.regeneration {
                *voltage = voltage.max(lowest);
            }
            if case.passes() {
                return Some(lowest);
            }
            digits = digits.further(Side::Above);
        });
        None
    }
}
