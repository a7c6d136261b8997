//! Turns a change of parameters into a set that is ready to run, or into the reason for refusing it.
//!
//! The steps are those of a compiled scene: certificate, timing, servo. A set is built as a whole outside the
//! servo's interrupt; a refused set changes nothing.

mod error;

pub use crate::parameter::{NamedParameters, TUNABLE};
pub use error::{RenderError, TuningError};

use core::fmt;

use crate::build_error::BuildError;
use crate::certificate::{Parameter, certify_scene, scene_data, timing_checked};
use crate::current::{MAY_HAVE_BRIDGE, Push, ReturnedEnergy};
use crate::environment::{EnvironmentModel, SupportsTiming};
use crate::host::{BesideServo, HostResponse, HostTimes, ServoNumbers};
use crate::number::Number;
use crate::output_timing::OutputMode;
use crate::rendering::Rendering;
use crate::scene::Scene;
use crate::servo::{PreparedServo, RenderingOptions};
use crate::step::Step;
use crate::transducers::Transducers;

/// An environment whose scenes can be certified, checked for timing, rendered in the number format `N`, and
/// changed while they run.
pub trait Tunable<N: Number>: EnvironmentModel + Rendering<N> {}

impl<N: Number, E: EnvironmentModel + Rendering<N>> Tunable<N> for E {}

/// The tunable parameter of this name.
pub fn parameter(name: &str) -> Option<Parameter> {
    TUNABLE.iter().find(|(known, _)| *known == name).map(|(_, parameter)| *parameter)
}

/// The name of a tunable parameter.
pub fn name(parameter: Parameter) -> Option<&'static str> {
    TUNABLE.iter().find(|(_, known)| *known == parameter).map(|(name, _)| *name)
}

/// A subset of the [`TUNABLE`] parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parameters {
    /// One bit each, in the table's order.
    bits: u16,
}

const _: () = assert!(TUNABLE.len() <= u16::BITS as usize, "a bit for each");

impl Parameters {
    /// The subset of [`TUNABLE`] with these parameters.
    pub fn of(given: impl Iterator<Item = Parameter>) -> Self {
        let place = |parameter| TUNABLE.iter().position(|(_, known)| *known == parameter);
        Self { bits: given.filter_map(place).fold(0, |bits, i| bits | 1 << i) }
    }

    /// The parameters in the table's order.
    pub fn iter(self) -> impl Iterator<Item = Parameter> {
        TUNABLE
            .iter()
            .enumerate()
            .filter(move |(i, _)| self.bits >> i & 1 != 0)
            .map(|(_, (_, parameter))| *parameter)
    }
}

/// The names, with commas between them.
impl fmt::Display for Parameters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, name) in self.iter().filter_map(name).enumerate() {
            if i > 0 {
                f.write_str(", ")?;
            }
            f.write_str(name)?;
        }
        Ok(())
    }
}

/// The parameters that a scene has.
pub fn parameters<E: NamedParameters + Copy>(scene: &Scene<E>) -> Parameters {
    let mut scene = *scene;
    let mut bits = 0;
    for (i, (_, parameter)) in TUNABLE.iter().enumerate() {
        bits |= u16::from(scene.value(*parameter).is_some()) << i;
    }
    Parameters { bits }
}

/// The value of a scene's parameter; `None` if the scene does not have it.
pub fn get<E: NamedParameters + Copy>(scene: &Scene<E>, parameter: Parameter) -> Option<f64> {
    let mut scene = *scene;
    scene.value(parameter).copied()
}

/// Checks that a scene with these parameters can be changed in this way.
///
/// # Errors
/// If the scene does not have one of the parameters, or a change occurs twice.
pub fn check(has: Parameters, changes: &[(Parameter, f64)]) -> Result<(), TuningError> {
    for (i, &(parameter, _)) in changes.iter().enumerate() {
        if name(parameter).is_none() {
            return Err(TuningError::Fixed { parameter });
        }
        if changes.iter().take(i).any(|(earlier, _)| *earlier == parameter) {
            return Err(TuningError::Twice { parameter });
        }
        if !has.iter().any(|has| has == parameter) {
            return Err(TuningError::Absent { parameter, has });
        }
    }
    Ok(())
}

/// The scene with some parameters changed. The certificate judges the values.
///
/// # Errors
/// As [`check`].
pub fn apply<E: NamedParameters + Copy>(
    scene: &Scene<E>,
    changes: &[(Parameter, f64)],
) -> Result<Scene<E>, TuningError> {
    check(parameters(scene), changes)?;
    let mut changed = *scene;
    for &(parameter, to) in changes {
        if let Some(value) = changed.value(parameter) {
            *value = to;
        }
    }
    Ok(changed)
}

