//! A host whose energy is less than the errors of the encoder's counts can cost.
use haptic_servo::host::HostTorque;
use refusals::*;

const HOST: HostTorque =
    HostTorque { energy: 1e-5, power: 0.0, damping: 0.001, torque: 0.5, timeout: 0.05 };

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    host: HOST,
    transducers: TRANSDUCERS,
}
