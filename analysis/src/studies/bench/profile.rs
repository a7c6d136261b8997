//! The cost of a verdict on a torque profile of 64 knots, on this machine and on the emulated board.

use std::path::Path;

use firmware_harness::tables::MAGNET;
use haptic_servo::environment::{Ends, Profile};
use haptic_servo::scene::Scene;

use crate::emulator::{CertifyClient, EmulatorError};
use crate::program::knob;

/// Such profiles: gentle and too steep, late by one to three samples, with ends and without.
pub fn scenes() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for torque in [0.02, 0.2, 20.0] {
        for delay in 1..=3 {
            for ends in [None, Some(Ends { from: -2.0, to: 2.0, stiffness: 12.0 })] {
                let profile = Profile { torque, ends, ..Profile::of(&MAGNET, delay) };
                scenes.push(Scene { environment: profile.alone(), ..knob::SCENE });
            }
        }
    }
    scenes
}

/// Largest number of instructions of a verdict on them on the emulated board, and of the whole assessment
/// with remedies.
///
/// # Errors
/// If the emulated board fails.
pub fn verdict_instructions(elf: &Path) -> Result<[u64; 2], EmulatorError> {
    let mut board = CertifyClient::boot(elf)?;
    let mut most = [0; 2];
    for scene in scenes() {
        let reply = board.certify(&scene)?;
        let found = [reply.verdict_instructions, reply.instructions];
        most = std::array::from_fn(|i| most[i].max(found[i]));
    }
    board.finish()?;
    Ok(most)
}
