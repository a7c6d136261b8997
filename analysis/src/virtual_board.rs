//! A program that is flashed, unmodified, on a virtual board: a process of its own, in lockstep with
//! this one.
//!
//! The board is the package `virtual-board`, which documents its protocol; it is built when it is first
//! needed. Its libraries are under a licence of their own, so nothing here links with it.

use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use haptic_model::board::client::frame;
use haptic_servo::current::{Drive, Motor, Regeneration, Winding};
use haptic_servo::dac::DacCode;
use haptic_servo::servo::RenderingOptions;
use haptic_servo::wire::message::{LONGEST_TO_HOST, Outcome, Status, ToBoard, ToHost};
use haptic_servo::wire::{CHECKSUM, Decoder};

use crate::emulator::InstructionStats;
use crate::shaft::{Shaft, ShaftMotion};
use crate::simulation::SimulationError;
use crate::toolchain::BoardModel;

/// First byte of a board's message at the end of a sample, and at its end on request.
const SAMPLE: u8 = 1;
const END: u8 = 0;
/// First byte of its message at the end of each period of its bridge's modulation, and the length of the
/// rest.
const PWM_PERIOD: u8 = 2;
const PWM_PERIOD_BYTES: u64 = 16;
/// The amplifier's state while an alignment, and not the servo, drives the gates.
const ALIGNING: u8 = 2;
/// The value that stands for no code.
const NO_CODE: u16 = u16::MAX;
/// Largest number of samples from the request to arm until the servo is armed: many times the duration of a
/// frame and of the board's other work.
pub const LONGEST_ARMING: usize = 10_000;

#[derive(Debug, thiserror::Error)]
pub enum VirtualBoardError {
    #[error("the virtual board could not be started: {0}")]
    Start(#[source] io::Error),
    #[error("the virtual board has stopped: {said}")]
    Stopped { said: String },
    #[error(
        "the motor at the virtual board's bridge is not aligned after {samples} samples; it has told: {said}"
    )]
    NotAligned { samples: usize, said: String },
    #[error(
        "the virtual board's amplifier has stayed off for {LONGEST_ARMING} samples; it has told: {said}"
    )]
    NotArmed { said: String },
    #[error(transparent)]
    Device(#[from] SimulationError),
}

/// A sample that has ended; where a bridge drives the motor, a sample that begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The DAC's code in it; none while nothing drives its pin. The code that a bridge's current loop follows
    /// in it.
    pub code: Option<u16>,
    /// Whether the amplifier was on, or the bridge's gates are driven.
    pub amplifier: bool,
    /// Whether an alignment drives the gates, or is about to begin.
    pub is_aligning: bool,
    /// The bytes that the serial port has sent.
    pub sent: Vec<u8>,
}

