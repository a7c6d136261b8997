//! The tests of the search, in one program, so that it links once.
//! `cargo test -p adversary --test all NAME::` runs those of one file.

mod device;
mod host;
mod periodic_motion;
mod planted;
mod refuted_scenes;
mod search;
mod teeth;

/// Scenes of a search: of all planted faults, the rarest shows in the 4155th scene.
const SCENES: u64 = 5000;

/// Scenes of a search that takes some seconds.
const FEW: u64 = 500;
