//! The largest stiffness of a spring that a method shows as stable, over its steps per tick.

use super::setting::*;
use crate::chain::{Link, Mass};
use crate::device::{self, Hand};
use crate::simulation::method::Method;
use crate::simulation::plant::Plant;
use crate::simulation::{Experiment, Integration};
use crate::stability::critical_stiffness;

/// The devices by name: that of theory, section 9; and as two masses whose resonance is at 1183 rad/s, in a hand.
/// Each is released at a millirad, on a spring of 300 N m/rad without delay and coupling.
pub fn devices() -> [(&'static str, Experiment); 2] {
    let masses = [Mass { inertia: 0.05, damping: 0.5 }, Mass { inertia: 0.02, damping: 0.0 }];
    let links = [Link { stiffness: 20e3, damping: 0.27 }];
    let hand = Hand { inertia: 0.1, damping: 1.0, stiffness: 1000.0 };
    let released = |plant| {
        let scene = rigid(KNOB, wall_of(300.0, 0.0, 0));
        let start = device::Motion { position: 1e-3, velocity: 0.0 };
        Experiment { plant, start, samples: 1000, ..Experiment::still(&scene) }
    };
    [
        ("mass and damper", released(Plant::rigid(KNOB))),
        ("two masses in a hand", released(Plant::chain(&masses, &links).with_hand(hand))),
    ]
}

/// The compared methods, the least accurate first.
pub const METHODS: [Method; 4] = [Method::SemiImplicit, Method::Rk4, Method::Tustin, Method::Euler];

/// The steps per tick, about evenly spaced on a logarithmic axis.
const SUBSTEPS: [u32; 21] =
    [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 17, 20, 25, 30, 36, 44, 54, 66, 81, 100];

/// The limits of a spring on one device by several methods.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The device.
    pub device: &'static str,
    /// Stiffness in N m/rad above which the loop is unstable.
    pub truth: f64,
    /// Largest certified stiffness in N m/rad.
    pub certified: f64,
    /// The apparent limit by each of [`METHODS`]: steps per tick and stiffness in N m/rad, zero if no spring
    /// appears stable.
    pub apparent: [Vec<(f64, f64)>; METHODS.len()],
}

impl Region {
    /// An undelayed spring without a coupling on the heavy knob, and on two masses in a hand.
    pub fn all() -> Result<[Self; 2], StudyError> {
        let [knob, held] = devices();
        Ok([Self::of(knob.0, &knob.1)?, Self::of(held.0, &held.1)?])
    }

    fn of(device: &'static str, experiment: &Experiment) -> Result<Self, StudyError> {
        let limit = |method, substeps| -> Result<f64, StudyError> {
            let integration = Integration { method, substeps };
            Ok(critical_stiffness(experiment, integration)?.unwrap_or(0.0))
        };
        let certified = limit_of(&experiment.scene)?;
        let mut apparent = [const { Vec::new() }; METHODS.len()];
        for (method, points) in METHODS.into_iter().zip(&mut apparent) {
            for substeps in SUBSTEPS {
                points.push((f64::from(substeps), limit(method, substeps)?));
            }
        }
        Ok(Self { device, truth: limit(Method::Exact, 1)?, certified, apparent })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Theory, section 9, for two masses. Of one mass the limits are tested where they are computed.
    #[test]
    fn apparent_limits_of_two_masses_are_those_of_theory() {
        let [_, (_, chain)] = devices();
        let limit = |method| {
            critical_stiffness(&chain, Integration { method, ..Integration::default() }).unwrap()
        };
        let truth = limit(Method::Exact).unwrap();
        let part = |method| limit(method).map(|found| found / truth - 1.0);
        assert!((0.12..0.16).contains(&part(Method::Rk4).unwrap()));
        assert!((-0.06..-0.04).contains(&part(Method::Tustin).unwrap()));
        assert_eq!(part(Method::Euler), None);
    }
}
