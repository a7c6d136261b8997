//! The angle that the encoder of a scene shows: with its nonlinearity, its noise, its hysteresis and its steps.

use haptic_servo::scene::EncoderReading;
use haptic_servo::torque::LimitReason;

/// An encoder.
#[derive(Clone, Debug)]
pub struct Reading {
    encoder: &'static EncoderReading,
    /// Angle of a count in rad; without it there is neither noise nor hysteresis.
    step: Option<f64>,
    /// The angle that the hysteresis holds.
    held: Option<f64>,
    random: fastrand::Rng,
}

impl Reading {
    /// The encoder of a scene with this angle of a count in rad. Its noise is the same in every simulation.
    pub fn new(encoder: &'static EncoderReading, step: Option<f64>) -> Self {
        Self { encoder, step, held: None, random: fastrand::Rng::with_seed(0) }
    }

    /// The angle in rad that is shown at a position in rad, and the limit if its count is too large for the
    /// servo's 32 bits: the angle then saturates.
    pub fn of(&mut self, position: f64) -> (f64, LimitReason) {
        let angle = self.angle(position);
        let Some(step) = self.step else { return (angle, LimitReason::None) };
        let count = (angle / step).floor();
        let nearest = count.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
        let reason = if nearest == count { LimitReason::None } else { LimitReason::Angle };
        (nearest * step, reason)
    }

    /// The same angle in rad before it is floored to a count.
    pub fn angle(&mut self, position: f64) -> f64 {
        let EncoderReading { linearity, noise, hysteresis, .. } = *self.encoder;
        // The steepest error of one period in a turn.
        let angle = if linearity == 0.0 { position } else { position + linearity * position.sin() };
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
