//! What the programs have in common, and passes: a device, its transducers and a scene. A program in
//! `refused` changes what it must not compile for, its neighbour in `examples` what compiles; the test is
//! in `tests`.

use firmware::certificate::Certified;
use firmware::current::{Drive, Motor, PowerStage, Supply, Thermistor, Winding};
use firmware::encoder::CounterWidth;
use firmware::environment::{DamperWall, DelayedSpring, Matched};
use firmware::scene::{Coupling, Device, Latency, Scene, Timing};
use firmware::servo::Transducers;
use firmware::servo_loop::READ_WITHIN;

/// An environment behind the paper's device and the standard coupling, and no torque limit.
pub const fn scene<E: Copy>(environment: E) -> Scene<E> {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 0.001, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment,
        latency: Latency::NONE,
        torque_limit: None,
    }
}

/// A wall that is not late, behind the coupling that absorbs an output delay.
pub type UndelayedWall = Matched<DamperWall<0>>;

/// Such a wall in a scene with this output delay in s.
pub const fn at_phase(output_delay: f64) -> Scene<UndelayedWall> {
    let wall = Matched { environment: DamperWall { stiffness: 2.0, damping: 0.002 } };
    let latency = Latency { output_jitter: READ_WITHIN, ..Latency::delayed(output_delay) };
    Scene { coupling: Coupling::Matched, latency, ..scene(wall) }
}

/// A spring that boards can render.
pub const SCENE: Scene<DelayedSpring<1>> =
    Scene { torque_limit: Some(1.0), ..scene(DelayedSpring { stiffness: 14.0 }) };

/// Its certificate.
pub const CERTIFIED: Certified<Scene<DelayedSpring<1>>> = SCENE.certified();

/// Sensor and motor.
pub const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 2.0,
    largest_speed: 100.0,
};

/// A brushed motor.
pub const DRIVE: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushed,
        resistance: 0.6,
        inductance: 0.3e-3,
        torque_constant: 0.05,
    },
    supply: Supply { lowest: 22.0, highest: 26.0 },
    bandwidth: 1000.0,
    largest_temperature: 90.0,
};

/// Its sensor, and its torque.
pub const SMALL_MOTOR: Transducers = Transducers { full_scale_torque: 0.2, ..TRANSDUCERS };

/// A power stage.
pub const STAGE: PowerStage = PowerStage {
    clock: 170e6,
    amps_per_count: 0.03,
    current_lowers_count: true,
    volts_per_count: 0.0084,
    largest_current: 40.0,
    offset_counts: (1900, 2300),
    supply: Supply { lowest: 10.0, highest: 34.0 },
    dead_time: 0.2e-6,
    shortest_low: 1.5e-6,
    thermistor: Thermistor { resistance: 10e3, beta: 3380.0, to_ground: 4.7e3 },
};
