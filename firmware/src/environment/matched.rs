//! Environments behind the coupling that absorbs latency.

use super::delay_line::{DelayLine, FixedDelay};
use super::law::{Discretize, Law, LawContext};
use super::turn::Turn;
use crate::build_error::BuildError;
use crate::coupling::{Coupling, Response, Slopes};
use crate::matched::{MatchedCoupling, Trail};
use crate::number::Number;
use crate::parameter::{NamedParameters, Parameter};

/// An environment behind [`Coupling::Matched`]: the coupling's memory is part of the type, so that a scene
/// without latency has none.
///
/// `WHOLE` is the number of [whole samples](crate::latency::Latency::whole_samples) in the scene's output
/// delay, `LAGS` the number of [lags](crate::latency::Latency::trails) of amplifier and sensor, where a lag in
/// a range counts twice, `UPDATES` whether the amplifier is updated several times in a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matched<E, const WHOLE: usize = 0, const LAGS: usize = 0, const UPDATES: bool = false> {
    /// The environment.
    pub environment: E,
}

impl<E: NamedParameters, const WHOLE: usize, const LAGS: usize, const UPDATES: bool> NamedParameters
    for Matched<E, WHOLE, LAGS, UPDATES>
{
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        self.environment.value(parameter)
    }
}

/// A coupling's memory of past torques.
#[derive(Clone, Debug)]
pub struct CouplingMemory<N: Number, D, const LAGS: usize> {
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

impl<N: Number, D: DelayLine<N>, const LAGS: usize> CouplingMemory<N, D, LAGS> {
    /// The memory of a matched coupling, with a line of zeros as long as its whole samples.
    ///
    /// # Errors
    /// If a coefficient does not fit the number format, or there are more lags than it can hold.
    pub(crate) fn new(coupling: &MatchedCoupling, torques: D) -> Result<Self, BuildError> {
        let lags = coupling.trails.iter().filter(|trail| trail.gain != 0.0);
        if lags.clone().count() > LAGS {
            return Err(BuildError::CouplingMemory);
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
            torques,
            deflection: N::ZERO,
            compliance: coupling.compliance,
        })
    }

    /// Compliance of the coupling in rad/(N m) for the torque of the same tick.
    pub(crate) fn compliance(&self) -> f64 {
        self.compliance
    }

    /// Takes the torque of a tick in N m, and returns the deflection in rad that this torque and the earlier
    /// ones cause in the next tick.
    #[inline(always)]
    pub(crate) fn deflection_after(&mut self, torque: N) -> N {
        let arriving = match self.torques.due() {
            None => torque,
            Some(oldest) => {
                self.torques.push(torque);
                oldest
            }
        };
        let mut deflection = arriving.times(self.arriving);
        if self.torques.due().is_some() {
            deflection = deflection.plus(self.torques.sum().times(self.held));
        }
        for trail in &mut self.trails {
            deflection = deflection.plus(trail.torque.times(trail.gain));
            trail.torque = trail.torque.times(trail.decay).plus(arriving);
        }
        deflection
    }

    /// The deflection in rad stored by [`CouplingMemory::remember`].
    #[inline(always)]
    pub(crate) fn deflection(&self) -> N {
        self.deflection
    }

    /// Stores the [`CouplingMemory::deflection_after`] a torque in N m.
    #[inline(always)]
    pub(crate) fn remember(&mut self, torque: N) {
        self.deflection = self.deflection_after(torque);
    }

    /// Forgets all torques.
    pub(crate) fn rest(&mut self) {
        self.torques.fill(N::ZERO);
        self.trails.iter_mut().for_each(|trail| trail.torque = N::ZERO);
        self.deflection = N::ZERO;
    }
}

/// The law of an environment behind a coupling with memory.
#[derive(Clone, Debug)]
pub struct MatchedLaw<N: Number, L, D, const LAGS: usize> {
    law: L,
    memory: CouplingMemory<N, D, LAGS>,
}

impl<N: Number, L: Law<N>, D: DelayLine<N>, const LAGS: usize> Law<N>
    for MatchedLaw<N, L, D, LAGS>
{
    const IS_COMPLIANT: bool = true;

    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        self.law.evaluate(x)
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        self.law.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.law.rest_at(x_e);
        self.memory.rest();
    }

    #[inline(always)]
    fn turn(&mut self) -> Option<&mut Turn<N>> {
        self.law.turn()
    }

    fn shift(&mut self, by: N) {
        self.law.shift(by);
    }

    fn hysteresis(&self) -> f64 {
        self.law.hysteresis()
    }

    fn slopes(&self) -> Slopes {
        self.law.slopes()
    }

    fn matched_compliance(&self) -> Option<f64> {
        Some(self.memory.compliance())
    }

    #[inline(always)]
    fn deflection_after(&mut self, torque: N) -> N {
        self.memory.deflection_after(torque)
    }

    #[inline(always)]
    fn lasting_deflection(&self) -> N {
        self.memory.deflection()
    }

    #[inline(always)]
    fn remember(&mut self, torque: N) {
        self.memory.remember(torque);
    }
}

impl<N: Number, E: Discretize<N>, const WHOLE: usize, const LAGS: usize, const UPDATES: bool>
    Discretize<N> for Matched<E, WHOLE, LAGS, UPDATES>
{
    type Law = MatchedLaw<N, E::Law, FixedDelay<N, WHOLE>, LAGS>;

    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError> {
        let coupling = match setting.coupling {
            Coupling::Matched => setting.matched::<UPDATES>(N::FORMAT)?,
            _ => return Err(BuildError::CouplingMemory),
        };
        if coupling.whole != WHOLE {
            return Err(BuildError::CouplingMemory);
        }
        Ok(MatchedLaw {
            law: self.environment.law(setting)?,
            memory: CouplingMemory::new(&coupling, FixedDelay::at_rest())?,
        })
    }
}
