//! The codes of a sweep, one per sample.

use super::sine::{QUINTIC, sine};
use super::{Step, Sweep};
use crate::dac::DacCode;

/// The output of a sweep in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Excitation {
    /// Code for the DAC.
    pub code: DacCode,
    /// The tone whose measured part contains this sample; `None` while the device settles and after the
    /// sweep.
    pub measured: Option<usize>,
}

/// Plays a sweep.
///
/// The sine is a polynomial whose error is below that of the nearest code, even at full scale. It is the
/// cheapest such method: all others take more instructions or have errors of codes.
#[derive(Clone, Debug)]
pub struct Exciter<'a> {
    steps: &'a [Step],
    step: usize,
    sample: u32,
    /// Phase in parts of a turn, with as many parts as the step has measured samples.
    phase: u32,
}

impl<'a> Exciter<'a> {
    /// An exciter at the beginning of the sweep.
    pub const fn new<const N: usize>(sweep: &'a Sweep<N>) -> Self {
        Self { steps: &sweep.steps, step: 0, sample: 0, phase: 0 }
    }

    /// The next sample; no torque after the last.
    #[expect(clippy::should_implement_trait, reason = "an exciter does not end")]
    pub fn next(&mut self) -> Excitation {
        let Some(step) = self.steps.get(self.step) else {
            return Excitation { code: DacCode::MID_SCALE, measured: None };
        };
        let turn = self.phase as f32 / step.measured as f32;
        let code = code(step.codes * sine(turn, &QUINTIC));
        let measured = (self.sample >= step.settle).then_some(self.step);
        self.advance(*step);
        Excitation { code, measured }
    }

    fn advance(&mut self, step: Step) {
        self.sample += 1;
        self.phase += step.cycles;
        if self.phase >= step.measured {
            self.phase -= step.measured;
        }
        if self.sample == step.settle + step.measured {
            (self.step, self.sample, self.phase) = (self.step + 1, 0, 0);
        }
    }
}

/// The nearest code to a torque in codes.
fn code(codes: f32) -> DacCode {
    const MOST: i16 = DacCode::CODES_TO_FULL_SCALE.cast_signed();
    let half = if codes < 0.0 { -0.5 } else { 0.5 };
    // The sine may be a little above 1.
    let offset = ((codes + half) as i16).clamp(-MOST, MOST);
    DacCode::from_low_bits(DacCode::MID_SCALE.get().wrapping_add_signed(offset))
}
