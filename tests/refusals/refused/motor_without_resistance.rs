//! A motor without resistance.

use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, Motor};
use refusals::{DRIVE, MOTORISED};

const CHANGED: Drive = Drive { motor: Motor { resistance: 0.0, ..DRIVE.motor }, ..DRIVE };

const _: CurrentLoop = CurrentLoop::checked(&CHANGED, &B_G431B_ESC1, &MOTORISED, 0.001);

fn main() {}
