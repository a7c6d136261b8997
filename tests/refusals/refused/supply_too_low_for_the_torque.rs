//! A supply that has not the voltage for full torque at the largest speed.

use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, Supply};
use refusals::{DRIVE, MOTORISED};

const CHANGED: Drive = Drive { supply: Supply::sinking(12.0, 25.2), ..DRIVE };

const _: CurrentLoop = CurrentLoop::checked(&CHANGED, &B_G431B_ESC1, &MOTORISED, 0.001);

fn main() {}
