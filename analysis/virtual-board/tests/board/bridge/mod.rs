//! What is flashed where the board's own bridge drives the motor.

mod arming;
mod bench;
mod faults;
mod gates;
mod paddle;
mod same;
mod wall;

// A program of its own, of which this uses the numbers.
#[allow(dead_code)]
#[path = "../../../../../firmware/src/bin/bridge_wall.rs"]
mod bridge_wall;
