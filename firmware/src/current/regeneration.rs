//! The energy that a motor returns to a supply that takes nothing back (theory, section 17).
//!
//! A hand that pushes into a wall and lets go returns energy twice: the motor generates while it is pushed
//! back, and again while it stops the device. The energy stays in the capacitance at the bridge. If its voltage
//! reaches the fault level, the bridge is switched off, and the wall vanishes under the hand.

use core::f64::consts::TAU;

use crate::environment::{Parts, Profile, Wall};
use crate::matched::MatchedCoupling;
use crate::number::Format;
use crate::passivity::interval::Interval;
use crate::scene::{Coupling, Scene};
use crate::text::{Text, error_with_sentence, push};
use crate::transducers::Transducers;

/// Steps of the search for the torque limit: its relative error is below that of a double.
const STEPS: u32 = 60;

/// Relative distance of a remedy from its bound, more than its last written digit.
const MARGIN: f64 = 1e-8;

/// The largest push of a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// The torque limit in N m.
    pub torque: f64,
    /// Largest speed of the device in rad/s.
    pub speed: f64,
    /// Damping in N m s/rad that is injected.
    pub injected: f64,
    /// Energy in J that the motor's winding stores at full-scale current, and a flexible device at the torque
    /// limit; zero if not known.
    pub stored: f64,
}

impl Push {
    /// The push into a scene with these transducers, this injected damping in N m s/rad and this stored energy
    /// in J.
    pub const fn of<E>(
        scene: &Scene<E>,
        transducers: &Transducers,
        injection: Option<f64>,
        stored: f64,
    ) -> Self {
        let torque = match scene.torque_limit {
            Some(limit) => limit,
            None => transducers.full_scale_torque,
        };
        let injected = match injection {
            Some(damping) => damping,
            None => 0.0,
        };
        Self { torque, speed: transducers.largest_speed, injected, stored }
    }
}

/// The largest energies in J that a scene returns after a push, rounded up (equation 62).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReturnedEnergy {
    /// What the motor takes from the hand: of a spring the energy that it stores at the torque limit.
    pub pushed: f64,
    /// The kinetic energy of the device at its largest speed.
    pub kinetic: f64,
    /// What winding and device store.
    pub stored: f64,
}

impl ReturnedEnergy {
    /// The energy of a scene after a push; `None` if the push has no known end, as for a rational environment,
    /// an environment of another crate, or a damper without a spring.
    pub const fn of(scene: &Scene, push: &Push) -> Option<Self> {
        let Some(pushed) = pushed(scene, push) else { return None };
        let speed = Interval::decimal(push.speed);
        let kinetic = Interval::decimal(scene.device.inertia).half().mul(speed).mul(speed);
        Some(Self { pushed: pushed.hi(), kinetic: kinetic.hi(), stored: push.stored })
    }

    /// The sum, rounded up.
    pub const fn total(&self) -> f64 {
        let moved = Interval::exact(self.kinetic).add(Interval::exact(self.stored));
        Interval::exact(self.pushed).add(moved).hi()
    }
}

/// The energy in J that the motor takes from the hand in a push, rounded up in its upper end: the torque limit
/// over the largest depth, or for a wall at the port that of its spring and its damper.
const fn pushed(scene: &Scene, push: &Push) -> Option<Interval> {
    let torque = Interval::decimal(push.torque);
    let Some(coupling) = compliance(scene) else { return None };
    let parts = scene.environment.parts();
    if parts.others() > 0 || parts.anticogging.is_some() {
        return None;
    }
    let Parts { profile, wall, canceller, .. } = parts;
    let depth = match (profile, wall) {
        (None, Some(wall)) => match depth(wall, torque) {
            Some(depth) if coupling.is_zero() => return Some(at_the_port(wall, depth, push)),
            other => other,
        },
        (Some(profile), wall) => beside(profile, wall.as_ref(), torque),
        (None, None) if canceller.is_some() => Some(Interval::ZERO),
        (None, None) => None,
    };
    match depth {
        Some(depth) => Some(torque.mul(depth.add(torque.mul(coupling)))),
        None => None,
    }
}

/// Of a wall without a coupling: the spring's energy, and what dampers take over its depth.
const fn at_the_port(wall: &Wall, depth: Interval, push: &Push) -> Interval {
    let torque = Interval::decimal(push.torque);
    let damping = Interval::decimal(wall.damping().max(0.0)).add(Interval::decimal(push.injected));
    let damped = damping.mul(Interval::decimal(push.speed)).add(torque.half());
    torque.min(damped).mul(depth)
}

/// The depth in rad at which a wall has this torque at rest.
const fn depth(wall: &Wall, torque: Interval) -> Option<Interval> {
    let stiffness = Interval::decimal(wall.stiffness);
    if stiffness.is_positive() { Some(torque.div(stiffness)) } else { None }
}

/// The depth for a torque profile beside a wall: in the profile's range and the springs beyond it, a period of
/// a profile without ends; or where the wall alone has both torques.
const fn beside(profile: &Profile, wall: Option<&Wall>, torque: Interval) -> Option<Interval> {
    if let Some(wall) = wall {
        return depth(wall, torque.add(Interval::decimal(profile.torque.abs())));
    }
    match profile.ends {
        Some(ends) => {
            let stiffness = Interval::decimal(ends.stiffness);
            if !stiffness.is_positive() {
                return None;
            }
            let range = Interval::decimal(ends.to).sub(Interval::decimal(ends.from));
            Some(range.add(torque.div(stiffness).double()))
        }
        None => {
            let turn = Interval::exact(TAU).hi().next_up();
            Some(Interval::exact(turn).div(Interval::decimal(profile.count)))
        }
    }
}

