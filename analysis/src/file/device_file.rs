//! A file of a device, or the device of a scene's file.

use super::device::{Purpose, device};
use super::faults::{Faults, Read};
use super::key::{self, Key};
use super::scene;
use super::section::Section;
use super::tree::Node;
use crate::chain::Chain;

/// A file that describes a device.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceFile {
    /// What the person calls it, or the scene that it is part of.
    pub name: Option<String>,
    /// The device.
    pub chain: Chain,
}

/// A file of a device is a table, like that of a scene.
const ROOT: Key = Key::root("a table of [device] and perhaps `name`");

/// Reads a device file, or the device of a scene file, which is checked as a whole.
pub fn read(source: (&str, &Faults), root: Node) -> Read<DeviceFile> {
    let mut top = Section::new(source, "a device's file", &ROOT, root.clone())?;
    if [key::SERVO, key::ENVIRONMENT].iter().any(|key| top.has(key)) {
        let scene = scene::read(source, root, Purpose::Simulate)?;
        return Ok(DeviceFile { name: Some(scene.name), chain: scene.chain });
    }
    let name = top.text(&key::NAME);
    let table = top.needed_table(&key::DEVICE);
    top.finish();
    let (chain, ..) = table.and_then(|table| device(table, Purpose::Simulate))?;
    Ok(DeviceFile { name: name?.map(|found| found.value), chain })
}
