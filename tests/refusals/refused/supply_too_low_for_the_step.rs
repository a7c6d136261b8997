//! A supply with which the current could not be what the certificate says.
use firmware::current::{CurrentLoop, Drive, Supply};
use refusals::{DRIVE, SMALL_MOTOR, STAGE};

const TIRED: Drive = Drive { supply: Supply { lowest: 15.0, highest: 26.0 }, ..DRIVE };

const CURRENT: CurrentLoop = CurrentLoop::checked(&TIRED, &STAGE, &SMALL_MOTOR, 1e-3);

fn main() {
    let _ = CURRENT;
}
