//! The most detents in a turn that a hand can tell apart.

use std::f64::consts::TAU;

use haptic_servo::certificate::QuantizationBound;
use haptic_servo::environment::{Profile, Shape};
use haptic_servo::number::Format;
use haptic_servo::parameter::Parameter;
use haptic_servo::scene::{EncoderReading, Scene};
use thiserror::Error;

use super::edge::{Edge, edge};
use super::stiffest::{Search, Structure};
use crate::quantity::significant;

/// Why a device has no detents that a hand can tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoDetents {
    /// The motor is too weak.
    #[error("{} N m, twice that of friction and of the cogging that remains, are more than the {} N m of the motor",
            significant(*torque, 3), significant(*motor, 3))]
    Motor {
        /// Peak torque of each in N m.
        torque: f64,
        /// Largest torque of the motor in N m.
        motor: f64,
    },
    /// The encoder is too coarse.
    #[error("a reading is off by {} rad, more than a quarter of a turn", significant(*error, 3))]
    Reading {
        /// Largest error of a reading in rad.
        error: f64,
    },
    /// The encoder is too nonlinear (theory, equation 68).
    #[error("through `encoder.linearity` even one of {} N m in a turn has a mean torque of up to {} N m, and the \
             friction of {} N m does not hold both this and the errors at rest",
            significant(*torque, 3), significant(*mean, 3), significant(*friction, 3))]
    Mean {
        /// Peak torque of each in N m.
        torque: f64,
        /// Their largest mean torque in N m.
        mean: f64,
        /// Friction of the device in N m.
        friction: f64,
    },
    /// One is steeper than what certifies and is silent.
    #[error("even one of {} N m in a turn is too steep to be silent", significant(*torque, 3))]
    Steep {
        /// Peak torque of each in N m.
        torque: f64,
    },
}

/// Knots in the table of one detent.
const KNOTS: usize = 16;

impl Search {
    /// The most detents in a turn, with this peak torque in N m, that pass at a period in s in one of the structures.
    /// From rest to peak, a quarter of the pitch, they are at least the error of a reading apart.
    ///
    /// # Errors
    /// If not even one passes.
    pub fn most_detents(&self, torque: f64, period: f64) -> Result<f64, NoDetents> {
        let motor = self.scene.torque_limit.or(self.steps.full_scale).unwrap_or(f64::INFINITY);
        if torque > motor {
            return Err(NoDetents::Motor { torque, motor });
        }
        let error = 0.5 * self.steps.encoder.unwrap_or(0.0) * self.scene.latency.encoder.steps();
        let most = TAU / (4.0 * error);
        if most < 1.0 {
            return Err(NoDetents::Reading { error });
        }
        let scenes = self.with_detents(torque, period);
        let passes = |count: f64| {
            let count = count.floor();
            (1.0..=most).contains(&count)
                && scenes.iter().any(|scene| self.passes(&repeated(scene, count)))
        };
        // The count is whole, so that this precision is exact.
        match edge(passes, most.min(64.0), 2.0, 1e-6) {
            Edge::At(count) => Ok(count.floor()),
            Edge::Always | Edge::Never => Err(self.too_steep(torque, &scenes)),
        }
    }

    /// One detent in a turn in place of the wall, in each structure.
    fn with_detents(&self, torque: f64, period: f64) -> Vec<Scene> {
        let shapes = [Shape::detents(1, torque)];
        let Ok(profile) = Profile::sampled(&shapes, vec![0; KNOTS].leak(), 0) else {
            return Vec::new();
        };
        // A scene refers to it.
        let encoder: &EncoderReading = Box::leak(Box::new(EncoderReading {
            friction: self.steps.friction.unwrap_or(0.0),
            ..*self.scene.latency.encoder
        }));
        let with_profile = |&structure: &Structure| {
            let mut scene = self.scene_of(structure, period, None)?;
            let parts = scene.environment.parts();
            let profile = Profile { delay: parts.wall?.delay, ..profile }.alone();
            scene.environment = match parts.anticogging {
                Some(learnt) => profile.beside(learnt),
                None => profile,
            };
            scene.latency.encoder = encoder;
            Some(scene)
        };
        Structure::ALL.iter().filter_map(with_profile).collect()
    }

