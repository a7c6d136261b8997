//! A file of a device, or the device of a scene's file.

use haptic_servo::scene::TimeRange;

use super::device::{DeviceTable, Purpose, device};
use super::faults::{Faults, Read};
use super::key::{self, Key};
use super::problem::{Fault, Problem};
use super::scene;
use super::section::{Found, Section};
use super::tree::{Node, Span};
use crate::chain::Chain;

/// A file that describes a device.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceFile {
    /// Name of the device, or of the scene that contains it.
    pub name: Option<String>,
    /// The device behind its amplifier; for a lag that lies in a range, with the middle of it.
    pub chain: Chain,
}

/// A file of a device is a table, like that of a scene.
const ROOT: Key = Key::root("a table of [device] and perhaps `name`");

/// Reads a device file, or the device of a scene file, which is checked as a whole.
pub fn read(source: (&str, &Faults), root: Node) -> Read<DeviceFile> {
    let mut top = Section::new(source, "a device's file", &ROOT, root.clone())?;
    if [key::SERVO, key::ENVIRONMENT].iter().any(|key| top.has(key)) {
        let scene = scene::read(source, root, Purpose::Simulate)?;
        let lag = scene.scene.latency.actuator_lag;
        let chain = lagging(source.1, scene.chain, lag, 0..0)?;
        return Ok(DeviceFile { name: Some(scene.name), chain });
    }
    let name = top.text(&key::NAME);
    let table = top.needed_table(&key::DEVICE);
    top.finish();
    let DeviceTable { chain, actuator_lag, .. } =
        table.and_then(|table| device(table, Purpose::Simulate))?;
    let chain = match actuator_lag {
        Some(Found { value, span }) => lagging(source.1, chain, value, span)?,
        None => chain,
    };
    Ok(DeviceFile { name: name?.map(|found| found.value), chain })
}

/// The chain behind its amplifier. Every lag that was read is valid for it.
fn lagging(faults: &Faults, chain: Chain, lag: TimeRange, span: Span) -> Read<Chain> {
    chain.with_actuator_lag(lag.middle()).map_err(|error| {
        let (key, value) = (key::ACTUATOR_LAG.path.to_owned(), lag.middle().to_string());
        let problem = Problem::Conflict { key, value, reason: error.to_string() };
        faults.report(Fault { span, problem })
    })
}
