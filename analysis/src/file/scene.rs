//! A scene file's tables turned into a [`Scene`].

use firmware::certificate::Steps;
use firmware::environment::{Coefficients, Environment, MAX_DEGREE, MAX_DELAY, Rational, Wall};
use firmware::scene::{Coupling, Scene, Timing};

use super::device::{self, Purpose};
use super::key::{self, Key};
use super::problem::Fault;
use super::section::{Found, Section};
use super::simulation::{self, Simulation};
use super::tree::{Node, Value};
use crate::chain::Chain;
use crate::device::Hand;

/// Everything that a scene file says.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// What the person calls the scene.
    pub name: String,
    /// The scene itself; nothing about it is certified yet. Its device is the rigid body that
    /// stands for the chain: all inertia, all damping to the ground, and the chain's passivity.
    pub scene: Scene,
    /// The device as the file describes it, for simulation.
    pub chain: Chain,
    /// What a simulation starts from.
    pub simulation: Option<Simulation>,
    /// A passive hand that holds the device, for simulation.
    pub hand: Option<Hand>,
    /// Angle of one encoder count in rad.
    pub encoder_step: Option<f64>,
    /// Torque of the motor in N m at the converter's largest code.
    pub full_scale: Option<f64>,
    /// Dry friction of the device in N m.
    pub friction: Option<f64>,
}

impl SceneFile {
    /// What the file says of the machine, for the certificate's assumptions.
    pub fn steps(&self) -> Steps {
        let Self { encoder_step: encoder, full_scale, friction, .. } = *self;
        Steps { encoder, full_scale, friction }
    }
}

/// Reads the tables of a parsed file.
pub fn read(text: &str, root: Node, purpose: Purpose) -> Result<SceneFile, Fault> {
    let mut top = Section::new(text, "a scene", &ROOT, root)?;
    let name = top.needed_text(&key::NAME)?.value;
    let (chain, device, friction) = device::device(top.needed_table(&key::DEVICE)?, purpose)?;
    let timing = timing(top.needed_table(&key::SERVO)?)?;
    let coupling = top.table(&key::COUPLING)?.map_or(Ok(Coupling::Rigid), coupling)?;
    let environment = environment(top.needed_table(&key::ENVIRONMENT)?)?;
    let simulation = top.table(&key::SIMULATION)?;
    let rubs = friction.unwrap_or(0.0);
    let simulation = simulation.map(|table| simulation::simulation(table, timing.period, rubs));
    let simulation = simulation.transpose()?;
    let hand = top.table(&key::HUMAN)?.map(simulation::hand).transpose()?;
    let [torque_limit, encoder_step, full_scale] =
        top.table(&key::LIMITS)?.map_or(Ok([None; 3]), limits)?;
    top.finish()?;
    let scene = Scene { device, timing, coupling, environment, torque_limit };
    Ok(SceneFile { name, scene, chain, simulation, hand, encoder_step, full_scale, friction })
}

/// The file as a whole: it has no name, and must be a table.
const ROOT: Key = Key {
    path: "",
    unit: "",
    bound: key::Bound::Other("a table of `name`, [device], [servo] and [environment]"),
};

fn timing(mut section: Section<'_>) -> Result<Timing, Fault> {
    let period = section.number(&key::PERIOD)?;
    let worst = section.found(&key::WORST_PERIOD)?;
    if let Some(Found { value, span }) = &worst
        && *value < period
    {
        let reason = format!("is shorter than `{}` = {period} s", key::PERIOD.path);
        return Err(section.conflict(&key::WORST_PERIOD, span.clone(), reason));
    }
    section.finish()?;
    Ok(Timing { period, worst_period: worst.map(|found| found.value) })
}

fn coupling(mut section: Section<'_>) -> Result<Coupling, Fault> {
    let stiffness = section.number(&key::COUPLING_STIFFNESS)?;
    section.finish()?;
    Ok(Coupling::Spring { stiffness })
}

fn limits(mut section: Section<'_>) -> Result<[Option<f64>; 3], Fault> {
    let keys = [&key::TORQUE_LIMIT, &key::ENCODER_STEP, &key::FULL_SCALE];
    let mut found = [None; 3];
    for (place, key) in found.iter_mut().zip(keys) {
        *place = section.optional(key)?;
    }
    section.finish()?;
    Ok(found)
}

