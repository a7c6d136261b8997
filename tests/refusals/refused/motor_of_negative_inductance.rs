//! An inductance below zero.

use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, Motor};
use refusals::{DRIVE, MOTORISED};

const CHANGED: Drive = Drive { motor: Motor { inductance: -0.12e-3, ..DRIVE.motor }, ..DRIVE };

const _: CurrentLoop = CurrentLoop::checked(&CHANGED, &B_G431B_ESC1, &MOTORISED, 0.001);

fn main() {}
