//! A scene file's tables turned into a [`Scene`].

use haptic_servo::environment::{Coefficients, Environment, MAX_DEGREE, MAX_DELAY, Rational};
use haptic_servo::host::HostTorque;
use haptic_servo::latency::{LONGEST_DELAY, LONGEST_LAG};
use haptic_servo::magnetic::Chip;
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};

use super::anticogging;
use super::device::{self, DeviceTable, Purpose};
use super::encoder;
use super::faults::{Faults, Read, all};
use super::filter;
use super::host;
use super::key::{self, Key, OF_DEVICE_FILE};
use super::kind::{self, Kind};
use super::motor::{FileMotor, motor};
use super::problem::{Fault, Problem};
use super::profile::{self, ProfileTable, Shapes};
use super::section::Section;
use super::simulation::{self, Simulation};
use super::supply::{FileSupply, supply};
use super::tree::{Node, Value};
use super::updates;
use crate::chain::Chain;
use crate::chip_on_board::ChipOnBoard;
use crate::device::Hand;
use crate::disturbance::{Cogging, Disturbance};
use crate::hand::HandTrajectory;
use crate::missed::Missed;

/// The contents of a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// Name of the scene.
    pub name: String,
    /// The scene itself; nothing about it is certified yet. Its device is the rigid body that
    /// stands for the chain: all inertia, all damping to the ground, and the chain's passivity.
    pub scene: Scene,
    /// The device as the file describes it, for simulation; the lags at its two ends are the scene's.
    pub chain: Chain,
    /// The settings of a simulation.
    pub simulation: Option<Simulation>,
    /// A passive hand that holds the device, for simulation.
    pub hand: Option<Hand>,
    /// Angle of one encoder count in rad.
    pub encoder_step: Option<f64>,
    /// Torque of the motor in N m at the DAC's largest code.
    pub full_scale: Option<f64>,
    /// Dry friction of the device in N m.
    pub friction: Option<f64>,
    /// Cogging of its motor.
    pub cogging: Option<Cogging>,
    /// The supply of the bridge that drives the motor.
    pub supply: Option<FileSupply>,
    /// The motor, if a board's own bridge drives it.
    pub motor: Option<FileMotor>,
    /// The budget of a host that adds torques.
    pub host: Option<HostTorque>,
    /// The shapes that the scene's torque profile was sampled from.
    pub shapes: Option<Shapes>,
    /// The chip of a magnetic encoder that the board reads.
    pub chip: Option<&'static Chip>,
}

impl SceneFile {
    /// Friction and cogging of the device's motor.
    pub fn disturbance(&self) -> Disturbance {
        Disturbance {
            friction: self.friction.unwrap_or(0.0),
            cogging: self.cogging.unwrap_or_default(),
        }
    }

    /// The chip of its encoder, as the board of its motor reads it.
    pub fn chip_on_board(&self) -> Option<ChipOnBoard> {
        Some(ChipOnBoard { chip: self.chip?, has_bridge: self.motor.is_some() })
    }

    /// Readings of its encoder that fail in a simulation.
    pub fn dropped(&self) -> Missed {
        self.simulation.as_ref().map_or(Missed::None, |simulation| simulation.dropped)
    }

    /// The trajectory that demonstrates its environment, in its hand if it has one.
    pub fn demonstration(&self) -> HandTrajectory {
        let trajectory = HandTrajectory::for_environment(&self.scene.environment);
        HandTrajectory { hand: self.hand.unwrap_or(trajectory.hand), ..trajectory }
    }
}

