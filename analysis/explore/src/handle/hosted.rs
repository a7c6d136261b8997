//! A servo with a host that wants energy beside it, and what the hand takes of the budget.

use haptic_model::controller::Controller;
use haptic_model::file::SceneFile;
use haptic_model::host::{HostEnergy, HostSender, HostedServo, HostileHost, unlimited};
use haptic_model::verdict::{Verdict, judge_file_without_remedies};
use haptic_servo::host::HostTorque;
use haptic_servo::number::Format;
use haptic_servo::servo::{OutputTiming, Transducers};
use serde::Serialize;

/// A servo with a host beside it.
pub struct Hosted {
    pub servo: HostedServo<'static>,
    energy: HostEnergy,
    budget: HostTorque,
    period: f64,
    /// Time in s since it began.
    time: f64,
    taken: f64,
    /// Sums of torques in N m that were wanted, and refused.
    wanted: f64,
    refused: f64,
}

/// What the hand has taken since the host began.
#[derive(Debug, Serialize)]
pub struct HostMoved {
    /// In J.
    taken: f64,
    /// In J.
    budget: f64,
    /// The part of the wanted torque that was refused.
    refused: f64,
}

impl Hosted {
    /// A full tank beside a certified servo that stands at this count.
    ///
    /// # Errors
    /// If there is no such host, or the scene may not have one.
    pub fn new(
        servo: Box<dyn Controller>,
        file: &SceneFile,
        transducers: &Transducers,
        (law, has_no_tank): (&str, bool),
        count: i32,
    ) -> Result<Self, String> {
        let law = law.parse()?;
        let budget = file.host.ok_or("the scene has no table `host` with a budget")?;
        let report = judge_file_without_remedies(file);
        if report.verdict != Verdict::Certified {
            return Err(report.message);
        }
        let (scene, output) = (&file.scene, OutputTiming::Simultaneous);
        let period = scene.timing.period;
        let given = if has_no_tank { unlimited(&budget, period) } else { budget };
        let host = HostileHost::new(law, budget.torque);
        let sender = HostSender::new(host, period, transducers, count);
        let kind = (Format::F32, file.supply.is_some_and(|supply| supply.stores()));
        let servo = HostedServo::new(servo, &given, scene, transducers, output, kind);
        let servo = servo.map_err(|error| error.to_string())?;
        Ok(Self {
            servo: servo.driven_by(sender).standing_at(count),
            energy: HostEnergy::new(&budget, &scene.latency, period, 0),
            budget,
            period,
            time: 0.0,
            taken: 0.0,
            wanted: 0.0,
            refused: 0.0,
        })
    }

    /// Its largest torque in N m.
    pub const fn largest(&self) -> f64 {
        self.budget.torque
    }

    /// Adds the tick that has just passed, in which the device moved by so many rad.
    pub fn add(&mut self, moved: f64) {
        let tick = self.servo.last();
        self.time += self.period;
        self.taken = self.energy.tick(tick.given, moved);
        self.wanted += tick.wanted.abs();
        self.refused += (tick.wanted - tick.given).abs();
    }

    /// What the hand has taken.
    pub fn moved(&self) -> HostMoved {
        let HostTorque { energy, power, .. } = self.budget;
        let refused = if self.wanted > 0.0 { self.refused / self.wanted } else { 0.0 };
        HostMoved { taken: self.taken, budget: energy + power * self.time, refused }
    }
}
