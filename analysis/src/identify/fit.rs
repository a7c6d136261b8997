//! Results from the responses: the disk that contains them, and the rigid device behind a late torque that
//! fits them.

use super::error::IdentifyError;
use super::estimate::Estimate;
use super::latency::{Latency, NoLatency};
use super::least_squares::{Delay, Measured};
use super::model::Model;
use super::profile::{Profile, student};
use super::response::{Correction, FrequencyPoint};
use super::step::LeftOut;
use crate::quantity::significant;

/// Least motion in counts: below it the encoder's steps do not act as noise any more.
const LEAST_COUNTS: f64 = 1.5;

/// Largest squared residual, in squared deviations a degree of freedom, of a device that passes for rigid:
/// residuals up to three times the deviation of the noise, which allows for noise that is not white.
const RIGID: f64 = 9.0;

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
}

impl Identification {
    /// Whether inertia, damping, lag and delay explain the responses.
    pub fn is_rigid(&self) -> bool {
        self.misfit <= RIGID
    }

    /// Damping of the device in N m s/rad that motion loses through the board's own current loop; 0 with an
    /// external amplifier.
    pub fn motion_loss(&self) -> f64 {
        self.model.source.map_or(0.0, |source| source.loss)
    }

    /// `delta` to certify with, in N m s/rad: the lower end of the damping of a rigid device, less the
    /// damping that motion loses through the board's own current loop. `None` where that is not positive, and
    /// for a device that is not rigid: no hand held it, and its damping in a hand cannot be measured from the
    /// motor alone (theory, section 3.2).
    pub fn passivity(&self) -> Option<f64> {
        let passivity = self.damping.lo - self.motion_loss();
        (self.is_rigid() && passivity > 0.0).then_some(passivity)
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
    left_out.extend(lost.iter().map(lost_in_noise));
    let usable = responses.len();
    let too_few = |left_out: Vec<LeftOut>| IdentifyError::TooFew { found, usable, left_out };
    if usable < 3 {
        return Err(too_few(left_out));
    }
    let (declared, source) = (correction.delay(), correction.source);
    let measured = Measured { responses: &responses, period, declared, source };
    let Some(profile) = Profile::of(&measured, correction.longest_lag) else {
        return Err(too_few(left_out));
    };
    let model = profile.best.model;
    let is_rigid = profile.misfit <= RIGID;
    let latency = Latency::of(&profile, measured.fastest(), is_rigid);
    // Lag and delay of a fit that explains nothing would add false images.
    let plain = if is_rigid { None } else { measured.fit(0.0, Delay::Fixed(0.0)) };
    let responses = without_images(&measured, &plain.map_or(model, |fit| fit.model));
    let disk = disk(&responses);
    Ok(Identification {
        inertia: profile.inertia(),
        damping: profile.damping(),
        mean_delay: profile.mean_delay(),
        latency,
        model,
        disk,
        bias: model.impedance(disk.omega).re - model.damping,
        misfit: profile.misfit,
        responses,
        left_out,
    })
}

fn lost_in_noise(response: &FrequencyPoint) -> LeftOut {
    let counts = significant(response.counts, 2);
    let reason = format!(
        "its motion of {counts} counts is below quantisation and noise: use a larger torque, or a \
         longer tone"
    );
    LeftOut::new(response.omega, reason)
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
