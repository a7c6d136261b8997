//! From reset to a servo that may run, in an order in which nothing can move by surprise:
//! amplifier off, converter at mid-scale, self-check, encoder zeroed, watchdog; and then, in the
//! servo's first tick, amplifier on, and from there on the clamp opens step by step.

use core::hint::black_box;

use crate::cycle::{Cycle, Hardware, Options, Requests};
use crate::dac::DacCode;
use crate::environment::Renderable;
use crate::fault::{Fault, Retained};
use crate::number::Number;
use crate::scene::Scene;
use crate::servo::{OutputMode, Rendering, RenderingOptions, Renders, Step, Transducers};
use crate::tuning::{self, Prepared, Tunable};

/// What a board has besides, before its servo runs.
pub trait Startup: Hardware {
    /// Sets the encoder's counter to zero: where the device is now is its zero.
    fn zero(&mut self);
    /// Starts the watchdog. From here on only the servo feeds it.
    fn guard(&mut self);
    /// The words that outlived the reset; see [`Retained`].
    fn kept(&mut self) -> [u32; Retained::WORDS];
    /// Whether the watchdog was the reset's cause.
    fn was_reset_by_watchdog(&mut self) -> bool;
    /// Timer counts in the servo's period.
    fn period(&self) -> u32;
}

/// What a program brings.
#[derive(Clone, Copy, Debug)]
pub struct Program<E> {
    /// The scene that was certified when the program was compiled.
    pub scene: Scene<E>,
    /// Sensor and motor.
    pub transducers: Transducers,
    /// How the scene is rendered.
    pub rendering: RenderingOptions,
    /// What the cycle does beside it.
    pub options: Options,
}

/// A board whose servo may run.
#[derive(Clone, Debug)]
pub struct Booted<E: Renderable<N>, N: Number, M> {
    /// What its interrupt runs.
    pub cycle: Cycle<E, N, M>,
    /// Damping in N m s/rad that the device may lose with this scene running.
    pub margin: Option<f64>,
    /// What was left from before the reset.
    pub left: Option<Retained>,
}

/// Everything up to the first tick. Arms the servo, unless something was left from before the
/// reset: then it stays off until somebody arms it.
///
/// # Errors
/// Where the self-check fails: in which step, whose reason [`tuning::explain`] has. The amplifier is off and the converter at mid-scale then.
pub fn boot<E, N, M>(
    program: &Program<E>,
    hardware: &mut impl Startup,
    requests: &Requests<'_, Rendering<E, N, M>>,
) -> Result<Booted<E, N, M>, Step>
where
    E: Tunable<N> + Renders<M>,
    N: Number,
    M: OutputMode,
{
    hardware.amplifier(false);
    hardware.write(DacCode::MID_SCALE);
    // Hidden from the optimiser, which would otherwise judge a constant scene when it compiles.
    let scene = black_box(program.scene);
    let Prepared { rendering, margin, .. } =
        tuning::prepare(&scene, &[], &program.transducers, &program.rendering)?;
    hardware.zero();
    let left = left(hardware);
    let fault = left.map(|left| left.fault);
    let cycle = Cycle::new(rendering, &program.options, hardware.period(), fault);
    hardware.guard();
    if left.is_none() {
        requests.arm();
    }
    Ok(Booted { cycle, margin, left })
}

/// What was left from before the reset.
fn left(hardware: &mut impl Startup) -> Option<Retained> {
    let by_watchdog = hardware.was_reset_by_watchdog();
    // A panic or a hard fault lets the watchdog reset the board: what it wrote says more.
    Retained::decode(&hardware.kept()).or(by_watchdog.then_some(Retained {
        fault: Fault::Watchdog,
        tick: 0,
        count: 0,
    }))
}
