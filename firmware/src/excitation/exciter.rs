//! A sweep's codes, one a sample.

use super::sine::{QUINTIC, sine};
use super::{Step, Sweep};
use crate::dac::DacCode;

/// The output of a sweep in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Excitation {
    /// Code for the DAC.
    pub code: DacCode,
    /// The tone that this sample belongs to the measured part of; `None` while the device settles
    /// and after the sweep.
    pub measured: Option<usize>,
}

/// Plays a sweep.
///
/// The sine is a polynomial whose error is below that of the nearest code, at full scale too. It is
/// the cheapest that is: each of the others takes more instructions, or is off by codes.
#[derive(Clone, Debug)]
pub struct Exciter<'a> {
    steps: &'a [Step],
    step: usize,
    sample: u32,
    /// In parts of a turn, of which there are as many as the step has measured samples.
    phase: u32,
}

impl<'a> Exciter<'a> {
    /// At the sweep's beginning.
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

/// The nearest code to so many codes of torque.
fn code(codes: f32) -> DacCode {
    const MOST: i16 = DacCode::CODES_TO_FULL_SCALE.cast_signed();
    let half = if codes < 0.0 { -0.5 } else { 0.5 };
    // The sine may be a little above 1.
    let offset = ((codes + half) as i16).clamp(-MOST, MOST);
    DacCode::from_low_bits(DacCode::MID_SCALE.get().wrapping_add_signed(offset))
}
