//! Decides whether every value between two certified values of a parameter also passes.
//!
//! A remedy with a range is proved at its ends by certificates, and between them by the convexity of the
//! passing set. Otherwise a remedy names one value.
//!
//! **Exact rule** (theory, section 4.1). It requires that `p = delta + T C / (z - 1)` is positive real, with
//! the whole controller `C = E / (1 + V E)`. Sums of positive real functions are positive real, so the
//! passing set is convex in `T C`, and a greater `delta` only enlarges it. In `E` it is convex
//!
//! - behind a rigid coupling, where `C = E`;
//! - behind the standard coupling, where the rule is `delta + Re L > 0`, affine in `E`;
//! - behind a stiffer one. With `k = 2 delta V / T` in `[0, 1]`, `w = k + (1 - k) / z` and
//!   `e = T z E / (2 delta (z - 1))` the rule is `e = D / (1 - D w)` with `abs(D) < 1`. Since `abs(w) <= 1`,
//!   the values of `e` that pass at a point of the circle are a disk; and a function that stays in these
//!   disks on the whole circle has `Re(1 + w e) > 1/2` there and so outside, where `D = e / (1 + w e)` then
//!   has no pole.
//!
//! Behind a softer coupling the passing values are the outside of a disk, which is not convex.
//!
//! Times that vary or are known in a range have several proofs, each of which is enough. Their union is not convex; but
//! each holds for the law 0, so with a passing law the smaller parts of it pass.
//!
//! If updates may be missed, a linear scene must pass two such rules at once, one of them with a softer
//! coupling: then nothing is claimed.
//!
//! **Nonlinear rule** (theory, section 5): an index exists, the loop within a tick has a gain above 0,
//! `bound < K_vc T / 2 <= delta` and `bound < delta`. The first is convex in `E`, the gain is affine, and the
//! bound is affine in stiffness and damping of the wall and convex in the cancelled damping: `be`, and
//! `K T be / (K T - 2 be)` in its magnitude where damping is added. If no damping is added, all of them are
//! also convex in `T`.
//!
//! **Static laws at the port** (equation 59). The index is the norm of a sum of operators, one for each slope
//! and damper, and convex in them.
//!
//! **Another part** beside these adds a constant to the transfer function, to the gain and to the bound, so
//! that the above holds in stiffness, damping and residual; nothing is claimed about periods.
//!
//! **Torque profiles** (equations 46 to 48). The bound grows with each slope and with the damper's magnitude,
//! and the slopes grow with the torque of the table and with the stiffness of its end stops: with less of one
//! of them a passing scene still passes, rounded or not, because rounding keeps the order. It is affine in
//! the period, and without a damper in proportion to it, as is the coupling's limit.
//!
//! **Rounded coefficients.** Rounding keeps the order: the coefficient of a number between two others is
//! between their coefficients, and a law that is affine in the coefficient also passes there. This applies to
//! a late wall, where the gain that solves a tick does not depend on the number. Otherwise coefficients that
//! are rounded separately can leave a hole.

use super::deviation::Deviation;
use super::linearity::is_nonlinear;
use super::loop_intervals::LoopIntervals;
use crate::environment::{Canceller, Parts, Profile, Wall};
use crate::number::Format;
use crate::parameter::Parameter;
use crate::scene::{Coupling, Scene};

/// The verdict on the values between two passing values.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Between {
    /// Nothing is proved.
    Unknown,
    /// They pass.
    Passes,
    /// They pass, and all smaller positive values pass.
    PassesDownToZero,
    /// They pass, and all smaller positive values pass if the scene with zero stiffness passes.
    PassesDownToZeroWithoutStiffness,
}

/// The verdict for a parameter of the search next to `value`.
pub(super) const fn between(
    scene: &Scene,
    format: Format,
    parameter: Parameter,
    value: f64,
) -> Between {
    let n = LoopIntervals::of(scene, format);
    let parts = scene.environment.parts();
    // Times in s are more of a shorter period.
    if matches!(parameter, Parameter::Period) && n.latency.is_some() {
        return Between::Unknown;
    }
    if matches!(parameter, Parameter::Anticogging) {
        // With less of it more passivity is left, for which a matched coupling is designed anew.
        let is_rigid = matches!(scene.coupling, Coupling::Rigid);
        return if is_rigid { Between::PassesDownToZero } else { Between::Unknown };
    }
    match &parts.profile {
        Some(profile) if parts.count() == 1 => return between_profiles(profile, &n, parameter),
        Some(_) => return between_sums(parts, parameter),
        None => {}
    }
    let passes = match parameter {
        Parameter::Stiffness | Parameter::Damping => is_affine_in_wall(scene, parts, &n),
        Parameter::Residual => is_affine_in_residual(scene, &n),
        Parameter::Period if parts.others() > 0 => false,
        Parameter::Period => return between_periods(scene, &n, value),
        _ => false,
    };
    if passes { Between::Passes } else { Between::Unknown }
}

const fn between_profiles(profile: &Profile, n: &LoopIntervals, parameter: Parameter) -> Between {
    match parameter {
        // The line to a snap point, which reduces a fall, is rounded separately.
        Parameter::ProfileTorque
            if profile.snap.is_some() && profile.delay == 0 && !matches!(n.format, Format::F64) =>
        {
            Between::Unknown
        }
        Parameter::Stiffness | Parameter::Damping | Parameter::ProfileTorque => {
            Between::PassesDownToZero
        }
        Parameter::Period if profile.damping() == 0.0 => Between::PassesDownToZero,
        Parameter::Period if matches!(n.format, Format::F64) => Between::Passes,
        _ => Between::Unknown,
    }
}