/// Compliance of the coupling at rest in rad/(N m).
const fn compliance(scene: &Scene) -> Option<Interval> {
    match scene.coupling {
        Coupling::Rigid => Some(Interval::ZERO),
        Coupling::Spring { stiffness } => Some(Interval::ONE.div(Interval::decimal(stiffness))),
        Coupling::Matched => {
            let (timing, passivity) = (scene.timing, scene.device.passivity());
            let (period, longer) = (timing.period, timing.longer_period());
            match MatchedCoupling::of(period, longer, passivity, &scene.latency, Format::F64) {
                Some(coupling) => Some(coupling.compliance_at_rest()),
                None => None,
            }
        }
    }
}

/// The capacitance at a bridge whose supply takes no energy back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bus {
    /// The highest voltage in V that the supply itself delivers.
    pub voltage: f64,
    /// The least capacitance in F.
    pub capacitance: f64,
    /// The lowest voltage in V at which the bridge may switch itself off.
    pub fault_level: f64,
}

impl Bus {
    /// The highest voltage in V after the motor has returned this energy in J, rounded up (equation 63).
    pub const fn voltage_after(&self, energy: f64) -> f64 {
        let voltage = Interval::decimal(self.voltage);
        let risen = Interval::exact(energy).double().div(Interval::decimal(self.capacitance));
        voltage.mul(voltage).add(risen).sqrt().hi()
    }

    /// Energy in J that it stores between its voltage and the fault level, rounded down.
    pub const fn room(&self) -> f64 {
        let [level, voltage] =
            [Interval::decimal(self.fault_level), Interval::decimal(self.voltage)];
        let squares = level.mul(level).sub(voltage.mul(voltage));
        squares.half().mul(Interval::decimal(self.capacitance)).lo()
    }

    /// Checks that it stays below the fault level after a push into a scene; returns the energy.
    ///
    /// # Errors
    /// If it does not, or if no bound on the energy is known.
    pub const fn check(
        &self,
        scene: &Scene,
        push: &Push,
    ) -> Result<ReturnedEnergy, RegenerationError> {
        let Some(energy) = ReturnedEnergy::of(scene, push) else {
            return Err(RegenerationError::Unbounded);
        };
        if energy.total() < self.room() {
            return Ok(energy);
        }
        let torque = self.largest_torque(scene, push);
        Err(RegenerationError::OverVoltage { bus: *self, energy, torque })
    }

    /// The largest torque limit in N m with which it stays below the fault level; zero if none is known.
    const fn largest_torque(&self, scene: &Scene, push: &Push) -> f64 {
        let (mut least, mut most) = (0.0, push.torque);
        let mut step = 0;
        while step < STEPS {
            let torque = 0.5 * (least + most);
            match ReturnedEnergy::of(scene, &Push { torque, ..*push }) {
                Some(energy) if energy.total() < self.room() => least = torque,
                _ => most = torque,
            }
            step += 1;
        }
        // The stored energy is that of the larger torque.
        least * (1.0 - MARGIN)
    }

    /// The least capacitance in F for this energy in J; `None` if the supply alone reaches the fault level.
    pub const fn least_capacitance(&self, energy: f64) -> Option<f64> {
        let squares = self.fault_level * self.fault_level - self.voltage * self.voltage;
        if squares > 0.0 { Some(2.0 * energy / squares * (1.0 + MARGIN)) } else { None }
    }

    /// The largest voltage in V of the supply for this energy in J; `None` if none is low enough.
    pub const fn largest_voltage(&self, energy: f64) -> Option<f64> {
        let square = self.fault_level * self.fault_level - 2.0 * energy / self.capacitance;
        if square > 0.0 { Some(Interval::exact(square).sqrt().lo() * (1.0 - MARGIN)) } else { None }
    }
}

/// The reason why a supply that takes no energy back does not fit a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "each variant's description and sentence name its fields")]
pub enum RegenerationError {
    /// The returned energy raises it to its fault level; the largest torque limit in N m with which it stays below,
    /// zero if there is none.
    OverVoltage { bus: Bus, energy: ReturnedEnergy, torque: f64 },
    /// No bound on the energy is known for this environment.
    Unbounded,
}

impl RegenerationError {
    /// The error as a sentence, the same at compile time and later.
    pub const fn sentence(&self) -> Text<480> {
        let mut t = Text::new();
        let Self::OverVoltage { bus, energy, torque } = *self else {
            t.push(
                "no bound is known for the energy that this environment returns to its supply, which takes \
                 none: take a supply that sinks, such as one with a brake resistor",
            );
            return t;
        };
        let energy = energy.total();
        push!(t,
            "a hand that pushes and lets go returns up to " {energy} " J, which raises the " {bus.capacitance}
            " F at the bridge from " {bus.voltage} " to " {bus.voltage_after(energy)}
            " V, and the bridge may switch itself off at " {bus.fault_level} " V: take ");
        if let Some(capacitance) = bus.least_capacitance(energy) {
            push!(t, "at least " {capacitance} " F, ");
        }
        if let Some(voltage) = bus.largest_voltage(energy) {
            push!(t, "a supply of at most " {voltage} " V, ");
        }
        if torque > 0.0 {
            push!(t, "a torque limit of at most " {torque} " N m, ");
        }
        t.push("or a supply that sinks, such as one with a brake resistor");
        t
    }
}

error_with_sentence!(RegenerationError);
