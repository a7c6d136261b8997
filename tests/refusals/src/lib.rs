//! What the programs have in common, and passes: a device, its transducers and a scene. A program in
//! `refused` changes what it must not compile for; the test is in `tests`. Each sees another way past the
//! certificate that is open. Which numbers pass is a matter of unit tests.

use haptic_servo::certificate::Certified;
use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, Motor, Supply, Winding};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Latency, Scene};
use haptic_servo::servo::Transducers;
use haptic_servo::servo_loop::READ_WITHIN;

/// An environment behind the paper's device and the standard coupling, and no torque limit.
pub const fn scene<E: Copy>(environment: E) -> Scene<E> {
    Scene {
        coupling: Coupling::Spring { stiffness: 44.0 },
        ..Scene::of(Device::damped(2.2e-5, 0.022), 0.001, environment)
    }
}

/// A wall that is not late, behind the coupling that absorbs this output delay in s.
pub const fn at_phase(output_delay: f64) -> Scene {
    let latency = Latency { output_jitter: READ_WITHIN, ..Latency::delayed(output_delay) };
    Scene { coupling: Coupling::Matched, latency, ..scene(Wall::damped(2.0, 0.002, 0).alone()) }
}

/// A spring that boards can render.
pub const SCENE: Scene = Scene { torque_limit: Some(1.0), ..scene(Wall::spring(14.0, 1).alone()) };

/// Its certificate.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

/// Sensor and motor.
pub const TRANSDUCERS: Transducers =
    Transducers { counter: CounterWidth::Bits16, ..Transducers::of(61_440.0, 2.0) };

/// Sensor and motor of a board with a bridge.
pub const MOTORISED: Transducers =
    Transducers { full_scale_torque: 1.0, largest_speed: 25.0, ..TRANSDUCERS };

/// A motor that such a board can drive, and its supply.
pub const DRIVE: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushed,
        resistance: 0.6,
        inductance: 0.12e-3,
        torque_constant: 0.29,
    },
    supply: Supply::sinking(23.5, 25.2),
    bandwidth: 2000.0,
    largest_temperature: 80.0,
};

/// Its current loop.
pub const CURRENT_LOOP: CurrentLoop =
    CurrentLoop::checked(&DRIVE, &B_G431B_ESC1, &MOTORISED, 0.001);
