//! The host at standard input and output: messages of the board, and the replies.

use std::io::{self, BufWriter, Read, Stdin, Stdout, Write};

use virtual_board::device::Motion;

/// The kinds of messages to the host.
const SAMPLE: u8 = 1;
const PWM_PERIOD: u8 = 2;

/// An invalid code.
const NO_CODE: u16 = u16::MAX;

/// Whether the amplifier is on, or the driver of the bridge's gates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Nothing.
    Off = 0,
    /// The servo.
    On = 1,
    /// An alignment.
    Aligning = 2,
}

/// The host, and the bytes between it and the board's serial port.
pub struct HostLink {
    input: Stdin,
    output: BufWriter<Stdout>,
    /// Bytes for the serial port.
    pub to_board: Vec<u8>,
    /// Bytes that the serial port has sent.
    pub from_board: Vec<u8>,
    /// Set if the host has closed its end, or if communication failed.
    end: Option<io::Result<()>>,
    /// The last motion of the shaft.
    motion: Motion,
    /// Whether the encoder's transfers fail from now on.
    pub readings_fail: bool,
}

impl HostLink {
    /// A link to the process that has started this one.
    pub fn new() -> Self {
        Self {
            input: io::stdin(),
            output: BufWriter::new(io::stdout()),
            to_board: Vec::new(),
            from_board: Vec::new(),
            end: None,
            motion: Motion::default(),
            readings_fail: false,
        }
    }

    /// Reports a sample; returns the counts of the encoder.
    pub fn sample(&mut self, code: Option<u16>, drive: Drive) -> i32 {
        let exchanged = self.exchange_sample(code, drive);
        self.or_end(exchanged).unwrap_or(0)
    }

    /// Reports the mean torque in N m over a period of the modulation of `seconds`; returns the motion of the
    /// shaft at its end. The shaft stands still after the host has closed its end.
    pub fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        let exchanged = self.exchange_turn(torque, seconds);
        let standing = Motion { counts: 0, speed: 0.0, ..self.motion };
        self.motion = self.or_end(exchanged).unwrap_or(standing);
        self.motion
    }

    /// The reason, after the host is gone.
    pub fn end(&mut self) -> Option<io::Result<()>> {
        self.end.take()
    }

    /// The received value; `None` from the end on.
    fn or_end<T>(&mut self, exchanged: io::Result<T>) -> Option<T> {
        match exchanged {
            Ok(came) => Some(came),
            Err(error) => {
                let end = match error.kind() {
                    io::ErrorKind::UnexpectedEof => Ok(()),
                    _ => Err(error),
                };
                // A host that has closed its end does not read either.
                self.end.get_or_insert(end);
                None
            }
        }
    }

    fn exchange_sample(&mut self, code: Option<u16>, drive: Drive) -> io::Result<i32> {
        let sent = self.from_board.len().min(u16::MAX.into());
        let bytes: Vec<u8> = self.from_board.drain(..sent).collect();
        self.output.write_all(&[SAMPLE])?;
        self.output.write_all(&code.unwrap_or(NO_CODE).to_le_bytes())?;
        self.output.write_all(&[drive as u8])?;
        self.output.write_all(&(sent as u16).to_le_bytes())?;
        self.output.write_all(&bytes)?;
        self.output.flush()?;
        let turned = i32::from_le_bytes(self.bytes()?);
        self.readings_fail = self.bytes()? == [1];
        let mut bytes = vec![0; u16::from_le_bytes(self.bytes()?).into()];
        self.input.read_exact(&mut bytes)?;
        self.to_board.extend(bytes);
        Ok(turned)
    }

    fn exchange_turn(&mut self, torque: f64, seconds: f64) -> io::Result<Motion> {
        self.output.write_all(&[PWM_PERIOD])?;
        self.output.write_all(&torque.to_le_bytes())?;
        self.output.write_all(&seconds.to_le_bytes())?;
        self.output.flush()?;
        let counts = i32::from_le_bytes(self.bytes()?);
        let angle = f64::from_le_bytes(self.bytes()?);
        let speed = f64::from_le_bytes(self.bytes()?);
        self.readings_fail = self.bytes()? == [1];
        Ok(Motion { counts, angle, speed })
    }

    fn bytes<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.input.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}