    fn too_steep(&self, torque: f64, scenes: &[Scene]) -> NoDetents {
        let bounds =
            scenes.iter().filter_map(|one| QuantizationBound::of(one, Format::F64, &self.steps));
        let mut of_mean = bounds.filter_map(|rest| {
            let friction = rest.friction?;
            let is_held = rest.hum() <= friction && rest.for_rest() > friction;
            is_held.then_some(NoDetents::Mean { torque, mean: rest.mean, friction })
        });
        of_mean.next().unwrap_or(NoDetents::Steep { torque })
    }
}

/// The scene with so many of its detents in a turn.
fn repeated(scene: &Scene, count: f64) -> Scene {
    scene.with(Parameter::Count, count).unwrap_or(*scene)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Judge, Terms};
    use crate::file::{Format as FileFormat, parse};
    use haptic_servo::dac::DacCode;
    use std::f64::consts::FRAC_PI_2;

    const TORQUE: f64 = 0.016;
    const FRICTION: f64 = 0.003;
    const LINEARITY: f64 = 0.04;
    const FULL_SCALE: f64 = 0.2;

    /// A gimbal motor at 10 kHz whose encoder has these counts and this noise.
    fn most(counts: f64, noise: f64, linearity: f64) -> Result<f64, NoDetents> {
        let text = format!(
            "name = \"knob\"\n[device]\ninertia = 3e-5\ndamping = 0.001\nfriction = {FRICTION}\n\
             actuator_lag = 8e-5\n[servo]\nrate = 10000.0\n[encoder]\nage = [0.0, 1e-5]\n\
             counts_per_turn = {counts:?}\nnoise = {noise:?}\nlinearity = {linearity}\n\
             [limits]\ntorque = 0.15\nfull_scale = {FULL_SCALE}\n\
             [environment]\ntype = \"damper-wall\"\nstiffness = 1.0\ndamping = 0.0\ndelay = 1\n"
        );
        let file = parse("knob.toml", FileFormat::Toml, &text).unwrap();
        let search = Search::new(&file, &Terms { judge: Judge::BOARD, ..Terms::KEPT }).unwrap();
        search.without_rest().silent().unwrap().most_detents(TORQUE, 1e-4)
    }

    #[test]
    fn a_finer_or_quieter_encoder_never_has_fewer() {
        let all = [6, 8, 11, 14, 15, 16, 17, 20, 24].map(|bits| 2.0_f64.powi(bits));
        let of = |noise| all.map(|counts| most(counts, noise, LINEARITY).unwrap_or(0.0));
        let [quiet, usual, loud] = [0.0, 2.0, 40.0].map(of);
        for found in [&quiet, &usual, &loud] {
            assert!(found.is_sorted(), "{found:?}");
        }
        for ((quiet, usual), loud) in quiet.iter().zip(usual).zip(loud) {
            assert!(*quiet >= usual && usual >= loud, "{quiet} {usual} {loud}");
        }
        assert!(usual[0] < usual[3] && usual[3] < usual[5] && loud[4] > 0.0, "{usual:?}");
    }

    /// The slope of a triangle is `2 n F/pi`; friction holds its error, the mean torque (equation 68) and half a code.
    #[test]
    fn friction_holds_so_many_and_not_one_more() {
        for counts in [4096.0, 16384.0, 32768.0] {
            let found = most(counts, 2.0, LINEARITY).unwrap();
            let error = 2.5 * TAU / counts;
            let mean = TORQUE * LINEARITY / (1.0 - LINEARITY);
            let code = 0.5 * FULL_SCALE / f64::from(DacCode::CODES_TO_FULL_SCALE);
            let needed = |count: f64| count * TORQUE / FRAC_PI_2 * error + mean + code;
            assert!(needed(found) <= FRICTION && needed(found + 1.0) > FRICTION - 1e-6, "{found}");
        }
    }

    #[test]
    fn the_reason_for_none_is_what_prevents_them() {
        let none = |counts, linearity| most(counts, 2.0, linearity).unwrap_err();
        assert!(matches!(none(16384.0, 0.4), NoDetents::Mean { friction: FRICTION, .. }));
        assert!(matches!(none(8.0, LINEARITY), NoDetents::Reading { .. }));
        assert!(matches!(none(20.0, 0.0), NoDetents::Steep { torque: TORQUE }));
    }
}
