//! Judges every mode of a scene, so that no mode is refused when it is selected.

use super::certify_in;
use super::margin::Limited;
use super::rejection::Rejection;
use super::timed::{TimingError, agree};
use crate::environment::ModeSelection;
use crate::number::Format;
use crate::output_timing::OutputTiming;
use crate::parameter::Parameter;
use crate::scene::Scene;
use crate::text::{Sentence, push};

/// A refused mode of a scene, which is not the selected one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefusedMode<R> {
    /// Its number, from 0.
    pub mode: usize,
    /// Its name.
    pub name: &'static str,
    /// The reason.
    pub reason: R,
}

impl<R: Copy> RefusedMode<R> {
    const fn sentence_of(&self, reason: &Sentence) -> Sentence {
        let mut t = Sentence::new();
        push!(t, "mode " {self.mode} ", `" {self.name} "`: " {reason.as_str()});
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

/// The first mode with which a scene is not certified in a number format. `None`: all modes are certified, or
/// the scene has no other modes.
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

/// The limits of a certified scene's modes on a board, the tightest of each kind, because any mode may be
/// selected; or the first mode that a board cannot render. `None` if there are no other modes.
pub(super) const fn tightest_mode(
    scene: &Scene,
    format: Format,
    timing: OutputTiming,
) -> Result<Option<Limited>, RefusedMode<TimingError>> {
    let mut tightest: Option<Limited> = None;
    let mut mode = 0;
    while let Some((name, selecting)) = nth(scene, mode) {
        if certify_in(&selecting, format).is_ok() {
            let limited = match agree(timing, &selecting, format) {
                Ok(limited) => limited,
                Err(reason) => return Err(RefusedMode { mode, name, reason }),
            };
            tightest = Some(match tightest {
                Some(other) => limited.tighter(&other),
                None => limited,
            });
        }
        mode += 1;
    }
    Ok(tightest)
}

/// The name of a mode of a scene, and the scene with this mode selected.
const fn nth(scene: &Scene, mode: usize) -> Option<(&'static str, Scene)> {
    let Some(modes) = modes(scene) else { return None };
    if mode >= modes.modes().len() {
        return None;
    }
    let selecting = some!(scene.with(Parameter::Mode, mode as f64));
    Some((modes.modes()[mode].name(), selecting))
}

const fn modes(scene: &Scene) -> Option<&ModeSelection> {
    let profile = some!(scene.environment.profile());
    profile.modes.as_ref()
}
