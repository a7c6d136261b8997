//! A sweep as it is played: its codes, one per sample, the limits of the device's motion while it is driven open
//! loop, and the end of the sweep, which is the last word of the record on the wire.

use core::f64::consts::TAU;

use super::sine::{QUINTIC, sine};
use super::{Step, Sweep};
use crate::dac::DacCode;
use crate::text::words;
use crate::transducers::Transducers;

/// The output of a sweep in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Excitation {
    /// Code for the DAC.
    pub code: DacCode,
    /// The tone whose measured part contains this sample; `None` while the device settles and after the
    /// sweep.
    pub measured: Option<usize>,
}

/// Plays a sweep.
///
/// The sine is a polynomial whose error is below that of the nearest code, even at full scale. It is the
/// cheapest such method: all others take more instructions or have errors of codes.
#[derive(Clone, Debug)]
pub struct Exciter<'a> {
    steps: &'a [Step],
    step: usize,
    sample: u32,
    /// Phase in parts of a turn, with as many parts as the step has measured samples.
    phase: u32,
}

impl<'a> Exciter<'a> {
    /// An exciter at the beginning of the sweep.
    pub const fn new<const N: usize>(sweep: &'a Sweep<N>) -> Self {
        Self { steps: &sweep.steps, step: 0, sample: 0, phase: 0 }
    }

    /// The next sample; no torque after the last.
    #[expect(clippy::should_implement_trait, reason = "an exciter does not end")]
    pub fn next(&mut self) -> Excitation {
        let Some(step) = self.steps.get(self.step) else {
            return Excitation { code: DacCode::MID_SCALE, measured: None };
        };
        let turn = self.phase as f32 / step.measured as f32;
        let code = code(step.codes * sine(turn, &QUINTIC));
        let measured = (self.sample >= step.settle).then_some(self.step);
        self.advance(*step);
        Excitation { code, measured }
    }

    fn advance(&mut self, step: Step) {
        self.sample += 1;
        self.phase += step.cycles;
        if self.phase >= step.measured {
            self.phase -= step.measured;
        }
        if self.sample == step.settle + step.measured {
            (self.step, self.sample, self.phase) = (self.step + 1, 0, 0);
        }
    }
}

/// The nearest code to a torque in codes.
fn code(codes: f32) -> DacCode {
    const MOST: i16 = DacCode::CODES_TO_FULL_SCALE.cast_signed();
    let half = if codes < 0.0 { -0.5 } else { 0.5 };
    // The sine may be a little above 1.
    let offset = ((codes + half) as i16).clamp(-MOST, MOST);
    DacCode::from_low_bits(DacCode::MID_SCALE.get().wrapping_add_signed(offset))
}

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

/// Version of the protocol of a board that plays a sweep.
pub const SWEEP_PROTOCOL: u32 = 3;

/// Time in s without a request of the host after which an unsupervised sweep ends.
pub const SILENCE: f64 = 0.5;

words! {
    /// The end of a sweep.
    SweepEnd {
    /// The sweep is complete.
    Done "done",
    /// The host stopped it.
    Stopped "stopped",
    /// The host has sent no request for [`SILENCE`].
    Silent "silent",
    /// A tick came late or not at all, so that a torque was held for too long.
    MissedTick "missed-tick",
    /// A row was lost because the queue to the host was full.
    LostRow "lost-row",
    /// The device left the limits of its travel.
    Travel "travel",
    /// The device was faster than its limit.
    Speed "speed",
    /// The encoder moved further than a device can.
    Jump "jump",
    /// The board's bridge removed the torque.
    OutputFault "output-fault",
    }
}

impl SweepEnd {
    /// The end with this word.
    pub fn find(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|end| end.as_str() == word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scene::PADDLE;

    const TRANSDUCERS: Transducers = Transducers {
        // A thousand counts in a rad, and a little more, so that no limit is a whole number of them.
        counts_per_turn: 1000.5 * TAU,
        ..PADDLE
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
