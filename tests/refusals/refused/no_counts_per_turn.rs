//! An encoder that counts nothing.
use firmware::environment::DelayedSpring;
use firmware::servo::Transducers;
use refusals::*;

const TRANSDUCERS: Transducers = Transducers { counts_per_turn: 0.0, ..refusals::TRANSDUCERS };

firmware::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
}
