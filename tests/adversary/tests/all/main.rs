//! The tests of the search, in one program, so that it links once.
//! `cargo test -p adversary --test all NAME::` runs those of one file.

mod device;
mod periodic_motion;
mod planted;
mod search;
mod teeth;
