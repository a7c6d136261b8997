//! What is flashed where the board's own bridge drives the motor.

mod arming;
mod bench;
mod brushless;
mod faults;
mod gates;
mod paddle;
mod same;
mod wall;

// Programs of their own, of which these use the numbers.
#[allow(dead_code)]
#[path = "../../../../../firmware/src/bin/bridge_wall.rs"]
mod bridge_wall;
#[allow(dead_code)]
#[path = "../../../../../firmware/src/bin/brushless_wall.rs"]
mod brushless_wall;
