//! Whether a device comes to rest: compares the torque errors of quantisation with the friction of the device
//! (theory, sections 6, 8 and 9).
//!
//! The certificate is about a controller without quantisation. Encoder, DAC and the rounding of numbers
//! change its torque by at most some `e`. Coulomb friction of `e` or more dissipates the energy of that
//! error, `f_c abs(v) >= e v`, so the device is as passive as certified. With less friction a limit cycle at
//! rest is possible. What holds the mean torque of an endless profile or of a learnt map is not there for `e`.
//!
//! For a linear scene, and for a spring that is one-sided or limited, `e` holds for any motion. A damper
//! behind a face does not have such an `e`: a count more or less changes the tick in which it switches, and
//! the torque then differs by damping times speed. Its `e` holds for motions on one side of the face, as at
//! rest. The same applies to a limited scene whose response may grow with each change between limited and not
//! limited.

use core::f64::consts::TAU;
use core::fmt;

use super::endless::mean_torque;
use super::linearity::is_nonlinear;
use super::loop_intervals::LoopIntervals;
use super::model::LoopTransfers;
use super::part::{Washout, canceller, damper, jump_at_face, peak_gain_beside};
use super::profile::{ExtremeSlopes, peak_gain, step_of_part};
use crate::current::CurrentResolution;
use crate::dac::DacCode;
use crate::encoder_reading::EncoderReading;
use crate::environment::{Environment, Parts, Rational};
use crate::matched::{MatchedCoupling, Trail};
use crate::number::Format;
use crate::passivity::interval::Interval;
use crate::passivity::polynomial::{Polynomial, UnitRoot};
use crate::passivity::transfer::Transfer;
use crate::scene::Scene;
use crate::text::{RoundUp3, ShortF64};
use crate::transducers::Transducers;

/// Data of the device that a scene does not contain, as far as stated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resolution {
    /// Angle of one encoder count in rad.
    pub encoder: Option<f64>,
    /// Torque of the motor in N m at the DAC's largest code.
    pub full_scale: Option<f64>,
    /// Coulomb friction of the device in N m, at the motor.
    pub friction: Option<f64>,
    /// Largest deviation of a current loop's torque from its model, in N m; `None` for an external amplifier
    /// without such steps, infinite if the loop is not known.
    pub current: Option<f64>,
    /// Additional deviation of a current loop in N m when the torque changes its sign, until its feedback has
    /// corrected an instant in which the dead time is compensated with the wrong sign.
    pub crossing: Option<f64>,
}

impl Resolution {
    /// The resolution of a program's transducers, with the friction of its device.
    pub fn of(transducers: &Transducers, friction: Option<f64>) -> Self {
        Self {
            encoder: Some(TAU / transducers.counts_per_turn),
            full_scale: Some(transducers.full_scale_torque),
            friction,
            current: None,
            crossing: None,
        }
    }

    /// The same with a current loop of this resolution: the deviation of a settled current with half of its
    /// ripple, and the addition at a change of its sign.
    pub fn with_current_loop(self, loop_resolution: &CurrentResolution) -> Self {
        let CurrentResolution { deviation, zero_crossing, ripple, .. } = *loop_resolution;
        Self { current: Some(deviation + 0.5 * ripple), crossing: Some(zero_crossing), ..self }
    }

    /// Whether a current loop makes the torque of which no design is known.
    pub(super) fn lacks_current_loop(&self) -> bool {
        self.current == Some(f64::INFINITY)
    }

    /// The same with the error of a reading in place of half a count: noise and hysteresis are further steps
    /// (theory, section 18.5).
    fn read_by(&self, encoder: &EncoderReading) -> Self {
        Self { encoder: self.encoder.map(|step| step * encoder.steps()), ..*self }
    }

    /// Torque of one DAC code in N m.
    fn converter(&self) -> Option<f64> {
        self.full_scale.map(|torque| torque / f64::from(DacCode::CODES_TO_FULL_SCALE))
    }
}

