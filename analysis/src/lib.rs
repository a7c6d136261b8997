//! Host side of the haptic servo, with the program `haptic` in front ([`command`]).
//!
//! A [`mod@file`] holds a scene, [`verdict`] the certificate's answer, [`batch`] both for many scenes;
//! [`simulation`] computes a scene's motion, certified or not. The modules below are in layers: each uses
//! those of its own layer and of the layers under it, and none above it. "Theory" and "equation" are those
//! of `firmware/THEORY.md`.

// The program `haptic`.
pub mod command;

// Output: charts, and pages with charts.
pub mod chart;
pub mod report;

// Measured once and kept: comparisons of methods, formats and models.
pub mod studies;

// What runs: a program's scene in a servo, with a simulated device, a recording or a board around
// it; and the device that was measured so.
pub mod compare_run;
pub mod counts_csv;
pub mod felt_turn;
pub mod identify;
pub mod program;

// The board, emulated or virtual, what builds for it, and a board without hardware.
pub mod board_sim;
pub mod emulator;
pub mod lockstep;
pub mod toolchain;
pub mod virtual_board;

// A board that runs, at the other end of a wire, and the view of it.
pub mod link;
pub mod scope;

// What scenes are worth and would do, and how far one may go.
pub mod batch;
pub mod closed_form;
pub mod design;
pub mod latency_limits;
pub mod limits;
pub mod mu_analysis;
pub mod open_loop;
pub mod profile_curve;
pub mod response;
pub mod run_csv;
pub mod simulation;
pub mod snap_branches;
pub mod stability;
pub mod stability_map;
pub mod trace;
pub mod unit_circle_poles;
pub mod verdict;
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
pub mod table;

// Numbers and words.
pub mod date;
pub mod line_search;
pub mod number;
pub mod progress;
pub mod quantity;
pub mod terminal;
pub mod text_table;

/// The scene file of the guide to certifying a wall, as this library reads it.
///
/// ```
/// use analysis::file::{Format, parse};
///
/// let guide = include_str!("../../docs/certify.md");
/// let (_, marked) = guide.split_once("<!-- file -->").expect("a marked block");
/// let lines = marked.lines().skip(2).take_while(|line| !line.starts_with('`'));
/// let text: String = lines.map(|line| format!("{line}\n")).collect();
/// let file = parse("wall.toml", Format::Toml, &text)?;
/// assert_eq!(file.name, "delayed wall");
/// assert!(file.scene.certify().is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[cfg(doctest)]
pub mod guide {}
