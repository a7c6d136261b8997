//! A magnetic encoder's chip as a board reads it: what a scene has to state for that, and at another period.

use haptic_servo::current::B_G431B_ESC1;
use haptic_servo::latency::Latency;
use haptic_servo::magnetic::{Chip, ChipError, Transfers};
use haptic_servo::scene::{EncoderReading, Scene, TimeRange};

/// A chip, and where a board reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipOnBoard {
    /// The chip.
    pub chip: &'static Chip,
    /// Whether that board's own bridge drives the motor, which has its transfers before the updates of the current.
    pub has_bridge: bool,
}

impl ChipOnBoard {
    /// When the board makes its transfers for a scene.
    pub fn transfers(&self, scene: &Scene) -> Transfers {
        let (period, updates) = (scene.timing.period, scene.latency.actuator_updates);
        if self.has_bridge && updates > 0 {
            let interval = period / f64::from(updates);
            return Transfers::before_update(self.chip, interval, B_G431B_ESC1.clock);
        }
        Transfers::at_count(self.chip, period)
    }

    /// Checks that the certificate of a scene covers its readings, with these counts in a turn.
    ///
    /// # Errors
    /// The number of the scene that is not the chip's.
    pub fn check(&self, scene: &Scene, counts: f64) -> Result<(), ChipError> {
        self.chip.check(&scene.latency, &self.transfers(scene), counts)
    }

    /// The age in s that its readings have, where they have the stated one of a scene, at the period and the updates
    /// of another: an AS504x reads what it has sampled a transfer before.
    pub fn age_in(&self, scene: &Scene, other: &Scene) -> TimeRange {
        let TimeRange { least, most } = scene.latency.encoder.age;
        let [before, after] = [scene, other].map(|scene| self.chip.age_in(&self.transfers(scene)));
        if before == after {
            return scene.latency.encoder.age;
        }
        // Outwards to nanoseconds, but for the rounding of the sum.
        const ROUNDED: f64 = 1e-3;
        let least = ((least + (after.least - before.least)) * 1e9 + ROUNDED).floor();
        let most = ((most + (after.most - before.most)) * 1e9 - ROUNDED).ceil();
        TimeRange::between(least.max(0.0) / 1e9, most.max(0.0) / 1e9)
    }
}

/// The times of a scene with another age of its encoder's readings in s.
pub fn with_age(latency: &Latency, age: TimeRange) -> Latency {
    if age == latency.encoder.age {
        return *latency;
    }
    reread(latency, EncoderReading { age, ..*latency.encoder })
}

/// The times of a scene with other readings of its encoder.
pub fn reread(latency: &Latency, encoder: EncoderReading) -> Latency {
    let before = latency.encoder;
    let TimeRange { least, most } = latency.output_delay;
    let delay = encoder.age.middle() - before.age.middle();
    Latency {
        output_delay: TimeRange::between(least + delay, most + delay),
        count_jitter: latency.count_jitter - before.deviation_of_age() + encoder.deviation_of_age(),
        // A scene refers to it.
        encoder: Box::leak(Box::new(encoder)),
        ..*latency
    }
}
