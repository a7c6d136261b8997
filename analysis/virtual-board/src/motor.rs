//! An electrical motor at the three terminals of a bridge: exact currents between switching instants.
//!
//! Each phase is a resistance, an inductance and a back-EMF in series; the three meet at a neutral point that
//! nothing else is connected to. A brushed motor is the same circuit with half of the winding at each of two
//! terminals. While the voltages at the terminals are constant, each current is an exponential, so a step of
//! any length is exact. The back-EMF is constant between two updates of speed and angle.

use std::array;
use std::f64::consts::TAU;

/// The kind of the windings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Winding {
    /// One winding, at the first two wires.
    Brushed,
    /// Three in a star, with a sinusoidal back-EMF.
    Brushless {
        /// Electrical turns in a turn of the shaft.
        pole_pairs: u32,
        /// Electrical angle at the shaft's angle zero, in rad; it is zero where the first phase links the
        /// most flux.
        offset: f64,
    },
}

/// A leg of the bridge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leg {
    /// The switch to the supply is on.
    High,
    /// The switch to ground is on.
    Low,
    /// Both are off: a current flows through a diode.
    Off,
}

/// A rail that a terminal is connected to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rail {
    Supply,
    Ground,
}

/// Integrals over an interval of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Torque, in N m s.
    pub torque: f64,
    /// Charge that the supply has delivered, in A s.
    pub charge: f64,
    /// Heat in the windings, in J.
    pub heat: f64,
    /// Power of the currents against the back-EMF, in J.
    pub work: f64,
}

impl std::ops::AddAssign for Totals {
    fn add_assign(&mut self, more: Self) {
        self.torque += more.torque;
        self.charge += more.charge;
        self.heat += more.heat;
        self.work += more.work;
    }
}

/// A motor with its wires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Its windings.
    pub winding: Winding,
    /// Resistance in Ω: between the two wires of a brushed motor, of one phase of a brushless one.
    pub resistance: f64,
    /// Inductance in H, of the same.
    pub inductance: f64,
    /// N m for each A; of a brushless motor, for each A of the currents' amplitude at the best angle.
    pub torque_constant: f64,
    /// Which of the motor's wires is at each terminal of the bridge.
    pub wires: [usize; 3],
    /// Terminals whose wire is broken.
    pub open: [bool; 3],
    /// A short circuit between all three wires, as resistance in Ω and inductance in H from each to their
    /// common point. It hides the motor.
    pub short: Option<(f64, f64)>,
    /// Currents from the terminals into the motor, in A.
    currents: [f64; 3],
    /// Torque of each terminal's current, in N m/A, and its back-EMF, in V s/rad.
    shape: [f64; 3],
    /// Speed of the shaft in rad/s.
    speed: f64,
}

/// Currents below this, in A, have ended.
const NONE: f64 = 1e-12;
/// Largest number of diodes that begin or end to conduct between two switching instants.
const CHANGES: usize = 16;

impl Motor {
    /// A motor at rest at an angle of zero, without current.
    pub fn new(winding: Winding, resistance: f64, inductance: f64, torque_constant: f64) -> Self {
        let mut motor = Self {
            winding,
            resistance,
            inductance,
            torque_constant,
            wires: [0, 1, 2],
            open: [false; 3],
            short: None,
            currents: [0.0; 3],
            shape: [0.0; 3],
            speed: 0.0,
        };
        motor.turn(0.0, 0.0);
        motor
    }

    /// Sets the shaft's angle in rad and its speed in rad/s.
    pub fn turn(&mut self, angle: f64, speed: f64) {
        self.speed = speed;
        self.shape = array::from_fn(|terminal| self.shape_of(self.wires[terminal], angle));
    }

    fn shape_of(&self, wire: usize, angle: f64) -> f64 {
        match self.winding {
            Winding::Brushed => [0.5, -0.5, 0.0][wire] * self.torque_constant,
            Winding::Brushless { pole_pairs, offset } => {
                let electrical = f64::from(pole_pairs) * angle + offset;
                // The flux is the cosine; three phases share the torque, and 3/2 is their sum.
                let phase = electrical - wire as f64 * TAU / 3.0;
                -phase.sin() * self.torque_constant / 1.5
            }
        }
    }

    /// Currents from the terminals into the motor, in A.
    pub fn currents(&self) -> [f64; 3] {
        self.currents
    }

    /// The current in the switch or the diode to ground, from ground to the motor, in A.
    pub fn low_side_current(&self, terminal: usize, leg: Leg) -> f64 {
        let current = self.currents[terminal];
        match leg {
            Leg::Low => current,
            Leg::Off => current.max(0.0),
            Leg::High => 0.0,
        }
    }

