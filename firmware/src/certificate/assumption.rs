//! Assumptions of a verdict: only those that apply to the scene, each with its condition (theory, section 8)
//! and the status of the condition.

use core::fmt;

use super::anticogging::passivity_for_anticogging;
use super::assessment::Assessment;
use super::endless::mean_torque;
use super::linearity::is_nonlinear;
use super::loop_intervals::LoopIntervals;
use super::margin::Limited;
use super::model::LoopTransfers;
use super::quantization::{QuantizationBound, Resolution};
use super::timed::{is_uneven, limited_bound};
use crate::encoder_reading::EncoderReading;
use crate::environment::{Environment, StatedModel, Wall};
use crate::passivity::discrete::index;
use crate::passivity::interval::Interval;
use crate::passivity::transfer::Transfer;
use crate::scene::{Coupling, Latency, Scene, TimeRange};
use crate::text::{RoundUp3, ShortF64};

/// An assumption of a verdict, or a condition that was checked. Times in s, torques in N m, passivity, damping and bounds
/// on an index in N m s/rad.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "each variant's description and sentence name its fields")]
pub enum Assumption {
    /// A1 of theory, section 4.
    DevicePassivity { delta: f64 },
    /// A2 of theory, section 4: the period, if no update may be missed, and whether a torque begins with its count;
    /// otherwise see [`Assumption::Latency`].
    Hold { period: Option<f64>, at_once: bool },
    /// The delays and lags of the device are those of the scene.
    Latency(Latency),
    /// The readings of the encoder are those of the scene.
    Encoder(EncoderReading),
    /// An endless torque profile is no motor: the bound on the mean torque through a nonlinear encoder, which friction
    /// must hold; `None` with a linear one.
    Endless { mean: Option<f64> },
    /// Updates may be missed: the longest time between two of them, the device's remaining passivity, and whether the
    /// scene passes with it.
    WorstPeriod { longest: f64, delta: f64, passes: bool },
    /// The delay of the device is that of the scene, in whole samples.
    Delay { samples: usize },
    /// The environment is of another crate, and its statement is certified: the stated bound, if there is one.
    StatedModel { index: Option<f64> },
    /// The wall acts on one side only, and this bound decides.
    OneSided { bound: Option<f64> },
    /// A share of the learnt cogging is opposed: the passivity that it takes, and the friction on which it relies.
    Anticogging { share: f64, taken: f64, mean: f64 },
    /// The torque is limited between environment and coupling, and the DAC's full scale, if stated, is not below that.
    Limited { torque: f64, full_scale: Option<f64> },
    /// The scene has no torque limit, and the DAC has one: the bound with which it would pass with a limit, `None` if it
    /// would not pass, and the damping that the device may then lose.
    Saturates { bound: Option<f64>, margin: f64 },
    /// The canceller removes damping, which the device must have.
    CancelledDamping { damping: f64 },
    /// Quantisation by encoder, numbers and DAC is outside the linear verdict.
    Quantisation(QuantizationBound),
    /// The same with unknown encoder and DAC.
    StepsNotStated,
    /// The same if the controller's response does not end.
    StepsUnbounded,
    /// The same if the current loop that makes the torque is not known.
    CurrentLoopNotKnown,
    /// Without a certificate, the effect of the device's friction: the mean speed in rad/s over a tick up to which
    /// friction and damping dissipate at least what the controller adds (equation 33).
    FrictionOnly { friction: f64, speed: f64 },
}

/// Whether an assumption holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssumptionStatus {
    /// It is about the machine and cannot be checked with the scene.
    Assumed,
    /// Its condition was checked and holds.
    Holds,
    /// Its condition could be checked if more numbers were stated.
    NotStated,
    /// Its condition was checked and does not hold.
    Fails,
}

