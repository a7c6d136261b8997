//! The table of a device: a rigid body, or a chain of masses, and the lags at its two ends.

use haptic_servo::scene::{Device, TimeRange};

use super::faults::{Read, Reported, all};
use super::key::{self, Key};
use super::problem::Problem;
use super::section::{Found, Section};
use super::tree::Span;
use crate::chain::{Chain, EncoderPlace, Link, MAX_MASSES, Mass, NoPassivity};

/// The purpose of reading a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To certify: a device without passivity is an error.
    Certify,
    /// To simulate: a device without passivity gets no certificate, so the scene's `passivity` is NaN.
    Simulate,
}

/// The contents of `[device]`.
pub struct DeviceTable {
    /// The chain, without the lag of its amplifier.
    pub chain: Chain,
    /// The rigid body that stands for it in a certificate.
    pub device: Device,
    /// Dry friction of the motor's mass in N m.
    pub friction: Option<f64>,
    /// Time constant of the amplifier.
    pub actuator_lag: Option<Found<TimeRange>>,
    /// Time constant of the filter behind the encoder.
    pub sensor_lag: Option<Found<TimeRange>>,
    /// Begin and end of the amplifier's step response.
    pub actuator_response: Option<Found<TimeRange>>,
    /// Updates of the amplifier in a period.
    pub actuator_updates: Option<Found<f64>>,
}

/// Reads `[device]`.
pub fn device(mut section: Section<'_>, purpose: Purpose) -> Read<DeviceTable> {
    let friction = section.optional(&key::DEVICE_FRICTION);
    let masses = section.tables(&key::MASS);
    let is_rigid = matches!(masses, Ok(None));
    let chain = match masses {
        Ok(None) => rigid(&mut section),
        Ok(Some(masses)) => masses_and_links(&mut section, masses),
        Err(reported) => {
            let unread = [&key::INERTIA, &key::DEVICE_DAMPING, &key::LINK];
            unread.into_iter().for_each(|key| section.skip(key));
            Err(reported)
        }
    };
    let declared = section.found(&key::PASSIVITY);
    let encoder = section.text(&key::ENCODER);
    let [actuator_lag, sensor_lag, actuator_response] =
        [&key::ACTUATOR_LAG, &key::SENSOR_LAG, &key::ACTUATOR_RESPONSE]
            .map(|key| section.time(key));
    let actuator_updates = section.found(&key::ACTUATOR_UPDATES);
    section.finish();
    let (friction, chain, declared) = (friction?, chain?, declared?);
    let (encoder, actuator_lag, sensor_lag) = (encoder?, actuator_lag?, sensor_lag?);
    let (actuator_response, actuator_updates) = (actuator_response?, actuator_updates?);
    alone(&section, actuator_response.as_ref(), &[&actuator_lag, &sensor_lag])?;
    let chain = placed(&section, chain, encoder.as_ref())?;
    let place = match &encoder {
        Some(found) if !chain.is_collocated() => (&key::ENCODER, found.span.clone()),
        _ => (&key::DEVICE, section.span()),
    };
    let passivity = passivity(&section, &chain, purpose, place, declared, is_rigid)?;
    let device = Device { inertia: chain.inertia(), damping: chain.damping(), passivity };
    Ok(DeviceTable {
        chain,
        device,
        friction,
        actuator_lag,
        sensor_lag,
        actuator_response,
        actuator_updates,
    })
}

/// A step response of unknown shape cannot stand beside a lag: no bound is known for both.
fn alone(
    section: &Section<'_>,
    response: Option<&Found<TimeRange>>,
    lags: &[&Option<Found<TimeRange>>],
) -> Read<()> {
    let has_lag = lags.iter().any(|lag| lag.as_ref().is_some_and(|found| !found.value.is_zero()));
    match response {
        Some(found) if has_lag && !found.value.is_zero() => {
            let lags = [key::ACTUATOR_LAG.path, key::SENSOR_LAG.path];
            let reason = format!("stands beside `{}` or `{}`", lags[0], lags[1]);
            Err(section.conflict(&key::ACTUATOR_RESPONSE, found.span.clone(), reason))
        }
        _ => Ok(()),
    }
}

fn rigid(section: &mut Section<'_>) -> Read<Chain> {
    let inertia = section.number(&key::INERTIA);
    let damping = section.number(&key::DEVICE_DAMPING);
    let mass = Mass { inertia: inertia?, damping: damping? };
    chain(section, &key::DEVICE, section.span(), vec![mass], Vec::new())
}