fn environment(mut section: Section<'_>) -> Result<Environment, Fault> {
    let kind = section.needed_text(&key::TYPE)?;
    section.retitle(format!("a {} [environment]", super::problem::excerpt(&kind.value)));
    let environment = match kind.value.as_str() {
        "delayed-spring" => Environment::DelayedSpring(spring(&mut section)?),
        "damper-wall" => Environment::DamperWall(wall(&mut section)?),
        "free-mode" => Environment::FreeMode {
            residual: section.number(&key::RESIDUAL)?,
            delay: whole(section.optional(&key::DELAY_SAMPLES)?),
        },
        "free-mode-wall" => Environment::FreeModeWall {
            residual: section.number(&key::RESIDUAL)?,
            wall: wall(&mut section)?,
        },
        "rational" => Environment::Rational(rational(&mut section)?),
        _ => return Err(section.out_of_bounds(&key::TYPE, key::TYPE.path, &kind.span)),
    };
    section.finish()?;
    Ok(environment)
}

fn spring(section: &mut Section<'_>) -> Result<Wall, Fault> {
    let stiffness = section.number(&key::STIFFNESS)?;
    let delay = whole(Some(section.number(&key::DELAY_SAMPLES)?));
    Ok(Wall { stiffness, damping: 0.0, filter: None, delay, face: 0.0, one_sided: false })
}

fn wall(section: &mut Section<'_>) -> Result<Wall, Fault> {
    Ok(Wall {
        stiffness: section.number(&key::STIFFNESS)?,
        damping: section.number(&key::DAMPING)?,
        filter: section.optional(&key::FILTER)?,
        delay: whole(Some(section.number(&key::DELAY_SAMPLES)?)),
        face: section.optional(&key::FACE)?.unwrap_or(0.0),
        one_sided: section.boolean(&key::ONE_SIDED)?.unwrap_or(false),
    })
}

fn rational(section: &mut Section<'_>) -> Result<Rational, Fault> {
    let numerator = polynomial(section, &key::NUMERATOR, 0)?.0;
    let delay = whole(section.optional(&key::DELAY_SAMPLES)?);
    let (denominator, more) = polynomial(section, &key::DENOMINATOR, MAX_DELAY - delay)?;
    let delay = delay + more;
    let unit_zeros = section.found(&key::UNIT_ZEROS)?;
    if let Some(Found { value, span }) = &unit_zeros
        && numerator.as_slice().len() - 1 + whole(Some(*value)) > MAX_DEGREE
    {
        let reason = format!("makes the numerator's degree more than {MAX_DEGREE}");
        return Err(section.conflict(&key::UNIT_ZEROS, span.clone(), reason));
    }
    let unit_zeros = whole(unit_zeros.map(|found| found.value));
    Ok(Rational { numerator, denominator, delay, unit_zeros })
}

/// Descending coefficients without leading zeros; a denominator must have one that is not zero. And how
/// many of the zeros at its end, up to `most`, were too many for the degree and taken off.
fn polynomial(
    section: &mut Section<'_>,
    key: &Key,
    most: usize,
) -> Result<(Coefficients, usize), Fault> {
    let Some(Found { mut value, span }) = section.list(key)? else {
        return Err(section.missing(key));
    };
    let mut taken = 0;
    while taken < most && value.len() > MAX_DEGREE + 1 && value.last() == Some(&0.0) {
        value.pop();
        taken += 1;
    }
    let leading = value.iter().position(|&coefficient| coefficient != 0.0);
    let significant = match leading {
        Some(first) => &value[first..],
        None if *key == key::DENOMINATOR => &[],
        None => &value[value.len().saturating_sub(1)..],
    };
    let coefficients =
        if value.len() > MAX_DEGREE + 1 { None } else { Coefficients::new(significant) };
    let coefficients = coefficients.ok_or_else(|| section.out_of_bounds(key, key.path, &span))?;
    Ok((coefficients, taken))
}

/// A number whose bound is [`key::Bound::Whole`]; zero where it was left out.
fn whole(value: Option<f64>) -> usize {
    value.map_or(0, |value| value as usize)
}

/// Whether a parsed file has nothing in it.
pub fn is_empty(root: &Node) -> bool {
    matches!(&root.value, Value::Table(entries) if entries.is_empty())
}
