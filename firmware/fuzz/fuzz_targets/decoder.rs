#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../bodies/decoder.rs"]
mod decoder;

fuzz_target!(|data: &[u8]| decoder::run(data));
