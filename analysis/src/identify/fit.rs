//! Results from the responses: the disk that contains them, and the rigid device behind a late torque that
//! fits them.

use super::error::IdentifyError;
use super::estimate::Estimate;
use super::latency::{Latency, NoLatency};
use super::least_squares::{Delay, Measured};
use super::left_out::{LeftOut, Reason};
use super::model::{Model, friction_damping};
use super::profile::{Profile, student};
use super::response::{Correction, FrequencyPoint};

/// Least motion in counts: below it the encoder's steps do not act as noise any more.
const LEAST_COUNTS: f64 = 1.5;

/// Largest squared residual, in squared deviations a degree of freedom, of a device that passes for rigid:
/// residuals up to three times the deviation of the noise, which allows for noise that is not white.
const RIGID: f64 = 9.0;

/// Smallest ratio of the largest to the smallest velocity at which friction is fitted: where all sines have
/// the same velocity, friction and damping are the same.
const LEAST_SPEEDS: f64 = 1.5;

/// Largest friction as a part of a sine's torque at which the describing function is used: the error of its
/// real part is of the third order in this part.
const MOST_FRICTION: f64 = 0.4;

/// Error of the describing function, as a factor of the friction's damping times the part of the torque that
/// friction takes: the third harmonic of the velocity is at most `4/(3 pi)` of that part and moves the zeros
/// of the velocity, which turns friction by as much.
const DESCRIBED: f64 = 0.5;

/// Intervals of the damping that its lower bound for a certificate is below it: the end of one interval is above
/// the truth in a fortieth of all measurements, that of two in one of ten thousand.
const BOUND: f64 = 2.0;

/// Number of fits in which the part of the friction is found.
const ROUNDS: usize = 4;

/// The disk around all responses as they were measured: centre and radius `1/(2 delta)`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Disk {
    /// `min Re(1/J)` in N m s/rad; the responses lie in a disk only if it is positive.
    pub delta: f64,
    /// Lower end of its confidence interval.
    pub lo: f64,
    /// Angular frequency in rad/s of the response that is on the rim.
    pub omega: f64,
}

/// The device found in a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// Inertia in kg m^2.
    pub inertia: Estimate,
    /// Damping in N m s/rad.
    pub damping: Estimate,
    /// The damping less twice its uncertainty, in N m s/rad, as the encoder shows it.
    pub least_damping: f64,
    /// Coulomb friction in N m. Where it cannot be told from damping, its upper end is that of a device without
    /// damping.
    pub friction: Estimate,
    /// Whether the velocities of the sines differ enough to tell friction from damping.
    pub tells_friction: bool,
    /// Smallest and largest amplitude of the velocity of the sines that were used, in rad/s.
    pub speeds: [f64; 2],
    /// Mean delay in s of the torque's step response beyond the declared delay, which is the sum of the
    /// amplifier's lag and the output's delay; less than zero where the counts are younger than their time.
    pub mean_delay: Estimate,
    /// Lag and delay separately, or why they have no intervals.
    pub latency: Result<Latency, NoLatency>,
    /// The best fit of all four together.
    pub model: Model,
    /// The disk, with lag and delay in it.
    pub disk: Disk,
    /// Part of `disk.delta` that lag and delay cause, in N m s/rad at the disk's frequency; of a delay `t0`
    /// alone it is `b cos(w t0) - m w sin(w t0) - b`.
    pub bias: f64,
    /// Mean squared residual of the fit in squared deviations.
    pub misfit: f64,
    /// The responses, in the order of the record.
    pub responses: Vec<FrequencyPoint>,
    /// Tones of the record that were not used, and why.
    pub left_out: Vec<LeftOut>,
    /// The largest slope of the encoder's error over the angle, where it is [known](Self::with_linearity).
    pub linearity: f64,
}

impl Identification {
    /// The same for an encoder with this largest slope of its error over the angle: it shows a velocity that is
    /// larger or smaller by as much, and an inertia and a damping that are smaller or larger.
    pub fn with_linearity(self, linearity: f64) -> Self {
        let [inertia, damping] = [self.inertia, self.damping].map(|it| it.within_part(linearity));
        Self { inertia, damping, linearity, ..self }
    }

    /// Whether inertia, damping, lag and delay explain the responses.
    pub fn is_rigid(&self) -> bool {
        self.misfit <= RIGID
    }

    /// Damping of the device in N m s/rad that motion loses through the board's own current loop; 0 with an
    /// external amplifier.
    pub fn motion_loss(&self) -> f64 {
        self.model.source.map_or(0.0, |source| source.loss)
    }

    /// `delta` to certify with, in N m s/rad: the damping of a rigid device less twice its uncertainty, less the
    /// damping that motion loses through the board's own current loop. `None` where that is not positive, and
    /// for a device that is not rigid: no hand held it, and its damping in a hand cannot be measured from the
    /// motor alone (theory, section 3.2), and where friction may be part of what looks like damping.
    pub fn passivity(&self) -> Option<f64> {
        let passivity = self.least_damping * (1.0 - self.linearity) - self.motion_loss();
        (self.is_rigid() && self.tells_friction && passivity > 0.0).then_some(passivity)
    }
}

