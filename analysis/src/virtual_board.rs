//! A program that is flashed, unmodified, on a virtual board: a process of its own, in lockstep with
//! this one.
//!
//! The board is the package `virtual-board`, which says how it is talked to; it is built when it is
//! first wanted. What it links with is under a licence of its own, so nothing here links with it.

use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use firmware::dac::DacCode;
use firmware::servo::RenderingOptions;
use firmware::wire::message::{LONGEST_TO_BOARD, ToBoard};
use firmware::wire::{encode, largest_frame};

use crate::emulator::InstructionStats;
use crate::emulator::log::LogDecoder;
use crate::lockstep::RemoteServo;
use crate::toolchain::Board;

/// What a board says at the end of a sample, and when it is asked to end.
const SAMPLE: u8 = 1;
const END: u8 = 0;
/// A code that is none.
const NO_CODE: u16 = u16::MAX;
/// Samples within which a servo that was asked to arm must have done so: many times what a frame and
/// what the board may be at take.
const LONGEST_ARMING: usize = 10_000;

/// Why a virtual board does not do what it should.
#[derive(Debug, thiserror::Error)]
pub enum VirtualBoardError {
    /// It could not be started.
    #[error("the virtual board could not be started: {0}")]
    Start(#[source] io::Error),
    /// It has ended before it was asked to.
    #[error("the virtual board has stopped: {said}")]
    Stopped {
        /// What it said.
        said: String,
    },
    /// Its servo was asked to arm, and did not switch the amplifier on.
    #[error(
        "the virtual board's amplifier has stayed off for {LONGEST_ARMING} samples; its log: {log}"
    )]
    NotArmed {
        /// What it logged.
        log: String,
    },
}

/// A sample that has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The DAC's code in it; none while nothing drives its pin.
    pub code: Option<u16>,
    /// Whether the amplifier was on.
    pub amplifier: bool,
    /// What the serial port has sent.
    pub sent: Vec<u8>,
}

impl Sample {
    /// The code that acts on the motor: that of no torque while the amplifier is off or no code drives
    /// its input.
    pub fn applied_code(&self) -> u16 {
        self.code.filter(|_| self.amplifier).unwrap_or(DacCode::MID_SCALE.get())
    }
}

/// What a run gave.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualBoardReport {
    /// Instructions from reading the count to writing the code.
    pub compute: InstructionStats,
    /// Instructions of the servo's whole interrupt.
    pub interrupt: InstructionStats,
    /// Times that the board was reset.
    pub resets: u32,
    /// Lines of the log.
    pub log: Vec<String>,
}

/// A running board.
pub struct VirtualBoard {
    process: Child,
    input: Option<BufWriter<ChildStdin>>,
    output: BufReader<ChildStdout>,
    decoder: LogDecoder,
    /// The encoder's position in counts, as the world has it.
    count: i32,
}

impl VirtualBoard {
    /// Switches one on: the `program` that is a virtual board, as this `board`, with the ELF in its
    /// flash. It stands still until the first [`Self::sample`].
    ///
    /// # Errors
    /// Where it cannot be started.
    pub fn boot(program: &Path, board: Board, elf: &Path) -> Result<Self, VirtualBoardError> {
        let decoder =
            LogDecoder::of_program(&std::fs::read(elf).map_err(VirtualBoardError::Start)?);
        let mut process = Command::new(program)
            .arg(board.name())
            .arg(elf)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(VirtualBoardError::Start)?;
        let missing = || VirtualBoardError::Start(io::ErrorKind::BrokenPipe.into());
        let input = process.stdin.take().ok_or_else(missing)?;
        let output = process.stdout.take().ok_or_else(missing)?;
        let (input, output) = (Some(BufWriter::new(input)), BufReader::new(output));
        Ok(Self { process, input, output, decoder, count: 0 })
    }

    /// Waits for the end of the sample that runs.
    ///
    /// # Errors
    /// Where the board has stopped.
    pub fn sample(&mut self) -> Result<Sample, VirtualBoardError> {
        self.read_sample().map_err(|error| self.stopped(&error))
    }

    /// What comes of a sample: the position that the encoder has turned to in it, and bytes to the
    /// serial port. The next sample begins.
    ///
    /// # Errors
    /// Where the board has stopped.
    pub fn answer(&mut self, count: i32, bytes: &[u8]) -> Result<(), VirtualBoardError> {
        let turned = count.wrapping_sub(self.count);
        self.count = count;
        self.write_answer(turned, bytes).map_err(|error| self.stopped(&error))
    }

