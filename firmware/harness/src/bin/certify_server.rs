//! Certifies scenes that the host sends by their bits, on the emulated board: the tests compare its
//! replies with the results of the compiler and of the host, bit for bit. It drives no motor.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    firmware_harness::server::certify::run()
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on the emulated board and is started by the tests.");
}
