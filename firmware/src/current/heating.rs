//! I2t: takes the torque's limit down to the continuous current before the power stage gets too hot.
//!
//! The mean of the squared current, over the time constant of a first-order lag, is the heat. From nine tenths of
//! the continuous current's heat on, the allowed current falls in a straight line, from full scale to the continuous
//! current at its own heat: there the two stay, because a current at its own heat does not change the heat. The
//! servo's limit moves by the steps of its clamp, and rises only above a torque that it did not limit.

use crate::dac::DacCode;

/// Time constant in s of the heat: chosen, not from a data sheet, so that twice the continuous current lasts a
/// second from cold.
pub(super) const TIME: f64 = 4.0;

/// Parts of the continuous current's heat at which the limit begins to fall, below which it rises again, and below
/// which it has risen: the heat takes longer from one to the other than a servo's limit takes to open.
const FALLS: f32 = 0.9;
const RISES: f32 = 0.8;
const RISEN: f32 = 0.25;

/// The limit of a current loop whose full-scale current is above the continuous current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeatLimit {
    /// Square of the continuous current in A^2.
    pub square: f32,
    /// The continuous current in codes.
    pub codes: f32,
    /// Weight of a period of the servo in the mean.
    pub weight: f32,
}

/// A step of the servo's torque limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeatStep {
    /// The limit falls by a step.
    Lower,
    /// The limit rises by a step.
    Raise,
}

/// The heat of a running current loop.
#[derive(Clone, Copy, Debug)]
pub struct Heating {
    limit: Option<HeatLimit>,
    mean_square: f32,
    /// Whether the limit may not have risen since it last fell.
    is_lowered: bool,
}

impl Heating {
    /// A cold power stage.
    pub(super) const fn new(limit: Option<HeatLimit>) -> Self {
        Self { limit, mean_square: 0.0, is_lowered: false }
    }

    /// Takes the current in A of a period of the servo and its code by
    /// [`DacCode::offset`](crate::dac::DacCode::offset); returns the step of the torque limit, if one is due.
    #[inline(always)]
    pub fn observe(&mut self, current: f32, code_offset: i16) -> Option<HeatStep> {
        let limit = self.limit.as_ref()?;
        self.mean_square += (current * current - self.mean_square) * limit.weight;
        if self.mean_square < FALLS * limit.square && !self.is_lowered {
            return None;
        }
        Self::step(limit, self.mean_square, &mut self.is_lowered, code_offset)
    }

    #[cold]
    #[inline(never)]
    fn step(
        limit: &HeatLimit,
        mean_square: f32,
        is_lowered: &mut bool,
        code_offset: i16,
    ) -> Option<HeatStep> {
        let full = f32::from(DacCode::CODES_TO_FULL_SCALE);
        let left = (1.0 - mean_square / limit.square) / (1.0 - FALLS);
        let allowed = limit.codes + (full - limit.codes) * left.clamp(0.0, 1.0);
        if f32::from(code_offset).abs() > allowed {
            *is_lowered = true;
            Some(HeatStep::Lower)
        } else if mean_square < RISES * limit.square && *is_lowered {
            *is_lowered = mean_square > RISEN * limit.square;
            Some(HeatStep::Raise)
        } else {
            None
        }
    }
}
