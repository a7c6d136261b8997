//! The environments as transfer functions with interval coefficients (theory, section 5), and the
//! bound on their index when they are one-sided or limited.

use crate::environment::{Environment, Rational, Wall};
use crate::passivity::interval::Interval;
use crate::passivity::polynomial::Polynomial;
use crate::passivity::transfer::{Transfer, Unbuildable};
use crate::scene::{Coupling, Scene};

/// The numbers of a scene as the intervals that the certificate computes with.
#[derive(Clone, Copy)]
pub(super) struct Numbers {
    /// Nominal period `T`.
    pub period: Interval,
    /// Device passivity, scaled to the worst period: all indices are per tick, so a longest
    /// period of `k T` leaves `delta / k` (theory, section 8).
    pub delta: Interval,
    /// Damping that a canceller takes away, `be = b - epsilon`; zero without a canceller.
    pub cancelled: Interval,
    /// Coupling stiffness; `None`: rigid.
    pub coupling: Option<Interval>,
}

impl Numbers {
    pub const fn of(scene: &Scene) -> Self {
        let period = Interval::decimal(scene.timing.period);
        let delta = Interval::decimal(match scene.device.passivity {
            Some(passivity) => passivity,
            None => scene.device.damping,
        });
        let delta = match scene.timing.worst_period {
            Some(worst) if worst != scene.timing.period => {
                delta.mul(period).div(Interval::decimal(worst))
            }
            _ => delta,
        };
        let cancelled = match scene.environment {
            Environment::FreeMode { residual, .. } | Environment::FreeModeWall { residual, .. } => {
                Interval::decimal(scene.device.damping).sub(Interval::decimal(residual))
            }
            _ => Interval::ZERO,
        };
        let coupling = match scene.coupling {
            Coupling::Rigid => None,
            Coupling::Spring { stiffness } => Some(Interval::decimal(stiffness)),
        };
        Self { period, delta, cancelled, coupling }
    }

    /// Compliance `V` of the coupling in rad/(N m).
    pub const fn compliance(&self) -> Interval {
        match self.coupling {
            None => Interval::ZERO,
            Some(stiffness) => Interval::ONE.div(stiffness),
        }
    }

    /// `K_vc T / 2`, the damping that the coupling stands for; `None`: rigid.
    pub const fn coupling_damping(&self) -> Option<Interval> {
        match self.coupling {
            None => None,
            Some(stiffness) => Some(stiffness.mul(self.period).half()),
        }
    }

    /// `V - T / (2 delta)`: what the coupling has over the standard one. Contains 0 where the
    /// coupling is the standard one to the digits that were written.
    pub const fn excess_compliance(&self) -> Interval {
        self.compliance().sub(self.period.div(self.delta.double()))
    }
}

/// `E(z)`, causal and with a proper denominator.
#[inline(never)]
pub(super) const fn transfer(
    environment: &Environment,
    n: &Numbers,
) -> Result<Transfer, Unbuildable> {
    let built = match environment {
        Environment::DelayedSpring(w) | Environment::DamperWall(w) => Some(wall(w, n)),
        Environment::FreeMode { delay, .. } => {
            let free = free_mode(n);
            Some(Transfer { shift: free.shift - *delay as i32, ..free })
        }
        Environment::FreeModeWall { wall: w, .. } => free_mode(n).plus(wall(w, n)),
        Environment::Rational(r) => Some(rational(r)),
    };
    match built {
        None => Err(Unbuildable::OutOfRange),
        Some(transfer) => match transfer.check() {
            Ok(()) => Ok(transfer),
            Err(error) => Err(error),
        },
    }
}

/// `z^-n (K + B (1 - a)(z - 1) / (T (z - a)))`, `a = 0` without a filter (equation 24).
const fn wall(w: &Wall, n: &Numbers) -> Transfer {
    let (k, b) = (Interval::decimal(w.stiffness), Interval::decimal(w.damping));
    let a = match w.filter {
        Some(a) if w.damping != 0.0 => Interval::decimal(a),
        _ => Interval::ZERO,
    };
    let b = b.mul(Interval::ONE.sub(a));
    let denominator = Polynomial::ascending(&[a.neg().mul(n.period), n.period]);
    let shift = -(w.delay as i32);
    if w.stiffness == 0.0 {
        // A pure damper keeps its exact zero at z = 1.
        let numerator = Polynomial::ascending(&[b]);
        return Transfer { shift, ones: 1, ..Transfer::new(numerator, denominator) };
    }
    let kt = k.mul(n.period);
    let numerator = Polynomial::ascending(&[kt.mul(a).add(b).neg(), kt.add(b)]);
    Transfer { shift, ..Transfer::new(numerator, denominator) }
}

