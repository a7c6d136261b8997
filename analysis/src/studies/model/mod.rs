//! The simplest sufficient model of a device: the cheapest model whose verdict and motion stay within a bound
//! of those of the full model, which the scene's file describes.
//!
//! The servo is the same in all of them. A model may omit the hand that holds the device, masses of the chain
//! (links become rigid: [`Chain::lumped`]) and the amplifier's lag.

mod advice;
mod deviation;
mod model_result;

pub use advice::{Advice, advise};
pub use deviation::{Deviation, percent};
pub use model_result::ModelResult;

use std::fmt;

use haptic_servo::scene::{Scene, TimeRange};

use crate::chain::Chain;
use crate::device::Hand;
use crate::file::SceneFile;
use crate::simulation::Experiment;
use crate::simulation::plant::Plant;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Model {
    /// Masses of the chain; one is a rigid device.
    pub masses: usize,
    /// Whether the file's hand holds it.
    pub hand: bool,
    pub lag: bool,
}

impl Model {
    /// The model with all parts of the file.
    pub fn fullest(file: &SceneFile) -> Self {
        Self {
            masses: file.chain.masses().len(),
            hand: file.hand.is_some_and(|hand| hand != Hand::default()),
            lag: !file.scene.latency.actuator_lag.is_zero(),
        }
    }

    /// This model and all models that omit parts of it, the cheapest first: by the number of states, then by
    /// the number of parts.
    pub fn up_to(self) -> Vec<Self> {
        let either = |is: bool| if is { &[false, true][..] } else { &[false] };
        let mut models = Vec::new();
        for masses in 1..=self.masses {
            for &lag in either(self.lag) {
                models.extend(either(self.hand).iter().map(|&hand| Self { masses, hand, lag }));
            }
        }
        models.sort_by_key(|model| (2 * model.masses + usize::from(model.lag), model.hand));
        models
    }

    /// The device of a file in this model.
    pub fn chain(self, file: &SceneFile) -> Chain {
        file.chain.lumped(self.masses)
    }

    /// The scene of a file with the latency of this model's machine.
    pub fn scene(self, file: &SceneFile) -> Scene {
        let mut scene = file.scene;
        if !self.lag {
            scene.latency.actuator_lag = TimeRange::ZERO;
            scene.latency.actuator_updates = 0;
        }
        scene
    }

    /// The machine of a file in this model.
    pub fn plant(self, file: &SceneFile) -> Plant {
        let hand = file.hand.filter(|_| self.hand).unwrap_or_default();
        Plant::of(&self.chain(file)).with_hand(hand)
    }

    /// The file's simulation on this model's machine.
    pub fn experiment(self, file: &SceneFile, run: &Experiment) -> Experiment {
        Experiment { plant: self.plant(file), scene: self.scene(file), ..run.clone() }
    }

    /// Its omissions compared with another model, as text.
    pub fn lacks(self, fuller: Self) -> Vec<String> {
        let mut lacks = Vec::new();
        match fuller.masses - self.masses {
            0 => {}
            1 => lacks.push("a mass".to_owned()),
            masses => lacks.push(format!("{masses} masses")),
        }
        if fuller.hand && !self.hand {
            lacks.push("the hand".to_owned());
        }
        if fuller.lag && !self.lag {
            lacks.push("the amplifier's lag".to_owned());
        }
        lacks
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.masses {
            1 => f.write_str("rigid")?,
            masses => write!(f, "{masses} masses")?,
        }
        f.write_str(if self.hand { ", hand" } else { "" })?;
        f.write_str(if self.lag { ", lag" } else { "" })
    }
}

#[cfg(test)]
mod tests;
