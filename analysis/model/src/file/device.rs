//! The table of a device: a rigid body, or a chain of masses, and the lags at its two ends.

use haptic_servo::scene::{Device, Latency};

use super::faults::{Read, all};
use super::key::{self, Key};
use super::section::Section;
use crate::chain::{Chain, EncoderPlace, Link, MAX_MASSES, Mass};
use crate::disturbance::{Cogging, Sine};
use crate::quantity::significant;

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
    /// Cogging of the motor.
    pub cogging: Option<Cogging>,
    /// The times of amplifier and encoder.
    pub latency: Latency,
}

/// Reads `[device]`.
pub fn device(mut section: Section<'_>, purpose: Purpose) -> Read<DeviceTable> {
    let friction = section.optional(&key::DEVICE_FRICTION);
    let cogging = section.tables_or_one(&key::COGGING).and_then(|tables| {
        let mut counts = Vec::new();
        let sines = |tables: Vec<_>| all(tables.into_iter().map(|table| sine(table, &mut counts)));
        tables.map(sines).transpose().map(|read| read.map(Cogging::of))
    });
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
    let declared = section.optional(&key::PASSIVITY);
    let encoder = section.text(&key::ENCODER);
    let [actuator_lag, sensor_lag, actuator_response] =
        [&key::ACTUATOR_LAG, &key::SENSOR_LAG, &key::ACTUATOR_RESPONSE]
            .map(|key| section.time(key));
    let updates = section.number(&key::ACTUATOR_UPDATES);
    section.finish();
    let (friction, cogging) = (friction?, cogging?);
    let (chain, declared, encoder) = (chain?, declared?, encoder?);
    let latency = Latency {
        actuator_lag: actuator_lag?,
        sensor_lag: sensor_lag?,
        actuator_response: actuator_response?,
        actuator_updates: updates? as u16,
        ..Latency::NONE
    };
    alone(&section, &latency)?;
    followed(&section, &chain, cogging)?;
    let chain = placed(&section, chain, encoder.as_deref())?;
    let is_apart = encoder.is_some() && !chain.is_collocated();
    let key = if is_apart { &key::ENCODER } else { &key::DEVICE };
    let passivity = passivity(&section, &chain, purpose, key, declared, is_rigid)?;
    let device = Device { inertia: chain.inertia(), damping: chain.damping(), passivity };
    Ok(DeviceTable { chain, device, friction, cogging, latency })
}

/// One harmonic; the `counts` are those of the harmonics before.
fn sine(mut section: Section<'_>, counts: &mut Vec<f64>) -> Read<Sine> {
    let [torque, count, phase] = [&key::COGGING_TORQUE, &key::COGGING_COUNT, &key::COGGING_PHASE]
        .map(|key| section.number(key));
    section.finish();
    let count = count?;
    if counts.contains(&count) {
        let reason = "is the count of a harmonic before, too: write one harmonic of both";
        return Err(section.conflict(&key::COGGING_COUNT, reason));
    }
    counts.push(count);
    Ok(Sine { torque: torque?, count, phase: phase? })
}

/// A simulation takes the more steps in a tick, the faster the motor's mass swings in its cogging.
fn followed(section: &Section<'_>, chain: &Chain, cogging: Option<Cogging>) -> Read<()> {
    let inertias = chain.masses().first().map(|mass| mass.inertia);
    let rate = cogging.zip(inertias).map_or(0.0, |(cogging, inertia)| cogging.rate(inertia));
    if rate <= Cogging::LARGEST_RATE {
        return Ok(());
    }
    let (rate, largest) = (significant(rate, 3), Cogging::LARGEST_RATE);
    let reason = format!(
        "lets the motor's inertia swing at up to {rate} rad/s, and a simulation follows at most {largest} rad/s"
    );
    Err(section.conflict(&key::COGGING, reason))
}

/// A step response of unknown shape cannot stand beside a lag: no bound is known for both.
fn alone(section: &Section<'_>, latency: &Latency) -> Read<()> {
    let lags = [latency.actuator_lag, latency.sensor_lag];
    if latency.actuator_response.is_zero() || lags.iter().all(|lag| lag.is_zero()) {
        return Ok(());
    }
    let [actuator, sensor] = [key::ACTUATOR_LAG.path, key::SENSOR_LAG.path];
    let reason = format!("stands beside `{actuator}` or `{sensor}`");
    Err(section.conflict(&key::ACTUATOR_RESPONSE, reason))
}