/// Reads the tables of a parsed file.
pub fn read(source: (&str, &Faults), root: Node, purpose: Purpose) -> Read<SceneFile> {
    if is_device_file(&root) {
        let span = root.span.start..root.span.start;
        return Err(source.1.report(Fault { span, problem: Problem::OfDevice }));
    }
    let mut top = Section::new(source, "a scene", &ROOT, root)?;
    let name = top.needed_text(&key::NAME);
    let [device, servo, environment] =
        [&key::DEVICE, &key::SERVO, &key::ENVIRONMENT].map(|key| top.needed_table(key));
    let [reading, learnt, coupling, simulation, human, limits, host, supplied, driven] = [
        &key::READING,
        &key::ANTICOGGING,
        &key::COUPLING,
        &key::SIMULATION,
        &key::HUMAN,
        &key::LIMITS,
        &key::HOST,
        &key::SUPPLY,
        &key::MOTOR,
    ]
    .map(|key| top.table(key));
    top.finish();
    let device = device.and_then(|table| device::device(table, purpose));
    let reading = reading.and_then(|table| table.map(encoder::encoder).transpose());
    let learnt = learnt.and_then(|table| table.map(anticogging::anticogging).transpose());
    let servo = servo.and_then(servo_of);
    let coupling = coupling.and_then(|table| table.map_or(Ok(Coupling::Rigid), coupling_of));
    let environment = environment.and_then(environment_of);
    // If the servo could not be read, any latency is short enough.
    let period = servo.as_ref().map_or(f64::INFINITY, |servo| servo.timing.period);
    let rubs = device.as_ref().map_or(0.0, |table| table.friction.unwrap_or(0.0));
    let simulation = simulation
        .and_then(|table| table.map(|it| simulation::simulation(it, period, rubs)).transpose());
    let hand = human.and_then(|table| table.map(simulation::hand).transpose());
    let limits = limits.and_then(|table| table.map_or(Ok([None; 3]), limits_of));
    // If the limits could not be read, there may be a torque limit.
    let largest = limits.as_ref().map_or(Some(f64::INFINITY), |[torque, _, full]| torque.or(*full));
    let supply = supplied.and_then(|table| table.map(|it| supply(it, largest)).transpose());
    let host = host.and_then(|table| table.map(host::host).transpose());
    let driven = driven.and_then(|table| table.map(motor).transpose());
    let (name, table, reading, learnt, motor) = (name?, device?, reading?, learnt?, driven?);
    let [torque_limit, encoder_step, full_scale] = limits?;
    let (servo, coupling, environment) = (servo?, coupling?, environment?);
    let (environment, shapes) = match environment {
        EnvironmentTable::Profile(table) => {
            table.within(&top, full_scale)?;
            (table.environment, Some(table.shapes))
        }
        EnvironmentTable::Other(environment) => (*environment, None),
    };
    let DeviceTable { chain, device, friction, cogging, latency } = table;
    let latency = Latency {
        output_delay: servo.latency.output_delay,
        output_jitter: servo.latency.output_jitter,
        count_jitter: servo.latency.count_jitter,
        ..latency
    };
    let timing = servo.timing;
    check_latency(&top, &timing, &latency, environment.is_late())?;
    let mut scene = Scene { device, timing, coupling, environment, latency, torque_limit };
    let (mut encoder_step, mut chip) = (encoder_step, None);
    if let Some(reading) = reading {
        scene = reading.read(&top, scene, friction)?;
        encoder_step = reading.step(&top, encoder_step)?;
        reading.check_chip(&top, &scene, encoder_step, motor.is_some())?;
        chip = reading.chip;
    }
    motor.map_or(Ok(()), |motor| motor.check_phase(&top, encoder_step))?;
    if let Some(learnt) = learnt {
        scene = anticogging::beside(&top, scene, learnt, friction, full_scale)?;
    }
    let (simulation, hand, host, supply) = (simulation?, hand?, host?, supply?);
    let taken = torque_limit.map(|limit| limit + scene.environment.parts().against_cogging());
    host::check(&top, host.as_ref(), [taken, full_scale], simulation.as_ref())?;
    Ok(SceneFile {
        name,
        scene,
        chain,
        simulation,
        hand,
        encoder_step,
        full_scale,
        friction,
        cogging,
        host,
        supply,
        motor,
        shapes,
        chip,
    })
}

/// Whether a file has the table of a device, and no key that a device file has not.
fn is_device_file(root: &Node) -> bool {
    let Value::Table(entries) = &root.value else { return false };
    entries.iter().any(|entry| entry.name == key::DEVICE.name())
        && entries.iter().all(|entry| OF_DEVICE_FILE.iter().any(|key| key.name() == entry.name))
}

/// The file as a whole: it has no name, and must be a table.
const ROOT: Key = Key::root("a table of `name`, [device], [servo] and [environment]");

/// The contents of `[servo]`.
struct Servo {
    timing: Timing,
    /// The times from a count to its torque.
    latency: Latency,
}

