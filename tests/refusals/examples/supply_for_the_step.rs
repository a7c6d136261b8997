//! The same drive with its own supply.
use firmware::current::CurrentLoop;
use refusals::{DRIVE, SMALL_MOTOR, STAGE};

const CURRENT: CurrentLoop = CurrentLoop::checked(&DRIVE, &STAGE, &SMALL_MOTOR, 1e-3);

fn main() {
    assert_eq!(CURRENT.updates(), 40);
}