impl Sample {
    /// The code that acts on the motor: that of no torque while the amplifier is off or no code drives
    /// its input.
    pub fn applied_code(&self) -> u16 {
        self.code.filter(|_| self.amplifier).unwrap_or(DacCode::MID_SCALE.get())
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct VirtualBoardReport {
    /// Instructions from reading the count to writing the code; none where that is to memory, for a bridge.
    pub compute: Option<InstructionStats>,
    /// Instructions of the servo's whole interrupt.
    pub interrupt: InstructionStats,
    pub resets: u32,
    pub log: Vec<String>,
}

/// The bytes to the serial port in a sample after the request to arm: that request, and one for the fault of a servo
/// that is not armed long after.
pub fn request_to_arm(sample: usize) -> Vec<u8> {
    const ASKED: usize = LONGEST_ARMING - 200;
    match sample {
        0 => frame(&ToBoard::Arm { id: 0 }),
        ASKED => frame(&ToBoard::Status),
        _ => Vec::new(),
    }
}

/// Samples from arming until the clamp of a servo with this period in s has opened.
pub fn fading_samples(period: f64) -> usize {
    // Rounded up, and two for the ticks in which it begins and ends.
    (RenderingOptions::DEFAULT.fade / period).ceil() as usize + 2
}

/// A drive as the virtual board reads it. Its supply takes energy back only if the drive says so.
fn words(drive: &Drive) -> [String; 6] {
    let Motor { winding, resistance, inductance, torque_constant } = drive.motor;
    let winding = match winding {
        Winding::Brushed => "brushed".to_owned(),
        Winding::Brushless { pole_pairs } => pole_pairs.to_string(),
    };
    let numbers = [resistance, inductance, torque_constant, drive.supply.open_voltage()];
    let [resistance, inductance, torque_constant, supply] = numbers.map(|it| it.to_string());
    let capacitance = match drive.supply.regeneration {
        Regeneration::Sinks => "sinks".to_owned(),
        Regeneration::Stores { capacitance, .. } => capacitance.to_string(),
    };
    [winding, resistance, inductance, torque_constant, supply, capacitance]
}

pub struct VirtualBoard {
    process: Child,
    input: Option<BufWriter<ChildStdin>>,
    output: BufReader<ChildStdout>,
    /// The encoder's position in counts, as the simulated world has it, and that which a chip's last good transfer before
    /// an update of the modulation has read.
    count: i32,
    before: i32,
    /// Whether the chip's transfers fail from the next answer on.
    fails: bool,
    /// Periods of the modulation in the sample before.
    turns: usize,
    /// Of a magnetic encoder's reading at rest: none of a counter.
    rest: Option<Rest>,
    decoder: Box<Decoder<{ LONGEST_TO_HOST + CHECKSUM }>>,
    /// Its reasons for refused requests, and its faults.
    told: Vec<String>,
}

/// A chip that reads the same angle [100 times](haptic_servo::magnetic::Chip::frozen_after) counts as stopped. So one
/// position in fifty at rest is off by a count.
#[derive(Default)]
struct Rest {
    /// The position without that, and how often it was the same.
    count: i32,
    equal: u32,
}

impl Rest {
    const LONGEST: u32 = 50;

    fn reads(&mut self, count: i32, may_be_off: bool) -> i32 {
        self.equal = if count == self.count { self.equal + 1 } else { 0 };
        self.count = count;
        if !may_be_off || self.equal < Self::LONGEST {
            return count;
        }
        self.equal = 0;
        count + 1
    }
}

impl VirtualBoard {
    /// Switches a board on: runs the `program` of the virtual board as this `board`, with the ELF in its
    /// flash, and the drive of its bridge if it has one. It stands still until the first [`Self::sample`].
    pub fn boot(
        program: &Path,
        board: BoardModel,
        elf: &Path,
        drive: Option<&Drive>,
        is_magnetic: bool,
    ) -> Result<Self, VirtualBoardError> {
        let mut process = Command::new(program)
            .arg(board.name())
            .arg(elf)
            .args(drive.map(words).into_iter().flatten())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(VirtualBoardError::Start)?;
        let missing = || VirtualBoardError::Start(io::ErrorKind::BrokenPipe.into());
        let input = process.stdin.take().ok_or_else(missing)?;
        let output = process.stdout.take().ok_or_else(missing)?;
        let (input, output) = (Some(BufWriter::new(input)), BufReader::new(output));
        let rest = is_magnetic.then(Rest::default);
        let (decoder, told) = (Box::new(Decoder::new()), Vec::new());
        let (count, before, fails, turns) = (0, 0, false, 0);
        Ok(Self { process, input, output, count, before, fails, turns, rest, decoder, told })
    }

    /// Waits for the end of the sample that runs.
    pub fn sample(&mut self) -> Result<Sample, VirtualBoardError> {
        self.read_sample(None).map_err(|error| self.stopped(&error))
    }

    /// The same where a bridge drives a motor, which turns this shaft meanwhile.
    pub fn sample_turning(&mut self, shaft: &mut dyn Shaft) -> Result<Sample, VirtualBoardError> {
        self.read_sample(Some(shaft)).map_err(|error| self.stopped(&error))
    }

    /// Answers a sample: with the position to which the encoder has turned in it, and bytes to the serial
    /// port. The next sample begins.
    pub fn answer(&mut self, count: i32, bytes: &[u8]) -> Result<(), VirtualBoardError> {
        let turned = count.wrapping_sub(self.count);
        self.count = count;
        self.write_answer(turned, bytes).map_err(|error| self.stopped(&error))
    }

    /// Whether a chip's transfers fail from the next answer on. A counter's readings do not.
    pub fn reading_fails(&mut self, fails: bool) {
        self.fails = fails;
    }

    /// The board waits for a count and holds the code that it computed before: the code of that sample is the
    /// answer. With bytes to the serial port and from it.
    pub fn exchange(
        &mut self,
        count: i32,
        bytes: &[u8],
    ) -> Result<(u16, Vec<u8>), VirtualBoardError> {
        self.answer(count, bytes)?;
        let sample = self.sample()?;
        Ok((sample.applied_code(), sample.sent))
    }

    /// Arms the servo over the serial port, and runs until the clamp of a servo with this period in s has
    /// opened. The device stands still meanwhile.
    pub fn arm_and_wait(&mut self, period: f64) -> Result<(), VirtualBoardError> {
        for sample in 0..LONGEST_ARMING {
            let on = self.sample()?.amplifier;
            self.answer_at_rest(&request_to_arm(sample), true)?;
            if on {
                return self.hold_still(fading_samples(period));
            }
        }
        Err(VirtualBoardError::NotArmed { said: self.last_words()? })
    }

    /// Runs this many samples with the device at rest; then the board waits for the first count.
    fn hold_still(&mut self, samples: usize) -> Result<(), VirtualBoardError> {
        for left in (1..samples).rev() {
            self.sample()?;
            // The servo forgets that before the first count.
            self.answer_at_rest(&[], left > Rest::LONGEST as usize / 2)?;
        }
        self.sample().map(drop)
    }

    fn answer_at_rest(&mut self, bytes: &[u8], may_be_off: bool) -> Result<(), VirtualBoardError> {
        let count =
            self.rest.as_mut().map_or(self.count, |rest| rest.reads(rest.count, may_be_off));
        self.answer(count, bytes)
    }

    /// The encoder's position in counts.
    pub fn count(&self) -> i32 {
        self.count
    }

    /// The position in counts that the servo reads: with a chip that at the update of the modulation before, as its
    /// transfer begins before an update, and the position changes at updates.
    pub fn read_count(&self) -> i32 {
        if self.rest.is_some() { self.before } else { self.count }
    }

    /// Switches it off, and gives in a line what it has told: refusals, faults and its log.
    pub fn last_words(&mut self) -> Result<String, VirtualBoardError> {
        let report = self.end().map_err(|error| self.stopped(&error))?;
        self.told.extend(report.log);
        Ok(std::mem::take(&mut self.told).join("; "))
    }

    /// Switches it off.
    pub fn finish(mut self) -> Result<VirtualBoardReport, VirtualBoardError> {
        self.end().map_err(|error| self.stopped(&error))
    }

    fn read_sample(&mut self, mut shaft: Option<&mut dyn Shaft>) -> io::Result<Sample> {
        let mut turns = 0;
        loop {
            match (self.bytes()?, &mut shaft) {
                ([SAMPLE], _) => {
                    self.turns = turns;
                    return self.rest_of_sample();
                }
                ([PWM_PERIOD], Some(shaft)) => {
                    turns += 1;
                    self.turn(*shaft, turns)?;
                }
                _ => return Err(io::ErrorKind::InvalidData.into()),
            }
        }
    }

    /// A period of the modulation has ended, the one of this number in its sample. The servo reads the transfer before
    /// the last one's end; its reading fails if all since the reading before fail.
    fn turn(&mut self, shaft: &mut dyn Shaft, number: usize) -> io::Result<()> {
        let torque = f64::from_le_bytes(self.bytes()?);
        let seconds = f64::from_le_bytes(self.bytes()?);
        let ShaftMotion { count, angle, speed } = shaft.turn(torque, seconds);
        let count = self.rest.as_mut().map_or(count, |rest| rest.reads(count, number == 1));
        let turned = count.wrapping_sub(self.count);
        if !self.fails {
            self.before = self.count;
        }
        self.count = count;
        if number == self.turns {
            self.fails = shaft.reading_fails();
        }
        let input = self.input.as_mut().ok_or(io::ErrorKind::BrokenPipe)?;
        input.write_all(&turned.to_le_bytes())?;
        input.write_all(&angle.to_le_bytes())?;
        input.write_all(&speed.to_le_bytes())?;
        input.write_all(&[self.fails.into()])?;
        input.flush()
    }

    fn rest_of_sample(&mut self) -> io::Result<Sample> {
        let code = u16::from_le_bytes(self.bytes()?);
        let [amplifier] = self.bytes()?;
        let mut sent = vec![0; u16::from_le_bytes(self.bytes()?).into()];
        self.output.read_exact(&mut sent)?;
        for &byte in &sent {
            match self.decoder.push::<ToHost<String>>(byte) {
                Some(ToHost::Answer { outcome: Outcome::Refused(why), .. }) => {
                    self.told.push(why.to_string());
                }
                Some(ToHost::Status(Status { fault: Some(fault), .. })) => {
                    self.told.push(fault.to_string());
                }
                _ => {}
            }
        }
        Ok(Sample {
            code: (code != NO_CODE).then_some(code),
            amplifier: amplifier != 0,
            is_aligning: amplifier == ALIGNING,
            sent,
        })
    }

    fn write_answer(&mut self, turned: i32, bytes: &[u8]) -> io::Result<()> {
        let input = self.input.as_mut().ok_or(io::ErrorKind::BrokenPipe)?;
        let length = u16::try_from(bytes.len()).map_err(io::Error::other)?;
        input.write_all(&turned.to_le_bytes())?;
        input.write_all(&[self.fails.into()])?;
        input.write_all(&length.to_le_bytes())?;
        input.write_all(bytes)?;
        input.flush()
    }

    fn end(&mut self) -> io::Result<VirtualBoardReport> {
        self.input = None;
        loop {
            // Skips unread bytes.
            let length = match self.bytes()? {
                [END] => break,
                [PWM_PERIOD] => PWM_PERIOD_BYTES,
                // Code and amplifier follow its mark.
                _ => {
                    let [_, _, _, low, high] = self.bytes()?;
                    u16::from_le_bytes([low, high]).into()
                }
            };
            io::copy(&mut (&mut self.output).take(length), &mut io::sink())?;
        }
        let compute = Some(self.stats()?).filter(|stats| stats.count > 0);
        let interrupt = self.stats()?;
        let resets = u32::from_le_bytes(self.bytes()?);
        let log = io::BufRead::lines(&mut self.output).collect::<io::Result<_>>()?;
        Ok(VirtualBoardReport { compute, interrupt, resets, log })
    }

    fn stats(&mut self) -> io::Result<InstructionStats> {
        let mut number = || self.bytes().map(u64::from_le_bytes);
        let (count, min, max, sum) = (number()?, number()?, number()?, number()?);
        // With a count of 0 the mean is NaN.
        Ok(InstructionStats { count, min, max, mean: sum as f64 / count as f64 })
    }

    fn bytes<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.output.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    /// Why it has stopped: its message, or else the error seen here.
    fn stopped(&mut self, noticed: &io::Error) -> VirtualBoardError {
        self.input = None;
        let mut said = String::new();
        // The read ends with the process.
        if let Some(errors) = self.process.stderr.as_mut() {
            let _ = errors.read_to_string(&mut said);
        }
        let said = if said.trim().is_empty() { noticed.to_string() } else { said.trim().into() };
        VirtualBoardError::Stopped { said }
    }
}

impl Drop for VirtualBoard {
    fn drop(&mut self) {
        // Without its input it ends; it may have ended before.
        self.input = None;
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::current::Supply;

    use super::*;

    /// A supply sinks only if the drive says so.
    #[test]
    fn the_words_have_the_drive_s_supply() {
        let motor = Motor {
            winding: Winding::Brushed,
            resistance: 0.6,
            inductance: 1.2e-4,
            torque_constant: 0.29,
        };
        let supply = Supply::sinking(23.0, 25.0);
        let drive = Drive { motor, supply, bandwidth: 1e3, largest_temperature: 80.0 };
        assert_eq!(words(&drive), ["brushed", "0.6", "0.00012", "0.29", "24", "sinks"]);
        let regeneration = Regeneration::Stores { voltage: 23.5, capacitance: 0.01 };
        let drive = Drive { supply: Supply { regeneration, ..supply }, ..drive };
        assert_eq!(words(&drive)[4..], ["23.5", "0.01"]);
    }
}
