//! The past torques that a coupling stores.

use crate::build_error::BuildError;
use crate::coupling::Coupling;
use crate::environment::{DelayLine, LawContext, VariableDelay};
#[cfg(doc)]
use crate::latency::Latency;
use crate::latency::TRAILS;
use crate::matched::{MatchedCoupling, Trail};
use crate::number::Number;

/// A coupling's memory of the torques of earlier ticks, initially at rest.
pub trait CouplingMemory<N: Number>: Clone + core::fmt::Debug + Sized {
    /// Whether the coupling is compliant in every scene that has this memory.
    const IS_COMPLIANT: bool;
    /// The memory of a scene's coupling.
    ///
    /// # Errors
    /// If a coefficient does not fit the number format or does not exist, or the coupling needs another memory.
    fn of(context: &LawContext) -> Result<Self, BuildError>;
    /// Compliance in rad/(N m) of the coupling for the torque of the same tick; `None` without a memory.
    fn compliance(&self) -> Option<f64> {
        None
    }
    /// Deflection in rad of the coupling in this tick by the torques of earlier ticks; the argument is the last
    /// of them in N m. Call it once per tick, before anything else.
    #[inline(always)]
    fn deflection_after(&mut self, _torque: N) -> N {
        N::ZERO
    }
    /// The same for ticks that begin with a known torque: by the torques passed to
    /// [`remember`](CouplingMemory::remember).
    #[inline(always)]
    fn lasting_deflection(&self) -> N {
        N::ZERO
    }
    /// Ends such a tick, and stores this torque in N m.
    #[inline(always)]
    fn remember(&mut self, _torque: N) {}
    /// Forgets all torques.
    fn rest(&mut self) {}
}

/// No memory: a rigid coupling or a spring.
#[derive(Clone, Copy, Debug)]
pub struct NoMemory;

impl<N: Number> CouplingMemory<N> for NoMemory {
    const IS_COMPLIANT: bool = false;

    fn of(context: &LawContext) -> Result<Self, BuildError> {
        match context.coupling {
            Coupling::Matched => Err(BuildError::Structure),
            Coupling::Rigid | Coupling::Spring { .. } => Ok(Self),
        }
    }
}

/// The memory of [`Coupling::Matched`]: `D` stores the torques of the [whole samples](Latency::whole_samples)
/// of output delay, `LAGS` is the number of [lags](Latency::trails) of amplifier and sensor that it can have,
/// where a lag in a range counts twice, and without `UPDATES` there is no code for an amplifier that is updated
/// several times in a period.
#[derive(Clone, Debug)]
pub struct MatchedMemory<N: Number, D, const LAGS: usize, const UPDATES: bool> {
    held: N::Coefficient,
    arriving: N::Coefficient,
    trails: [Fading<N>; LAGS],
    torques: D,
    /// Used if a tick begins with a known torque.
    deflection: N,
    compliance: f64,
}

#[derive(Clone, Debug)]
struct Fading<N: Number> {
    gain: N::Coefficient,
    decay: N::Coefficient,
    torque: N,
}

impl<N: Number> Fading<N> {
    fn of(trail: Trail) -> Result<Self, BuildError> {
        Ok(Self {
            gain: BuildError::coefficient::<N>("coupling's gain after a lag", trail.gain)?,
            decay: BuildError::coefficient::<N>("decay of a lag", trail.decay)?,
            torque: N::ZERO,
        })
    }
}

impl<N: Number, D: DelayLine<N>, const LAGS: usize, const UPDATES: bool> CouplingMemory<N>
    for MatchedMemory<N, D, LAGS, UPDATES>
{
    const IS_COMPLIANT: bool = true;

    fn of(context: &LawContext) -> Result<Self, BuildError> {
        let LawContext { period, worst_period, passivity, latency, .. } = context;
        let Coupling::Matched = context.coupling else { return Err(BuildError::Structure) };
        let coupling = MatchedCoupling::of_kind::<UPDATES>(
            *period,
            *worst_period,
            *passivity,
            latency,
            N::FORMAT,
        );
        let coupling = coupling.ok_or(BuildError::NoMatchedCoupling)?;
        let lags = coupling.trails.iter().filter(|trail| trail.gain != 0.0);
        if lags.clone().count() > LAGS {
            return Err(BuildError::Structure);
        }
        let nothing = Fading::of(Trail { gain: 0.0, decay: 0.0 })?;
        let mut trails: [Fading<N>; LAGS] = core::array::from_fn(|_| nothing.clone());
        for (place, trail) in trails.iter_mut().zip(lags) {
            *place = Fading::of(*trail)?;
        }
        Ok(Self {
            held: BuildError::coefficient::<N>("coupling's compliance", coupling.held)?,
            arriving: BuildError::coefficient::<N>("coupling's compliance", coupling.arriving)?,
            trails,
            torques: D::at_rest(coupling.whole)?,
            deflection: N::ZERO,
            compliance: coupling.compliance,
        })
    }

    fn compliance(&self) -> Option<f64> {
        Some(self.compliance)
    }

    #[inline(always)]
    fn deflection_after(&mut self, torque: N) -> N {
        let arriving = match self.torques.due() {
            None => torque,
            Some(oldest) => {
                self.torques.push(torque);
                oldest
            }
        };
        let mut deflection = arriving.times(self.arriving);
        if self.torques.due().is_some() {
            let waiting = self.torques.waiting().iter().fold(N::ZERO, |sum, next| sum.plus(*next));
            deflection = deflection.plus(waiting.times(self.held));
        }
        for trail in &mut self.trails {
            deflection = deflection.plus(trail.torque.times(trail.gain));
            trail.torque = trail.torque.times(trail.decay).plus(arriving);
        }
        deflection
    }

    #[inline(always)]
    fn lasting_deflection(&self) -> N {
        self.deflection
    }

    #[inline(always)]
    fn remember(&mut self, torque: N) {
        self.deflection = self.deflection_after(torque);
    }

    fn rest(&mut self) {
        self.torques.fill(N::ZERO);
        self.trails.iter_mut().for_each(|trail| trail.torque = N::ZERO);
        self.deflection = N::ZERO;
    }
}

/// The memory of any coupling, for scenes as data.
pub type AnyMemory<N> = Option<MatchedMemory<N, VariableDelay<N>, TRAILS, true>>;

impl<N: Number> CouplingMemory<N> for AnyMemory<N> {
    const IS_COMPLIANT: bool = false;

    fn of(context: &LawContext) -> Result<Self, BuildError> {
        match context.coupling {
            Coupling::Matched => MatchedMemory::of(context).map(Some),
            Coupling::Rigid | Coupling::Spring { .. } => Ok(None),
        }
    }

    fn compliance(&self) -> Option<f64> {
        self.as_ref().and_then(CouplingMemory::compliance)
    }

    #[inline]
    fn deflection_after(&mut self, torque: N) -> N {
        self.as_mut().map_or(N::ZERO, |memory| memory.deflection_after(torque))
    }

    #[inline]
    fn lasting_deflection(&self) -> N {
        self.as_ref().map_or(N::ZERO, CouplingMemory::lasting_deflection)
    }

    #[inline]
    fn remember(&mut self, torque: N) {
        self.iter_mut().for_each(|memory| memory.remember(torque));
    }

    fn rest(&mut self) {
        self.iter_mut().for_each(CouplingMemory::rest);
    }
}