fn masses_and_links(section: &mut Section<'_>, masses: Found<Vec<Section<'_>>>) -> Read<Chain> {
    let alone = [&key::INERTIA, &key::DEVICE_DAMPING].map(|key| {
        let Some(Found { span, .. }) = section.found(key)? else { return Ok(()) };
        let reason = format!("stands beside [[{}]], which has its own", key::MASS.path);
        Err(section.conflict(key, span, reason))
    });
    let links = section.tables(&key::LINK)?;
    let (count, mass_span) = (masses.value.len(), masses.span);
    if count == 0 || count > MAX_MASSES {
        return Err(section.out_of_bounds(&key::MASS, key::MASS.path, &mass_span));
    }
    let masses = all(masses.value.into_iter().map(mass));
    let (links, link_span) =
        links.map_or((Vec::new(), None), |links| (links.value, Some(links.span)));
    if links.len() + 1 != count {
        let reason = format!("are {} for {count} masses; there must be {}", links.len(), count - 1);
        return Err(match link_span {
            Some(span) => section.conflict(&key::LINK, span, reason),
            None => section.missing(&key::LINK),
        });
    }
    let links = all(links.into_iter().map(link));
    all(alone.into_iter())?;
    chain(section, &key::MASS, mass_span, masses?, links?)
}

fn mass(mut section: Section<'_>) -> Read<Mass> {
    let inertia = section.number(&key::MASS_INERTIA);
    let damping = section.number(&key::MASS_DAMPING);
    section.finish();
    Ok(Mass { inertia: inertia?, damping: damping? })
}

fn link(mut section: Section<'_>) -> Read<Link> {
    let stiffness = section.found(&key::LINK_STIFFNESS);
    let stiffness =
        stiffness.and_then(|found| found.ok_or_else(|| section.missing(&key::LINK_STIFFNESS)));
    let damping = section.number(&key::LINK_DAMPING);
    section.finish();
    let (stiffness, damping) = (stiffness?, damping?);
    if stiffness.value == 0.0 && damping == 0.0 {
        let reason = "and no damping connect nothing".to_owned();
        return Err(section.conflict(&key::LINK_STIFFNESS, stiffness.span, reason));
    }
    Ok(Link { stiffness: stiffness.value, damping })
}

/// The bounds of the keys are those of a chain, so this does not fail; an error would be reported, not a
/// panic.
fn chain(
    section: &Section<'_>,
    key: &Key,
    span: Span,
    masses: Vec<Mass>,
    links: Vec<Link>,
) -> Read<Chain> {
    Chain::new(masses, links).map_err(|error| section.conflict(key, span, error.to_string()))
}

fn placed(section: &Section<'_>, chain: Chain, encoder: Option<&Found<String>>) -> Read<Chain> {
    let Some(Found { value, span }) = encoder else { return Ok(chain) };
    let place = [EncoderPlace::Motor, EncoderPlace::Hand].into_iter().find(|at| at.word() == value);
    match place {
        Some(place) => Ok(chain.with_encoder(place)),
        None => Err(section.out_of_bounds(&key::ENCODER, key::ENCODER.path, span)),
    }
}

/// The `passivity` of the rigid body that stands for the chain: the declared value, or the lower end of the
/// chain's passivity; `None` for a rigid body without a declared value, whose passivity is its damping. It is
/// at most the damping, whose sum over a chain is rounded.
fn passivity(
    section: &Section<'_>,
    chain: &Chain,
    purpose: Purpose,
    (key, span): (&'static Key, Span),
    declared: Option<Found<f64>>,
    is_rigid: bool,
) -> Read<Option<f64>> {
    if let Some(Found { value, span }) = &declared
        && is_rigid
        && *value > chain.damping()
    {
        let (name, damping, unit) =
            (key::DEVICE_DAMPING.path, chain.damping(), key::DEVICE_DAMPING.unit);
        let reason = format!(
            "is more than `{name}` = {damping} {unit}, and no device has more passivity than damping"
        );
        return Err(section.conflict(&key::PASSIVITY, span.clone(), reason));
    }
    let found = match chain.excess_passivity() {
        Ok(found) => found.delta,
        Err(_) if purpose == Purpose::Simulate => return Ok(Some(f64::NAN)),
        Err(reason) => return Err(no_passivity(section, key, span, reason)),
    };
    match declared {
        None if is_rigid => Ok(None),
        None => Ok(Some(found.lo().min(chain.damping()))),
        Some(Found { value, span }) if !is_rigid && value > found.hi() => {
            let reason = format!("is more than the {} N m s/rad that the chain has", found.hi());
            Err(section.conflict(&key::PASSIVITY, span, reason))
        }
        Some(Found { value, .. }) => Ok(Some(value.min(chain.damping()))),
    }
}

fn no_passivity(
    section: &Section<'_>,
    key: &'static Key,
    span: Span,
    reason: NoPassivity,
) -> Reported {
    let value = section.written(&span);
    section.report(span, Problem::NoPassivity { key: key.path, value, reason })
}
