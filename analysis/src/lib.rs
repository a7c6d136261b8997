//! Host side of the haptic servo, with the program `haptic` in front ([`command`]).
//!
//! A [`mod@file`] holds a scene, [`verdict`] the certificate's answer; [`simulation`] computes a scene's
//! motion, certified or not. The modules below are in layers: each uses those of its own layer and of the
//! layers under it, and none above it. "Theory" and "equation" are those of `firmware/THEORY.md`.

// The program `haptic`.
pub mod command;

// Output: charts, and pages with charts.
mod chart;
mod explore;

// Measured once and kept: comparisons of methods, formats and models.
pub mod studies;

// Runs of a program's scene in a servo, with a simulated device, a recording or a board around it; and the
// device that such a run measures.
mod bridge_run;
pub mod compare_run;
mod counts_csv;
mod felt_turn;
mod host_run;
pub mod identify;
pub mod program;

// The board, emulated or virtual, its toolchain, and a board without hardware.
pub mod board_sim;
mod bridge_board;
pub mod emulator;
pub mod lockstep;
mod shaft;
pub mod toolchain;
mod virtual_board;

// A board that runs, at the other end of a wire, and the view of it; its client is the package
// `haptic-client`.
pub use haptic_client as link;
pub mod scope;
pub mod serve;

// Verdicts, motions and limits of scenes: all code for them that needs no operating system is in the package
// `haptic-model`.
pub use haptic_model::{
    chain, closed_form, controller, design, device, disturbance, felt, file, hand, latency_limits,
    limits, line_search, missed, nominal_latency, number, nyquist, on_board, open_loop,
    profile_curve, quantity, response, sampled_actuator, simulation, snap_branches, stability,
    stability_map, text_width, trace, unit_circle_poles, verdict, verdict_text, worst_hand,
};

// The same with threads, files and studies.
mod mu_analysis;
mod run_csv;
mod table;

// Numbers and words.
mod progress;
mod terminal;
mod text_table;
mod tick_gaps;

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
