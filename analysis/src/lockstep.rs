//! The tick-by-tick loop of a servo and its surroundings: a recording, or a simulated device with encoder,
//! motor and hand. A remote servo may run in lockstep, and its codes are compared.

use std::fmt;

use haptic_servo::scene::{Latency, Scene, Timing};
use haptic_servo::servo::Transducers;

use crate::controller::{Controller, Tick};
use crate::device::{Energy, Motion};
use crate::disturbance::Disturbance;
use crate::hand::HandTrajectory;
use crate::simulation::SimulationError;
use crate::simulation::device_in_hand::DeviceInHand;

/// Source of the encoder's counts and sink of the DAC codes.
pub trait PlantIo {
    /// The counter's content now; `None` at the end of a recording.
    fn count(&mut self) -> Option<i32>;
    /// Outputs the code of this tick, which is held until that of the next tick.
    fn hold(&mut self, code: u16);
}

/// A recording: the DAC code changes nothing.
pub struct Recording<'a> {
    counts: std::slice::Iter<'a, i32>,
}

impl<'a> Recording<'a> {
    /// Plays the counts, one a tick.
    pub fn new(counts: &'a [i32]) -> Self {
        Self { counts: counts.iter() }
    }
}

impl PlantIo for Recording<'_> {
    fn count(&mut self) -> Option<i32> {
        self.counts.next().copied()
    }

    fn hold(&mut self, _: u16) {}
}

/// A simulated device in a hand that follows a trajectory.
pub struct SimulatedDevice {
    device: DeviceInHand,
    trajectory: HandTrajectory,
    period: f64,
    ticks: u64,
    let_go: bool,
}

impl SimulatedDevice {
    /// A scene's device at rest at zero, with the encoder and the motor of the servo.
    pub fn new(
        scene: &Scene,
        trajectory: HandTrajectory,
        transducers: &Transducers,
    ) -> Result<Self, SimulationError> {
        let device = DeviceInHand::new(scene, trajectory.hand, transducers)?;
        Ok(Self { device, trajectory, period: scene.timing.period, ticks: 0, let_go: false })
    }

    /// The same with friction and cogging of its motor.
    pub fn with_disturbance(self, disturbance: Disturbance) -> Self {
        Self { device: self.device.with_disturbance(disturbance), ..self }
    }

    /// The same on the shaft of a motor whose torque comes from elsewhere, in steps of this length in s.
    pub fn on_shaft(
        scene: &Scene,
        trajectory: HandTrajectory,
        transducers: &Transducers,
        step: f64,
    ) -> Result<Self, SimulationError> {
        let timing = Timing { period: step, worst_period: None };
        // Its encoder is that of the scene.
        let latency = Latency::NONE.read_by(scene.latency.encoder);
        Self::new(&Scene { timing, latency, ..*scene }, trajectory, transducers)
    }

    /// The hand lets go, or follows its trajectory.
    pub fn let_go(&mut self, let_go: bool) {
        self.let_go = let_go;
    }

    /// A step with this motor torque in N m.
    pub fn push(&mut self, torque: f64) {
        let start = self.ticks as f64 * self.period;
        self.ticks += 1;
        let setpoint = self.trajectory.setpoint(start, self.ticks as f64 * self.period);
        let is_held = start < self.trajectory.release && !self.let_go;
        self.device.push(torque, setpoint, is_held);
    }

    /// The present motion of the device.
    pub fn motion(&self) -> Motion {
        self.device.motion()
    }

    /// Energy that passed between hand and device so far.
    pub fn energy(&self) -> Energy {
        self.device.energy()
    }
}

impl PlantIo for SimulatedDevice {
    fn count(&mut self) -> Option<i32> {
        Some(self.device.count())
    }

    fn hold(&mut self, code: u16) {
        self.push(self.device.torque(code));
    }
}

/// The same servo on a board: it gets the same counts.
pub trait RemoteServo {
    /// Why it could not answer.
    type Error;
    /// The board's code for a count.
    fn exchange(&mut self, raw: i32) -> Result<u16, Self::Error>;
}

