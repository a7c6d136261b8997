//! Scene files, what the certificate says about them, and what they would do: the mathematics of the host,
//! without an operating system, so that a browser and a notebook have the same.
//!
//! A [`mod@file`] holds a scene, [`verdict`] the certificate's answer; [`simulation`] computes a scene's
//! motion, certified or not. The modules below are in layers: each uses those of its own layer and of the
//! layers under it, and none above it. "Theory" and "equation" are those of `firmware/THEORY.md`.

// A board that runs, in words and units.
pub mod board;

// What scenes are worth and would do, and how far one may go.
pub mod closed_form;
pub mod design;
pub mod latency_limits;
pub mod limits;
pub mod nyquist;
pub mod open_loop;
pub mod profile_curve;
pub mod remedy_change;
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
pub mod controller;
pub mod device;
pub mod file;
pub mod hand;
pub mod missed;
pub mod nominal_latency;
pub mod sampled_actuator;

// Numbers and words.
pub mod line_search;
pub mod number;
pub mod quantity;
pub mod text_width;
