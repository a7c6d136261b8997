//! Drives with numbers that no motor and no supply has.

use haptic_servo::current::{
    B_G431B_ESC1, CurrentLoop, Drive, Motor, Regeneration, Supply, Winding,
};
use refusals::{DRIVE, MOTORISED};

const MOTOR: Motor = Motor { winding: Winding::Brushless { pole_pairs: 0 }, ..DRIVE.motor };
const _: CurrentLoop =
    CurrentLoop::checked(&Drive { motor: MOTOR, ..DRIVE }, &B_G431B_ESC1, &MOTORISED, 0.001);

const SUPPLY: Supply = Supply {
    regeneration: Regeneration::Stores { voltage: 24.0, capacitance: 0.0 },
    ..DRIVE.supply
};
const _: CurrentLoop =
    CurrentLoop::checked(&Drive { supply: SUPPLY, ..DRIVE }, &B_G431B_ESC1, &MOTORISED, 0.001);

fn main() {}
