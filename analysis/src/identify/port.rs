//! A sweep that a board plays to a real device, recorded over the board's serial port.

use std::io;
use std::time::{Duration, Instant};

use haptic_servo::current::TorqueSource;
use haptic_servo::excitation::{SILENCE, SWEEP_PROTOCOL, SweepEnd};
use haptic_servo::wire::sweep::SweepRequest;
use thiserror::Error;

use super::record::Recorder;
use super::torque_source;
use crate::link::{Address, LinkError, Transport, open, read_within};

/// Timeout for a board's description, and between rows.
const TIMEOUT: Duration = Duration::from_secs(2);
/// Timeout for the first row of a board's own bridge, which first aligns a brushless motor.
const ALIGNMENT: Duration = Duration::from_secs(12);
/// Time between two keep-alives of the host; the board waits five times as long.
const LISTENING: Duration = Duration::from_millis((SILENCE * 200.0) as u64);
/// Time in which a board whose sweep still ran falls silent.
const SETTLE: Duration = Duration::from_millis(200);
/// Longest line in bytes: the description of a bridge has less than half of it.
const LONGEST_LINE: usize = 512;
/// Limit of travel in rad above which a sweep is of slow turns: a handle that drifts needs three turns.
const TURNING: f64 = 100.0;
const HEADING: &str = "time,torque,counts";

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Description {
    /// Sampling period in s.
    pub period: f64,
    /// Encoder counts in one turn.
    pub counts_per_turn: f64,
    /// Rows of the whole record.
    pub ticks: u64,
    /// The limit of travel in rad.
    pub travel: f64,
    /// The limit of speed in rad/s.
    pub speed: f64,
    /// The current loop of a board whose own bridge drives the motor.
    pub source: Option<TorqueSource>,
}

/// The record that a board has sent.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    pub description: Description,
    pub text: String,
    pub rows: u64,
    pub end: SweepEnd,
}

/// Why there is no record.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum PortError {
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(
        "no board with the program `identify` answers on {address} within {} s: flash it (cargo \
         haptic flash identify --device FILE.toml --board BOARD), and check the port and its speed",
        TIMEOUT.as_secs()
    )]
    Silent { address: Address },
    #[error(
        "the board on {address} describes its sweep as `{line}`, which is not version \
         {SWEEP_PROTOCOL} of the sweep protocol: flash `identify` again"
    )]
    Protocol { address: Address, line: String },
    #[error(
        "the board on {address} has sent nothing for {} s after {rows} of {ticks} rows: check its \
         cable and its power; its watchdog or its own limit of {SILENCE} s has stopped the motor",
        .timeout.as_secs()
    )]
    Lost { address: Address, rows: u64, ticks: u64, timeout: Duration },
    #[error(
        "the board on {address} has sent more than the {ticks} rows of its sweep: check that no \
         other program has the port open, and flash `identify` again"
    )]
    TooLong { address: Address, ticks: u64 },
    #[error("the sweep ended with `{}` after {rows} of {ticks} rows: {}", .end.as_str(), remedy(*.end, .travel, .speed))]
    Ended { end: SweepEnd, rows: u64, ticks: u64, travel: f64, speed: f64 },
    #[error(
        "the board on {address} runs the program `{runs}`, which {}: flash `{needed}`, or {} --turns",
        if *.needed == "turns" { "makes no whole turns" } else { "turns slowly, and plays no fast sines" },
        if *.needed == "turns" { "leave out" } else { "add" }
    )]
    Program { address: Address, runs: &'static str, needed: &'static str },
    #[error("the board ended the sweep with the unknown word `{word}`: flash `identify` again")]
    Word { word: String },
}

/// The cause of a sweep's end, and its remedy.
fn remedy(end: SweepEnd, travel: &f64, speed: &f64) -> String {
    match end {
        SweepEnd::Done => "nothing is wrong".to_owned(),
        SweepEnd::Stopped => "another program that has the port open stopped it".to_owned(),
        SweepEnd::Silent => format!(
            "the board received nothing from this computer for {SILENCE} s: check the cable, and \
             close other programs that have the port open"
        ),
        SweepEnd::MissedTick => {
            "the board missed a tick or was late, so a torque was held for too long: run it \
             without a debugger, and report it if it happens again"
                .to_owned()
        }
        SweepEnd::LostRow => {
            "the connection to this computer was too slow for the rows: connect the board without \
             a hub, and end other programs that load this computer"
                .to_owned()
        }
        SweepEnd::Travel => format!(
            "the device moved by more than {travel} rad from its start. If it drifts to one side, \
             trim the amplifier's offset; if it swings too far, lower the amplitudes of the lowest \
             tones, or raise LIMITS.travel (firmware/src/bin/identify.rs) if the device has room"
        ),
        SweepEnd::Speed => format!(
            "the device was faster than {speed} rad/s: lower the amplitudes, or raise LIMITS.speed \
             (firmware/src/bin/identify.rs) if the device may be faster"
        ),
        SweepEnd::Jump => "the encoder jumped by more than the device can move: check its cable, \
                           its supply and counts_per_turn"
            .to_owned(),
        SweepEnd::OutputFault => {
            "the board's own bridge took the torque away: wrong current, supply or temperature, or \
             a brushless motor that was not aligned. Flash a scene's program with the same motor, \
             align it and arm it: `haptic tune` then says which fault it was, and \
             firmware/TROUBLESHOOTING.md what to do"
                .to_owned()
        }
    }
}

