//! The angle that the encoder of a scene shows: with its nonlinearity, its noise, its hysteresis and its steps.

use haptic_servo::scene::EncoderReading;
use haptic_servo::torque::LimitReason;

use crate::missed::{Missed, Ticks};
use crate::nonlinear_encoder::shown;

/// An encoder.
#[derive(Clone, Debug)]
pub struct Reading {
    encoder: &'static EncoderReading,
    /// Angle of a count in rad; without it there is neither noise nor hysteresis.
    step: Option<f64>,
    /// The angle that the hysteresis holds.
    held: Option<f64>,
    random: fastrand::Rng,
    /// Which readings fail, and the last that did not.
    failing: Ticks,
    last: f64,
}

impl Reading {
    /// The encoder of a scene with this angle of a count in rad. Its noise is the same in every simulation.
    pub fn new(encoder: &'static EncoderReading, step: Option<f64>) -> Self {
        let (random, failing) = (fastrand::Rng::with_seed(0), Missed::None.ticks());
        Self { encoder, step, held: None, random, failing, last: 0.0 }
    }

    /// The same of which some readings fail.
    pub fn failing(self, failing: Missed) -> Self {
        Self { failing: failing.ticks(), ..self }
    }

    /// Whether the next reading fails: the last good one takes its place.
    pub fn fails(&mut self) -> bool {
        self.failing.next().unwrap_or(false)
    }

    /// The last angle in rad that was read, before it is floored to a count.
    pub fn last(&self) -> f64 {
        self.last
    }

    /// The angle in rad that is shown at a position in rad, and the limit if its count is too large for the
    /// servo's 32 bits: the angle then saturates.
    pub fn of(&mut self, position: f64) -> (f64, LimitReason) {
        let angle = self.angle(position);
        self.shown(angle)
    }

    /// An angle in rad as it is shown.
    pub fn shown(&self, angle: f64) -> (f64, LimitReason) {
        let Some(step) = self.step else { return (angle, LimitReason::None) };
        let count = (angle / step).floor();
        let nearest = count.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
        let reason = if nearest == count { LimitReason::None } else { LimitReason::Angle };
        (nearest * step, reason)
    }

    /// The same angle in rad before it is floored to a count.
    pub fn angle(&mut self, position: f64) -> f64 {
        self.last = self.read(position);
        self.last
    }

    fn read(&mut self, position: f64) -> f64 {
        let EncoderReading { linearity, noise, hysteresis, .. } = *self.encoder;
        let angle = shown(position, linearity);
        let Some(step) = self.step else { return angle };
        let angle = match noise {
            0.0 => angle,
            _ => angle + noise * step * (2.0 * self.random.f64() - 1.0),
        };
        let half = 0.5 * hysteresis * step;
        let held = self.held.map_or(angle, |held| held.clamp(angle - half, angle + half));
        self.held = Some(held);
        held
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_off_by_no_more_than_the_certificate_takes_of_it() {
        let step = 1e-3;
        const NOISY: EncoderReading =
            EncoderReading { noise: 2.0, hysteresis: 3.0, ..EncoderReading::IDEAL };
        let mut reading = Reading::new(&NOISY, Some(step));
        let most = 0.5 * step * NOISY.steps();
        let (mut least, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
        for k in 0..100_000 {
            let position = 0.3 * (f64::from(k) * 1e-3).sin();
            // A count stands for the middle of its step.
            let error = reading.of(position).0 + 0.5 * step - position;
            assert!(error.abs() <= most * (1.0 + 1e-9), "{error} {most}");
            (least, largest) = (least.min(error), largest.max(error));
        }
        assert!(least < -0.75 * most && largest > 0.75 * most, "{least} {largest} {most}");
        const STEEP: EncoderReading = EncoderReading { linearity: 0.1, ..EncoderReading::IDEAL };
        let mut reading = Reading::new(&STEEP, None);
        let slope = (reading.of(1e-6).0 - reading.of(-1e-6).0) / 2e-6;
        assert!((slope - 1.1).abs() < 1e-9, "{slope}");
    }
}
