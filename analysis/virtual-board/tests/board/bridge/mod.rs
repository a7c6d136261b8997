//! The flashed programs for a motor at the board's own bridge.

mod arming;
mod bench;
mod brushless;
mod faults;
mod gates;
mod hosted;
mod identify;
mod index;
mod load;
mod magnetic;
mod paddle;
mod regeneration;
mod same;
mod wall;

// Programs of their own, of which these use the numbers.
#[allow(dead_code)]
#[path = "../../../../../firmware/src/bin/bridge_identify.rs"]
mod bridge_identify;
#[allow(dead_code)]
#[path = "../../../../../firmware/src/bin/bridge_wall.rs"]
mod bridge_wall;
#[allow(dead_code)]
#[path = "../../../../../firmware/src/bin/brushless_identify.rs"]
mod brushless_identify;
#[allow(dead_code)]
#[path = "../../../../../firmware/src/bin/brushless_index.rs"]
mod brushless_index;
#[allow(dead_code)]
#[path = "../../../../../firmware/src/bin/brushless_wall.rs"]
mod brushless_wall;
