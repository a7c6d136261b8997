//! The device of a file: a rigid body, or a chain of masses, perhaps behind an amplifier that lags.

use firmware::scene::Device;

use super::key::{self, Key};
use super::problem::{Fault, Problem};
use super::scene;
use super::section::{Found, Section};
use super::tree::{Node, Span};
use crate::chain::{Chain, EncoderPlace, Link, MAX_MASSES, Mass, NoPassivity};

/// What a file is read for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To certify: a device without passivity is an error.
    Certify,
    /// To look at: a device without passivity is one that no certificate is given for, so the
    /// scene's `passivity` is not a number.
    Simulate,
}

/// A file that describes a device.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceFile {
    /// What the person calls it, or the scene that it is part of.
    pub name: Option<String>,
    /// The device.
    pub chain: Chain,
}

/// A file of a device is a table, like that of a scene.
const ROOT: Key =
    Key { path: "", unit: "", bound: key::Bound::Other("a table of [device] and perhaps `name`") };

/// Reads a device file, or the device of a scene file, which is checked as a whole.
pub fn read(text: &str, root: Node) -> Result<DeviceFile, Fault> {
    let mut top = Section::new(text, "a device's file", &ROOT, root.clone())?;
    if [key::SERVO, key::ENVIRONMENT].iter().any(|key| top.has(key)) {
        let scene = scene::read(text, root, Purpose::Simulate)?;
        return Ok(DeviceFile { name: Some(scene.name), chain: scene.chain });
    }
    let name = top.text(&key::NAME)?.map(|found| found.value);
    let (chain, ..) = device(top.needed_table(&key::DEVICE)?, Purpose::Simulate)?;
    top.finish()?;
    Ok(DeviceFile { name, chain })
}

/// Reads `[device]`: the chain, the rigid body that stands for it in a certificate, and the dry
/// friction of the motor's mass.
pub fn device(
    mut section: Section<'_>,
    purpose: Purpose,
) -> Result<(Chain, Device, Option<f64>), Fault> {
    let friction = section.optional(&key::DEVICE_FRICTION)?;
    let masses = section.tables(&key::MASS)?;
    let is_rigid = masses.is_none();
    let chain = match masses {
        None => rigid(&mut section)?,
        Some(masses) => masses_and_links(&mut section, masses)?,
    };
    let declared = section.found(&key::PASSIVITY)?;
    let encoder = section.text(&key::ENCODER)?;
    let lag = section.found(&key::ACTUATOR_LAG)?;
    let chain = placed(&section, chain, encoder.as_ref())?;
    let chain = match &lag {
        None => chain,
        Some(Found { value, span }) => {
            let lagging = chain.with_actuator_lag(*value);
            lagging.map_err(|error| {
                section.conflict(&key::ACTUATOR_LAG, span.clone(), error.to_string())
            })?
        }
    };
    let place = match (&lag, &encoder) {
        (_, Some(found)) if !chain.is_collocated() => (&key::ENCODER, found.span.clone()),
        (Some(found), _) => (&key::ACTUATOR_LAG, found.span.clone()),
        _ => (&key::DEVICE, section.span()),
    };
    let passivity = passivity(&section, &chain, purpose, place, declared, is_rigid)?;
    section.finish()?;
    let device = Device { inertia: chain.inertia(), damping: chain.damping(), passivity };
    Ok((chain, device, friction))
}

fn rigid(section: &mut Section<'_>) -> Result<Chain, Fault> {
    let inertia = section.number(&key::INERTIA)?;
    let damping = section.number(&key::DEVICE_DAMPING)?;
    chain(section, &key::DEVICE, section.span(), vec![Mass { inertia, damping }], Vec::new())
}

fn masses_and_links(
    section: &mut Section<'_>,
    masses: Found<Vec<Section<'_>>>,
) -> Result<Chain, Fault> {
    for key in [&key::INERTIA, &key::DEVICE_DAMPING] {
        if let Some(Found { span, .. }) = section.found(key)? {
            let reason = format!("stands beside [[{}]], which has its own", key::MASS.path);
            return Err(section.conflict(key, span, reason));
        }
    }
    let (count, mass_span) = (masses.value.len(), masses.span);
    if count == 0 || count > MAX_MASSES {
        return Err(section.out_of_bounds(&key::MASS, key::MASS.path, &mass_span));
    }
    let links = section.tables(&key::LINK)?;
    let (links, link_span) =
        links.map_or((Vec::new(), None), |links| (links.value, Some(links.span)));
    if links.len() + 1 != count {
        let reason = format!("are {} for {count} masses; there must be {}", links.len(), count - 1);
        return Err(match link_span {
            Some(span) => section.conflict(&key::LINK, span, reason),
            None => section.missing(&key::LINK),
        });
    }
    let masses = masses.value.into_iter().map(mass).collect::<Result<_, _>>()?;
    let links = links.into_iter().map(link).collect::<Result<_, _>>()?;
    chain(section, &key::MASS, mass_span, masses, links)
}

fn mass(mut section: Section<'_>) -> Result<Mass, Fault> {
    let inertia = section.number(&key::MASS_INERTIA)?;
    let damping = section.optional(&key::MASS_DAMPING)?.unwrap_or(0.0);
    section.finish()?;
    Ok(Mass { inertia, damping })
}

fn link(mut section: Section<'_>) -> Result<Link, Fault> {
    let stiffness = section.found(&key::LINK_STIFFNESS)?;
    let stiffness = stiffness.ok_or_else(|| section.missing(&key::LINK_STIFFNESS))?;
    let damping = section.optional(&key::LINK_DAMPING)?.unwrap_or(0.0);
    if stiffness.value == 0.0 && damping == 0.0 {
        let reason = "and no damping connect nothing".to_owned();
        return Err(section.conflict(&key::LINK_STIFFNESS, stiffness.span, reason));
    }
    section.finish()?;
    Ok(Link { stiffness: stiffness.value, damping })
}

/// The bounds of the keys are those of a chain, so that this does not fail; if it did, it would be
/// with a sentence and not with a panic.
fn chain(
    section: &Section<'_>,
    key: &Key,
    span: Span,
    masses: Vec<Mass>,
    links: Vec<Link>,
) -> Result<Chain, Fault> {
    Chain::new(masses, links).map_err(|error| section.conflict(key, span, error.to_string()))
}

fn placed(
    section: &Section<'_>,
    chain: Chain,
    encoder: Option<&Found<String>>,
) -> Result<Chain, Fault> {
    let Some(Found { value, span }) = encoder else { return Ok(chain) };
    let place = [EncoderPlace::Motor, EncoderPlace::Hand].into_iter().find(|at| at.word() == value);
    match place {
        Some(place) => Ok(chain.with_encoder(place)),
        None => Err(section.out_of_bounds(&key::ENCODER, key::ENCODER.path, span)),
    }
}

/// The `passivity` of the rigid body that stands for the chain: the lower end of what the chain
/// has, unless something smaller has been measured. A rigid body's is its damping. Either is at most
/// the damping, whose sum over a chain is rounded.
fn passivity(
    section: &Section<'_>,
    chain: &Chain,
    purpose: Purpose,
    (key, span): (&'static Key, Span),
    declared: Option<Found<f64>>,
    is_rigid: bool,
) -> Result<Option<f64>, Fault> {
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
) -> Fault {
    let value = section.written(&span);
    Fault { span, problem: Problem::NoPassivity { key: key.path, value, reason } }
}
