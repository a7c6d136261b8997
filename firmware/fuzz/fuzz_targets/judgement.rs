#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../bodies/judgement.rs"]
mod judgement;

fuzz_target!(|data: &[u8]| judgement::run(data));
