//! The numbers of a scene as the certificate computes with them: enclosed, and rounded to a number format.

use crate::latency::Latency;
use crate::matched::MatchedCoupling;
use crate::number::{Format, Rounding};
use crate::passivity::interval::Interval;
use crate::passivity::transfer::{Transfer, Unbuildable};
use crate::scene::{Coupling, Scene, Timing};

/// The numbers of a scene as the intervals that the certificate computes with.
#[derive(Clone, Copy)]
pub(super) struct LoopIntervals {
    /// Nominal period `T`.
    pub period: Interval,
    /// Device passivity, scaled to the worst period: all indices are per tick, so a longest
    /// period of `k T` leaves `delta / k` (theory, section 8). Of a limited late spring behind a coupling, what
    /// a nonlinear encoder leaves of it.
    pub delta: Interval,
    /// Missed updates, if a torque may be latched a period after its count.
    pub missed: Option<Missed>,
    /// Damping removed by a canceller, `be = b - epsilon`; zero without a canceller.
    pub cancelled: Interval,
    /// Unrounded coupling stiffness; `None`: rigid.
    pub coupling: Option<Interval>,
    /// Compliance `V` of the coupling in rad/(N m).
    pub compliance: Interval,
    /// Whether the coupling is the standard one, `V = T / (2 delta)`, within the precision of its digits. The
    /// rounded compliance is then equal or slightly larger.
    pub is_standard: bool,
    /// The number format of the servo's coefficients.
    pub format: Format,
    /// Whether the worst period differs from the period.
    pub misses_updates: bool,
    /// Longest time between two updates over the period.
    pub stretch: Interval,
    /// Whether the index is that of a static law at the device's port, without a coupling.
    pub is_at_port: bool,
    /// Whether the coupling is the matched one.
    pub is_matched: bool,
    /// `eta` of the encoder, if the passivity does not include it.
    pub linearity: Interval,
    /// Delays and lags; `None`: none at all, and a coupling without memory.
    pub latency: Option<Lagging>,
}

/// Whether torques lag, or the coupling has memory.
pub(super) const fn has_latency(scene: &Scene) -> bool {
    !scene.latency.is_none() || matches!(scene.coupling, Coupling::Matched)
}

/// The additional numbers of a scene with latency.
#[derive(Clone, Copy)]
pub(super) struct Lagging {
    /// The times.
    pub latency: Latency,
    /// The timing of the servo.
    pub timing: Timing,
    /// The coupling, if it is matched.
    pub matched: Option<MatchedCoupling>,
    /// Upper bound on the index by the paper's rule; `None` if none is known.
    pub limit: Option<Interval>,
}

/// The missed updates of a scene whose torques may be latched one period after their counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Missed {
    /// Longest time between two counts over the period, `T_max / T`.
    pub stretch: Interval,
    /// Device passivity as declared.
    pub declared: Interval,
}

impl Missed {
    /// The same, with counts that are read up to a part `late` of a period after its beginning: the time
    /// between two counts may then be longer, and the time to the latch shorter, by this part.
    pub const fn read_late(n: &LoopIntervals, late: Interval) -> Self {
        let slowest = Interval::ONE.add(late).div(Interval::ONE.sub(late));
        match n.missed {
            Some(missed) => Self { stretch: missed.stretch.mul(slowest), ..missed },
            None => Self { stretch: slowest, declared: n.delta },
        }
    }

    /// The upper bound on an index behind a coupling spring of damping `k = K_vc T / 2`, with latched
    /// torques: `1 / ((T_max / T - 1) / delta + 1 / k)`, for `k <= delta` (equation 36).
    ///
    /// Let the counts be `x_j`, `T_j <= T_max` apart, with the torque `u_j` at `x_j` and
    /// `u_{j+1}` from one period later on, `x_E,j = x_j - V u_j`, `d = x_{j+1} - x_j`,
    /// `w = u_{j+1} - u_j`, `e = d - V w`, and `s = T / T_j`. Summed by equation 34, device
    /// and controller keep over each interval at least the quadratic form
    ///
    /// ```text
    /// s delta d^2 / T - s w d + (V / 2 - (1 - s) T / (4 delta)) w^2 - alpha e^2 / T,
    /// ```
    ///
    /// apart from differences of the coupling's and the environment's energy. For `nu = 2 delta V / T` and
    /// `a = alpha / delta` its determinant has the sign of `(nu - 1) (s - a - s a (nu - 1))`: it is not
    /// negative for `nu >= 1` and `1 / a >= 1 / s + nu - 1`, whatever the pattern of misses, and
    /// `s = T / T_max` is the worst.
    pub const fn limit(&self, k: Interval) -> Interval {
        let delta = self.declared;
        let product = delta.mul(k);
        product.div(self.stretch.sub(Interval::ONE).mul(k).add(delta))
    }
}