/// A set that is ready to run.
#[derive(Clone, Debug)]
pub struct Prepared<E: Rendering<N>, N: Number, M> {
    /// The certified scene with checked timing.
    pub scene: Scene<E>,
    /// Damping in N m s/rad that the device may lose while this set runs; see
    /// [`TimingChecked::margin`](crate::certificate::TimingChecked::margin).
    pub margin: Option<f64>,
    /// Its servo.
    pub rendering: PreparedServo<E, N, M>,
}

/// Makes a changed scene ready to run.
///
/// Not inlined: certifying takes most of a small board's stack.
///
/// # Errors
/// The step that failed. [`explain`] returns the reason.
#[inline(never)]
pub fn prepare<E, N, M>(
    scene: &Scene<E>,
    changes: &[(Parameter, f64)],
    transducers: &Transducers,
    options: &RenderingOptions,
) -> Result<Prepared<E, N, M>, Step>
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    let scene = apply(scene, changes).map_err(|_| Step::Change)?;
    let timed = timing_checked(scene, N::FORMAT)?;
    // A host is refused beside a supply for which the energy matters.
    if !E::Host::IS_PRESENT {
        check_returned(&scene, transducers, options).map_err(|_| Step::Servo)?;
    }
    let rendering = PreparedServo::build(&timed, transducers, options).map_err(|_| Step::Servo)?;
    let margin = timed.margin_with(options.injection.unwrap_or(0.0));
    let prepared = Prepared { scene, margin, rendering };
    if E::Host::IS_PRESENT { beside_host(prepared, transducers, options) } else { Ok(prepared) }
}

/// Largest torque in N m that opposes cogging.
fn against_cogging<E: Rendering<N>, N: Number>(scene: &Scene<E>) -> f64 {
    scene.environment.anticogging().map_or(0.0, |(anticogging, _)| anticogging.largest())
}

/// The set with its host, whose tank is full and whose share is taken from the margin.
fn beside_host<E, N, M>(
    set: Prepared<E, N, M>,
    transducers: &Transducers,
    options: &RenderingOptions,
) -> Result<Prepared<E, N, M>, Step>
where
    E: Tunable<N>,
    N: Number,
    M: OutputMode,
{
    let Prepared { scene, margin, rendering } = set;
    let budget = scene.environment.budget();
    let cogging = against_cogging::<E, N>(&scene);
    let servo = ServoNumbers::of(&scene, cogging, margin, transducers, options, M::TIMING);
    let host = E::Host::beside(&budget, &servo.map_err(|_| Step::Servo)?);
    let rendering = rendering.with_host(host.map_err(|_| Step::Servo)?);
    let share = E::Host::host(&budget).map_or(0.0, |host| host.damping);
    Ok(Prepared { scene, margin: margin.map(|margin| margin - share), rendering })
}

/// Checks that the supply takes the energy of a push into the scene.
#[inline(never)]
fn check_returned<E: EnvironmentModel>(
    scene: &Scene<E>,
    transducers: &Transducers,
    options: &RenderingOptions,
) -> Result<(), BuildError> {
    let Some(largest) = options.returned.filter(|_| MAY_HAVE_BRIDGE) else { return Ok(()) };
    let push = Push::of(scene, transducers, options.injection, 0.0);
    let returned = ReturnedEnergy::of(&scene_data(scene), &push);
    let energy = returned.map_or(f64::INFINITY, |energy| energy.total());
    if energy < largest { Ok(()) } else { Err(BuildError::Returned { energy, largest }) }
}

/// The reason why [`prepare`] refuses a changed scene, with remedies. This is too large for a small board;
/// its host computes it from the same numbers with the same code.
///
/// # Errors
/// The error of the set, whose text includes the remedies.
pub fn explain<E, N, M>(
    scene: &Scene<E>,
    changes: &[(Parameter, f64)],
    transducers: &Transducers,
    options: &RenderingOptions,
) -> Result<(), RenderError>
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    let changed = apply(scene, changes)?;
    let timed = certify_scene(changed, N::FORMAT)?.time()?;
    check_returned(&changed, transducers, options)?;
    PreparedServo::<E, N, M>::build(&timed, transducers, options)?;
    if let Some(host) = E::Host::host(&changed.environment.budget()) {
        let margin = timed.margin_with(options.injection.unwrap_or(0.0));
        let cogging = against_cogging::<E, N>(&changed);
        let servo = ServoNumbers::of(&changed, cogging, margin, transducers, options, M::TIMING)?;
        HostResponse::beside(
            &host,
            &servo,
            HostTimes::of(&changed.latency, changed.timing.period),
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
