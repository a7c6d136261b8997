//! Several torque profiles, one of which is selected.

use super::any::AnyProfile;
use super::law::ProfileLaw;
use super::mode_table::ProfileMode;
use super::selection::ModeSelection;
use super::snap::AnySnap;
use crate::build_error::BuildError;
use crate::environment::delay_line::FixedDelay;
use crate::environment::law::{Discretize, LawContext};
use crate::environment::velocity::NoDamping;
use crate::number::Number;
use crate::parameter::named_parameters;

/// Several torque profiles, one of which is rendered, delayed by whole samples: a knob with modes that are
/// selected while it runs.
///
/// Its scene is certified with each of its modes, so with the compiled numbers no mode is refused later.
/// Another mode is swapped in like any other change
/// ([`servo_loop::longest_gap`](crate::servo_loop::longest_gap)). Each swap restarts the count of turns: a
/// mode with end stops starts in the turn in which the knob is nearest to its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileModes<const DELAY: usize> {
    modes: &'static [ProfileMode],
    /// Number of the selected mode, from 0.
    pub mode: f64,
}

impl<const DELAY: usize> ProfileModes<DELAY> {
    /// These modes, with the first selected.
    ///
    /// # Panics
    /// If there is none; in a constant this is a compile error.
    #[track_caller]
    pub const fn of(modes: &'static [ProfileMode]) -> Self {
        assert!(!modes.is_empty(), "there is no mode to select");
        Self { modes, mode: 0.0 }
    }

    /// The same with another mode selected.
    pub const fn selecting(self, mode: f64) -> Self {
        Self { mode, ..self }
    }

    /// All modes.
    pub const fn modes(&self) -> &'static [ProfileMode] {
        self.modes
    }

    /// The selected profile as data. If no mode has the number, it is the first profile with this number,
    /// which the certificate refuses.
    pub const fn as_any(&self) -> AnyProfile {
        let selection = ModeSelection::of(self.modes, self.mode);
        match AnyProfile::selected(selection, DELAY) {
            Some(profile) => profile,
            None => AnyProfile::of_mode(&self.modes[0], selection, DELAY),
        }
    }
}

named_parameters! {
    [const DELAY: usize] ProfileModes<DELAY>: Mode => mode;
}

/// The law of any mode: its table is read through a reference, so that all have one type.
type ModeLaw<N, const DELAY: usize> =
    ProfileLaw<N, &'static [i16], NoDamping, FixedDelay<N, DELAY>, AnySnap<N>>;

impl<N: Number, const DELAY: usize> Discretize<N> for ProfileModes<DELAY> {
    type Law = ModeLaw<N, DELAY>;

    fn law(&self, _: &LawContext) -> Result<Self::Law, BuildError> {
        // A number format that cannot represent one of the modes is refused for the program, so that no mode
        // is refused later.
        let selection = ModeSelection::of(self.modes, self.mode);
        for mode in self.modes {
            law::<N, DELAY>(&AnyProfile::of_mode(mode, selection, DELAY))?;
        }
        law(&self.as_any())
    }
}

/// The law of a mode.
fn law<N: Number, const DELAY: usize>(
    profile: &AnyProfile,
) -> Result<ModeLaw<N, DELAY>, BuildError> {
    let (outline, layout) = (profile.outline(), profile.layout());
    let (delay, snap) = (FixedDelay::at_rest(), |origin| profile.snap_law(origin));
    let law = ProfileLaw::new(profile.units(), &outline, &layout, NoDamping, delay, snap)?;
    Ok(law.counting_turns_anew(&layout))
}

#[cfg(test)]
mod tests;