/// Fits the disk and the rigid device to the responses of a record; `period` in s.
///
/// Lag and delay stay in the model also where they are not significant: a fit that leaves them out attributes
/// their effect to the damping.
pub fn identify(
    period: f64,
    correction: &Correction,
    found: usize,
    responses: Vec<FrequencyPoint>,
    mut left_out: Vec<LeftOut>,
) -> Result<Identification, IdentifyError> {
    let stands_out =
        |r: &FrequencyPoint| r.counts >= LEAST_COUNTS && r.deviation < 0.5 * r.impedance().norm();
    let (responses, lost): (Vec<_>, Vec<_>) = responses.into_iter().partition(stands_out);
    left_out.extend(lost.iter().map(|r| without(r, Reason::Noise(r.counts))));
    let (usable, speeds) = (responses.len(), speeds(&responses));
    let too_few = |left_out: Vec<LeftOut>| IdentifyError::TooFew { found, usable, left_out };
    if usable < 3 {
        return Err(too_few(left_out));
    }
    let tells_friction = speeds[1] >= LEAST_SPEEDS * speeds[0];
    let (declared, source) = (correction.delay(), correction.source);
    let nothing =
        Measured { responses: &[], period, declared, source, with_friction: tells_friction };
    let profile = |responses: &[FrequencyPoint]| {
        Profile::of(&Measured { responses, ..nothing }, correction.longest_lag)
    };
    let Some(mut profile_found) = profile(&responses) else {
        return Err(too_few(left_out));
    };
    let (mut slipping, mut held) = (responses.clone(), Vec::new());
    for _ in 0..ROUNDS {
        let friction = profile_found.best.model.friction;
        let parts = responses.iter().map(|r| (*r, friction / (r.speed * r.impedance().norm())));
        let (most, least): (Vec<_>, Vec<_>) = parts.partition(|(_, part)| *part > MOST_FRICTION);
        slipping = least.iter().map(|(r, part)| described(r, friction, *part)).collect();
        held = most;
        match profile(&slipping).filter(|_| slipping.len() >= 3) {
            Some(found) => profile_found = found,
            None => return Err(too_few(left_out)),
        }
    }
    left_out.extend(held.iter().map(|(r, part)| without(r, Reason::Friction(*part))));
    let (responses, profile) = (slipping, profile_found);
    let measured = Measured { responses: &responses, ..nothing };
    let model = profile.best.model;
    let is_rigid = profile.misfit <= RIGID;
    let latency = Latency::of(&profile, measured.fastest(), is_rigid);
    // Lag and delay of a fit that explains nothing would add false images.
    let plain = if is_rigid { None } else { measured.fit(0.0, Delay::Fixed(0.0)) };
    let responses = without_images(&measured, &plain.map_or(model, |fit| fit.model));
    let disk = disk(&responses);
    let damping = profile.damping();
    Ok(Identification {
        inertia: profile.inertia(),
        damping,
        least_damping: damping.value - BOUND * (damping.value - damping.lo),
        friction: friction(&profile, tells_friction, speeds[1]),
        tells_friction,
        speeds,
        mean_delay: profile.mean_delay(),
        latency,
        model,
        disk,
        bias: model.impedance(disk.omega).re - model.damping,
        misfit: profile.misfit,
        linearity: 0.0,
        responses,
        left_out,
    })
}

/// The smallest and the largest velocity in rad/s.
fn speeds(responses: &[FrequencyPoint]) -> [f64; 2] {
    let speeds = || responses.iter().map(|r| r.speed);
    [speeds().fold(f64::INFINITY, f64::min), speeds().fold(0.0, f64::max)]
}

/// A response with the error of the describing function of friction, which takes this part of its torque.
fn described(response: &FrequencyPoint, friction: f64, part: f64) -> FrequencyPoint {
    let error = DESCRIBED * part * friction_damping(friction, response.speed);
    FrequencyPoint { deviation: response.deviation.hypot(error), ..*response }
}

/// Friction as fitted, or all of the damping, where nothing tells them apart.
fn friction(profile: &Profile, is_told: bool, speed: f64) -> Estimate {
    match is_told {
        true => profile.friction(),
        false => {
            let most = profile.damping().hi.max(0.0) / friction_damping(1.0, speed);
            Estimate { value: 0.0, lo: 0.0, hi: most }
        }
    }
}

fn without(response: &FrequencyPoint, reason: Reason) -> LeftOut {
    LeftOut::new(response.omega, response.row, reason)
}

/// The responses without the images of the held torque, which are known once the device is.
fn without_images(measured: &Measured<'_>, model: &Model) -> Vec<FrequencyPoint> {
    let corrected = |r: &FrequencyPoint| {
        let admittance = r.admittance / measured.images(model, r.omega);
        FrequencyPoint { admittance, ..*r }
    };
    measured.responses.iter().map(corrected).collect()
}

/// The response nearest to the rim has the smallest lower end.
fn disk(responses: &[FrequencyPoint]) -> Disk {
    // Normal distribution: the deviation of each response rests on many samples.
    let quantile = student(1e6);
    let rim = |r: &FrequencyPoint| {
        let delta = r.impedance().re;
        Disk { delta, lo: delta - quantile * r.deviation, omega: r.omega }
    };
    let nearer = |a: Disk, b: Disk| if b.delta < a.delta { b } else { a };
    let none = Disk { delta: f64::INFINITY, lo: f64::INFINITY, omega: 0.0 };
    let nearest = responses.iter().map(rim).fold(none, nearer);
    let lo = responses.iter().map(|r| rim(r).lo).fold(f64::INFINITY, f64::min);
    Disk { lo, ..nearest }
}
