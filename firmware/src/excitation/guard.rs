//! Limits of a device's motion while it is driven open loop.

use core::f64::consts::TAU;

use super::SweepEnd;
use crate::transducers::Transducers;

/// Limits of the motion. Beyond any of them the sweep ends and the amplifier goes off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionLimits {
    /// Largest distance in rad from the beginning of the sweep, in either direction.
    pub travel: f64,
    /// Largest speed in rad/s. It must be below the transducers' largest speed, above which a motion counts
    /// as a jump of the encoder.
    pub speed: f64,
}

/// The same limits in counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Guard {
    /// Largest distance from the beginning of the sweep in counts.
    travel: u32,
    /// Largest motion within a period in counts.
    speed: u32,
    /// Motion within a period in counts that no device makes.
    jump: u32,
}

impl Guard {
    /// The limits for an encoder that is read every `period` s.
    ///
    /// Panics, in a constant as a compile error, if a limit is not positive or the limit of the speed is not
    /// below the largest speed.
    #[track_caller]
    pub const fn planned(limits: &MotionLimits, transducers: &Transducers, period: f64) -> Self {
        let MotionLimits { travel, speed } = *limits;
        let Transducers { counts_per_turn, largest_speed, .. } = *transducers;
        // Written so that NaN is refused.
        assert!(travel > 0.0 && travel < f64::INFINITY, "the limit of travel is not positive");
        assert!(
            speed > 0.0 && speed < largest_speed,
            "the limit of speed is not between 0 and the largest speed of the transducers"
        );
        let counts = counts_per_turn / TAU;
        let (speed, jump) = (speed * period * counts, largest_speed * period * counts);
        // The casts round down; one count more is for the encoder's step.
        Self {
            travel: (travel * counts) as u32 + 1,
            speed: speed as u32 + 1,
            jump: jump as u32 + 1,
        }
    }

    /// The reason if a motion ends the sweep: `travel` counts from its beginning, `step` of them in the last
    /// period.
    pub const fn check(&self, travel: i32, step: i32) -> Option<SweepEnd> {
        let step = step.unsigned_abs();
        if step > self.jump {
            Some(SweepEnd::Jump)
        } else if step > self.speed {
            Some(SweepEnd::Speed)
        } else if travel.unsigned_abs() > self.travel {
            Some(SweepEnd::Travel)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoder::CounterWidth;

    const TRANSDUCERS: Transducers = Transducers {
        // A thousand counts in a rad, and a little more, so that no limit is a whole number of them.
        counts_per_turn: 1000.5 * TAU,
        counter: CounterWidth::Bits16,
        full_scale_torque: 2.0,
        largest_speed: 100.0,
    };

    #[test]
    fn each_limit_ends_the_sweep_one_count_beyond_it() {
        let limits = MotionLimits { travel: 0.5, speed: 80.0 };
        let guard = Guard::planned(&limits, &TRANSDUCERS, 1e-3);
        for sign in [1, -1] {
            let check = |travel: i32, step: i32| guard.check(sign * travel, sign * step);
            assert_eq!(check(501, 81), None);
            assert_eq!(check(502, 0), Some(SweepEnd::Travel));
            assert_eq!(check(0, 82), Some(SweepEnd::Speed));
            assert_eq!(check(0, 101), Some(SweepEnd::Speed));
            assert_eq!(check(502, 102), Some(SweepEnd::Jump));
        }
        assert_eq!(guard.check(i32::MIN, i32::MIN), Some(SweepEnd::Jump));
    }

    #[test]
    fn limits_that_stop_nothing_are_refused() {
        for (travel, speed) in [(0.0, 80.0), (f64::NAN, 80.0), (0.5, 0.0), (0.5, 100.0)] {
            let limits = MotionLimits { travel, speed };
            let planned = || Guard::planned(&limits, &TRANSDUCERS, 1e-3);
            assert!(std::panic::catch_unwind(planned).is_err(), "{limits:?}");
        }
    }
}
