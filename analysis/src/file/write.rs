//! A [`Scene`] written as the file that reads back as the same scene, to the last bit.

use std::fmt::Write;

use firmware::environment::{Coefficients, Environment, Wall};
use firmware::scene::{Coupling, Scene};

/// The text of a scene file in TOML.
pub fn toml(name: &str, scene: &Scene) -> String {
    let mut lines = vec![format!("name = {}", quoted(name)), "[device]".to_owned()];
    let mut number = |key: &str, value: f64| lines.push(format!("{key} = {value:?}"));
    number("inertia", scene.device.inertia);
    number("damping", scene.device.damping);
    if let Some(passivity) = scene.device.passivity {
        number("passivity", passivity);
    }
    lines.push("[servo]".to_owned());
    lines.push(format!("period = {:?}", scene.timing.period));
    if let Some(worst) = scene.timing.worst_period {
        lines.push(format!("worst_period = {worst:?}"));
    }
    if let Coupling::Spring { stiffness } = scene.coupling {
        lines.push(format!("[coupling]\nstiffness = {stiffness:?}"));
    }
    lines.push("[environment]".to_owned());
    environment(&mut lines, &scene.environment);
    if let Some(limit) = scene.torque_limit {
        lines.push(format!("[limits]\ntorque = {limit:?}"));
    }
    lines.join("\n") + "\n"
}

fn environment(lines: &mut Vec<String>, environment: &Environment) {
    let kind = match environment {
        // A spring with a face is a wall without damping to the reader of a file.
        Environment::DelayedSpring(wall) if !wall.one_sided && wall.face == 0.0 => "delayed-spring",
        Environment::DelayedSpring(_) | Environment::DamperWall(_) => "damper-wall",
        Environment::FreeMode { .. } => "free-mode",
        Environment::FreeModeWall { .. } => "free-mode-wall",
        Environment::Rational(_) => "rational",
    };
    lines.push(format!("type = \"{kind}\""));
    match environment {
        Environment::DelayedSpring(spring) => {
            wall(lines, &Wall { damping: 0.0, filter: None, ..*spring }, kind == "damper-wall");
        }
        Environment::DamperWall(with_damper) => wall(lines, with_damper, true),
        Environment::FreeMode { residual, delay } => {
            lines.push(format!("residual = {residual:?}\ndelay = {delay}"));
        }
        Environment::FreeModeWall { residual, wall: behind } => {
            lines.push(format!("residual = {residual:?}"));
            wall(lines, behind, true);
        }
        Environment::Rational(rational) => {
            lines.push(format!("numerator = {}", list(&rational.numerator)));
            lines.push(format!("denominator = {}", list(&rational.denominator)));
            lines.push(format!("delay = {}\nunit_zeros = {}", rational.delay, rational.unit_zeros));
        }
    }
}

fn wall(lines: &mut Vec<String>, wall: &Wall, is_wall: bool) {
    lines.push(format!("stiffness = {:?}", wall.stiffness));
    if is_wall {
        lines.push(format!("damping = {:?}", wall.damping));
    }
    lines.push(format!("delay = {}", wall.delay));
    if let Some(pole) = wall.filter {
        lines.push(format!("filter = {pole:?}"));
    }
    if wall.face != 0.0 {
        lines.push(format!("face = {:?}", wall.face));
    }
    if wall.one_sided {
        lines.push("one_sided = true".to_owned());
    }
}

fn list(coefficients: &Coefficients) -> String {
    let mut text = String::from("[");
    for (index, coefficient) in coefficients.as_slice().iter().enumerate() {
        let apart = if index == 0 { "" } else { ", " };
        // Writing to a string does not fail.
        let _ = write!(text, "{apart}{coefficient:?}");
    }
    text + "]"
}

/// A string as TOML's basic strings have it, which is as JSON has it.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::{Format, parse};

    #[test]
    fn what_is_written_reads_back_as_the_same_scene() {
        let head = "name = \"a \\\"b\\\"\"\n[device]\ninertia = 2.2e-5\ndamping = 0.1\n\
                    passivity = 0.07\n[servo]\nperiod = 0.001\nworst_period = 0.003\n";
        for rest in [
            "[coupling]\nstiffness = 44\n[environment]\ntype = \"delayed-spring\"\n\
             stiffness = 0.1\ndelay = 3\n[limits]\ntorque = 0.7\n",
            "[environment]\ntype = \"damper-wall\"\nstiffness = 1e-30\ndamping = -0.3\ndelay = 0\n\
             filter = 0.3\nface = -0.2\none_sided = true\n",
            "[environment]\ntype = \"free-mode\"\nresidual = 0.001\ndelay = 1\n",
            "[environment]\ntype = \"free-mode-wall\"\nresidual = 0.001\nstiffness = 3\n\
             damping = 0.2\ndelay = 1\n",
            "[environment]\ntype = \"rational\"\nnumerator = [1, -0.3]\n\
             denominator = [1, 0.1, 0.7]\ndelay = 2\nunit_zeros = 1\n",
        ] {
            let first = parse("a.toml", Format::Toml, &format!("{head}{rest}")).unwrap();
            let text = toml(&first.name, &first.scene);
            let second = parse("b.toml", Format::Toml, &text).unwrap();
            assert_eq!((first.name, first.scene), (second.name, second.scene), "{text}");
        }
    }
}