    /// Torque in N m.
    pub fn torque(&self) -> f64 {
        (0..3).map(|terminal| self.currents[terminal] * self.factor(terminal)).sum()
    }

    /// Energy in the inductances, in J.
    pub fn stored(&self) -> f64 {
        let squares: f64 = self.currents.iter().map(|current| current * current).sum();
        0.5 * self.phase().1 * squares
    }

    /// Largest change of a current in A within a time in s, for any switching: at most the supply and two
    /// back-EMFs, and as much again over the resistance, are at an inductance.
    pub fn largest_change(&self, supply: f64, seconds: f64) -> f64 {
        let (resistance, inductance) = self.phase();
        let back_emf = (0..3).map(|terminal| self.back_emf(terminal).abs()).fold(0.0, f64::max);
        let driving = supply + 2.0 * back_emf;
        let current = self.currents.iter().map(|current| current.abs()).fold(0.0, f64::max);
        (driving + driving.max(resistance * current)) / inductance * seconds
    }

    /// Advances by a time in s, with these legs and this voltage of the supply.
    pub fn advance(&mut self, legs: [Leg; 3], supply: f64, seconds: f64) -> Totals {
        let mut totals = Totals::default();
        let mut left = seconds;
        for _ in 0..CHANGES {
            let rails = self.rails(legs, supply);
            let settled = self.settled(rails, supply);
            let step = self.until_a_diode_ends(legs, settled, left);
            totals += self.flow(rails, settled, step);
            if step >= left {
                return totals;
            }
            left -= step;
        }
        let rails = self.rails(legs, supply);
        totals += self.flow(rails, self.settled(rails, supply), left);
        totals
    }

    /// Resistance and inductance from a terminal to the common point.
    fn phase(&self) -> (f64, f64) {
        match (self.short, self.winding) {
            (Some(short), _) => short,
            (None, Winding::Brushed) => (0.5 * self.resistance, 0.5 * self.inductance),
            (None, Winding::Brushless { .. }) => (self.resistance, self.inductance),
        }
    }

    fn factor(&self, terminal: usize) -> f64 {
        if self.short.is_some() { 0.0 } else { self.shape[terminal] }
    }

    fn back_emf(&self, terminal: usize) -> f64 {
        self.factor(terminal) * self.speed
    }

    /// Whether a terminal leads to a winding.
    fn is_connected(&self, terminal: usize) -> bool {
        let has_winding =
            self.short.is_some() || self.winding != Winding::Brushed || self.wires[terminal] < 2;
        has_winding && !self.open[terminal]
    }

    /// The rails that currents flow to; none where no current flows.
    fn rails(&mut self, legs: [Leg; 3], supply: f64) -> [Option<Rail>; 3] {
        let mut rails = array::from_fn(|terminal| self.rail(terminal, legs[terminal]));
        // Each round connects one more terminal, or is the last.
        while let Some((terminal, rail)) = self.begins_to_conduct(&rails, legs, supply) {
            rails[terminal] = Some(rail);
        }
        rails
    }

    fn rail(&mut self, terminal: usize, leg: Leg) -> Option<Rail> {
        if !self.is_connected(terminal) {
            self.currents[terminal] = 0.0;
            return None;
        }
        match leg {
            Leg::High => Some(Rail::Supply),
            Leg::Low => Some(Rail::Ground),
            Leg::Off if self.currents[terminal] > NONE => Some(Rail::Ground),
            Leg::Off if self.currents[terminal] < -NONE => Some(Rail::Supply),
            Leg::Off => {
                self.currents[terminal] = 0.0;
                None
            }
        }
    }

    /// A terminal without current that the back-EMF lifts above the supply or pulls below ground.
    fn begins_to_conduct(
        &self,
        rails: &[Option<Rail>; 3],
        legs: [Leg; 3],
        supply: f64,
    ) -> Option<(usize, Rail)> {
        let floats = |&terminal: &usize| {
            rails[terminal].is_none() && legs[terminal] == Leg::Off && self.is_connected(terminal)
        };
        if let Some(neutral) = self.neutral(rails, supply) {
            return (0..3).filter(floats).find_map(|terminal| {
                let level = neutral + self.back_emf(terminal);
                let above = (level > supply + NONE).then_some(Rail::Supply);
                let below = (level < -NONE).then_some(Rail::Ground);
                above.or(below).map(|rail| (terminal, rail))
            });
        }
        // Nothing fixes the neutral point's level: two diodes begin together.
        let by_back_emf = |a: &usize, b: &usize| self.back_emf(*a).total_cmp(&self.back_emf(*b));
        let highest = (0..3).filter(floats).max_by(by_back_emf)?;
        let lowest = (0..3).filter(floats).min_by(by_back_emf)?;
        let between = self.back_emf(highest) - self.back_emf(lowest);
        (between > supply + NONE).then_some((highest, Rail::Supply))
    }