/// The largest torque error of each kind of step in N m, and the friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuantizationBound {
    /// Of the encoder: half a count times the controller's peak torque per position.
    /// `K Delta / 2 + B Delta / T` for a wall without a coupling.
    pub encoder: Option<f64>,
    /// Of the servo's numbers, within a turn of its zero.
    pub numbers: f64,
    /// Of the DAC: half a code.
    pub converter: Option<f64>,
    /// Of the current loop: see [`Resolution::with_current_loop`].
    pub current: Option<f64>,
    /// The addition when the torque changes its sign: see [`Resolution::crossing`].
    pub crossing: Option<f64>,
    /// Declared friction of the device.
    pub friction: Option<f64>,
    /// Mean torque in N m of what repeats in every turn, which takes as much of the friction (theory, section
    /// 18.4).
    pub mean: f64,
    /// Largest torque of the motor, as far as stated.
    pub motor: Option<f64>,
    /// Whether the bound holds for any motion. Otherwise it holds at rest, and on one side of a
    /// face.
    pub in_any_motion: bool,
}

impl QuantizationBound {
    /// The bound of a scene that runs in a number format. `None` if the controller has no finite peak torque
    /// per position: if it is unstable, or so near to instability that its response does not end. `None`, too,
    /// if the current loop is not known.
    pub fn of(scene: &Scene, format: Format, steps: &Resolution) -> Option<Self> {
        if steps.lacks_current_loop() {
            return None;
        }
        let Peak { norm: peak, in_any_motion } = peak(scene, format)?;
        let steps = &steps.read_by(scene.latency.encoder);
        let anticogging = Anticogged::of(scene, format);
        let mean = mean_torque::<Environment>(scene, &LoopIntervals::of(scene, format));
        let found = Self {
            encoder: steps.encoder.map(|step| 0.5 * step * (peak + anticogging.slope)),
            numbers: numbers(scene, format, steps, peak)? + anticogging.numbers,
            converter: steps.converter().map(|step| 0.5 * step),
            current: steps.current,
            crossing: steps.crossing,
            friction: steps.friction,
            mean: mean.map_or(0.0, Interval::hi),
            motor: match (scene.torque_limit, steps.full_scale) {
                (Some(limit), Some(full_scale)) => Some(limit.min(full_scale)),
                (limit, full_scale) => limit.or(full_scale),
            },
            in_any_motion,
        };
        let is_safe =
            |hysteresis| hysteresis >= 2.0 * found.position_error(scene, format, steps, peak);
        hysteresis(scene).is_none_or(is_safe).then_some(found)
    }

    /// Largest error of the environment's position in rad: half a count, the rounding of numbers, and the
    /// coupling's deflection by a torque error.
    fn position_error(&self, scene: &Scene, format: Format, steps: &Resolution, peak: f64) -> f64 {
        let torque = self.encoder.unwrap_or(0.0) + self.numbers;
        let counted = 0.5 * steps.encoder.unwrap_or(0.0) + self.numbers / peak;
        counted + compliance(scene, format) * torque
    }

    /// Bound on the torque error of all stated steps together, in N m. With less friction than
    /// [`Self::for_rest`] a limit cycle may exceed this torque.
    pub fn hum(&self) -> f64 {
        self.parts().iter().filter_map(|(_, part)| *part).sum()
    }

    /// Friction in N m with which the device comes to rest.
    pub fn for_rest(&self) -> f64 {
        self.hum() + self.mean
    }

    /// The parts by name, as far as stated.
    pub fn parts(&self) -> [(&'static str, Option<f64>); 4] {
        let Self { encoder, numbers, converter, current, .. } = *self;
        [
            ("encoder", encoder),
            ("numbers", Some(numbers)),
            ("DAC", converter),
            ("current loop", current),
        ]
    }

    /// The parts of every scene that were not stated. A current loop is always stated if there is one.
    pub(crate) fn not_stated(&self) -> impl Iterator<Item = &'static str> {
        let parts = [("encoder", self.encoder), ("DAC", self.converter)];
        parts.into_iter().filter(|(_, part)| part.is_none()).map(|(name, _)| name)
    }

    /// Whether the declared friction is sufficient; `None` if that is unknown.
    pub fn comes_to_rest(&self) -> Option<bool> {
        let enough = self.friction? >= self.for_rest();
        let all_stated = self.encoder.is_some() && self.converter.is_some();
        (all_stated || !enough).then_some(enough)
    }
}

