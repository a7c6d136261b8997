#![doc = include_str!("../README.md")]
//!
//! # Modules
//!
//! | what | begin with |
//! |---|---|
//! | a scene in TOML or JSON | [`file::parse`], [`file::load`] |
//! | is it certified, and by how much | [`verdict::judge`], [`verdict_text`] |
//! | what the hand feels | [`felt`] |
//! | how it moves | [`simulation::simulate`] |
//! | how far one may go | [`design`], [`limits`], [`stability_map`] |
//! | its curves | [`response`], [`nyquist`], [`stability`] |
//! | the hand that takes most energy out | [`worst_hand`] |
//!
//! The modules below are in layers: each uses those of its own layer and of the layers under it, and none
//! above it. "Theory" and "equation" are those of `THEORY.md` in the package [`haptic_servo`].
//!
//! # Features
//!
//! None is on by default. `clap` gives quantities and methods names on a command line.
//!
//! # Stability
//!
//! Versions follow semantic versioning; before 1.0 a minor version may break the interface. The keys of scene
//! files and of reports in JSON keep their meaning; new keys may come. [`haptic_servo`], whose version is
//! that of this package, states how certificates may change from version to version. Exempt are the texts of
//! errors and reports. The minimum supported Rust version is 1.95; a minor version may raise it.

// A running board, in words and units.
pub mod board;

// Verdicts, simulations and limits of scenes.
mod beside_host;
pub mod closed_form;
pub mod design;
pub mod felt;
pub mod host;
pub mod latency_limits;
pub mod limits;
pub mod nyquist;
pub mod on_board;
pub mod open_loop;
pub mod profile_curve;
pub mod regeneration;
pub mod remedy_change;
pub mod remedy_search;
pub mod response;
pub mod simulation;
pub mod snap_branches;
pub mod stability;
pub mod stability_map;
pub mod trace;
pub mod unit_circle_poles;
pub mod verdict;
pub mod verdict_text;
pub mod worst_hand;

// Input: a scene, its device, its hand and its servo.
pub mod chain;
pub mod chip_on_board;
pub mod controller;
pub mod device;
pub mod disturbance;
pub mod file;
pub mod hand;
pub mod missed;
pub mod nominal_latency;
pub mod nonlinear_encoder;
pub mod sampled_actuator;

// Numbers and words.
pub mod line_search;
pub mod number;
pub mod quantity;
pub mod text_width;

#[cfg(test)]
mod fixture;