fn rigid(section: &mut Section<'_>) -> Read<Chain> {
    let inertia = section.number(&key::INERTIA);
    let damping = section.number(&key::DEVICE_DAMPING);
    let mass = Mass { inertia: inertia?, damping: damping? };
    chain(section, &key::DEVICE, vec![mass], Vec::new())
}

fn masses_and_links(section: &mut Section<'_>, masses: Vec<Section<'_>>) -> Read<Chain> {
    let alone = [&key::INERTIA, &key::DEVICE_DAMPING].map(|key| match section.optional(key)? {
        None => Ok(()),
        Some(_) => {
            let reason = format!("stands beside [[{}]], which has its own", key::MASS.path);
            Err(section.conflict(key, reason))
        }
    });
    let links = section.tables(&key::LINK)?;
    let count = masses.len();
    if count == 0 || count > MAX_MASSES {
        return Err(section.out_of_bounds(&key::MASS));
    }
    let masses = all(masses.into_iter().map(mass));
    let has_links = links.is_some();
    let links = links.unwrap_or_default();
    if links.len() + 1 != count {
        let reason = format!("are {} for {count} masses; there must be {}", links.len(), count - 1);
        return Err(match has_links {
            true => section.conflict(&key::LINK, reason),
            false => section.missing(&key::LINK),
        });
    }
    let links = all(links.into_iter().map(link));
    all(alone.into_iter())?;
    chain(section, &key::MASS, masses?, links?)
}

fn mass(mut section: Section<'_>) -> Read<Mass> {
    let inertia = section.number(&key::MASS_INERTIA);
    let damping = section.number(&key::MASS_DAMPING);
    section.finish();
    Ok(Mass { inertia: inertia?, damping: damping? })
}

fn link(mut section: Section<'_>) -> Read<Link> {
    let stiffness = section.number(&key::LINK_STIFFNESS);
    let damping = section.number(&key::LINK_DAMPING);
    section.finish();
    let link = Link { stiffness: stiffness?, damping: damping? };
    if link.stiffness == 0.0 && link.damping == 0.0 {
        return Err(section.conflict(&key::LINK_STIFFNESS, "and no damping connect nothing"));
    }
    Ok(link)
}

/// The bounds of the keys are those of a chain, so this does not fail; an error would be reported, not a
/// panic.
fn chain(section: &Section<'_>, key: &Key, masses: Vec<Mass>, links: Vec<Link>) -> Read<Chain> {
    Chain::new(masses, links).map_err(|error| section.conflict(key, error))
}

fn placed(section: &Section<'_>, chain: Chain, encoder: Option<&str>) -> Read<Chain> {
    let Some(encoder) = encoder else { return Ok(chain) };
    match EncoderPlace::ALL.into_iter().find(|at| at.as_str() == encoder) {
        Some(place) => Ok(chain.with_encoder(place)),
        None => Err(section.out_of_bounds(&key::ENCODER)),
    }
}

/// The `passivity` of the rigid body that stands for the chain: the declared value, or the lower end of the
/// chain's passivity; `None` for a rigid body without a declared value, whose passivity is its damping. It is
/// at most the damping, whose sum over a chain is rounded. `key` is what leaves a device without passivity.
fn passivity(
    section: &Section<'_>,
    chain: &Chain,
    purpose: Purpose,
    key: &Key,
    declared: Option<f64>,
    is_rigid: bool,
) -> Read<Option<f64>> {
    if is_rigid && declared.is_some_and(|declared| declared > chain.damping()) {
        let (name, damping, unit) =
            (key::DEVICE_DAMPING.path, chain.damping(), key::DEVICE_DAMPING.unit);
        let reason = format!(
            "is more than `{name}` = {damping} {unit}, and no device has more passivity than damping"
        );
        return Err(section.conflict(&key::PASSIVITY, reason));
    }
    let found = match chain.excess_passivity() {
        Ok(found) => found.delta,
        Err(_) if purpose == Purpose::Simulate => return Ok(Some(f64::NAN)),
        Err(reason) => {
            let reason = format!("leaves the device without passivity: {reason}");
            return Err(section.conflict(key, reason));
        }
    };
    match declared {
        None if is_rigid => Ok(None),
        None => Ok(Some(found.lo().min(chain.damping()))),
        Some(declared) if !is_rigid && declared > found.hi() => {
            let reason = format!("is more than the {} N m s/rad that the chain has", found.hi());
            Err(section.conflict(&key::PASSIVITY, reason))
        }
        Some(declared) => Ok(Some(declared.min(chain.damping()))),
    }
}
