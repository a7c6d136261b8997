//! What a magnetic encoder costs: of a verdict, and of a tick on its board.

use std::convert::Infallible;

use haptic_servo::certificate::is_static_at_port;
use haptic_servo::environment::Wall;
use haptic_servo::magnetic::{AS5048A, Chip, MA702, MT6701, MT6835, Transfers};
use haptic_servo::scene::{Coupling, EncoderReading, Scene, TimeRange, Timing};

use super::figure::{Pair, seconds};
use super::{judge, on_target};
use crate::file::{FileError, Format, SceneFile, parse};
use crate::program::damper_wall;

/// The reading of an MT6701, as docs/encoders.md states it.
const READING: EncoderReading = EncoderReading {
    age: TimeRange::between(0.0, 1e-5),
    linearity: 0.035,
    noise: 2.0,
    // That of any endless profile here.
    friction: 100.0,
    ..EncoderReading::IDEAL
};
/// The same of which one in a row may fail, for laws of one position.
const DROPPING: EncoderReading = EncoderReading { dropped: 1, ..READING };

/// One chip of each driver, and its noise in counts: that of docs/encoders.md or less, as a reading without a step costs
/// more than another.
pub const CHIPS: [(&Chip, u32); 4] = [(&MT6701, 2), (&MA702, 2), (&MT6835, 10), (&AS5048A, 2)];

/// A wall that a board reads by a chip with this noise in counts.
pub fn wall(chip: &Chip, noise: u32) -> Result<SceneFile, FileError> {
    const WALL: &str = include_str!("../../../virtual-board/tests/board/magnetic_wall.toml");
    const PERIOD: f64 = 1e-3;
    let TimeRange { least, most } = chip.age_in(&Transfers::at_count(chip, PERIOD));
    let (name, lag) = (chip.name, chip.lag.most);
    let mut text = WALL.to_owned();
    for (line, chip_s) in [
        ("chip = \"mt6701\"", format!("chip = \"{name}\"\nlag = {lag}")),
        ("age = [0.0, 1.0e-5]", format!("age = [{least}, {most}]")),
        ("noise = 2", format!("noise = {noise}")),
        // An AS504x is a period late already.
        ("dropped = 1", "dropped = 0".to_owned()),
    ] {
        text = text.replace(line, &chip_s);
    }
    parse("magnetic_wall.toml", Format::Toml, &text)
}

/// Scenes of devices that people build with such an encoder: springs and one-sided walls without a coupling and
/// behind one, and torque profiles.
fn scenes() -> Vec<Scene> {
    let mut scenes = on_target::profiles();
    for period in [1e-3, 1e-4] {
        for stiffness in [2.0, 10.0, 40.0] {
            let wall = Wall::spring(stiffness, 1);
            let environments = [wall, wall.behind(0.0), Wall::damped(stiffness, 0.002, 1)];
            scenes.extend(environments.map(|environment| Scene {
                environment: environment.alone(),
                timing: Timing { period, worst_period: None },
                coupling: Coupling::Rigid,
                ..damper_wall::SCENE
            }));
        }
    }
    scenes
}

/// Times in us of a verdict on these scenes with `[encoder]`, and without.
pub fn verdicts(rounds: usize) -> Pair {
    let plain = scenes();
    let read: Vec<_> = plain
        .iter()
        .map(|scene| {
            let reading = if is_static_at_port(scene) { &DROPPING } else { &READING };
            Scene { latency: scene.latency.read_by(reading), ..*scene }
        })
        .collect();
    let time = |scenes: &[Scene]| {
        Ok::<_, Infallible>(seconds(|| judge(scenes)) * 1e6 / scenes.len() as f64)
    };
    let Ok(pair) = Pair::in_turns(rounds, || time(&read), || time(&plain));
    pair
}
