//! Runs the servo of scenes that the host sends by their bits, on the emulated board, after certifying
//! each. The tests close the loop around it.
#![cfg_attr(target_os = "none", no_std, no_main)]

firmware_harness::server_program!(servo::run(), "the tests");
