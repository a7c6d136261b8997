//! Searches for energy that a certified scene gives away.
//!
//! The firmware's own servo loop runs against an exactly simulated device in a passive hand: any hand of
//! up to three masses, any angle to arm at, updates missed and codes late, sets swapped, torques and counts
//! that jitter in patterns, amplifiers and sensors that lag, encoders that err, read late and drop readings.
//! Scenes that no board renders run with the servo alone; where these are linear, the energy of periodic motions
//! is computed as well. Wrong rules are planted, too, and the same search has to find what they let pass. What the
//! certificate claims is an energy: device and hand never have more than they started with, and what little the
//! assumptions allow. A search looks for a run in which they do.

// Only where there is an operating system, as in `analysis`.
#![cfg(not(target_os = "none"))]

pub mod device;
pub mod hardware;
pub mod mode;
pub mod norm;
pub mod normalized_scene;
pub mod periodic_motion;
pub mod plan;
pub mod planted;
pub mod profiles;
pub mod run;
pub mod scenes;
pub mod search;
pub mod timing;
