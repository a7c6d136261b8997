//! The tests of the whole, in one program: it links once, and while some of them wait for a compiler or
//! an emulator others compute. `cargo test -p tests --test all NAME::` runs those of one file.

mod actuator_response;
mod bits;
mod boards;
mod closed_forms;
mod composed;
mod contact;
mod continuous;
mod decision;
mod documents;
mod emulated;
mod every_float;
mod exact;
mod failures;
mod foreign;
mod interval;
mod knob_modes;
mod lagging;
mod latency;
mod live;
mod margin;
mod matched;
mod misses;
mod own_environment;
mod profile_failures;
mod profiles;
mod random;
mod reference;
mod remedies;
mod sampled;
mod simulated;
mod snaps;
mod soundness;
mod vectors;
mod virtual_board;
mod worst_hand;