impl Assumption {
    /// The status of the assumption.
    pub fn standing(&self) -> AssumptionStatus {
        match self {
            Self::WorstPeriod { passes: true, .. }
            | Self::Saturates { bound: Some(_), .. }
            | Self::OneSided { bound: Some(_) }
            | Self::FrictionOnly { .. } => AssumptionStatus::Holds,
            Self::Limited { full_scale: None, .. }
            | Self::StepsNotStated
            | Self::CurrentLoopNotKnown => AssumptionStatus::NotStated,
            Self::Limited { torque, full_scale: Some(full_scale) } if torque <= full_scale => {
                AssumptionStatus::Holds
            }
            Self::OneSided { .. } | Self::Limited { .. } => AssumptionStatus::Fails,
            Self::Quantisation(rest) => match rest.comes_to_rest() {
                None => AssumptionStatus::NotStated,
                Some(true) => AssumptionStatus::Holds,
                Some(false) => AssumptionStatus::Fails,
            },
            // The others are about the machine.
            Self::DevicePassivity { .. }
            | Self::Hold { .. }
            | Self::Latency(_)
            | Self::Encoder(_)
            | Self::Endless { .. }
            | Self::Anticogging { .. }
            | Self::WorstPeriod { .. }
            | Self::Delay { .. }
            | Self::StatedModel { .. }
            | Self::Saturates { .. }
            | Self::CancelledDamping { .. }
            | Self::StepsUnbounded => AssumptionStatus::Assumed,
        }
    }
}

impl fmt::Display for Assumption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DevicePassivity { delta } => write!(
                f,
                "in every passive hand, the device is output strictly passive from motor torque to \
                 velocity at the encoder, with delta = {delta} N m s/rad"
            ),
            Self::Hold { period, at_once } => {
                f.write_str(if *at_once {
                    "position and torque belong to the same instant, and the torque is held until \
                     the next"
                } else {
                    "each torque is held until the next"
                })?;
                match period {
                    Some(period) => {
                        write!(f, ", {} s later: no update is missed", ShortF64(*period))
                    }
                    None => Ok(()),
                }
            }
            Self::Latency(latency) => write_latency(f, latency),
            Self::Encoder(encoder) => write_encoder(f, encoder),
            Self::Endless { mean: None } => f.write_str(
                "the encoder reads the angle without an error that depends on the angle: otherwise an endless \
                 torque profile turns the device as a motor does, and the friction has to hold it (state \
                 `encoder.linearity`)",
            ),
            Self::Endless { mean: Some(mean) } => write!(
                f,
                "the device has {} N m of Coulomb friction or more, which the mean torque of the endless profile \
                 through the nonlinear encoder does not exceed",
                RoundUp3(*mean)
            ),
            Self::Anticogging { share, taken, mean } => {
                write!(
                    f,
                    "the torque that opposes {} % of the learnt cogging takes {} N m s/rad of delta; the angle of the \
                     encoder has the same zero as when it was learnt",
                    ShortF64(100.0 * share),
                    RoundUp3(*taken)
                )?;
                match mean {
                    0.0 => Ok(()),
                    mean => write!(
                        f,
                        "; the device has {} N m of Coulomb friction or more, which the mean torque of what repeats \
                         in each turn does not exceed",
                        RoundUp3(*mean)
                    ),
                }
            }
            Self::WorstPeriod { longest, delta, .. } => write!(
                f,
                "no two counts are more than {} s apart: the servo stops otherwise; judged \
                 with the remaining delta of {} N m s/rad, for torques that begin with their count \
                 and for latched ones",
                ShortF64(*longest),
                ShortF64(*delta)
            ),
            Self::Delay { samples } => {
                write!(f, "the delay of the environment is exactly {samples} whole sample(s)")
            }
            Self::StatedModel { index: Some(index) } => write!(
                f,
                "the environment is of another crate and what that states of it: a passivity index \
                 of at most {index} N m s/rad"
            ),
            Self::StatedModel { index: None } => f.write_str(
                "the environment is of another crate and what that states of it: a transfer function",
            ),
            Self::OneSided { bound } => {
                f.write_str("one-sided wall; judged by the nonlinear bound")?;
                write_bound(f, *bound)
            }
            Self::Limited { torque, full_scale } => write_limit(f, *torque, *full_scale),
            Self::Saturates { bound: Some(bound), margin } => write!(
                f,
                "the torque may reach the DAC's full scale, and be faded in and out: with a torque \
                 limit the scene passes too, by the nonlinear bound of {} N m s/rad, and the \
                 device may lose {} N m s/rad of its damping",
                ShortF64(*bound),
                ShortF64(*margin)
            ),
            Self::Saturates { bound: None, .. } => f.write_str(
                "the torque is never limited: with a torque limit the scene would not pass, so no \
                 board runs it",
            ),
            Self::CancelledDamping { damping } => write!(
                f,
                "the device has the damping of {damping} N m s/rad that is partly cancelled"
            ),
            Self::Quantisation(rest) => write_rest(f, rest),
            Self::StepsNotStated => f.write_str(
                "the steps of encoder and DAC are not stated and not judged: with less Coulomb \
                 friction than the torque that they cause, a limit cycle at rest is possible",
            ),
            Self::StepsUnbounded => f.write_str(
                "the steps of encoder, numbers and DAC are not judged: the impulse response of the \
                 controller is not summable, so no bound exists",
            ),
            Self::CurrentLoopNotKnown => f.write_str(
                "no current loop of a board drives this motor, so that the error of the torque at rest is not known: \
                 a limit cycle is possible",
            ),
            Self::FrictionOnly { friction, speed } => write!(
                f,
                "as long as the mean speed over each tick is at most {1} rad/s, the device's friction of \
                 {0} N m and its damping dissipate at least what the controller generates",
                ShortF64(*friction),
                ShortF64(*speed)
            ),
        }
    }
}

