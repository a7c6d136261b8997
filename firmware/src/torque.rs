//! The torque limit, which acts on the coupling torque before the coupling is solved, so that
//! saturation is part of the environment and inside the certificate (theory, end of section 5).

use core::fmt;
use core::hint::cold_path;

use crate::current::HeatStep;
use crate::number::Number;
use crate::text::words;

words! {
    /// The reason why a tick's output is below the environment's torque. This is telemetry, not a fault.
    #[derive(Default)]
    #[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
    #[repr(u8)]
    LimitReason {
    /// Nothing was limited.
    #[default]
    None = 0 "none",
    /// The scene's torque limit.
    Torque = 1 "torque",
    /// The DAC's full scale; the scene has no limit of its own.
    DacRange = 2 "converter",
    /// The position left the range of the number format; the angle stays at its end.
    Angle = 3 "angle",
    /// The torque was not a number; the output was zero.
    NotANumber = 4 "not-a-number",
    /// The clamp is opening, closing or shut.
    Ramp = 5 "ramp",
    /// The continuous current of the board's bridge, after more current for a time.
    Heat = 6 "heat",
    /// The energy that the budget of a host leaves: the torque is the host's, not the scene's.
    Energy = 7 "energy",
    }
}

impl fmt::Display for LimitReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// Clamps the coupling torque to `-level..=level`.
///
/// The level is the scene's bound, except while the servo fades in or out: then it moves by a fixed step per
/// tick. A scene is faded only if it passes with a torque limit at any level
/// ([`TimingChecked`](crate::certificate::TimingChecked) requires this, also for linear scenes): many scenes
/// that are certified without a limit oscillate with one. The ramp changes the clamp and never the stiffness,
/// because a changing stiffness is outside the certificate.
#[derive(Clone, Copy, Debug)]
pub struct Limiter<N> {
    level: N,
    bound: N,
    step: N,
    reason: LimitReason,
    /// The reason for the level: the bound, or the ramp.
    because: LimitReason,
}

impl<N: Number> Limiter<N> {
    /// An open limiter with its bound in N m, and the reason that it reports; with an infinite bound it only
    /// limits NaN. It opens and closes in one step.
    pub const fn new(bound: N, reason: LimitReason) -> Self {
        Self { level: bound, bound, step: bound, reason, because: reason }
    }

    /// The same, opening and closing by `step` N m per tick.
    pub(crate) const fn stepping(self, step: N) -> Self {
        Self { step, ..self }
    }

    /// The torque within bounds, and the reason if it was limited; `otherwise` if not.
    #[inline(always)]
    pub fn limit(&self, wanted: N, otherwise: LimitReason) -> (N, LimitReason) {
        if wanted.within(self.level) {
            return (wanted, otherwise);
        }
        // Rare: keeps the usual path of the tick free of branches.
        cold_path();
        if wanted > N::ZERO {
            (self.level, self.because)
        } else if wanted < N::ZERO {
            (self.level.negated(), self.because)
        } else {
            (N::ZERO, LimitReason::NotANumber)
        }
    }

    /// The same for a one-sided torque: for its positive part. One comparison covers the sign, the bound and
    /// NaN.
    #[inline(always)]
    pub(crate) fn limit_push(&self, wanted: N, otherwise: LimitReason) -> (N, LimitReason) {
        if wanted.is_from_zero_to(self.level) {
            return (wanted, otherwise);
        }
        if wanted <= N::ZERO {
            return (wanted.positive_part(), otherwise);
        }
        let (torque, reason) = self.beyond(wanted);
        (torque, *reason)
    }

    /// The limited value of a push above the level, or of NaN. Not inlined, so that it needs no registers in
    /// a usual tick. It returns the reason by reference, so that the tick does not extract it from a
    /// register's lowest byte.
    #[cold]
    #[inline(never)]
    fn beyond(&self, wanted: N) -> (N, &LimitReason) {
        if wanted > N::ZERO {
            (self.level, &self.because)
        } else {
            (N::ZERO, &LimitReason::NotANumber)
        }
    }

    /// Shuts the limiter: no torque passes.
    pub(crate) fn shut(&mut self) {
        self.set(N::ZERO);
    }

    pub(crate) fn is_shut(&self) -> bool {
        self.level <= N::ZERO
    }

    /// Lowers the level to `torque` (N m), so that further closing acts at once.
    pub(crate) fn clamp_to_held_torque(&mut self, torque: N) {
        let magnitude = torque.larger(torque.negated());
        self.set(self.level.smaller(magnitude));
    }

    /// Opens by a step; returns whether it is now open.
    pub(crate) fn open(&mut self) -> bool {
        self.set(self.level.plus(self.step).smaller(self.bound));
        self.level >= self.bound
    }

    /// Steps until it is open.
    pub(crate) fn steps_to_open(&self) -> u32 {
        // The cast rounds down and saturates.
        (self.bound.minus(self.level).to_f64() / self.step.to_f64()) as u32
    }

    /// Closes by a step; returns whether it is now shut.
    pub(crate) fn close(&mut self) -> bool {
        self.set(self.level.minus(self.step).positive_part());
        self.is_shut()
    }

