//! Measures torques and sines on the emulated board, with the instructions of each: the table of
//! number formats comes from it. It drives no motor.
#![cfg_attr(target_os = "none", no_std, no_main)]

firmware_harness::server_program!(bench::run::<bench::ProgramScenes>(), "`haptic chart tradeoff`");
