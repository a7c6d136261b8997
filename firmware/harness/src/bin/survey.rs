//! Computes the torques of any scene in any number format, on the emulated board, and says what each
//! tick takes: what `trial` does for the scenes that have a program. It drives nothing.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    firmware_harness::server::trial::run::<firmware_harness::server::trial::Every>()
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on the emulated board and is started by `haptic chart tradeoff`.");
}