    /// The neutral point's voltage: the sum of the currents' changes is zero. `None` if it floats.
    fn neutral(&self, rails: &[Option<Rail>; 3], supply: f64) -> Option<f64> {
        let (mut sum, mut number) = (0.0, 0.0);
        for (terminal, rail) in rails.iter().enumerate() {
            if let Some(rail) = rail {
                sum += volts(*rail, supply) - self.back_emf(terminal);
                number += 1.0;
            }
        }
        (number > 0.0).then(|| sum / number)
    }

    /// The settled currents with these voltages.
    fn settled(&self, rails: [Option<Rail>; 3], supply: f64) -> [f64; 3] {
        let neutral = self.neutral(&rails, supply).unwrap_or(0.0);
        array::from_fn(|terminal| {
            rails[terminal].map_or(0.0, |rail| {
                (volts(rail, supply) - neutral - self.back_emf(terminal)) / self.phase().0
            })
        })
    }

    /// Time until the first current through a diode is zero, at most `most`.
    fn until_a_diode_ends(&self, legs: [Leg; 3], settled: [f64; 3], most: f64) -> f64 {
        let (resistance, inductance) = self.phase();
        let ends = |terminal: usize| {
            let (from, to) = (self.currents[terminal], settled[terminal]);
            let ends = legs[terminal] == Leg::Off && from * to < 0.0;
            ends.then(|| inductance / resistance * (-from / to).ln_1p())
        };
        (0..3).filter_map(ends).fold(most, f64::min)
    }

    /// Lets the currents move towards their settled values for a time.
    fn flow(&mut self, rails: [Option<Rail>; 3], settled: [f64; 3], seconds: f64) -> Totals {
        let (resistance, inductance) = self.phase();
        let lag = inductance / resistance;
        let gone = -(-seconds / lag).exp_m1();
        let mut totals = Totals::default();
        for terminal in 0..3 {
            let (to, off) = (settled[terminal], self.currents[terminal] - settled[terminal]);
            let charge = to * seconds + off * lag * gone;
            // The integral of the square: of the settled part, of both, and of what decays.
            let square = to * to * seconds
                + 2.0 * to * off * lag * gone
                + 0.5 * off * off * lag * gone * (2.0 - gone);
            totals.torque += self.factor(terminal) * charge;
            totals.work += self.back_emf(terminal) * charge;
            totals.heat += resistance * square;
            if rails[terminal] == Some(Rail::Supply) {
                totals.charge += charge;
            }
            self.currents[terminal] -= off * gone;
        }
        totals
    }
}

