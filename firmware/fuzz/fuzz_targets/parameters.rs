#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../bodies/parameters.rs"]
mod parameters;

fuzz_target!(|data: &[u8]| parameters::run(data));
