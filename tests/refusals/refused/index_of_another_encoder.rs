//! A phase at the index that is beyond an electrical turn of the motor's encoder.

use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, EncoderIndex, IndexOffset, Motor, Winding};
use refusals::{DRIVE, MOTORISED};

const BRUSHLESS: Drive = Drive {
    motor: Motor { winding: Winding::Brushless { pole_pairs: 7 }, ..DRIVE.motor },
    bandwidth: 1000.0,
    ..DRIVE
};

const OFFSET: IndexOffset = IndexOffset { counts: 20_000, is_reversed: false };

const _: CurrentLoop = CurrentLoop::checked(&BRUSHLESS, &B_G431B_ESC1, &MOTORISED, 0.001)
    .with_index(EncoderIndex { offset: Some(OFFSET) });

fn main() {}
