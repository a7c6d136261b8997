//! The tests of the program `haptic` and of its library, in one program: it links once, and while some of
//! them wait for a compiler or an emulator others compute. `cargo test -p analysis --test all NAME::` runs
//! those of one file.

mod bench;
mod cases;
mod closed_loop;
mod common;
mod haptic;
#[cfg(unix)]
mod identify_port;
mod identify_target;
mod knob_modes;
mod own_scene;
mod pictures;
mod profiles;
mod readme;
mod reference;
mod refused;
mod scene_files;
mod serve;
mod sessions;
mod set_up;
mod simulation_reference;
mod terminal;
mod virtual_board;
mod wire;
mod wire_target;
