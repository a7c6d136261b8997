//! A servo from an uncertified scene: there is no such constructor.
use firmware::environment::DelayedSpring;
use firmware::servo::Servo;
use refusals::{SCENE, TRANSDUCERS};

fn main() {
    let _ = Servo::<DelayedSpring<1>, f32>::new(&SCENE, &TRANSDUCERS);
}