impl LoopIntervals {
    /// The times alone, without passivity, coupling and latency.
    #[inline(always)]
    pub const fn timed(timing: Timing, format: Format) -> Self {
        let period = Interval::decimal(timing.period);
        Self {
            period,
            delta: Interval::ZERO,
            missed: None,
            cancelled: Interval::ZERO,
            coupling: None,
            compliance: Interval::ZERO,
            is_standard: false,
            format,
            misses_updates: timing.longer_period().is_some(),
            stretch: match timing.longer_period() {
                Some(worst) => Interval::decimal(worst).div(period),
                None => Interval::ONE,
            },
            is_at_port: false,
            is_matched: false,
            linearity: Interval::ZERO,
            latency: None,
        }
    }

    pub(super) const fn coefficient(&self, value: Interval) -> Interval {
        rounded(value, self.format, Rounding::Nearest)
    }

    /// The whole controller of an environment behind the coupling.
    #[inline(never)]
    pub const fn behind_coupling(&self, environment: &Transfer) -> Result<Transfer, Unbuildable> {
        let Some(lagging) = &self.latency else { return environment.behind(self.compliance) };
        match &lagging.matched {
            Some(matched) => match &matched.transfer() {
                Some((numerator, denominator)) => {
                    environment.behind_rational(numerator, denominator)
                }
                None => Err(Unbuildable::OutOfRange),
            },
            None if self.is_matched => Err(Unbuildable::OutOfRange),
            None => environment.behind(self.compliance),
        }
    }

    /// `K_vc T / 2`, the damping equivalent to the coupling; `None`: rigid.
    pub const fn coupling_damping(&self) -> Option<Interval> {
        match (self.coupling, self.format) {
            (None, _) => None,
            (Some(stiffness), Format::F64) => Some(stiffness.mul(self.period).half()),
            (Some(_), _) => Some(self.period.div(self.compliance).half()),
        }
    }

    /// `2 delta / T`, the stiffness of the standard coupling in N m/rad.
    pub const fn standard_stiffness(&self) -> Interval {
        self.delta.double().div(self.period)
    }

    /// `V - T / (2 delta)`: the excess of the coupling over the standard one.
    pub const fn excess_compliance(&self) -> Interval {
        self.compliance.sub(standard(self.period, self.delta))
    }

    /// The same for the declared passivity, which applies if torques are latched and updates are missed.
    pub const fn excess_where_latched(&self) -> Option<Interval> {
        let missed = some!(&self.missed);
        Some(self.compliance.sub(standard(self.period, missed.declared)))
    }

    /// The factor by which the servo's rounded gains scale an environment with this feedthrough.
    ///
    /// It solves the loop of coupling and environment by a gain `g`, which is `1 / (1 + f V)` rounded. The
    /// torque `g v`, with `v` the one for the device's own position, is that of the environment times
    /// `k = g / (1 - f V g)` behind the same coupling: exactly 1 for the exact gain, and without feedthrough.
    pub const fn solved(&self, feedthrough: Interval) -> Interval {
        if feedthrough.is_zero() || matches!(self.format, Format::F64) {
            return Interval::ONE;
        }
        let fed_back = feedthrough.mul(self.compliance);
        let gain = self.coefficient(Interval::ONE.div(Interval::ONE.add(fed_back)));
        gain.div(Interval::ONE.sub(fed_back.mul(gain)))
    }
}

/// `T / (2 delta)`: compliance of the standard coupling.
pub(super) const fn standard(period: Interval, delta: Interval) -> Interval {
    period.div(delta.double())
}

/// An interval of all coefficients of a format for the values of an interval.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) const fn rounded(value: Interval, format: Format, rounding: Rounding) -> Interval {
    match format {
        Format::F64 => value,
        _ => Interval::new(
            format.coefficient(value.lo(), rounding),
            format.coefficient(value.hi(), rounding),
        ),
    }
}