fn servo_of(mut section: Section<'_>) -> Read<Servo> {
    let period = section
        .or_reciprocal(&key::PERIOD)
        .and_then(|period| period.ok_or_else(|| section.missing(&key::PERIOD)));
    let worst = section.optional(&key::WORST_PERIOD);
    let output_delay = section.time(&key::OUTPUT_DELAY);
    let jitters = [&key::OUTPUT_JITTER, &key::COUNT_JITTER].map(|key| section.number(key));
    section.finish();
    let [output_jitter, count_jitter] = jitters;
    let (period, worst_period) = (period?, worst?);
    let latency = Latency {
        output_delay: output_delay?,
        output_jitter: output_jitter?,
        count_jitter: count_jitter?,
        ..Latency::NONE
    };
    if worst_period.is_some_and(|worst| worst < period) {
        let reason = format!("is shorter than {} = {period} s", section.stated(&key::PERIOD));
        return Err(section.conflict(&key::WORST_PERIOD, reason));
    }
    Ok(Servo { timing: Timing { period, worst_period }, latency })
}

/// Checks the times between count and torque, each with a bound that depends on other keys.
fn check_latency(top: &Section<'_>, timing: &Timing, latency: &Latency, is_late: bool) -> Read<()> {
    let period = timing.period;
    let within = |(key, time, longest)| top.check_time(key, time, longest, period);
    let output_delay = within((&key::OUTPUT_DELAY, latency.output_delay, LONGEST_DELAY));
    let others = [
        (&key::ACTUATOR_LAG, latency.actuator_lag, LONGEST_LAG),
        (&key::SENSOR_LAG, latency.sensor_lag, LONGEST_LAG),
        (&key::ACTUATOR_RESPONSE, latency.actuator_response, 1.0),
    ];
    let others = all(others.into_iter().map(within));
    let largest = match output_delay {
        Ok(()) => latency.largest_jitter(is_late, period),
        // If the time is too long, any jitter is small enough.
        Err(_) => f64::INFINITY,
    };
    let jitter = (latency.output_jitter > largest).then(|| {
        let reason = format!("is {}", more_than_time_to_torque(top, latency, largest));
        top.conflict(&key::OUTPUT_JITTER, reason)
    });
    output_delay?;
    others?;
    jitter.map_or(Ok(()), Err)?;
    check_count_jitter(top, timing, latency, largest)?;
    updates::check(top, latency, timing)
}

fn more_than_time_to_torque(top: &Section<'_>, latency: &Latency, largest: f64) -> String {
    let least = latency.output_delay.least;
    let period = top.stated(&key::PERIOD);
    let late = if largest > least { format!(" and {period}") } else { String::new() };
    format!(
        "more than the least `{}` = {least} s{late}: no torque comes before its count",
        key::OUTPUT_DELAY.path
    )
}

/// The count jitter beside the output jitter.
fn check_count_jitter(
    top: &Section<'_>,
    timing: &Timing,
    latency: &Latency,
    largest: f64,
) -> Read<()> {
    let sum = latency.total_jitter();
    let beside = match latency.output_jitter {
        0.0 => "is".to_owned(),
        jitter => format!("and `{}` = {jitter} s are together", key::OUTPUT_JITTER.path),
    };
    let reason = match latency.bound_on_two_jitters(timing.period) {
        _ if sum > largest => {
            format!("{beside} {}", more_than_time_to_torque(top, latency, largest))
        }
        _ if !latency.jitters_twice() => return Ok(()),
        None => format!(
            "stands beside `{}` and a lag of which only a range is known, for which there is no proof",
            key::OUTPUT_JITTER.path
        ),
        Some(bound) if sum >= bound => format!(
            "{beside} not below {bound} s, half of what the ranges of delay and response leave of {}",
            top.stated(&key::PERIOD)
        ),
        Some(_) => return Ok(()),
    };
    Err(top.conflict(&key::COUNT_JITTER, reason))
}

/// The `coupling.type` that takes no stiffness.
pub const MATCHED: &str = "matched";

fn coupling_of(mut section: Section<'_>) -> Read<Coupling> {
    let name = section.text(&key::COUPLING_TYPE);
    let stiffness = section.optional(&key::COUPLING_STIFFNESS);
    let coupling = match (name, stiffness) {
        (Err(reported), _) | (_, Err(reported)) => Err(reported),
        (Ok(Some(name)), Ok(stiffness)) if name == MATCHED => match stiffness {
            None => Ok(Coupling::Matched),
            Some(_) => {
                let other = key::COUPLING_TYPE.path;
                let reason =
                    format!("stands beside `{other}` = \"{MATCHED}\", which takes no stiffness");
                Err(section.conflict(&key::COUPLING_STIFFNESS, reason))
            }
        },
        (Ok(Some(name)), _) if name != "spring" => Err(section.out_of_bounds(&key::COUPLING_TYPE)),
        (_, Ok(Some(stiffness))) => Ok(Coupling::Spring { stiffness }),
        (_, Ok(None)) => Err(section.missing(&key::COUPLING_STIFFNESS)),
    };
    section.finish();
    coupling
}

