//! Scenes that the tests ask about.

/// The paper's device with a wall behind the standard coupling.
pub const WALL: &str = r#"{ "name": "wall", "device": { "inertia": 2.2e-5, "damping": 0.022 },
    "servo": { "period": 0.001 }, "coupling": { "stiffness": 44.0 },
    "environment": { "type": "damper-wall", "stiffness": 22.0, "damping": 0.01, "delay": 1 } }"#;

/// One whose torque is late and lags.
pub const LATE_WALL: &str = r#"{ "name": "late wall",
    "device": { "inertia": 2.2e-5, "damping": 0.022, "actuator_lag": 0.0005 },
    "servo": { "period": 0.001, "output_delay": 0.0003 }, "coupling": { "stiffness": 15.0 },
    "environment": { "type": "damper-wall", "stiffness": 6.0, "damping": 0.002, "delay": 0 } }"#;

/// Most of the device's damping taken away.
pub const FREE_MODE: &str = r#"{ "name": "free", "device": { "inertia": 2.2e-5, "damping": 0.022 },
    "servo": { "period": 0.001 },
    "environment": { "type": "free-mode", "residual": 0.012, "delay": 1 } }"#;

/// Detents behind the standard coupling.
pub const PROFILE: &str = r#"{ "name": "knob", "device": { "inertia": 2.2e-5, "damping": 0.022 },
    "servo": { "period": 0.001 }, "coupling": { "stiffness": 44.0 },
    "environment": { "type": "profile", "delay": 1,
        "shape": [{ "type": "detents", "count": 24, "torque": 0.05 }] } }"#;