impl fmt::Display for QuantizationBound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hum = RoundUp3(self.hum());
        // A motor does not move a device with more friction than its torque.
        let weak_motor = self.motor.filter(|&motor| self.hum() > motor).map(ShortF64);
        match (weak_motor, self.friction.map(ShortF64), self.comes_to_rest()) {
            (Some(motor), ..) => write!(
                f,
                "errors of torque of up to {hum} N m are more than the {motor} N m of the motor, so that no \
                 friction that it moves prevents a limit cycle: use a finer encoder, or a softer coupling or \
                 environment"
            ),
            (None, None, _) => write!(
                f,
                "errors of torque of up to {hum} N m make a limit cycle possible unless the device has {} N m \
                 of Coulomb friction",
                RoundUp3(self.for_rest())
            ),
            (None, Some(friction), rests) => {
                if rests == Some(false) {
                    write!(f, "errors of torque of up to {hum} N m make a limit cycle possible: ")?;
                }
                write!(f, "the device's friction of {friction} N m")?;
                if self.mean > 0.0 {
                    write!(f, ", less {} N m against the mean torque,", RoundUp3(self.mean))?;
                }
                f.write_str(match rests {
                    Some(false) => " is lower",
                    Some(true) => " prevents a limit cycle",
                    None => " prevents a limit cycle, as far as the steps are stated",
                })
            }
        }?;
        if let Some(crossing) = self.crossing.map(RoundUp3) {
            write!(
                f,
                "; where the torque changes its sign, it is off by up to {crossing} N m more until the \
                 current loop has corrected an instant in which the dead time is given back wrongly"
            )?;
        }
        if self.in_any_motion {
            return Ok(());
        }
        f.write_str("; while the device moves through a face the error is larger, in proportion to its speed")
    }
}

/// The anticogging of a scene, outside of its coupling.
struct Anticogged {
    /// Its steepest slope in N m/rad.
    slope: f64,
    /// Torque error in N m of its arithmetic: that of an angle within a turn, of a place and of a knot, each a whole
    /// part of a cell, and of a product and a sum.
    numbers: f64,
}

impl Anticogged {
    fn of(scene: &Scene, format: Format) -> Self {
        let Some((anticogging, delay)) = scene.environment.parts().late_anticogging() else {
            return Self { slope: 0.0, numbers: 0.0 };
        };
        let n = LoopIntervals::timed(scene.timing, format);
        let profile = anticogging.profile(delay);
        let slope = ExtremeSlopes::of_table::<Environment>(&profile, &n).steepest().hi();
        let torque =
            format.rounding_error(scene.torque_limit.unwrap_or(0.0) + anticogging.largest());
        let numbers = slope * format.rounding_error(TAU) * roundings(format, 2.0, 1.0)
            + 2.0 * step_of_part(&profile, &n)
            + torque * roundings(format, 1.0, 1.0);
        Self { slope, numbers }
    }
}

/// Angle in rad from a snap point to the point where the scene snaps back; `None` without snap points.
/// Position errors of less than half of it move a snap to a point where it loses less energy, but never to a
/// point where it adds energy (equation 50).
fn hysteresis(scene: &Scene) -> Option<f64> {
    let profile = scene.environment.profile()?;
    Some(profile.snap?.hysteresis(&profile.layout()))
}

/// The effect of position errors on the torque.
struct Peak {
    /// Largest torque error in N m for errors of up to 1 rad in each position.
    norm: f64,
    in_any_motion: bool,
}

/// The l1 norm of the controller's impulse response (theory, section 6).
///
/// A wall in and out of contact and a torque limit make the response vary. Then, for an environment of norm
/// `e` behind a coupling whose compliances add up to `V`, no torque is more than `e` times a position plus
/// `V e` times the largest earlier torque; for `V e < 1` the sum is `e / (1 - V e)`. Otherwise the norm is
/// the larger of those in contact and out of it. A wall may cancel a part of a canceller's response in
/// contact, so that there `e` is the sum of both, and the norm out of contact may be the larger.
///
/// A torque profile has no impulse response and is bounded by its steepest slope; the other parts are bounded
/// by the norm of their impulse response.
fn peak(scene: &Scene, format: Format) -> Option<Peak> {
    let switched = scene.environment.wall().is_some_and(|w| w.is_one_sided() && w.damping() != 0.0);
    if let Some(profile) = scene.environment.profile() {
        let n = LoopIntervals::of(scene, format);
        let beside = peak_gain_beside(scene.environment.parts(), &n);
        let norm = peak_gain(profile, beside, &n, compliance(scene, format))?;
        return Some(Peak { norm, in_any_motion: !switched });
    }
    let LoopTransfers { controller, environment, .. } =
        LoopTransfers::in_format(scene, format).ok()?;
    let mut linear = l1_norm(&controller)?;
    if !is_nonlinear(scene) {
        return Some(Peak { norm: linear, in_any_motion: true });
    }
    let alone = match out_of_contact(scene) {
        None => l1_norm(&environment)?,
        Some(free) => {
            let free = LoopTransfers::in_format(&free, format).ok()?;
            linear = linear.max(l1_norm(&free.controller)?);
            peak_gain_beside(scene.environment.parts(), &LoopIntervals::of(scene, format))
        }
    };
    let fed_back = alone * compliance(scene, format);
    Some(if fed_back < 1.0 {
        Peak { norm: linear.max(alone / (1.0 - fed_back)), in_any_motion: !switched }
    } else {
        Peak { norm: linear, in_any_motion: false }
    })
}

