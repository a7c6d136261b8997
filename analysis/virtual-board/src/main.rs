//! A virtual board for another program: `virtual-board BOARD PROGRAM.elf`, in lockstep with the
//! process at standard input and output.
//!
//! All numbers have their lowest byte first. At the end of each sample the board writes what the
//! sample was, and waits for what comes of it:
//!
//! | board | bytes | | world | bytes |
//! |---|---|---|---|---|
//! | 1 | 1 | | counts that the encoder turned by | 4 |
//! | code of the DAC, 65535 for none | 2 | | length of what follows | 2 |
//! | whether the amplifier is on | 1 | | bytes for the serial port | |
//! | length of what follows | 2 | | | |
//! | bytes that the serial port sent | | | | |
//!
//! Once the input ends, the board writes a 0, then how many there were and the least, the most and
//! the sum of the instructions from count to code and of the servo's whole interrupt (8 bytes each),
//! then the number of resets (4), and the rest is the log as defmt has encoded it.
//!
//! A board that cannot go on writes why to its standard error, and ends with a failure.

use std::io::{self, BufWriter, Read, Stdin, Stdout, Write};
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};

use virtual_board::chip::Chip;
use virtual_board::device::Device;
use virtual_board::machine::Machine;
use virtual_board::meter::InstructionStats;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Bytes on their way between the host and the board's serial port.
#[derive(Default)]
struct SerialQueues {
    to_board: Vec<u8>,
    from_board: Vec<u8>,
    /// The host has closed its end, or why it cannot be read.
    end: Option<io::Result<()>>,
}

/// The plant, which the host simulates at the standard input and output.
struct HostPlant {
    input: Stdin,
    output: BufWriter<Stdout>,
    serial: Arc<Mutex<SerialQueues>>,
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [board, elf] = arguments.as_slice() else {
        return Err("usage: virtual-board BOARD PROGRAM.elf".into());
    };
    let Some(chip) = Chip::find(board) else {
        let names = Chip::BOARDS.map(|chip| chip.name).join(", ");
        return Err(format!("there is no virtual board {board}; there are {names}").into());
    };
    let serial = Arc::<Mutex<SerialQueues>>::default();
    let plant = HostPlant {
        input: io::stdin(),
        output: BufWriter::new(io::stdout()),
        serial: serial.clone(),
    };
    let mut machine = Machine::boot(elf.as_ref(), chip, Box::new(plant))?;
    while step(&mut machine, &serial)?.is_none() {}
    Ok(report(&mut machine)?)
}

/// A sample, with what comes and goes over the serial port; says when the host has closed its end.
fn step(
    machine: &mut Machine,
    serial: &Mutex<SerialQueues>,
) -> Result<Option<()>, Box<dyn std::error::Error>> {
    machine.run_samples(1)?;
    let board = machine.board_mut();
    let mut serial = serial.lock().unwrap_or_else(PoisonError::into_inner);
    board.send(&std::mem::take(&mut serial.to_board));
    serial.from_board.extend(board.serial.take_sent());
    Ok(serial.end.take().transpose()?)
}

/// What was measured, to the standard output.
fn report(machine: &mut Machine) -> io::Result<()> {
    let mut output = BufWriter::new(io::stdout());
    output.write_all(&[0])?;
    let meter = &machine.board().meter;
    for stats in [meter.compute(), meter.interrupt()] {
        let InstructionStats { count, least, most, sum } = stats;
        for number in [count, least, most, sum] {
            output.write_all(&number.to_le_bytes())?;
        }
    }
    let resets = u32::try_from(machine.resets().len()).unwrap_or(u32::MAX);
    output.write_all(&resets.to_le_bytes())?;
    output.write_all(machine.log())?;
    output.flush()
}

impl HostPlant {
    fn exchange(&mut self, code: Option<u16>, amplifier: bool) -> io::Result<i32> {
        let mut serial = self.serial.lock().unwrap_or_else(PoisonError::into_inner);
        let sent = serial.from_board.len().min(u16::MAX.into());
        let bytes: Vec<u8> = serial.from_board.drain(..sent).collect();
        self.output.write_all(&[1])?;
        self.output.write_all(&code.unwrap_or(u16::MAX).to_le_bytes())?;
        self.output.write_all(&[amplifier.into()])?;
        self.output.write_all(&(sent as u16).to_le_bytes())?;
        self.output.write_all(&bytes)?;
        self.output.flush()?;
        let mut turned = [0; 4];
        self.input.read_exact(&mut turned)?;
        let mut length = [0; 2];
        self.input.read_exact(&mut length)?;
        let mut bytes = vec![0; u16::from_le_bytes(length).into()];
        self.input.read_exact(&mut bytes)?;
        serial.to_board.extend(bytes);
        Ok(i32::from_le_bytes(turned))
    }
}

impl Device for HostPlant {
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32 {
        match self.exchange(code, amplifier) {
            Ok(turned) => turned,
            Err(error) => {
                let end = match error.kind() {
                    io::ErrorKind::UnexpectedEof => Ok(()),
                    _ => Err(error),
                };
                self.serial.lock().unwrap_or_else(PoisonError::into_inner).end = Some(end);
                0
            }
        }
    }
}