/// The first tick whose codes were not equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Difference {
    /// The tick, counted from 0.
    pub tick: usize,
    /// The counter's content.
    pub count: i32,
    /// The host's code.
    pub host: u16,
    /// The board's code.
    pub target: u16,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tick, count, host, target } = self;
        write!(
            f,
            "the codes differ first at tick {tick}, count {count}: {host} on the host, {target} on \
             the target"
        )
    }
}

/// The result of a run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// The ticks in order; the codes are the host's.
    pub ticks: Vec<Tick>,
    /// Ticks whose codes were equal to the remote servo's.
    pub equal: usize,
    /// The first difference, if there is one.
    pub difference: Option<Difference>,
}

impl Run {
    /// Largest coupling torque in N m, without sign.
    pub fn peak_torque(&self) -> f64 {
        self.ticks.iter().fold(0.0, |peak, tick| tick.torque.abs().max(peak))
    }

    /// The host's next tick, of this count, beside the code that the remote servo gave.
    pub fn add(&mut self, count: i32, tick: Tick, target: u16) {
        if target == tick.code {
            self.equal += 1;
        } else if self.difference.is_none() {
            let (number, host) = (self.ticks.len(), tick.code);
            self.difference = Some(Difference { tick: number, count, host, target });
        }
        self.ticks.push(tick);
    }
}

/// Runs at most `ticks` ticks. With a remote servo, its codes move the device, and the servo here is
/// compared with it. `progress` is called after each tick.
pub fn run<T: RemoteServo>(
    plant: &mut dyn PlantIo,
    controller: &mut dyn Controller,
    mut remote: Option<&mut T>,
    ticks: usize,
    mut progress: impl FnMut(),
) -> Result<Run, T::Error> {
    let mut run = Run::default();
    while run.ticks.len() < ticks
        && let Some(count) = plant.count()
    {
        let tick = controller.tick(count);
        let code = match remote.as_mut() {
            Some(remote) => remote.exchange(count)?,
            None => tick.code,
        };
        plant.hold(code);
        run.add(count, tick, code);
        progress();
    }
    Ok(run)
}

/// No remote servo: for runs on the host alone.
pub enum NoRemote {}

impl RemoteServo for NoRemote {
    type Error = std::convert::Infallible;

    fn exchange(&mut self, _: i32) -> Result<u16, Self::Error> {
        match *self {}
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::dac::DacCode;
    use haptic_servo::encoder::CounterWidth;
    use haptic_servo::environment::Wall;
    use haptic_servo::scene::{Coupling, Device};

    use super::*;

    /// A free device is accelerated by the first code from its phase on, and by the previous code until then.
    #[test]
    fn a_code_acts_from_its_phase_on() {
        let (inertia, damping, period, phase) = (2.2e-5, 0.022, 1e-3, 2e-4);
        let wall = Wall::spring(22.0, 0);
        let scene = Scene {
            device: Device { inertia, damping, passivity: None },
            timing: Timing { period, worst_period: None },
            coupling: Coupling::Matched,
            environment: wall.alone(),
            latency: Latency::delayed(phase),
            torque_limit: None,
        };
        let transducers = Transducers {
            counts_per_turn: 61_440.0,
            counter: CounterWidth::Bits16,
            full_scale_torque: 2.0,
            largest_speed: 100.0,
        };
        let trajectory = HandTrajectory { release: 0.0, ..HandTrajectory::push_and_let_go() };
        let mut device = SimulatedDevice::new(&scene, trajectory, &transducers).unwrap();
        let rate = damping / inertia;
        // m v' = u - b v, with the code's torque from its phase on.
        let after = |velocity: f64, torque: f64, time: f64| {
            torque / damping + (velocity - torque / damping) * (-rate * time).exp()
        };
        let (mut velocity, mut before) = (0.0, 0.0);
        for codes in [500, -300, 0, 700] {
            device.hold(DacCode::MID_SCALE.get().wrapping_add_signed(codes));
            let torque = 2.0 * f64::from(codes) / f64::from(DacCode::CODES_TO_FULL_SCALE);
            velocity = after(after(velocity, before, phase), torque, period - phase);
            assert!((device.motion().velocity - velocity).abs() < 1e-11, "{codes}");
            before = torque;
        }
    }
}
