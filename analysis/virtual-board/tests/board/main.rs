//! The flashed programs on both virtual boards: they start as they should, render the host's codes, and stop
//! when they must.

mod assembly;
mod at_rest;
mod bench;
mod bridge;
mod contact;
mod device;
mod faults;
mod harmless;
mod hosted;
mod interrupts;
mod magnetic;
mod own_board;
mod phase;
mod provoked;
mod reset;
mod scenes;
mod start;
mod stub;
mod supervised;
mod sweep;
mod timing;
