//! A scene of several modes: each of them is judged, so that none is refused when it is selected.

use super::certify_in;
use super::margin::Limited;
use super::rejection::Rejection;
use super::timed::{TimingError, agree};
use crate::environment::ModeSelection;
use crate::number::Format;
use crate::output_timing::OutputTiming;
use crate::parameter::Parameter;
use crate::scene::Scene;
use crate::text::Sentence;

/// A mode of a scene that cannot be had, though another one is selected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefusedMode<R> {
    /// Its number, from 0.
    pub mode: usize,
    /// Its name.
    pub name: &'static str,
    /// Why not.
    pub reason: R,
}

impl<R: Copy> RefusedMode<R> {
    /// The mode in words, and then why it cannot be had.
    const fn sentence_of(&self, reason: &Sentence) -> Sentence {
        let mut t = Sentence::new();
        t.push("mode ");
        t.push_number(self.mode as f64);
        t.push(", `");
        t.push(self.name);
        t.push("`: ");
        t.push(reason.as_str());
        t
    }
}

impl RefusedMode<Rejection> {
    /// The rejection as a sentence that names the mode.
    pub const fn sentence_in(&self, format: Format) -> Sentence {
        self.sentence_of(&self.reason.sentence_in(format))
    }
}

impl RefusedMode<TimingError> {
    /// The error as a sentence that names the mode.
    pub const fn sentence(&self) -> Sentence {
        self.sentence_of(&self.reason.sentence())
    }
}

/// The first mode of a scene with which it is not certified in a number format. `None`: each of them is, or
/// the scene has no others to select.
pub const fn first_refused_mode(scene: &Scene, format: Format) -> Option<RefusedMode<Rejection>> {
    let mut mode = 0;
    while let Some((name, selecting)) = nth(scene, mode) {
        if let Err(reason) = certify_in(&selecting, format) {
            return Some(RefusedMode { mode, name, reason });
        }
        mode += 1;
    }
    None
}

/// The limits of a certified scene's modes on a board: of all modes those that leave the least damping to be
/// injected, since any of them may be selected. `None` where there are no others to select.
///
/// # Errors
/// The first mode that a board cannot render so.
pub(super) const fn tightest_mode(
    scene: &Scene,
    format: Format,
    timing: OutputTiming,
) -> Result<Option<Limited>, RefusedMode<TimingError>> {
    let mut tightest: Option<Limited> = None;
    let mut mode = 0;
    while let Some((name, selecting)) = nth(scene, mode) {
        if let Ok(assessment) = certify_in(&selecting, format) {
            let limited = match agree(timing, &selecting, &assessment) {
                Ok(limited) => limited,
                Err(reason) => return Err(RefusedMode { mode, name, reason }),
            };
            let is_tighter = match &tightest {
                Some(other) => limited.injectable_damping() < other.injectable_damping(),
                None => true,
            };
            tightest = if is_tighter { Some(limited) } else { tightest };
        }
        mode += 1;
    }
    Ok(tightest)
}

/// The name of a mode of a scene, and the scene with that one selected.
const fn nth(scene: &Scene, mode: usize) -> Option<(&'static str, Scene)> {
    let Some(modes) = modes(scene) else { return None };
    if mode >= modes.modes().len() {
        return None;
    }
    match scene.with(Parameter::Mode, mode as f64) {
        Some(selecting) => Some((modes.modes()[mode].name, selecting)),
        None => None,
    }
}

const fn modes(scene: &Scene) -> Option<&ModeSelection> {
    match scene.environment.profile() {
        Some(profile) => profile.modes.as_ref(),
        None => None,
    }
}
