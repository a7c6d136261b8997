//! What is flashed, on both virtual boards: that it starts as it should, renders what the host
//! renders, and stops when it must.

mod assembly;
mod at_rest;
mod bench;
mod bridge;
mod contact;
mod corpus;
mod device;
mod faults;
mod harmless;
mod interrupts;
mod own_board;
mod phase;
mod reset;
mod scenes;
mod start;
mod stub;
mod supervised;
mod sweep;
mod timing;
