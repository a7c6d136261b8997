//! The same device with fewer masses: links that are stiff enough are made rigid.

use super::{Chain, Link, Mass};

impl Chain {
    /// The chain with at most `masses` masses, and at least one: repeatedly, the fastest link is made rigid,
    /// and the masses at its ends become one. Total inertia, total damping, the encoder's end and the
    /// amplifier stay unchanged.
    ///
    /// ```
    /// use haptic_model::chain::{Chain, Link, Mass};
    /// let mass = Mass { inertia: 1e-5, damping: 0.01 };
    /// let [shaft, belt] = [9000.0, 40.0].map(|stiffness| Link { stiffness, damping: 0.0 });
    /// let device = Chain::new(vec![mass; 3], vec![shaft, belt])?.lumped(2);
    /// assert_eq!(device.masses()[0], Mass { inertia: 2e-5, damping: 0.02 });
    /// assert_eq!((device.masses()[1], device.links()[0]), (mass, belt));
    /// # Ok::<(), haptic_model::chain::ChainError>(())
    /// ```
    pub fn lumped(&self, masses: usize) -> Self {
        let mut lumped = self.clone();
        while lumped.masses.len() > masses {
            let rate = |link: &usize| lumped.rate(*link);
            let links = 0..lumped.links.len();
            let Some(fastest) = links.max_by(|a, b| rate(a).total_cmp(&rate(b))) else { break };
            lumped.weld(fastest);
        }
        lumped
    }

    /// Rate of a link in 1/s: the modulus of the slower root of `s^2 + c w s + k w = 0`, with
    /// `w = 1/m1 + 1/m2` of the masses at its ends.
    fn rate(&self, link: usize) -> f64 {
        let Link { stiffness, damping } = self.links[link];
        let mobility = 1.0 / self.masses[link].inertia + 1.0 / self.masses[link + 1].inertia;
        let (square, twice) = (stiffness * mobility, damping * mobility);
        match twice * twice - 4.0 * square {
            creeps if creeps > 0.0 => 2.0 * square / (twice + creeps.sqrt()),
            _ => square.sqrt(),
        }
    }

    fn weld(&mut self, link: usize) {
        self.links.remove(link);
        let Mass { inertia, damping } = self.masses.remove(link + 1);
        self.masses[link].inertia += inertia;
        self.masses[link].damping += damping;
    }
}
