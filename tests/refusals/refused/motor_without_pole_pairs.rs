//! A brushless motor without magnets.

use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, Motor, Winding};
use refusals::{DRIVE, MOTORISED};

const CHANGED: Drive = Drive { motor: Motor { winding: Winding::Brushless { pole_pairs: 0 }, ..DRIVE.motor }, ..DRIVE };

const _: CurrentLoop = CurrentLoop::checked(&CHANGED, &B_G431B_ESC1, &MOTORISED, 0.001);

fn main() {}
