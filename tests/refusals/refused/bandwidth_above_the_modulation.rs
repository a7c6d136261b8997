//! A current that is to follow faster than its loop is updated.

use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive};
use refusals::{DRIVE, MOTORISED};

const CHANGED: Drive = Drive { bandwidth: 4000.0, ..DRIVE };

const _: CurrentLoop = CurrentLoop::checked(&CHANGED, &B_G431B_ESC1, &MOTORISED, 0.001);

fn main() {}
