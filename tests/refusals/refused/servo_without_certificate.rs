//! A servo from an uncertified scene: there is no such constructor.
use haptic_servo::servo::Servo;
use refusals::{SCENE, TRANSDUCERS};

fn main() {
    let _ = Servo::<_, f32>::new(&SCENE, &TRANSDUCERS);
}