/// The scene out of contact with its wall, if another part acts there.
fn out_of_contact(scene: &Scene) -> Option<Scene> {
    let parts = *scene.environment.parts();
    let is_one_sided = parts.wall.is_some_and(|wall| wall.is_one_sided());
    let beside = Parts { wall: None, ..parts };
    (is_one_sided && beside.count() > 0).then(|| Scene { environment: beside.sum(), ..*scene })
}

/// Largest deflection of the coupling in rad for torques of up to 1 N m each.
fn compliance(scene: &Scene, format: Format) -> f64 {
    let n = LoopIntervals::of(scene, format);
    matched(&n).map_or_else(|| n.compliance.hi(), |coupling| coupling.compliance_at_rest().hi())
}

/// The matched coupling, if the scene has one.
fn matched(n: &LoopIntervals) -> Option<MatchedCoupling> {
    n.latency.and_then(|lagging| lagging.matched)
}

/// Roundings of one kind in a tick: fixed point rounds products, floating point also sums.
fn roundings(format: Format, products: f64, sums: f64) -> f64 {
    match format {
        Format::Fixed { .. } | Format::Truncated { .. } => products,
        Format::F32 | Format::F64 => products + sums,
    }
}

/// Largest torque error of the servo's arithmetic: each rounding in a tick times the norm from its place to
/// the torque.
///
/// Positions are rounded as the count becomes an angle and behind the coupling and its
/// [memory](deflection), and differ from a face and from a state; torques by stiffness, damper and the
/// two gains of the coupling. These come out through `1 / (1 + V E)`, whose norm is at most `1 + V` times
/// the controller's.
fn numbers(scene: &Scene, format: Format, steps: &Resolution, peak: f64) -> Option<f64> {
    // If no limit is stated, torques are small compared with their positions.
    let limit = scene.torque_limit.or(steps.full_scale).unwrap_or(0.0);
    let (angle, torque) = (format.rounding_error(TAU), format.rounding_error(limit));
    let at_torque = match scene.environment.rational() {
        // Its sums may cancel, so they count with the torque of a turn.
        Some(rational) => {
            let sum = format.rounding_error(peak * TAU);
            sum * roundings(format, 2.0, 2.0) * sections(rational)?
        }
        None => torque * roundings(format, 4.0, 3.0) + states(scene, format, angle),
    };
    let at_position = angle * roundings(format, 2.0, 3.0) + deflection(scene, format, limit);
    let (at_torque, at_position) = match scene.environment.profile() {
        // Places in its table and its end stops are whole parts of a cell, with one more product and sum.
        Some(profile) => {
            let part = step_of_part(profile, &LoopIntervals::of(scene, format));
            // The line to a snap point is one more product and sum, from a centre at whole parts.
            let snaps = if profile.snap.is_some() { 1.0 } else { 0.0 };
            let line = snaps * torque * roundings(format, 1.0, 1.0);
            let parts = (2.0 + snaps) * part;
            (at_torque + parts + line, at_position + angle * roundings(format, 1.0, 1.0))
        }
        None => (at_torque, at_position),
    };
    let parts = scene.environment.parts();
    // Another part is a product, a sum, and a difference of positions.
    let others = parts.others() as f64;
    let at_torque = at_torque + others * torque * roundings(format, 1.0, 1.0);
    let at_position = at_position + others * angle * roundings(format, 0.0, 1.0);
    let at_torque = if parts.profile.is_some() && parts.count() > 1 {
        // A product of the table and a sum for each part; the face of a wall that is solved in the tick
        // changes the other parts.
        let n = LoopIntervals::of(scene, format);
        at_torque + torque * roundings(format, 2.0, 3.0) + limit * jump_at_face(parts, &n)
    } else {
        at_torque
    };
    Some(peak * at_position + (1.0 + peak * compliance(scene, format)) * at_torque)
}