    /// Moves the level of an open limiter by a step, because of the heat of the torque output. It rises only
    /// above a `torque` (N m) that it did not limit, so that a spring at rest gives nothing that it did not take.
    pub(crate) fn step_by_heat(&mut self, step: HeatStep, torque: N) {
        match step {
            HeatStep::Lower => _ = self.close(),
            HeatStep::Raise if torque.larger(torque.negated()) < self.level => _ = self.open(),
            HeatStep::Raise => {}
        }
        if self.level < self.bound {
            self.because = LimitReason::Heat;
        }
    }

    fn set(&mut self, level: N) {
        self.level = level;
        self.because = if level < self.bound { LimitReason::Ramp } else { self.reason };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_moves_the_level_and_is_the_reason() {
        let mut limiter = Limiter::new(2.0_f32, LimitReason::Torque).stepping(0.25);
        limiter.step_by_heat(HeatStep::Lower, 2.0);
        assert_eq!(limiter.limit(2.0, LimitReason::None), (1.75, LimitReason::Heat));
        for pressed in [1.75, -1.75] {
            limiter.step_by_heat(HeatStep::Raise, pressed);
            assert_eq!(limiter.limit(2.0, LimitReason::None), (1.75, LimitReason::Heat));
        }
        limiter.step_by_heat(HeatStep::Raise, -1.5);
        limiter.step_by_heat(HeatStep::Raise, 0.0);
        assert_eq!(limiter.limit(3.0, LimitReason::None), (2.0, LimitReason::Torque));
    }

    #[test]
    fn says_what_it_did() {
        let limiter = Limiter::new(2.0_f32, LimitReason::Torque);
        let limit = |wanted| limiter.limit(wanted, LimitReason::None);
        assert_eq!(limit(2.0), (2.0, LimitReason::None));
        assert_eq!(limit(2.1), (2.0, LimitReason::Torque));
        assert_eq!(limit(-2.0), (-2.0, LimitReason::None));
        assert_eq!(limit(f32::NEG_INFINITY), (-2.0, LimitReason::Torque));
        assert_eq!(limit(f32::NAN), (0.0, LimitReason::NotANumber));
        assert_eq!(limiter.limit(1.0, LimitReason::Angle), (1.0, LimitReason::Angle));
        assert_eq!(limiter.limit(3.0, LimitReason::Angle), (2.0, LimitReason::Torque));
    }

    /// As the limit of the part above zero, which has a way of its own to the same.
    #[test]
    fn a_push_is_limited_as_its_part_above_zero() {
        let mut limiter = Limiter::new(2.0_f32, LimitReason::Torque);
        let wanted = [0.0, -0.0, 1e-40, 1.0, 2.0, 2.0_f32.next_up(), -1e-40, -3.0, f32::INFINITY];
        for is_shut in [false, true] {
            for wanted in wanted.into_iter().chain([f32::NAN, -f32::NAN]) {
                let (torque, limit) = limiter.limit(wanted.larger(0.0), LimitReason::Angle);
                let push = limiter.limit_push(wanted, LimitReason::Angle);
                assert_eq!((push.0, push.1), (torque, limit), "{wanted}, shut: {is_shut}");
            }
            limiter.shut();
        }
    }

    #[test]
    fn opens_and_closes_by_steps() {
        let mut limiter = Limiter::new(2.0_f32, LimitReason::Torque).stepping(0.75);
        assert!(!limiter.is_shut());
        limiter.clamp_to_held_torque(-1.0);
        assert_eq!(limiter.limit(1.5, LimitReason::None), (1.0, LimitReason::Ramp));
        assert!(!limiter.close());
        assert_eq!(limiter.limit(-1.5, LimitReason::Angle), (-0.25, LimitReason::Ramp));
        assert_eq!(limiter.limit(0.25, LimitReason::Angle), (0.25, LimitReason::Angle));
        assert!(limiter.close() && limiter.is_shut());
        assert_eq!(limiter.limit(-1.5, LimitReason::None), (0.0, LimitReason::Ramp));
        assert_eq!(limiter.limit(0.0, LimitReason::None), (0.0, LimitReason::None));
        assert_eq!(limiter.limit(f32::NAN, LimitReason::None), (0.0, LimitReason::NotANumber));
        assert!(!limiter.open() && !limiter.open() && limiter.open());
        assert_eq!(limiter.limit(2.5, LimitReason::None), (2.0, LimitReason::Torque));
        // What holds more than the level lets through does not open it.
        limiter.shut();
        limiter.clamp_to_held_torque(1.0);
        assert!(limiter.is_shut());
    }

    #[test]
    fn has_a_word_for_every_reason() {
        let words =
            ["none", "torque", "converter", "angle", "not-a-number", "ramp", "heat", "energy"];
        assert_eq!(LimitReason::ALL.map(LimitReason::as_str), words);
        for (number, reason) in LimitReason::ALL.into_iter().enumerate() {
            assert_eq!((reason as usize, reason.to_string()), (number, words[number].to_owned()));
        }
    }
}
