//! A supply that takes nothing back and has no capacitance.

use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, Regeneration, Supply};
use refusals::{DRIVE, MOTORISED};

const SUPPLY: Supply = Supply {
    regeneration: Regeneration::Stores { voltage: 24.0, capacitance: 0.0 },
    ..DRIVE.supply
};

const CHANGED: Drive = Drive { supply: SUPPLY, ..DRIVE };

const _: CurrentLoop = CurrentLoop::checked(&CHANGED, &B_G431B_ESC1, &MOTORISED, 0.001);

fn main() {}
