//! What a host wanted and got in a run, and what the hand took of the budget.

use haptic_servo::host::HostTorque;

use super::law::HostLaw;
use super::servo::HostTick;

/// What a host did in a run, a value a tick.
#[derive(Clone, Debug)]
pub struct HostRun {
    /// Its law.
    pub law: HostLaw,
    /// What it may do.
    pub budget: HostTorque,
    /// Period in s.
    pub period: f64,
    /// What it wanted and got.
    pub ticks: Vec<HostTick>,
    /// Energy in J that the hand has taken by the end of the tick.
    pub taken: Vec<f64>,
}

impl HostRun {
    /// The budget in J at the end of a tick.
    pub fn budget_at(&self, tick: usize) -> f64 {
        self.budget.energy + self.budget.power * self.time(tick)
    }

    /// The end of a tick in s.
    pub fn time(&self, tick: usize) -> f64 {
        (tick + 1) as f64 * self.period
    }

    /// The part of the wanted torque that was refused, and the number of ticks in which some was.
    pub fn refused(&self) -> (f64, usize) {
        let refused = |tick: &HostTick| (tick.wanted - tick.given).abs();
        let wanted: f64 = self.ticks.iter().map(|tick| tick.wanted.abs()).sum();
        let part: f64 = self.ticks.iter().map(refused).sum();
        let ticks = self.ticks.iter().filter(|tick| refused(tick) > 0.0).count();
        (if wanted > 0.0 { part / wanted } else { 0.0 }, ticks)
    }

    /// The ticks that end tenths of the run, or each of a short run.
    pub fn rows(&self) -> impl Iterator<Item = usize> {
        let (ticks, parts) = (self.ticks.len(), self.ticks.len().min(10));
        (1..=parts).map(move |part| ticks * part / parts - 1)
    }

    /// The largest part of the budget that was taken, and the time in s of that.
    pub fn most(&self) -> (f64, f64) {
        let parts = (0..self.taken.len())
            .map(|tick| (self.taken[tick] / self.budget_at(tick), self.time(tick)));
        parts.fold((0.0, 0.0), |most, next| if next.0 > most.0 { next } else { most })
    }
}
