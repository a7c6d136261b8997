//! A program for a board that is not in the firmware. On the host it prints the certificate of its scene.
//!
//! - `board.rs` is the servo's interface to the board, and its interrupts.
//! - `chip.rs` sets up the chip, and `serial.rs` is its port to the host.
//! - `scene.rs` is the scene, which is independent of the board.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod chip;
pub mod scene;
#[cfg(target_os = "none")]
mod serial;

#[cfg(not(target_os = "none"))]
fn main() {
    use haptic_servo::board::report::Report;
    use haptic_servo::certificate::Resolution;

    let resolution = Resolution::of(&scene::PROGRAM.transducers, None);
    print!("{}", Report::new(&scene::CERTIFIED, &resolution, scene::PROGRAM.rendering.injection));
}