fn write_bound(f: &mut fmt::Formatter<'_>, bound: Option<f64>) -> fmt::Result {
    match bound {
        Some(bound) => write!(f, " of {} N m s/rad", ShortF64(bound)),
        None => f.write_str(", but none is known for this environment"),
    }
}

fn write_limit(f: &mut fmt::Formatter<'_>, torque: f64, full_scale: Option<f64>) -> fmt::Result {
    write!(
        f,
        "torque limited to {torque} N m between environment and coupling; judged by the nonlinear \
         bound"
    )?;
    match full_scale {
        Some(full_scale) if torque <= full_scale => {
            write!(f, ", and within the DAC's full scale of {full_scale} N m")
        }
        Some(full_scale) => write!(
            f,
            ", but above the DAC's full scale of {full_scale} N m, which would limit it again: \
             lower the limit to the full scale"
        ),
        None => f.write_str("; the DAC's full scale must not be lower, and is not stated"),
    }
}

/// Writes torque errors at rest, resolutions not stated, and whether friction is sufficient.
fn write_rest(f: &mut fmt::Formatter<'_>, rest: &QuantizationBound) -> fmt::Result {
    f.write_str("at rest the error of the torque is at most")?;
    let mut between = " ";
    for (name, part) in rest.parts() {
        if let Some(part) = part {
            write!(f, "{between}{} N m ({name})", RoundUp3(part))?;
            between = ", ";
        }
    }
    for name in rest.not_stated() {
        write!(f, "; the step of the {name} is not stated and not included")?;
    }
    write!(f, ": {rest}")
}

/// Writes each time that the scene has.
fn write_latency(f: &mut fmt::Formatter<'_>, latency: &Latency) -> fmt::Result {
    let Latency {
        output_delay,
        output_jitter,
        count_jitter,
        actuator_lag,
        sensor_lag,
        actuator_response,
        actuator_updates,
        encoder,
    } = latency;
    f.write_str("a torque begins ")?;
    if output_delay.is_zero() {
        f.write_str("with its count")?;
    } else {
        write_time(f, *output_delay)?;
        let is_old = !encoder.age.is_zero();
        f.write_str(if is_old { " after the position of its count" } else { " after its count" })?;
    }
    if latency.total_jitter() > 0.0 {
        let jitter = if *output_jitter > 0.0 { output_jitter } else { count_jitter };
        write!(f, ", in each tick at most {} s earlier or later", ShortF64(*jitter))?;
    }
    if latency.jitters_twice() {
        write!(f, ", while its count is at most {} s early or late", ShortF64(*count_jitter))?;
    }
    write_lag(f, "amplifier", *actuator_lag)?;
    if *actuator_updates > 0 {
        write!(
            f,
            " where it is updated, {actuator_updates} times a period, and a straight line between two \
             updates"
        )?;
    }
    write_lag(f, "filter of the encoder", *sensor_lag)?;
    if encoder.window > 0.0 {
        write!(f, "; a reading is a mean of positions over {} s", ShortF64(encoder.window))?;
    } else if !actuator_response.is_zero() {
        let TimeRange { least, most } = *actuator_response;
        let (least, most) = (ShortF64(least), ShortF64(most));
        write!(
            f,
            "; the step response of the amplifier never falls, and rises from {least} to {most} s"
        )?;
    }
    Ok(())
}

