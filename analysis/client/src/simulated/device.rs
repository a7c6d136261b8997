//! The surroundings of a simulated board: encoder, motor, device and hand.

use haptic_model::device::{Energy, Motion};
use haptic_model::disturbance::Disturbance;
use haptic_model::hand::HandTrajectory;
use haptic_model::missed::Missed;
use haptic_model::simulation::SimulationError;
use haptic_model::simulation::device_in_hand::{DeviceInHand, ReadingOutcome};
use haptic_servo::scene::{Latency, Scene, Timing};
use haptic_servo::servo::Transducers;

/// Source of the encoder's counts and sink of the DAC codes.
pub trait PlantIo {
    /// The counter's content now; `None` at the end of a recording.
    fn count(&mut self) -> Option<i32>;
    /// What has come of the reading of this count.
    fn reading(&self) -> ReadingOutcome {
        ReadingOutcome::Read
    }
    /// Outputs the code of this tick, which is held until that of the next tick.
    fn hold(&mut self, code: u16);
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

    /// The same with readings of the encoder that fail.
    pub fn failing(self, dropped: Missed) -> Self {
        Self { device: self.device.failing(dropped), ..self }
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

    fn reading(&self) -> ReadingOutcome {
        self.device.reading()
    }

    fn hold(&mut self, code: u16) {
        self.push(self.device.torque(code));
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::dac::DacCode;
    use haptic_servo::environment::Wall;
    use haptic_servo::scene::{Coupling, Device};

    use super::*;

    /// A free device is accelerated by the first code from its phase on, and by the previous code until then.
    #[test]
    fn a_code_acts_from_its_phase_on() {
        let (inertia, damping, period, phase) = (2.2e-5, 0.022, 1e-3, 2e-4);
        let scene = Scene {
            coupling: Coupling::Matched,
            latency: Latency::delayed(phase),
            ..Scene::of(Device::damped(inertia, damping), period, Wall::spring(22.0, 0).alone())
        };
        let transducers = Transducers::of(61_440.0, 2.0);
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
