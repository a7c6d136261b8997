//! Measures the torques of any scene in any number format on the emulated board, with the instructions
//! of each tick: `bench_programs` does so for the scenes that have a program. It drives no motor.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    firmware_harness::server::bench::run::<firmware_harness::server::bench::AllScenes>()
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on the emulated board and is started by `haptic chart tradeoff`.");
}