fn volts(rail: Rail, supply: f64) -> f64 {
    match rail {
        Rail::Supply => supply,
        Rail::Ground => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Leg::{High, Low, Off};

    const SUPPLY: f64 = 24.0;
    const RESISTANCE: f64 = 0.8;
    const INDUCTANCE: f64 = 6e-4;
    const CONSTANT: f64 = 0.05;

    fn brushed() -> Motor {
        Motor::new(Winding::Brushed, RESISTANCE, INDUCTANCE, CONSTANT)
    }

    fn brushless() -> Motor {
        let winding = Winding::Brushless { pole_pairs: 7, offset: 0.4 };
        Motor::new(winding, RESISTANCE, INDUCTANCE, CONSTANT)
    }

    fn assert_near(value: f64, expected: f64, tolerance: f64) {
        assert!((value - expected).abs() <= tolerance, "{value} in place of {expected}");
    }

    #[test]
    fn a_step_of_voltage_is_an_exponential_of_the_winding() {
        for (steps, supply) in [(1, SUPPLY), (1000, 10.0)] {
            let mut motor = brushed();
            let seconds = 1.3e-3;
            for _ in 0..steps {
                motor.advance([High, Low, Off], supply, seconds / f64::from(steps));
            }
            let closed = supply / RESISTANCE * (1.0 - (-seconds * RESISTANCE / INDUCTANCE).exp());
            assert_near(motor.currents()[0], closed, 1e-10);
            assert_near(motor.currents()[1], -closed, 1e-10);
            assert_eq!(motor.currents()[2], 0.0);
            assert_near(motor.torque(), CONSTANT * closed, 1e-12);
        }
    }

    /// Torque times speed is the power of the currents against the back-EMF, and its constant is that of
    /// currents in the best angle, wherever the rotor is and however the wires are permuted.
    #[test]
    fn the_best_currents_have_the_torque_constant_at_every_angle() {
        for wires in [[0, 1, 2], [2, 0, 1], [1, 0, 2]] {
            for step in 0..24 {
                let angle = f64::from(step) * 0.31;
                let mut motor = brushless();
                motor.wires = wires;
                motor.turn(angle, 0.0);
                let electrical = 7.0 * angle + 0.4;
                motor.currents =
                    wires.map(|wire| -3.0 * (electrical - wire as f64 * TAU / 3.0).sin());
                assert_near(motor.torque(), 3.0 * CONSTANT, 1e-12);
            }
        }
    }

    /// At the angle of zero, a current into the first phase holds the rotor: it is pulled back.
    #[test]
    fn a_current_in_the_first_phase_holds_the_rotor_where_its_flux_is_largest() {
        let mut motor = Motor::new(
            Winding::Brushless { pole_pairs: 1, offset: 0.0 },
            RESISTANCE,
            INDUCTANCE,
            CONSTANT,
        );
        motor.currents = [2.0, -1.0, -1.0];
        for (angle, torque) in
            [(0.0, 0.0), (0.25 * TAU, -2.0 * CONSTANT), (-0.25 * TAU, 2.0 * CONSTANT)]
        {
            motor.turn(angle, 0.0);
            assert_near(motor.torque(), torque, 1e-12);
        }
    }

    #[test]
    fn no_current_changes_faster_than_is_said() {
        let states = [[High, Low, Low], [Off, High, Low], [Low, Off, High], [Off, Off, Off]];
        let mut closest: f64 = 0.0;
        for motor in [brushed(), brushless()] {
            for (round, legs) in (0..4000).zip(states.into_iter().cycle()) {
                let mut motor = motor;
                let phase = 0.37 * f64::from(round);
                motor.turn(phase, 700.0 * phase.sin());
                motor.currents = [0.0, 1.0, 2.0].map(|k| 30.0 * (phase + k * TAU / 3.0).cos());
                for seconds in [1e-7, 6e-6, 1e-3] {
                    let (mut after, bound) = (motor, motor.largest_change(SUPPLY, seconds));
                    after.advance(legs, SUPPLY, seconds);
                    for (before, after) in motor.currents.into_iter().zip(after.currents) {
                        // A terminal without a winding has no current to lose.
                        let change = if motor.is_connected(2) || after != 0.0 {
                            after - before
                        } else {
                            0.0
                        };
                        assert!(change.abs() <= bound, "{change} A of {bound} A");
                        closest = closest.max(change.abs() / bound);
                    }
                }
            }
        }
        assert!(closest > 0.5, "the bound is of some use: {closest}");
    }

    #[test]
    fn energy_is_neither_made_nor_lost() {
        let mut legs = [[High, Low, Low], [High, High, Low], [Off, High, Low], [Off, Off, Off]];
        for (round, mut motor) in [brushed(), brushless(), brushless()].into_iter().enumerate() {
            if round == 2 {
                motor.open[1] = true;
            }
            let mut energy = 0.0;
            for step in 0..400 {
                motor.turn(0.01 * f64::from(step), 60.0);
                let stored = motor.stored();
                let totals = motor.advance(legs[step as usize % 4], SUPPLY, 2.1e-5);
                let given = SUPPLY * totals.charge - totals.heat - totals.work;
                assert_near(motor.stored() - stored, given, 1e-12);
                assert_near(totals.work, 60.0 * totals.torque, 1e-12);
                assert_near(motor.currents().iter().sum(), 0.0, 1e-9);
                energy += totals.heat;
            }
            assert!(energy > 1e-3, "currents have flowed: {energy}");
            legs.rotate_left(1);
        }
    }

    #[test]
    fn currents_through_diodes_decay_to_zero_and_never_reverse() {
        for mut motor in [brushed(), brushless()] {
            motor.turn(0.2, 100.0);
            motor.advance([High, Low, Low], SUPPLY, 5e-4);
            let before = motor.currents();
            assert!(before[0] > 1.0);
            for _ in 0..2000 {
                motor.advance([Off; 3], SUPPLY, 1e-6);
                for (now, before) in motor.currents().into_iter().zip(before) {
                    assert!(now * before >= 0.0, "{now} after {before}");
                }
            }
            assert_eq!(motor.currents(), [0.0; 3]);
        }
    }

    #[test]
    fn a_bridge_that_is_off_rectifies_a_back_emf_above_the_supply_only() {
        for mut motor in [brushed(), brushless()] {
            // Between two of three phases, the back-EMF is up to 1.16 times the constant's.
            motor.turn(0.1, 0.85 * SUPPLY / CONSTANT);
            motor.advance([Off; 3], SUPPLY, 1e-2);
            assert_eq!(motor.currents(), [0.0; 3]);
            motor.turn(0.1, 2.0 * SUPPLY / CONSTANT);
            let totals = motor.advance([Off; 3], SUPPLY, 1e-2);
            assert!(totals.charge < 0.0 && totals.torque < 0.0, "it brakes: {totals:?}");
        }
    }
}