/// Position error in rad of a matched coupling, by rounding the deflection of past torques and the device's
/// position less this deflection, for torques of up to `limit` N m.
///
/// It multiplies and adds a torque for the part of a sample, the sum of the torques in transit, and a state
/// for each lag. Such a state decays and keeps a part of its own rounding.
fn deflection(scene: &Scene, format: Format, limit: f64) -> f64 {
    let Some(coupling) = matched(&LoopIntervals::of(scene, format)) else { return 0.0 };
    let whole = coupling.whole as f64;
    let lags = coupling.trails.iter().filter(|trail| trail.gain != 0.0);
    let terms = 2.0 + lags.clone().count() as f64;
    let at_position = format.rounding_error(TAU) * roundings(format, terms, terms);
    let at_sum =
        coupling.held * format.rounding_error(whole * limit) * roundings(format, 0.0, whole);
    let at_state = |trail: &Trail| {
        let left = 1.0 - trail.decay;
        let rounding = format.rounding_error(limit / left) * roundings(format, 1.0, 1.0);
        trail.gain.abs() * rounding / left
    };
    at_position + at_sum + lags.map(at_state).sum::<f64>()
}

/// Torque error in N m of the states of filter and canceller: each moves by a fraction of its remaining
/// distance, and stops when this fraction is rounded to zero.
fn states(scene: &Scene, format: Format, angle: f64) -> f64 {
    let n = LoopIntervals::of(scene, format);
    let stops = |state: Washout| {
        let gain = state.gain.magnitude() / scene.timing.period;
        gain * angle * roundings(format, 1.0, 2.0) / (1.0 - state.pole.magnitude())
    };
    let filter = scene.environment.wall().filter(|wall| wall.filter().is_some());
    let cancels = scene.environment.canceller().is_some();
    filter.map_or(0.0, |wall| stops(damper(wall, &n)))
        + if cancels { stops(canceller(&n)) } else { 0.0 }
}

/// The norm from all sums of a rational environment to its torque: one sum per degree, and `1 / denominator`
/// from each.
fn sections(written: &Rational) -> Option<f64> {
    let rational = written.cancelled();
    let denominator = Polynomial::descending(rational.denominator.as_slice(), false);
    let leading = Polynomial::ascending(&[denominator.leading()]);
    let norm = l1_norm(&Transfer::new(leading, denominator))?;
    Some(norm * (1.0 + denominator.degree() as f64))
}

/// Largest number of powers of `1/z` in a controller: degree 8, 8 samples of delay, 8 zeros at 1.
const TAPS: usize = 40;
/// Samples after which a response counts as not ending; the response of a pole at `1 - 1e-3` ends before.
const LONGEST: u32 = 1 << 16;