impl Recording {
    /// The record, if it is whole.
    pub fn check_complete(&self) -> Result<(), PortError> {
        let Description { ticks, travel, speed, .. } = self.description;
        let end = match self.end {
            SweepEnd::Done if self.rows == ticks => return Ok(()),
            SweepEnd::Done => SweepEnd::LostRow,
            end => end,
        };
        Err(PortError::Ended { end, rows: self.rows, ticks, travel, speed })
    }
}

/// A board whose sweep has not begun.
pub struct SweepPort {
    address: Address,
    transport: Box<dyn Transport>,
    /// Bytes of an incomplete line.
    rest: Vec<u8>,
    /// When the last request was sent.
    told: Instant,
    description: Description,
}

impl SweepPort {
    /// Connects, ends a sweep that may still run, and requests the description.
    pub fn open(address: &Address) -> Result<Self, PortError> {
        let transport =
            open(address).map_err(|source| LinkError::Open { address: address.clone(), source })?;
        let (address, rest, description) = (address.clone(), Vec::new(), Description::default());
        let mut player = Self { address, transport, rest, told: Instant::now(), description };
        match player.begin() {
            Ok(()) => Ok(player),
            Err(PortError::Link(error)) => Err(error.before_an_answer().into()),
            Err(error) => Err(error),
        }
    }

    fn begin(&mut self) -> Result<(), PortError> {
        self.send(&SweepRequest::Stop)?;
        let settled = Instant::now() + SETTLE;
        while self.line(settled)?.is_some() {}
        self.rest.clear();
        self.ask()
    }

    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Refuses a board with the other of two sweeps, by how far it lets the device turn.
    pub fn check_program(&self, turns: bool) -> Result<(), PortError> {
        const PROGRAMS: [&str; 2] = ["identify", "turns"];
        let makes_turns = self.description.travel > TURNING;
        if makes_turns == turns {
            return Ok(());
        }
        let [runs, needed] = [makes_turns, turns].map(|is_turns| PROGRAMS[usize::from(is_turns)]);
        Err(PortError::Program { address: self.address.clone(), runs, needed })
    }

    fn ask(&mut self) -> Result<(), PortError> {
        let end = Instant::now() + TIMEOUT;
        while Instant::now() < end {
            self.send(&SweepRequest::Describe)?;
            let again = Instant::now() + TIMEOUT / 8;
            while let Some(line) = self.line(again)? {
                if let Some(fields) = line.strip_prefix("identify,") {
                    self.description = describe(fields).ok_or_else(|| PortError::Protocol {
                        address: self.address.clone(),
                        line: line.clone(),
                    })?;
                    return Ok(());
                }
            }
        }
        Err(PortError::Silent { address: self.address.clone() })
    }

    /// Begins the sweep and takes its record, each row at once into the recorder. Calls `progress` on each row.
    ///
    /// The board ends the sweep by itself once this process is gone.
    pub fn record(
        mut self,
        recorder: &mut Recorder<'_>,
        mut progress: impl FnMut(),
    ) -> Result<Recording, PortError> {
        self.send(&SweepRequest::BEGIN)?;
        let (mut text, mut rows) = (String::new(), 0);
        let ticks = self.description.ticks;
        loop {
            let aligns = rows == 0 && self.description.source.is_some();
            let timeout = if aligns { ALIGNMENT } else { TIMEOUT };
            let Some(line) = self.line(Instant::now() + timeout)? else {
                return Err(PortError::Lost { address: self.address, rows, ticks, timeout });
            };
            if let Some(fields) = line.strip_prefix("end,") {
                let word = fields.split(',').next().unwrap_or_default();
                let end = SweepEnd::find(word)
                    .ok_or_else(|| PortError::Word { word: word.to_owned() })?;
                return Ok(Recording { description: self.description, text, rows, end });
            }
            // Lines before the heading were sent before the sweep began.
            if line == HEADING {
                (text, rows) = (String::new(), 0);
                recorder.begin(&line);
            } else if text.is_empty() {
                continue;
            } else if rows == ticks {
                let address = self.address.clone();
                return Err(PortError::TooLong { address, ticks });
            } else {
                rows += 1;
                recorder.row(&line);
                progress();
            }
            text.push_str(&line);
            text.push('\n');
        }
    }

