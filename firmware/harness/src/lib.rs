//! Requests of tests and measurements to the [`haptic_servo`] on the emulated board, and the servers there.
//!
//! A host sends a scene to the board: to certify it ([`scene_codec`]), or to measure the instructions of its
//! torques ([`bench_request`]) and of sines ([`sines`]). On the board a `server` answers. No program that drives
//! a motor needs any of this.
#![cfg_attr(not(test), no_std)]

pub mod bench_request;
pub mod currents;
pub mod rotations;
pub mod scene_codec;
pub mod sines;
pub mod tables;

#[cfg(all(target_os = "none", feature = "emulated"))]
pub mod server;

/// The program of a server. On the host it tells which program of the host starts it.
#[macro_export]
macro_rules! server_program {
    ($run:expr, $starter:literal) => {
        #[cfg(target_os = "none")]
        #[cortex_m_rt::entry]
        fn main() -> ! {
            use firmware_harness::server::*;
            $run
        }

        #[cfg(not(target_os = "none"))]
        fn main() {
            println!(concat!(
                "This program runs on the emulated board and is started by ",
                $starter,
                "."
            ));
        }
    };
}
