//! The tick-by-tick loop of a servo and its surroundings: a recording, or a simulated device with encoder,
//! motor and hand. A remote servo may run in lockstep, and its codes are compared.

use std::convert::Infallible;
use std::fmt;

pub use haptic_client::simulated::{PlantIo, ReadingOutcome, SimulatedDevice};

use crate::controller::{Controller, Tick};

/// Ticks at rest before a run, in which what a coupling stores of a constant torque settles.
const STANDING: usize = 1000;

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

    /// Begins a run of a servo that has stood at count 0, as a board has before its servo runs: a torque that the
    /// scene gives there is held.
    pub fn from_rest(controller: &mut dyn Controller) -> Self {
        for _ in 0..STANDING {
            let _: Tick = controller.tick(0);
        }
        Self::default()
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

/// Runs at most `ticks` ticks of a servo on this machine alone.
pub fn run(plant: &mut dyn PlantIo, controller: &mut dyn Controller, ticks: usize) -> Run {
    let own = |_, _, tick: &Tick| Ok::<_, Infallible>(tick.code);
    let Ok(run) = run_beside(plant, controller, own, ticks, || {});
    run
}

/// Runs at most `ticks` ticks. The codes of `remote`, for a count, whether its reading has failed, and the tick of
/// the servo here, move the device, and the servo here is compared with them. `progress` is called after each tick.
pub fn run_beside<E>(
    plant: &mut dyn PlantIo,
    controller: &mut dyn Controller,
    mut remote: impl FnMut(i32, bool, &Tick) -> Result<u16, E>,
    ticks: usize,
    mut progress: impl FnMut(),
) -> Result<Run, E> {
    let mut run = Run::from_rest(controller);
    while run.ticks.len() < ticks
        && let Some(count) = plant.count()
    {
        let reading = plant.reading();
        // Held: the first reading does not fail.
        let held = run.ticks.last().filter(|_| reading == ReadingOutcome::LeftOut);
        let (tick, code) = match held {
            Some(held) => (Tick { is_left_out: true, ..*held }, held.code),
            None => {
                let tick = controller.tick(count);
                (tick, remote(count, reading != ReadingOutcome::Read, &tick)?)
            }
        };
        plant.hold(code);
        run.add(count, tick, code);
        progress();
    }
    Ok(run)
}
