//! The tests of the program `haptic` and of its library, in one program: it links once, and while some of
//! them wait for a compiler or an emulator others compute. `cargo test -p analysis --test all NAME::` runs
//! those of one file.

mod bench;
mod charts;
mod closed_loop;
mod common;
mod composed;
mod device_files;
mod filters;
mod haptic;
#[cfg(unix)]
mod identify_port;
mod identify_target;
mod knob_modes;
mod own_scene;
mod pictures;
mod profiles;
mod python_client;
mod readme;
mod reference;
mod scene_files;
mod serve;
mod set_up;
mod simulate_program;
mod simulation_reference;
mod snaps;
mod terminal;
mod virtual_board;
mod wire;
mod wire_target;