/// Reads `[limits]`: the torque limit, the encoder's step, and the motor's full scale.
pub fn limits_of(mut section: Section<'_>) -> Read<[Option<f64>; 3]> {
    let [torque, full_scale] =
        [&key::TORQUE_LIMIT, &key::FULL_SCALE].map(|key| section.optional(key));
    let encoder = section.or_reciprocal(&key::ENCODER_STEP);
    section.finish();
    Ok([torque?, encoder?, full_scale?])
}

/// The contents of `[environment]`.
enum EnvironmentTable {
    Profile(Box<ProfileTable>),
    Other(Box<Environment>),
}

fn environment_of(mut section: Section<'_>) -> Read<EnvironmentTable> {
    let name = section.needed_text(&key::TYPE);
    let kind =
        name.and_then(|name| Kind::find(&name).ok_or_else(|| section.out_of_bounds(&key::TYPE)));
    let environment = match kind {
        Ok(kind) => {
            section.specialize(format!("a {} [environment]", kind.name), kind.needed);
            match kind.blank.profile() {
                Some(_) => profile::profile(&mut section)
                    .map(|table| EnvironmentTable::Profile(Box::new(table))),
                None => of_kind(kind, &mut section)
                    .map(|other| EnvironmentTable::Other(Box::new(other))),
            }
        }
        Err(reported) => {
            // The intended type is unknown: a key of any type is accepted.
            let keys = key::ALL.iter().filter(|key| key.table() == key::ENVIRONMENT.path);
            keys.for_each(|key| section.skip(key));
            Err(reported)
        }
    };
    section.finish();
    environment
}

fn of_kind(kind: &Kind, section: &mut Section<'_>) -> Read<Environment> {
    if matches!(kind.blank, Environment::Rational(_)) {
        let read = match kind.name {
            kind::SECTIONS => filter::sections(section),
            kind::ZEROS_POLES_GAIN => filter::zeros_poles_gain(section),
            _ => rational(section),
        };
        return read.map(Environment::Rational);
    }
    let numbers = kind.keys().filter_map(|key| Some((key, key.parameter?)));
    let numbers = all(numbers.map(|(key, parameter)| Ok((parameter, section.value(key)?))));
    let one_sided = match kind.keys().any(|key| *key == key::ONE_SIDED) {
        true => section.boolean(&key::ONE_SIDED)?,
        false => None,
    };
    let mut environment = kind.blank;
    for (parameter, value) in numbers? {
        let changed = value.and_then(|value| environment.with(parameter, value));
        environment = changed.unwrap_or(environment);
    }
    if let Some(wall) = environment.wall_mut() {
        wall.side = kind::side(wall.face(), one_sided);
    }
    Ok(environment)
}

fn rational(section: &mut Section<'_>) -> Read<Rational> {
    let numerator = polynomial(section, &key::NUMERATOR, 0);
    let delay = section.whole(&key::DELAY_SAMPLES);
    let room = MAX_DELAY - delay.as_ref().map_or(0, |delay| *delay);
    let denominator = polynomial(section, &key::DENOMINATOR, room);
    let unit_zeros = section.whole(&key::UNIT_ZEROS);
    let ((numerator, _), (denominator, more)) = (numerator?, denominator?);
    let (delay, unit_zeros) = (delay? + more, unit_zeros?);
    if unit_zeros > 0 && numerator.as_slice().len() - 1 + unit_zeros > MAX_DEGREE {
        let reason = format!("makes the numerator's degree more than {MAX_DEGREE}");
        return Err(section.conflict(&key::UNIT_ZEROS, reason));
    }
    Ok(Rational { numerator, denominator, delay, unit_zeros })
}

/// Descending coefficients without leading zeros; a denominator needs a coefficient that is not zero. Also
/// returns the number of zeros, up to `most`, that were removed from its end because the degree was too high.
fn polynomial(section: &mut Section<'_>, key: &Key, most: usize) -> Read<(Coefficients, usize)> {
    let Some(mut value) = section.list(key)? else { return Err(section.missing(key)) };
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
    let coefficients = coefficients.ok_or_else(|| section.out_of_bounds(key))?;
    Ok((coefficients, taken))
}
