//! The energy that a hand takes from a host, from the motion alone: nothing here knows of a tank.

use std::collections::VecDeque;

use haptic_servo::host::HostTorque;
use haptic_servo::scene::Latency;

use crate::sampled_actuator::SampledActuator;

/// The energy that a passive hand has taken from a host: at least the work of the host's torque at the motor, less
/// what the host's share of the damping takes (theory, section 19).
///
/// With `d` the step of the position in a period `T`, `m` the mean of the torque and `rho` its ripple, a motion
/// takes `integral (F v - delta' v^2) <= m d - delta' d^2/T + rho/(4 delta')`. Without a lag, `rho` is zero but
/// in periods in which the torque changes.
#[derive(Clone, Debug)]
pub struct HostEnergy {
    damping: f64,
    period: f64,
    /// Time in s from the begin of a period to the change of the torque.
    part: f64,
    /// Time constant of the amplifier in s, and its updates if it has some.
    lag: f64,
    updated: Option<SampledActuator>,
    /// Time in s since its last update.
    since: f64,
    /// Torques in N m that have not acted yet, the newest first.
    commands: VecDeque<f64>,
    /// The motor's torque in N m of the host.
    torque: f64,
    taken: f64,
}

impl HostEnergy {
    /// For a servo with this period in s, from whose count to the output are whole `ticks` and the latency of the
    /// scene, with the middle of each time.
    pub fn new(host: &HostTorque, latency: &Latency, period: f64, ticks: usize) -> Self {
        let delay = latency.output_delay.middle() / period;
        let (part, updated) = (delay.fract() * period, SampledActuator::of(latency, period));
        // A torque begins with an update.
        let since = updated.map_or(0.0, |amplifier| match amplifier.after_update(part) {
            0.0 => 0.0,
            first => amplifier.between() - first,
        });
        Self {
            damping: host.damping,
            period,
            part,
            lag: latency.actuator_lag.middle(),
            updated,
            since,
            commands: VecDeque::from(vec![0.0; ticks + delay as usize + 1]),
            torque: 0.0,
            taken: 0.0,
        }
    }

    /// A period in which the position moves by so many rad, with the host's torque in N m that its tick gives.
    /// Returns the energy in J that was taken so far.
    pub fn tick(&mut self, given: f64, moved: f64) -> f64 {
        self.commands.push_front(given);
        let before = self.commands.pop_back().unwrap_or(0.0);
        let after = self.commands.back().copied().unwrap_or(0.0);
        let (mut once, mut twice) = (0.0, 0.0);
        for (command, length) in [(before, self.part), (after, self.period - self.part)] {
            let [first, second] = match self.updated {
                Some(amplifier) => self.in_straight_lines(&amplifier, command, length),
                None => self.lagging(command, length),
            };
            once += first;
            twice += second;
        }
        let mean = once / self.period;
        let ripple = (twice - mean * once).max(0.0);
        self.taken += mean * moved - self.damping * moved * moved / self.period;
        self.taken += 0.25 * ripple / self.damping;
        self.taken
    }

    /// The integrals of the torque and of its square over a time in s with this command, in N m.
    fn lagging(&mut self, command: f64, length: f64) -> [f64; 2] {
        let gap = self.torque - command;
        let left = if self.lag > 0.0 { (-length / self.lag).exp() } else { 0.0 };
        let first = gap * self.lag * (1.0 - left);
        self.torque = command + gap * left;
        let second = 0.5 * gap * gap * self.lag * (1.0 - left * left);
        [command * length + first, command * (command * length + 2.0 * first) + second]
    }

    /// The same of an amplifier that is updated.
    fn in_straight_lines(
        &mut self,
        amplifier: &SampledActuator,
        command: f64,
        length: f64,
    ) -> [f64; 2] {
        let (mut once, mut twice, mut left) = (0.0, 0.0, length);
        // Less than that is rounding.
        let (between, rounding) = (amplifier.between(), 1e-9 * amplifier.between());
        while left > rounding {
            let (from, step) = (self.torque, left.min(between - self.since));
            let to = from + amplifier.slope(self.since) * step * (command - from);
            once += 0.5 * (from + to) * step;
            twice += (from * from + from * to + to * to) / 3.0 * step;
            (self.torque, self.since, left) = (to, self.since + step, left - step);
            if between - self.since <= rounding {
                self.since = 0.0;
            }
        }
        [once, twice]
    }
}
