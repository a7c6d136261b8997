//! The neighbour of `supply_too_low_for_the_torque`: a supply that has the voltage.

use haptic_servo::current::{B_G431B_ESC1, CurrentLoop};
use refusals::{DRIVE, MOTORISED};

const _: CurrentLoop = CurrentLoop::checked(&DRIVE, &B_G431B_ESC1, &MOTORISED, 0.001);

fn main() {}
