//! A virtual board whose own bridge drives a motor: aligned and armed as a person does it.

use std::path::Path;

use haptic_model::board::client::frame;
use haptic_servo::current::CurrentLoop;
use haptic_servo::dac::DacCode;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;
use haptic_servo::wire::message::ToBoard;

use crate::hand::HandTrajectory;
use crate::shaft::{HandHeldShaft, LedShaft, Shaft};
use crate::toolchain::BoardModel;
use crate::virtual_board::{
    LONGEST_ARMING, Sample, VirtualBoard, VirtualBoardError, VirtualBoardReport, fading_samples,
    request_to_arm,
};

/// Periods of the modulation in which the current sensors' offsets are measured, twice over.
const OFFSETS: usize = 512;
/// Longest time in s of an alignment.
const LONGEST_ALIGNMENT: f64 = 20.0;
/// Time in s in which a hand turns the aligned motor back to zero.
const RETURN: f64 = 0.5;

/// A running board, which waits at the beginning of a period of the servo.
pub struct BridgeBoard {
    board: VirtualBoard,
    current_loop: CurrentLoop,
    transducers: Transducers,
    sample: Option<Sample>,
    /// The count of each period so far, and whether an alignment moved the handle in it.
    past: Vec<(i32, bool)>,
}

impl BridgeBoard {
    /// Boots a board as [`VirtualBoard::boot`] does, with the motor of a current loop and perhaps a magnetic encoder.
    pub fn boot(
        program: &Path,
        board: BoardModel,
        elf: &Path,
        current_loop: &CurrentLoop,
        transducers: Transducers,
        is_magnetic: bool,
    ) -> Result<Self, VirtualBoardError> {
        let board =
            VirtualBoard::boot(program, board, elf, Some(current_loop.drive()), is_magnetic)?;
        let current_loop = *current_loop;
        Ok(Self { board, current_loop, transducers, sample: None, past: Vec::new() })
    }

    /// Runs to the beginning of the next period of the servo, with bytes to the serial port.
    pub fn period(
        &mut self,
        shaft: &mut dyn Shaft,
        bytes: &[u8],
    ) -> Result<&Sample, VirtualBoardError> {
        if self.sample.is_some() {
            self.board.answer(self.board.count(), bytes)?;
        }
        let sample = self.board.sample_turning(shaft)?;
        self.past.push((self.board.count(), sample.is_aligning));
        Ok(self.sample.insert(sample))
    }

    /// The counts at the beginning of all periods before this one, and whether an alignment moved the handle in
    /// each.
    pub fn past(&self) -> &[(i32, bool)] {
        self.past.split_last().map_or(&[], |(_, past)| past)
    }

    /// The count that the servo reads at the beginning of the period.
    pub fn count(&self) -> i32 {
        self.board.read_count()
    }

    /// The code that the current loop follows from there on: that of no torque while the gates are off.
    pub fn code(&self) -> u16 {
        self.sample.as_ref().map_or(DacCode::MID_SCALE.get(), Sample::applied_code)
    }

    /// Aligns the motor if it is brushless, with the scene's device on it that nobody holds, and turns it
    /// back to zero as a hand would; then arms the servo there, and runs until the bridge has started up and the clamp has opened.
    pub fn align_and_arm(&mut self, scene: &Scene) -> Result<(), VirtualBoardError> {
        let period = scene.timing.period;
        let mut still = LedShaft::new(0.0, &self.transducers, &self.current_loop);
        for _ in 0..OFFSETS / usize::from(self.current_loop.updates()) + 1 {
            self.period(&mut still, &[])?;
        }
        if self.current_loop.is_brushless() {
            self.align(scene)?;
        }
        self.arm(&mut still)?;
        let starting = self.current_loop.start_up_ticks() as usize;
        for _ in 0..starting + fading_samples(period) {
            self.period(&mut still, &[])?;
        }
        Ok(())
    }

    fn align(&mut self, scene: &Scene) -> Result<(), VirtualBoardError> {
        let hand = HandTrajectory::push_and_let_go();
        let mut shaft = HandHeldShaft::new(scene, hand, &self.transducers, &self.current_loop)?;
        shaft.let_go(true);
        let mut bytes = frame(&ToBoard::Align { id: 0 });
        let samples = (LONGEST_ALIGNMENT / scene.timing.period) as usize;
        let mut has_begun = false;
        for _ in 0..samples {
            let is_aligning = self.period(&mut shaft, &std::mem::take(&mut bytes))?.is_aligning;
            if has_begun && !is_aligning {
                return self.turn_to_zero(shaft.motion().angle, scene.timing.period);
            }
            has_begun |= is_aligning;
        }
        Err(VirtualBoardError::NotAligned { samples, said: self.board.last_words()? })
    }

    /// Turns the shaft smoothly from an angle in rad to zero.
    fn turn_to_zero(&mut self, angle: f64, period: f64) -> Result<(), VirtualBoardError> {
        let from = angle * self.transducers.counts_per_turn / std::f64::consts::TAU;
        let mut shaft = LedShaft::new(from, &self.transducers, &self.current_loop);
        let way = HandTrajectory {
            path: vec![(0.0, from), (RETURN, 0.0)],
            ..HandTrajectory::push_and_let_go()
        };
        // The board tells why the alignment failed, if it did.
        let mut bytes = frame(&ToBoard::Status);
        for tick in 1..=(RETURN / period).ceil() as usize {
            shaft.lead_to(way.position(tick as f64 * period));
            self.period(&mut shaft, &std::mem::take(&mut bytes))?;
        }
        Ok(())
    }

    fn arm(&mut self, shaft: &mut LedShaft) -> Result<(), VirtualBoardError> {
        for sample in 0..LONGEST_ARMING {
            if self.period(shaft, &request_to_arm(sample))?.amplifier {
                return Ok(());
            }
        }
        Err(VirtualBoardError::NotArmed { said: self.board.last_words()? })
    }

    /// Switches it off.
    pub fn finish(self) -> Result<VirtualBoardReport, VirtualBoardError> {
        self.board.finish()
    }
}