    /// Has the servo armed over the serial port, and runs until the clamp of a servo with this period in s has opened. The
    /// device stands still meanwhile.
    ///
    /// # Errors
    /// Where the board stops, or its servo is not armed.
    pub fn arm_and_wait(&mut self, period: f64) -> Result<(), VirtualBoardError> {
        let mut buffer = [0; largest_frame(LONGEST_TO_BOARD)];
        // A request is a few bytes; the buffer has room for the longest.
        let arm = encode(&ToBoard::Arm { id: 0 }, &mut buffer).unwrap_or_default();
        for sample in 0..LONGEST_ARMING {
            let on = self.sample()?.amplifier;
            self.answer(self.count, if sample == 0 { arm } else { &[] })?;
            if on {
                // Rounded up, and two for the ticks in which it begins and ends.
                let fading = (RenderingOptions::DEFAULT.fade / period).ceil() as usize + 2;
                return self.hold_still(fading);
            }
        }
        let log = self.end().map_err(|error| self.stopped(&error))?.log.join("; ");
        Err(VirtualBoardError::NotArmed { log })
    }

    /// So many samples in which the device stands still; then the board waits for the first count.
    fn hold_still(&mut self, samples: usize) -> Result<(), VirtualBoardError> {
        for _ in 1..samples {
            self.sample()?;
            self.answer(self.count, &[])?;
        }
        self.sample().map(drop)
    }

    /// Switches it off.
    ///
    /// # Errors
    /// Where it has stopped before.
    pub fn finish(mut self) -> Result<VirtualBoardReport, VirtualBoardError> {
        self.end().map_err(|error| self.stopped(&error))
    }

    fn read_sample(&mut self) -> io::Result<Sample> {
        if self.bytes::<1>()? != [SAMPLE] {
            return Err(io::ErrorKind::InvalidData.into());
        }
        let code = u16::from_le_bytes(self.bytes()?);
        let [amplifier] = self.bytes()?;
        let mut sent = vec![0; u16::from_le_bytes(self.bytes()?).into()];
        self.output.read_exact(&mut sent)?;
        Ok(Sample { code: (code != NO_CODE).then_some(code), amplifier: amplifier != 0, sent })
    }

    fn write_answer(&mut self, turned: i32, bytes: &[u8]) -> io::Result<()> {
        let input = self.input.as_mut().ok_or(io::ErrorKind::BrokenPipe)?;
        let length = u16::try_from(bytes.len()).map_err(io::Error::other)?;
        input.write_all(&turned.to_le_bytes())?;
        input.write_all(&length.to_le_bytes())?;
        input.write_all(bytes)?;
        input.flush()
    }

    fn end(&mut self) -> io::Result<VirtualBoardReport> {
        self.input = None;
        while self.bytes::<1>()? != [END] {
            // Skips an unread sample: code and amplifier follow its mark.
            let [_, _, _, low, high] = self.bytes()?;
            let length = u16::from_le_bytes([low, high]).into();
            io::copy(&mut (&mut self.output).take(length), &mut io::sink())?;
        }
        let compute = self.stats()?;
        let interrupt = self.stats()?;
        let resets = u32::from_le_bytes(self.bytes()?);
        let mut log = Vec::new();
        self.output.read_to_end(&mut log)?;
        Ok(VirtualBoardReport { compute, interrupt, resets, log: self.decoder.decode(&log) })
    }

    fn stats(&mut self) -> io::Result<InstructionStats> {
        let mut number = || self.bytes().map(u64::from_le_bytes);
        let (count, min, max, sum) = (number()?, number()?, number()?, number()?);
        // A mean over nothing is none, and its neighbours say so.
        Ok(InstructionStats { count, min, max, mean: sum as f64 / count as f64 })
    }

    fn bytes<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.output.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    /// Why it has stopped: what it said, or else what was noticed of it here.
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

/// The board waits for a count, holds what it had computed before, and that sample's code is the
/// answer.
impl RemoteServo for VirtualBoard {
    type Error = VirtualBoardError;

    fn exchange(&mut self, raw: i32) -> Result<u16, VirtualBoardError> {
        self.answer(raw, &[])?;
        Ok(self.sample()?.applied_code())
    }
}