fn write_lag(f: &mut fmt::Formatter<'_>, of: &str, lag: TimeRange) -> fmt::Result {
    if lag.is_zero() {
        return Ok(());
    }
    write!(f, "; the {of} is a first-order lag of ")?;
    write_time(f, lag)
}

/// Writes the conditions on the encoder's readings.
fn write_encoder(f: &mut fmt::Formatter<'_>, encoder: &EncoderReading) -> fmt::Result {
    f.write_str(
        "the encoder does not predict the position (of an AS5047P read 0x3FFE, or set DAECDIS); each reading is ",
    )?;
    let TimeRange { least, most } = encoder.age;
    if encoder.age.is_exact() {
        write!(f, "{} s old", ShortF64(most))?;
    } else {
        write!(f, "between {} and {} s old", ShortF64(least), ShortF64(most))?;
    }
    if encoder.linearity > 0.0 {
        let linearity = ShortF64(encoder.linearity);
        write!(f, "; the slope of its error over the angle is at most {linearity} (INL)")?;
    }
    match encoder.dropped {
        0 => f.write_str("; no reading is dropped"),
        dropped => write!(f, "; at most {dropped} in a row are dropped"),
    }
}

fn write_time(f: &mut fmt::Formatter<'_>, time: TimeRange) -> fmt::Result {
    if time.is_exact() {
        return write!(f, "{} s", ShortF64(time.most));
    }
    write!(f, "a constant {} to {} s", ShortF64(time.least), ShortF64(time.most))
}

const MOST: usize = 14;

/// The assumptions of a scene's verdict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assumptions {
    all: [Option<Assumption>; MOST],
}

impl Assumptions {
    /// Lists the assumptions of a verdict on `scene`, given the stated resolution.
    pub fn of(scene: &Scene, assessment: &Assessment, steps: &Resolution) -> Self {
        let mut list = Self { all: [None; MOST] };
        let delta = scene.device.passivity.unwrap_or(scene.device.damping);
        list.push(Some(Assumption::DevicePassivity { delta }));
        let worst = scene.timing.longer_period();
        let period = worst.is_none().then_some(scene.timing.period);
        let latency = scene.latency;
        list.push(Some(Assumption::Hold { period, at_once: latency.is_none() }));
        list.push((!latency.is_none()).then_some(Assumption::Latency(latency)));
        let encoder = latency.encoder;
        list.push((*encoder != EncoderReading::IDEAL).then_some(Assumption::Encoder(*encoder)));
        list.push(endless(scene, assessment));
        list.push(anticogging(scene, assessment));
        list.push(worst.map(|longest| Assumption::WorstPeriod {
            longest,
            delta: assessment.delta.midpoint(),
            passes: assessment.outcome.is_ok(),
        }));
        list.push(delay(&scene.environment));
        list.push(stated(&scene.environment));
        let one_sided = scene.environment.wall().is_some_and(Wall::is_one_sided);
        let bound = assessment.bound.map(Interval::hi);
        list.push(one_sided.then_some(Assumption::OneSided { bound }));
        list.push(saturation(scene, assessment, steps));
        let cancels = scene.environment.canceller().is_some();
        let damping = scene.device.damping;
        list.push(cancels.then_some(Assumption::CancelledDamping { damping }));
        list.push(assessment.outcome.is_ok().then(|| quantisation(scene, assessment, steps)));
        list.push(friction_only(scene, assessment, steps));
        list
    }

    fn push(&mut self, assumption: Option<Assumption>) {
        if let Some(place) = self.all.iter_mut().find(|place| place.is_none()) {
            *place = assumption;
        }
    }

    /// The assumptions in order.
    pub fn iter(&self) -> impl Iterator<Item = &Assumption> {
        self.all.iter().flatten()
    }

    /// The bound on quantisation at rest, if the scene is certified and the resolution was stated.
    pub fn rest(&self) -> Option<&QuantizationBound> {
        self.iter().find_map(|assumption| match assumption {
            Assumption::Quantisation(rest) => Some(rest),
            _ => None,
        })
    }
}

/// Of an endless profile, the friction that a nonlinear encoder makes it need.
fn endless(scene: &Scene, assessment: &Assessment) -> Option<Assumption> {
    let _ = scene.environment.profile().filter(|profile| profile.ends.is_none())?;
    if scene.environment.parts().anticogging.is_some() {
        // It states the sum of both.
        return None;
    }
    let numbers = LoopIntervals::of(scene, assessment.format);
    let mean = mean_torque::<Environment>(scene, &numbers).map(Interval::hi);
    Some(Assumption::Endless { mean })
}

