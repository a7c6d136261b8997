//! A torque profile with snap points.

use super::Profile;
use super::knots::{Cell, Knots};
use super::law::ProfileLaw;
use super::layout::{Layout, SnapPoint};
use super::snap::Snap;
use crate::build_error::BuildError;
use crate::environment::delay_line::FixedDelay;
use crate::environment::law::{Discretize, LawContext};
use crate::environment::velocity::NoDamping;
use crate::number::Number;
use crate::parameter::{NamedParameters, Parameter};

/// A [`Profile`] whose detents hold the knob up to a snap point: see [`Shape::snap`](super::Shape::snap).
///
/// It certifies with at most one sample of delay, behind a coupling.
///
/// ```
/// use haptic_servo::environment::{Knots, Shape, SnapProfile};
/// use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
///
/// static KNOTS: Knots<16> = Knots::of(&[Shape::detents(24, 0.05).snap(1.1)]);
/// const SCENE: Scene<SnapProfile<16, 1>> = Scene {
///     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
///     timing: Timing { period: 0.001, worst_period: None },
///     coupling: Coupling::Spring { stiffness: 44.0 },
///     environment: SnapProfile::of(&KNOTS),
///     latency: Latency::NONE,
///     torque_limit: Some(1.0),
/// };
/// assert!(SCENE.certify().is_ok());
/// ```
///
/// A [`Profile`] has no snap point:
///
/// ```compile_fail
/// use haptic_servo::environment::{Knots, Profile, Shape};
///
/// static KNOTS: Knots<16> = Knots::of(&[Shape::detents(24, 0.05).snap(1.1)]);
/// const PROFILE: Profile<16, 1> = Profile::of(&KNOTS);
/// assert_eq!(PROFILE.count, 24.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnapProfile<const KNOTS: usize, const DELAY: usize> {
    /// The table.
    pub profile: Profile<KNOTS, DELAY>,
    /// The detents that are added to the table, in proportion to it.
    pub snap: SnapPoint,
}

impl<const KNOTS: usize, const DELAY: usize> SnapProfile<KNOTS, DELAY> {
    /// The profile of a table, with the numbers of its shapes.
    ///
    /// # Panics
    /// If none of its shapes has a snap point; in a constant this is a compile error.
    #[track_caller]
    pub const fn of(knots: &'static Knots<KNOTS>) -> Self {
        match knots.layout().snap {
            Some(snap) => Self { profile: Profile::without_snap(knots), snap },
            None => panic!("no detents have a snap point: use `Profile::of`"),
        }
    }

    const fn layout(&self) -> Layout {
        Layout { snap: Some(self.snap), ..self.profile.layout() }
    }
}

impl<const KNOTS: usize, const DELAY: usize> NamedParameters for SnapProfile<KNOTS, DELAY> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        self.profile.value(parameter)
    }
}

impl<N: Number, const KNOTS: usize, const DELAY: usize> Discretize<N>
    for SnapProfile<KNOTS, DELAY>
{
    type Law = ProfileLaw<N, &'static [Cell; KNOTS], NoDamping, FixedDelay<N, DELAY>, Snap<N>>;

    fn law(&self, _: &LawContext) -> Result<Self::Law, BuildError> {
        let Profile { knots, .. } = self.profile;
        let (layout, outline) = (self.layout(), knots.outline());
        let snap = |origin| Snap::new(&self.snap, &layout, outline.knots, origin);
        ProfileLaw::new(knots.cells(), &outline, &layout, NoDamping, FixedDelay::at_rest(), snap)
    }
}
