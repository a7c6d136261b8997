//! Searches for energy that a certified scene gives away.
//!
//! The firmware's own servo loop runs against an exactly simulated device in a passive hand: any hand of
//! up to three masses, any angle to arm at, updates missed and codes late, sets swapped, torques and counts
//! that jitter in patterns, amplifiers and sensors that lag. Scenes that no board renders run with the servo
//! alone; where these are linear, the energy of periodic motions is computed as well. Wrong rules are planted, too, and the same search has to find what they let pass. What the
//! certificate claims is an energy: device and hand never have more than they started with, and
//! what little the assumptions allow. A search looks for a run in which they do.

#[cfg(not(target_os = "none"))]
pub mod coverage;
#[cfg(not(target_os = "none"))]
pub mod device;
#[cfg(not(target_os = "none"))]
pub mod hardware;
#[cfg(not(target_os = "none"))]
pub mod mode;
#[cfg(not(target_os = "none"))]
pub mod norm;
#[cfg(not(target_os = "none"))]
pub mod normalized_scene;
#[cfg(not(target_os = "none"))]
pub mod periodic_motion;
#[cfg(not(target_os = "none"))]
pub mod plan;
#[cfg(not(target_os = "none"))]
pub mod planted;
#[cfg(not(target_os = "none"))]
pub mod profiles;
#[cfg(not(target_os = "none"))]
pub mod refuted_scenes;
#[cfg(not(target_os = "none"))]
pub mod report;
#[cfg(not(target_os = "none"))]
pub mod run;
#[cfg(not(target_os = "none"))]
pub mod scenes;
#[cfg(not(target_os = "none"))]
pub mod search;
#[cfg(not(target_os = "none"))]
pub mod timing;
