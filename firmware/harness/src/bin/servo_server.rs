//! Runs the servo of scenes that the host sends by their bits, on the emulated board, after certifying
//! each. The tests close the loop around it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    firmware_harness::server::servo::run()
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on the emulated board and is started by the tests.");
}