/// What the anticogging takes; `None` without one, or if it is not known.
fn anticogging(scene: &Scene, assessment: &Assessment) -> Option<Assumption> {
    let anticogging = scene.environment.parts().anticogging?;
    let taken = passivity_for_anticogging(scene, assessment.format)?;
    let numbers = LoopIntervals::of(scene, assessment.format);
    let mean = mean_torque::<Environment>(scene, &numbers).map_or(0.0, Interval::hi);
    Some(Assumption::Anticogging { share: anticogging.share, taken, mean })
}

fn stated(environment: &Environment) -> Option<Assumption> {
    let Environment::Stated(stated) = environment else { return None };
    let index = match stated {
        StatedModel::Bounded { bound, .. } => Some(bound.index),
        StatedModel::Linear(_) => None,
    };
    Some(Assumption::StatedModel { index })
}

fn delay(environment: &Environment) -> Option<Assumption> {
    let samples = environment.delay();
    (samples > 0).then_some(Assumption::Delay { samples })
}

/// The scene's torque limit, or the DAC's: the servo limits the torque in the same place, so a linear scene
/// stays passive if the nonlinear bound also passes.
fn saturation(scene: &Scene, assessment: &Assessment, steps: &Resolution) -> Option<Assumption> {
    if let Some(torque) = scene.torque_limit {
        return Some(Assumption::Limited { torque, full_scale: steps.full_scale });
    }
    if is_nonlinear(scene) {
        // Already judged by this bound.
        return None;
    }
    let passes = passes_limited(scene, assessment);
    let bound = passes.map(|(bound, _)| bound.hi());
    Some(Assumption::Saturates { bound, margin: passes.map_or(0.0, |(_, margin)| margin) })
}

/// The nonlinear bound of a scene that has an index, if it passes, and the margin then.
fn passes_limited(scene: &Scene, assessment: &Assessment) -> Option<(Interval, f64)> {
    // Without an index its numbers may be out of range.
    assessment.alpha?;
    let numbers = LoopIntervals::of(scene, assessment.format);
    let limited = match scene.coupling {
        Coupling::Rigid => Limited::at_port::<Environment>(scene, &numbers, 0.0)
            .filter(|_| !is_uneven::<Environment>(&scene.environment))?,
        _ => {
            let bound = limited_bound(scene, &numbers)?;
            Limited::of(scene, &numbers, bound)?
        }
    };
    Some((limited.bound, limited.margin(0.0).unwrap_or(0.0)))
}

fn quantisation(scene: &Scene, assessment: &Assessment, steps: &Resolution) -> Assumption {
    if steps.encoder.or(steps.full_scale).is_none() {
        return Assumption::StepsNotStated;
    }
    match QuantizationBound::of(scene, assessment.format, steps) {
        Some(rest) => Assumption::Quantisation(rest),
        None if steps.lacks_current_loop() => Assumption::CurrentLoopNotKnown,
        None => Assumption::StepsUnbounded,
    }
}

/// For a scene without a certificate, the effect of its friction. A controller that needs `alpha` of damping
/// with only `delta` present adds at most `T (alpha - delta) v^2` more than damping dissipates in a tick of
/// the mean speed `v`, and friction dissipates at least `T f_c |v|` (equation 33). The index is that of the
/// whole controller one sample later, which is the condition without a coupling (theory, section 5).
fn friction_only(scene: &Scene, assessment: &Assessment, steps: &Resolution) -> Option<Assumption> {
    let friction = steps.friction.filter(|&friction| friction > 0.0)?;
    // The torque of a tick is not constant if it lags.
    if assessment.outcome.is_ok() || !scene.latency.is_none() {
        return None;
    }
    let controller = LoopTransfers::in_format(scene, assessment.format).ok()?.controller;
    let later = Transfer { shift: controller.shift - 1, ..controller };
    let needed = index(later, Interval::decimal(scene.timing.period), false).ok()?.minimum;
    let shortage = needed.sub(assessment.delta);
    let speed = Interval::decimal(friction).div(Interval::exact(shortage.hi())).lo();
    (shortage.lo() > 0.0).then_some(Assumption::FrictionOnly { friction, speed })
}
