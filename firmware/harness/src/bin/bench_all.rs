//! Measures the torques of any scene in any number format on the emulated board, with the instructions
//! of each tick: `bench_programs` does so for the scenes that have a program. It drives no motor.
#![cfg_attr(target_os = "none", no_std, no_main)]

firmware_harness::server_program!(bench::run::<bench::AllScenes>(), "`haptic chart tradeoff`");
