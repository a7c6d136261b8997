//! Judges a scene that is a text, with its remedies, and simulates it from a deflection.

use std::error::Error;
use std::path::Path;

use haptic_model::file::{self, Format};
use haptic_model::simulation::{Experiment, Integration, simulate};
use haptic_model::verdict;
use haptic_model::verdict_text;

/// A wall with twice the damping that the device can render.
const SCENE: &str = r#"
name = "wall"
device = { inertia = 2.2e-5, damping = 0.022 }
servo = { period = 0.001 }
coupling = { stiffness = 44.0 }
environment = { type = "damper-wall", stiffness = 22.0, damping = 0.023, delay = 1 }
simulation = { samples = 20, position = 0.001 }
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let file = file::parse("wall.toml", Format::Toml, SCENE)?;
    let report = verdict::judge(&file.name, &file.scene);
    print!("{}", verdict_text::text(&report));
    let experiment = Experiment::of(&file, Path::new("."))?;
    let motion = simulate(&experiment, Integration::default())?;
    let largest = motion.position.iter().fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
    println!("from 0.001 rad, in 20 ms: {largest:.3} rad at most");
    Ok(())
}