    fn send(&mut self, request: &SweepRequest) -> Result<(), PortError> {
        self.told = Instant::now();
        let frame = request.frame();
        let sent = self.transport.write_all(&frame).and_then(|()| self.transport.flush());
        sent.map_err(|source| self.lost(source))
    }

    /// The next line; `None` if there is none before the time is up.
    fn line(&mut self, until: Instant) -> Result<Option<String>, PortError> {
        loop {
            if let Some(line) = first_line(&mut self.rest) {
                return Ok(Some(line));
            }
            if self.told.elapsed() >= LISTENING {
                self.send(&SweepRequest::Listening)?;
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(None);
            }
            // No operating system takes a timeout of zero.
            let wait = left.clamp(Duration::from_millis(1), LISTENING);
            let mut bytes = [0; 4096];
            let read = read_within(self.transport.as_mut(), &mut bytes, wait);
            let count = read.map_err(|source| self.lost(source))?;
            self.rest.extend_from_slice(&bytes[..count]);
        }
    }

    fn lost(&self, source: io::Error) -> PortError {
        LinkError::Lost { address: self.address.clone(), source }.into()
    }
}

/// Takes the first line out of some bytes. Noise without an end of a line is not kept.
fn first_line(bytes: &mut Vec<u8>) -> Option<String> {
    let Some(end) = bytes.iter().position(|&byte| byte == b'\n') else {
        if bytes.len() > LONGEST_LINE {
            bytes.clear();
        }
        return None;
    };
    let line: Vec<u8> = bytes.drain(..=end).collect();
    Some(String::from_utf8_lossy(&line).trim_end().to_owned())
}

/// `PROTOCOL,period,counts per turn,ticks,travel,speed`, and of a bridge the numbers of its current loop.
fn describe(fields: &str) -> Option<Description> {
    let fields: Vec<&str> = fields.splitn(7, ',').collect();
    let [protocol, period, counts, ticks, travel, speed, rest @ ..] = fields.as_slice() else {
        return None;
    };
    let source = match rest.first() {
        Some(numbers) => Some(torque_source::parse(numbers)?),
        None => None,
    };
    let positive =
        |text: &str| text.parse().ok().filter(|value: &f64| *value > 0.0 && value.is_finite());
    (protocol.parse() == Ok(SWEEP_PROTOCOL)).then_some(())?;
    Some(Description {
        period: positive(period)?,
        counts_per_turn: positive(counts)?,
        ticks: ticks.parse().ok()?,
        travel: positive(travel)?,
        speed: positive(speed)?,
        source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_without_an_end_is_not_kept() {
        let mut bytes = vec![b'x'; LONGEST_LINE + 1];
        assert_eq!((first_line(&mut bytes), bytes.len()), (None, 0));
        bytes.extend(b"a line\r\nrest");
        assert_eq!(first_line(&mut bytes).as_deref(), Some("a line"));
        assert_eq!((first_line(&mut bytes), bytes.as_slice()), (None, &b"rest"[..]));
    }

    #[test]
    fn a_board_that_another_program_has_is_in_use() {
        let held = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = Address::Tcp(held.local_addr().expect("a port").to_string());
        std::thread::spawn(move || held.incoming().for_each(drop));
        let error = SweepPort::open(&address).err();
        let in_use = matches!(error, Some(PortError::Link(LinkError::InUse { .. })));
        assert!(in_use, "{error:?}");
    }

    #[test]
    fn a_description_of_another_version_or_shape_is_none() {
        assert!(describe("3,0.001,61440,52500,0.7,85").is_some_and(|it| it.source.is_none()));
        let bridge =
            "3,0.001,61440,52500,0.7,85,0.0841,0.6,0.00012,0.25,0.000025,0.00253,0.00427,0.115";
        assert!(describe(bridge).is_some_and(|it| it.source.is_some()));
        for wrong in [
            "2,0.001,61440,52500,0.7,85",
            "3,0.001,61440",
            "3,0,61440,52500,0.7,85",
            "3,0.001,61440,52500,0.7,85,",
            "3,0.001,61440,52500,0.7,85,0.0841",
            "",
        ] {
            assert_eq!(describe(wrong), None, "{wrong}");
        }
    }
}
