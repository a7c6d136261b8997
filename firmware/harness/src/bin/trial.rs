//! Computes torques and sines in ways that the host chooses, on the emulated board, and says what
//! each takes: the table of formats is measured with it. It drives nothing.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    firmware_harness::server::trial::run::<firmware_harness::server::trial::OfPrograms>()
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on the emulated board and is started by `haptic chart tradeoff`.");
}
