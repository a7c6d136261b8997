//! Certifies scenes that the host sends by their bits, on the emulated board: the tests compare its
//! replies with the results of the compiler and of the host, bit for bit. It drives no motor.
#![cfg_attr(target_os = "none", no_std, no_main)]

firmware_harness::server_program!(certify::run(), "the tests");
