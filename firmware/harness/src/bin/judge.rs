//! Judges scenes that the host sends by their bits, on the emulated board: the tests compare its
//! answers with the compiler's and the host's, bit for bit. It drives nothing.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    firmware_harness::server::judge::run()
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on the emulated board and is started by the tests.");
}