/// Each part of a sum has its own bound, independent of the other parts. The bound of a late wall is affine
/// in its stiffness and in the magnitude of its damping.
const fn between_sums(parts: &Parts, parameter: Parameter) -> Between {
    let is_late = !matches!(parts.wall, Some(Wall { delay: 0, .. }));
    match parameter {
        Parameter::ProfileTorque => Between::PassesDownToZero,
        Parameter::Stiffness | Parameter::Damping if is_late => Between::PassesDownToZero,
        _ => Between::Unknown,
    }
}

const fn is_affine_in_wall(scene: &Scene, parts: &Parts, n: &LoopIntervals) -> bool {
    let is_late = matches!(&parts.wall, Some(wall) if wall.delay > 0);
    let is_soft = n.missed.is_some() || !n.is_standard && n.excess_compliance().hi() > 0.0;
    let is_convex =
        is_nonlinear(scene) || !is_soft && (has_one_proof(n) || is_in_proportion(parts));
    (is_late || matches!(n.format, Format::F64)) && is_convex
}

/// Whether one proof alone decides a linear scene: a union of convex sets is not convex.
const fn has_one_proof(n: &LoopIntervals) -> bool {
    match &n.latency {
        None => n.linearity.is_zero(),
        Some(lagging) => Deviation::is_alone(lagging, n),
    }
}

/// Whether the law is in proportion to the wall's number that is not zero. Each proof holds for the law 0, so it also
/// holds for a smaller part of a law for which it holds.
const fn is_in_proportion(parts: &Parts) -> bool {
    match &parts.wall {
        Some(wall) => parts.count() == 1 && (wall.stiffness == 0.0 || wall.damping() == 0.0),
        None => false,
    }
}

/// Only an undelayed free mode has `T C = -be (z - 1) / z` for every coupling.
const fn is_affine_in_residual(scene: &Scene, n: &LoopIntervals) -> bool {
    let parts = scene.environment.parts();
    let is_undelayed_alone =
        parts.count() == 1 && matches!(parts.canceller, Some(Canceller { delay: 0, .. }));
    let is_affine = n.missed.is_none() && (n.coupling.is_none() || is_undelayed_alone);
    matches!(n.format, Format::F64) && (is_nonlinear(scene) || is_affine)
}

/// - A law without damper and canceller does not change with the period. The exact rule is then
///   affine in `T` and holds at 0; of the nonlinear rule, `bound < K_vc T / 2` is homogeneous.
/// - Behind a rigid coupling `T C` is affine in `T`, and at 0 that of the same scene without
///   stiffness.
/// - In the nonlinear rule, an undelayed damper without a filter adds nothing to the bound.
/// - At the port the index of a static law is affine in the period, and without a damper in proportion to it.
const fn between_periods(scene: &Scene, n: &LoopIntervals, longest: f64) -> Between {
    let wall = scene.environment.wall();
    let cancels = !n.cancelled.is_zero();
    let damping = match wall {
        Some(wall) => wall.damping(),
        None => 0.0,
    };
    let is_f64 = matches!(n.format, Format::F64);
    if n.is_at_port && (damping != 0.0 || cancels) {
        return if is_f64 { Between::Passes } else { Between::Unknown };
    }
    if damping == 0.0 && !cancels {
        return if is_f64 || is_nonlinear(scene) || is_never_standard(n, longest) {
            Between::PassesDownToZero
        } else {
            Between::Unknown
        };
    }
    if !is_f64 {
        return Between::Unknown;
    }
    if !is_nonlinear(scene) {
        return match n.coupling {
            None => Between::PassesDownToZeroWithoutStiffness,
            Some(_) => Between::Unknown,
        };
    }
    let is_late = matches!(wall, Some(wall) if wall.delay > 0);
    let is_passive = matches!(wall, Some(wall) if wall.filter().is_none());
    if n.cancelled.is_negative() || damping < 0.0 {
        Between::Unknown
    } else if is_late || !is_passive || cancels {
        Between::Passes
    } else {
        Between::PassesDownToZero
    }
}

/// Whether the rounded coupling is stiffer than the standard coupling up to this period. At the standard
/// coupling the verdict is that of the exact standard coupling, which rejects slightly more.
const fn is_never_standard(n: &LoopIntervals, longest: f64) -> bool {
    match n.coupling {
        None => true,
        Some(stiffness) => longest * stiffness.hi() < 1.99 * n.delta.lo(),
    }
}

/// Whether all larger passivities pass if this one passes. With rounded coefficients the exact rule is a
/// little stricter at the standard coupling than next to it.
pub(super) const fn passes_upwards(scene: &Scene, n: &LoopIntervals, passivity: f64) -> bool {
    if n.missed.is_some() && !is_nonlinear(scene) {
        return false;
    }
    match (n.format, n.coupling_damping()) {
        (Format::F64, _) | (_, None) => true,
        (_, Some(damping)) => is_nonlinear(scene) || damping.hi() < 0.99 * passivity,
    }
}