/// Sum of the magnitudes of an impulse response, to twelve digits; `None` if it does not end.
fn l1_norm(g: &Transfer) -> Option<f64> {
    let ones = usize::try_from(g.ones).ok()?;
    let numerator = g.numerator.times_unit_root(UnitRoot::Plus, ones)?;
    let scale = g.scale.midpoint() / g.denominator.leading().midpoint();
    // In powers of 1/z from the first nonzero one: a delay changes nothing.
    let taps = |p: &Polynomial, factor: f64| {
        let mut taps = [0.0; TAPS];
        for (i, tap) in taps.iter_mut().enumerate().take(p.len()) {
            *tap = p.coefficient(p.len() - 1 - i).midpoint() * factor;
        }
        taps
    };
    let forward = taps(&numerator, scale);
    let back = taps(&g.denominator, 1.0 / g.denominator.leading().midpoint());
    let used = numerator.len().max(g.denominator.len());
    let mut state = [0.0; TAPS];
    let (mut input, mut sum) = (1.0, 0.0);
    for _ in 0..LONGEST {
        let output = forward[0] * input + state[0];
        sum += output.abs();
        for i in 1..used {
            let next = state.get(i).copied().unwrap_or(0.0);
            state[i - 1] = forward[i] * input - back[i] * output + next;
        }
        input = 0.0;
        if state.iter().take(used).all(|s| s.abs() <= 1e-15 * sum) {
            return sum.is_finite().then_some(sum);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::{Canceller, Profile, Shape, Wall};
    use crate::test_scene::{self, largest_error};
    use fixed::types::I8F24;

    const COUNTS_PER_TURN: f64 = 4096.0;
    const FULL_SCALE: f64 = 1.0;
    /// Through many detents and back.
    const MOTION: [f64; 2] = [3.0, 0.05];

    fn scene(torque: f64, delay: usize) -> Scene {
        let units = vec![0; 16].leak();
        let profile = Profile::sampled(&[Shape::detents(24, torque)], units, delay).unwrap();
        Scene { torque_limit: Some(FULL_SCALE), ..test_scene::scene(profile.alone()) }
    }

    fn bound(scene: &Scene, format: Format) -> Option<QuantizationBound> {
        let steps = Resolution {
            encoder: Some(TAU / COUNTS_PER_TURN),
            full_scale: Some(FULL_SCALE),
            ..Resolution::default()
        };
        QuantizationBound::of(scene, format, &steps)
    }

    /// `M / (1 - M V)` of a slope of 20 N m/rad behind 44 N m/rad; `M` where nothing is late.
    #[test]
    fn the_peak_of_a_profile_is_its_steepest_slope() {
        let torque = 20.0 * TAU / (4.0 * 24.0);
        let half_a_count = 0.5 * TAU / COUNTS_PER_TURN;
        let late = bound(&scene(torque, 1), Format::F64).unwrap();
        let expected = half_a_count * 20.0 / (1.0 - 20.0 / 44.0);
        assert!((late.encoder.unwrap() / expected - 1.0).abs() < 1e-3, "{late:?}");
        let at_once = bound(&scene(torque, 0), Format::F64).unwrap();
        assert!((at_once.encoder.unwrap() / (half_a_count * 20.0) - 1.0).abs() < 1e-3);
        assert!(late.in_any_motion && at_once.in_any_motion);
        assert_eq!(bound(&scene(2.3 * torque, 1), Format::F64), None);
    }

    /// In contact the wall's damper cancels a part of the canceller's response: the norm there is 5 N m/rad,
    /// and 43 N m/rad out of contact.
    #[test]
    fn the_torque_out_of_contact_is_not_farther_off_than_the_bound() {
        for damping in [0.0, 0.01] {
            let canceller = Some(Canceller::to(0.0005));
            let wall = Some(Wall::damped(5.0, damping, 0).behind(4.0));
            let scene = test_scene::scene(Parts { canceller, wall, ..Parts::NONE }.sum());
            let most = bound(&scene, Format::F64).unwrap().encoder.unwrap();
            let found = largest_error::<f64>(&scene, COUNTS_PER_TURN, MOTION);
            // The finer of the two encoders is not exact, either.
            assert!(found <= most * (1.0 + 1.0 / 1024.0), "{damping}: {found} {most}");
            assert!(found > 0.9 * 43.0 * 0.5 * TAU / COUNTS_PER_TURN, "{damping}: {found}");
        }
    }

    #[test]
    fn no_motion_has_a_torque_farther_off_than_the_bound() {
        for delay in [0, 1] {
            let scene = scene(20.0 * TAU / (4.0 * 24.0), delay);
            // The finer of the two is not exact, either.
            let allowed = |format| {
                let bound = bound(&scene, format).unwrap();
                let fine = bound.encoder.unwrap() / 1024.0;
                (bound.encoder.unwrap() + bound.numbers + fine, bound.encoder.unwrap())
            };
            for (found, format) in [
                (largest_error::<f32>(&scene, COUNTS_PER_TURN, MOTION), Format::F32),
                (
                    largest_error::<I8F24>(&scene, COUNTS_PER_TURN, MOTION),
                    Format::Fixed { fraction_bits: 24 },
                ),
            ] {
                let (most, encoder) = allowed(format);
                assert!(found <= most, "{delay} {format}: {found} {most}");
                assert!(found > 0.3 * encoder, "{delay} {format}: {found} {encoder}");
            }
        }
    }
}
