//! The scenes of the page's measurements.

use serde_json::{Value, json};

/// A page to open, drag and draw.
#[derive(Clone, Copy, Debug)]
pub struct PageScene {
    /// Its name in the table.
    pub name: &'static str,
    /// The scene as a file in TOML.
    pub toml: &'static str,
    /// The key whose slider is dragged.
    pub dragged: &'static str,
}

/// A wall, the start of a page without a scene; free mode, whose map has other parameters; and a wall with
/// everything that makes a verdict slow: two lags, a range of latency, and a filter.
pub const SHOWN: [PageScene; 3] = [
    PageScene {
        name: "wall",
        toml: include_str!("../../../../pictures/wall.toml"),
        dragged: "environment.stiffness",
    },
    PageScene {
        name: "free mode",
        toml: "name = \"free mode\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n[servo]\n\
               period = 0.001\n[coupling]\nstiffness = 44.0\n[environment]\ntype = \"free-mode\"\n\
               residual = 0.001\ndelay = 1\n",
        dragged: "environment.residual",
    },
    PageScene {
        name: "wall behind lags and a range of latency",
        toml: "name = \"late wall\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n\
               actuator_lag = 5.0e-5\nsensor_lag = 2.0e-5\n[servo]\nperiod = 0.001\n\
               output_delay = [1.0e-5, 6.0e-5]\n[coupling]\nstiffness = 30.0\n[environment]\n\
               type = \"damper-wall\"\nstiffness = 12.0\ndamping = 0.005\nfilter = 0.1\ndelay = 1\n",
        dragged: "environment.stiffness",
    },
];

/// Scenes as JSON to compare the time of a verdict here and in a page: walls, springs, free mode, profiles,
/// with and without latency, certified and not.
pub fn judged() -> Vec<Value> {
    let mut scenes = Vec::new();
    for stiffness in [2.0, 12.0, 22.0, 60.0] {
        let environments = [
            json!({ "type": "delayed-spring", "stiffness": stiffness, "delay": 1 }),
            json!({ "type": "damper-wall", "stiffness": stiffness, "damping": 0.005, "delay": 2 }),
            json!({
                "type": "damper-wall", "stiffness": stiffness, "damping": 0.005, "delay": 1,
                "filter": 0.1, "one_sided": true
            }),
            json!({
                "type": "free-mode-wall", "residual": 0.004, "stiffness": stiffness, "damping": 0.005,
                "delay": 1
            }),
            json!({
                "type": "profile", "delay": 1,
                "shape": [{ "type": "detents", "count": 24, "torque": 0.005 * stiffness }]
            }),
        ];
        for environment in environments {
            scenes.push(json!({
                "name": "at once",
                "device": { "inertia": 2.2e-5, "damping": 0.022 },
                "servo": { "period": 0.001 },
                "coupling": { "stiffness": 44.0 },
                "environment": environment,
            }));
            scenes.push(json!({
                "name": "late",
                "device": { "inertia": 2.2e-5, "damping": 0.022, "actuator_lag": 5.3e-5 },
                "servo": { "period": 0.001, "output_delay": 1e-5 },
                "coupling": { "stiffness": 30.0 },
                "environment": environment,
            }));
        }
    }
    scenes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::{Format, parse};

    #[test]
    fn scenes_are_certified_and_rejected() {
        let judged: Vec<bool> = judged()
            .iter()
            .map(|scene| parse("scene", Format::Json, &scene.to_string()).unwrap())
            .map(|file| file.scene.certify().is_ok())
            .collect();
        let certified = judged.iter().filter(|is_certified| **is_certified).count();
        assert!(certified > 8 && certified + 8 < judged.len(), "{certified} of {}", judged.len());
        for shown in SHOWN {
            let file = parse("scene", Format::Toml, shown.toml).unwrap();
            assert!(file.scene.certify().is_ok(), "{}", shown.name);
        }
    }
}
