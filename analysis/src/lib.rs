//! Host side of the haptic servo, with the program `haptic` in front ([`command`]).
//!
//! A [`mod@file`] says what is asked, [`verdict`] what the certificate answers, [`batch`] both for
//! many scenes. The other modules are in groups by what they are about, with a line above each group. "Theory" and "equation" are those
//! of `firmware/THEORY.md`.

pub mod command;

pub mod file;

pub mod batch;
pub mod verdict;

// The device: a chain of masses, its passivity as the certificate and as the paper see it, and
// the identification of a real one.
pub mod chain;
pub mod identify;
pub mod mu;

// What runs: a program's scene in a servo, with a simulated device or a recording around it.
pub mod arithmetic;
pub mod controller;
pub mod device;
pub mod hand;
pub mod program;
pub mod recorded;
pub mod replay;
pub mod rig;
pub mod scenario;
pub mod table;

// The board, emulated or virtual, what builds for it, and what was built.
pub mod anatomy;
pub mod emulator;
pub mod toolchain;
pub mod virtual_board;

// A board that runs, at the other end of a wire, and the view of it.
pub mod link;
pub mod listing;
pub mod scope;
pub mod twin;

// What scenes would do, certified or not, and how far one may go.
pub mod closed_form;
pub mod design;
pub mod failures;
pub mod limits;
pub mod map;
pub mod model;
pub mod open_loop;
pub mod response;
pub mod simulation;
pub mod stability;
pub mod worst_hand;

// What is shown and measured.
pub mod bench;
pub mod chart;
pub mod circle;
pub mod date;
pub mod minimum;
pub mod number;
pub mod progress;
pub mod quantity;
pub mod report;
pub mod terminal;
pub mod tradeoff;

/// The scene file of the README, as this library reads it.
///
/// ```
/// use analysis::file::{Format, parse};
///
/// let readme = include_str!("../../README.md");
/// let (_, marked) = readme.split_once("<!-- file -->").expect("a marked block");
/// let lines = marked.lines().skip(2).take_while(|line| !line.starts_with('`'));
/// let text: String = lines.map(|line| format!("{line}\n")).collect();
/// let file = parse("wall.toml", Format::Toml, &text)?;
/// assert_eq!(file.name, "delayed wall");
/// assert!(file.scene.certify().is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[cfg(doctest)]
pub mod readme {}
