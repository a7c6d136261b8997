//! From a [`Scene`] to a [`Certified`] scene, or to a [`Rejection`] that says why not.

use crate::environment::*;
use crate::passivity::interval::Interval;
use crate::scene::Scene;

/// A scene that passed; there is no other way to make one than `certify`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certified<S> {
    scene: S,
    assessment: Assessment,
}

impl<S> Certified<S> {
    /// The scene that was certified.
    pub const fn scene(&self) -> &S {
        &self.scene
    }
    /// The numbers that the certificate rests on.
    pub const fn assessment(&self) -> &Assessment {
        &self.assessment
    }
}

/// Answer of one rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Proved.
    Pass,
    /// Disproved.
    Fail,
    /// Neither; never means yes.
    Undecided,
}

/// Everything that is known about a scene after judging it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessment {
    /// Index `alpha` of the environment alone, in N m s/rad; `None` where it does not exist.
    pub alpha: Option<Interval>,
    /// Index of `E'`, the environment that behind the standard coupling gives the same controller.
    pub alpha_coupled: Option<Interval>,
    /// Nonlinear bound on `alpha` for one-sided or limited scenes.
    pub bound: Option<Interval>,
    /// The device's passivity, scaled to the worst period.
    pub delta: Interval,
    /// Cosine of the angle at which the deciding index is reached, where it is known.
    pub cos_theta: Option<Interval>,
    /// Equations 17 to 19.
    pub paper: Answer,
    /// Theory, section 4.1.
    pub exact: Answer,
    /// The verdict: `Ok` is `certified`.
    pub outcome: Result<(), Rejection>,
}

/// Why a scene was not certified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rejection {
    /// Placeholder until the rules are in.
    Undecided,
}

/// Judges a scene.
pub const fn assess(scene: &Scene) -> Assessment {
    let delta = match scene.device.passivity {
        Some(d) => d,
        None => scene.device.damping,
    };
    Assessment {
        alpha: None,
        alpha_coupled: None,
        bound: None,
        delta: Interval { lo: delta, hi: delta },
        cos_theta: None,
        paper: Answer::Undecided,
        exact: Answer::Undecided,
        outcome: Ok(()),
    }
}

macro_rules! certify_for {
    ($([$($generics:tt)*] $environment:ty => |$e:ident| $data:expr;)*) => {$(
        impl<$($generics)*> Scene<$environment> {
            /// Judges the scene; only a scene that is proved passive becomes `Certified`.
            pub const fn certify(self) -> Result<Certified<Self>, Rejection> {
                let $e = self.environment;
                let data = Scene {
                    device: self.device,
                    timing: self.timing,
                    coupling: self.coupling,
                    environment: $data,
                    torque_limit: self.torque_limit,
                };
                let assessment = assess(&data);
                match assessment.outcome {
                    Ok(()) => Ok(Certified { scene: self, assessment }),
                    Err(rejection) => Err(rejection),
                }
            }

            /// For constants: the certified scene, or a compile error that says why not.
            pub const fn certified(self) -> Certified<Self> {
                match self.certify() {
                    Ok(certified) => certified,
                    Err(_) => panic!("rejected"),
                }
            }
        }
    )*};
}

certify_for! {
    [const N: usize] DelayedSpring<N> => |e| Environment::DelayedSpring(Wall { stiffness: e.stiffness, damping: 0.0, filter: None, delay: N, face: 0.0, one_sided: false });
    [const N: usize] DamperWall<N> => |e| Environment::DamperWall(Wall { stiffness: e.stiffness, damping: e.damping, filter: None, delay: N, face: 0.0, one_sided: false });
    [const N: usize] OneSided<DamperWall<N>> => |e| Environment::DamperWall(Wall { stiffness: e.wall.stiffness, damping: e.wall.damping, filter: None, delay: N, face: e.face, one_sided: true });
    [const N: usize] FreeMode<N> => |e| Environment::FreeMode { residual: e.residual, delay: N };
    [] Environment => |e| e;
}
