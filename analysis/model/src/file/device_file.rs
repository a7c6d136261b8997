//! A file of a device, or the device of a scene's file.

use haptic_servo::magnetic::Chip;
use haptic_servo::scene::{Device, EncoderReading, TimeRange};

use super::anticogging::anticogging;
use super::device::{Purpose, device};
use super::encoder::encoder;
use super::faults::{Faults, Read};
use super::key::{self, Key};
use super::problem::{Fault, Problem};
use super::scene;
use super::section::Section;
use super::supply::supply;
use super::transducers::StatedTransducers;
use super::tree::Node;
use crate::chain::Chain;
use crate::disturbance::Disturbance;

/// A file that describes a device.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceFile {
    /// Name of the device, or of the scene that contains it.
    pub name: Option<String>,
    /// The device behind its amplifier; for a lag that lies in a range, with the middle of it.
    pub chain: Chain,
    /// The rigid body that stands for it in a certificate.
    pub device: Device,
    /// Its encoder and its motor.
    pub transducers: StatedTransducers,
    /// Friction and cogging of the motor.
    pub disturbance: Disturbance,
    /// The readings of the encoder.
    pub reading: EncoderReading,
    /// The chip of its magnetic encoder, which a board reads.
    pub chip: Option<&'static Chip>,
    /// Time constant of the filter between encoder and servo.
    pub sensor_lag: TimeRange,
}

/// A file of a device is a table, like that of a scene.
const ROOT: Key = Key::root(
    "a table of [device], and perhaps `name`, [encoder], [anticogging], [limits], [supply] and [motor]",
);

/// Reads a device file, or the device of a scene file, which is checked as a whole.
pub fn read(source: (&str, &Faults), root: Node) -> Read<DeviceFile> {
    let mut top = Section::new(source, "a device's file", &ROOT, root.clone())?;
    if [key::SERVO, key::ENVIRONMENT].iter().any(|key| top.has(key)) {
        let scene = scene::read(source, root, Purpose::Simulate)?;
        let chain = lagging(source.1, scene.chain.clone(), scene.scene.latency.actuator_lag)?;
        let (transducers, chip) = (scene.stated(None, None), scene.chip);
        let (disturbance, latency) = (scene.disturbance(), &scene.scene.latency);
        return Ok(DeviceFile {
            name: Some(scene.name),
            chain,
            device: scene.scene.device,
            transducers,
            disturbance,
            reading: *latency.encoder,
            chip,
            sensor_lag: latency.sensor_lag,
        });
    }
    let name = top.text(&key::NAME);
    let table = top.needed_table(&key::DEVICE);
    let [reading, learnt, limits, supplied, motor] =
        [&key::READING, &key::ANTICOGGING, &key::LIMITS, &key::SUPPLY, &key::MOTOR]
            .map(|key| top.table(key));
    top.finish();
    let limits = limits.and_then(|table| table.map_or(Ok([None; 3]), scene::limits_of));
    // The torque limit may be that of a scene.
    let supply =
        supplied.and_then(|table| table.map(|it| supply(it, Some(f64::INFINITY))).transpose())?;
    let [torque_limit, limits_step, full_scale] = limits?;
    if let (Some(limit), Some(full_scale)) = (torque_limit, full_scale)
        && limit > full_scale
    {
        let reason = format!("is above `{}` = {full_scale} N m", key::FULL_SCALE.path);
        return Err(top.conflict(&key::TORQUE_LIMIT, reason));
    }
    let reading = reading.and_then(|table| table.map(encoder).transpose())?;
    let encoder_step = match &reading {
        Some(reading) => reading.step(&top, limits_step)?,
        None => limits_step,
    };
    learnt.and_then(|table| table.map(anticogging).transpose())?;
    let motor = motor.and_then(|table| table.map(super::motor::motor).transpose())?;
    motor.map_or(Ok(()), |motor| motor.check_phase(&top, encoder_step))?;
    let table = table.and_then(|table| device(table, Purpose::Simulate))?;
    let chain = lagging(source.1, table.chain, table.latency.actuator_lag)?;
    let transducers = StatedTransducers { encoder_step, full_scale, torque_limit, supply };
    let friction = table.friction.unwrap_or(0.0);
    let of_encoder = reading.as_ref().map_or(TimeRange::ZERO, |reading| reading.lag);
    Ok(DeviceFile {
        name: name?,
        chain,
        device: table.device,
        transducers,
        disturbance: Disturbance { friction, cogging: table.cogging.unwrap_or_default() },
        reading: reading.as_ref().map_or(EncoderReading::IDEAL, |reading| reading.reading),
        chip: reading.and_then(|reading| reading.chip),
        sensor_lag: table.latency.sensor_lag.followed_by(of_encoder),
    })
}

/// The chain behind its amplifier. Every lag that was read is valid for it.
fn lagging(faults: &Faults, chain: Chain, lag: TimeRange) -> Read<Chain> {
    let key = &key::ACTUATOR_LAG;
    chain.with_actuator_lag(lag.middle()).map_err(|error| {
        let problem = Problem::value(key.path, &lag.middle().to_string(), error);
        faults.report(Fault { span: faults.place(key.path).unwrap_or_default(), problem })
    })
}