/// `-be K (z - 1) / ((K T + be) z - be)`, for a rigid coupling `-be (z - 1) / (T z)` (equation
/// 23, generalised from `K = 2 b / T` to any coupling spring).
const fn free_mode(n: &Numbers) -> Transfer {
    let be = n.cancelled;
    let (gain, denominator) = match n.coupling {
        Some(k) => {
            let kt = k.mul(n.period);
            (be.mul(k), Polynomial::ascending(&[be.neg(), kt.add(be)]))
        }
        None => (be, Polynomial::ascending(&[Interval::ZERO, n.period])),
    };
    let numerator = Polynomial::ascending(&[gain.neg()]);
    Transfer { ones: 1, ..Transfer::new(numerator, denominator) }
}

const fn rational(r: &Rational) -> Transfer {
    Transfer {
        shift: -(r.delay as i32),
        ones: r.unit_zeros as i32,
        ..Transfer::new(
            Polynomial::descending(r.numerator.as_slice(), false),
            Polynomial::descending(r.denominator.as_slice(), false),
        )
    }
}

/// Upper bound on `alpha` that holds for one-sided walls, switching and a torque limit between
/// environment and coupling (theory, end of section 5); `None` where none is known.
///
/// - Wall, `n >= 1`: `K T (n - 1/2) + abs(B)`; a velocity filter has the l1 norm 1 and changes
///   nothing in `sum abs(v(k)) abs(v(k - i))`.
/// - Wall, undelayed: 0 for `B >= 0` without a filter, otherwise `abs(B)`.
/// - Canceller: the clipped torque is `g(k) (h * v)(k)` with `g` in `[0, 1]`, so by Young's
///   inequality `alpha <= sum abs(h)`, which for the first-order lag of [`free_mode`] is `be`.
pub(super) const fn nonlinear_bound(environment: &Environment, n: &Numbers) -> Option<Interval> {
    match environment {
        Environment::DelayedSpring(w) | Environment::DamperWall(w) => Some(wall_bound(w, n)),
        Environment::FreeMode { .. } => canceller_bound(n),
        Environment::FreeModeWall { wall: w, .. } => match canceller_bound(n) {
            Some(bound) => Some(bound.add(wall_bound(w, n))),
            None => None,
        },
        Environment::Rational(_) => None,
    }
}

const fn wall_bound(w: &Wall, n: &Numbers) -> Interval {
    let (k, b) = (Interval::decimal(w.stiffness), Interval::decimal(w.damping));
    if w.delay == 0 {
        let passive = w.filter.is_none() && w.damping >= 0.0;
        return if passive { Interval::ZERO } else { b.abs() };
    }
    let samples = Interval::exact(w.delay as f64 - 0.5);
    k.mul(n.period).mul(samples).add(b.abs())
}

const fn canceller_bound(n: &Numbers) -> Option<Interval> {
    let be = n.cancelled;
    match n.coupling {
        Some(k) if be.lo() < 0.0 => {
            // Added damping: the lag's pole be / (K T + be) is negative, its l1 norm larger.
            let kt = k.mul(n.period);
            let room = kt.sub(be.abs().double());
            if room.is_positive() { Some(kt.mul(be.abs()).div(room)) } else { None }
        }
        _ => Some(be.abs()),
    }
}

/// A scene's linear transfer functions from position (rad) to torque (N m), as the certificate
/// sees them: for pictures, and for simulating what was not certified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// The environment `E` alone.
    pub environment: Transfer,
    /// The total controller `C = E / (1 + V E)` (theory, section 2).
    pub controller: Transfer,
    /// `E'`, which behind the standard coupling is the same controller (theory, section 4.1).
    pub equivalent: Transfer,
}

impl Loop {
    /// The transfer functions of a scene, one-sidedness and torque limit left out.
    ///
    /// # Errors
    /// Where the environment is not causal, the loop of coupling and environment has no solution,
    /// or a number is out of range.
    pub const fn of(scene: &Scene) -> Result<Self, Unbuildable> {
        let n = Numbers::of(scene);
        let environment = match transfer(&scene.environment, &n) {
            Ok(environment) => environment,
            Err(error) => return Err(error),
        };
        let controller = match environment.behind(n.compliance()) {
            Ok(controller) => controller,
            Err(error) => return Err(error),
        };
        let excess = n.excess_compliance();
        let equivalent = if excess.contains(0.0) {
            environment
        } else {
            match environment.behind(excess) {
                Ok(equivalent) => equivalent,
                Err(error) => return Err(error),
            }
        };
        Ok(Self { environment, controller, equivalent })
    }
}
