//! A board behind a port, and a simulated board. `haptic/board.py` makes mappings and arrays of them.

use std::ffi::CString;
use std::num::NonZeroU32;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;

use haptic_client::simulated::{self, Pacing, SimulatedBoardError};
use haptic_client::{
    Address, Link, LinkError, Request, RequestResult, StreamError, StreamTick, change,
};
use haptic_model::board::timing::stream_every;
use haptic_model::board::{Report, budget, formatting};
use haptic_model::file::Purpose;
use haptic_model::quantity::shortened;
use haptic_servo::servo_loop::State;
use haptic_servo::torque::LimitReason;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict};
use thiserror::Error;

use crate::refusal::Refusal;
use crate::source::Source;
use crate::{arrays, check_signals};

mod errors {
    pyo3::import_exception!(haptic.errors, ConnectError);
    pyo3::import_exception!(haptic.errors, LinkLostError);
    pyo3::import_exception!(haptic.errors, ParameterError);
    pyo3::import_exception!(haptic.errors, RefusedError);
    pyo3::import_exception!(haptic.errors, StreamError);
    pyo3::import_exception!(haptic.errors, VersionError);
}

/// The reason for which a board did not do something.
#[derive(Debug, Error)]
pub enum BoardFailure {
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(transparent)]
    Stream(#[from] StreamError),
    /// An invalid address.
    #[error("{0}")]
    Address(String),
    /// A parameter or its value.
    #[error("{0}")]
    Parameter(String),
    /// The board's reason.
    #[error("{0}")]
    Refused(String),
    #[error("the connection to the board is closed: connect again")]
    Closed,
    #[error(
        "a stream runs on this connection: its function gets the motion, and other calls have to wait until it \
         has ended"
    )]
    Streams,
    #[error(transparent)]
    Python(#[from] PyErr),
}

impl From<BoardFailure> for PyErr {
    fn from(failure: BoardFailure) -> Self {
        let sentence = failure.to_string();
        match failure {
            BoardFailure::Python(error) => error,
            BoardFailure::Link(error) | BoardFailure::Stream(StreamError::Link(error)) => {
                match error {
                    LinkError::Lost { .. } | LinkError::Unanswered { .. } => {
                        errors::LinkLostError::new_err(sentence)
                    }
                    LinkError::Protocol(_) => errors::VersionError::new_err(sentence),
                    _ => errors::ConnectError::new_err(sentence),
                }
            }
            BoardFailure::Stream(_) | BoardFailure::Streams => {
                errors::StreamError::new_err(sentence)
            }
            BoardFailure::Address(_) => errors::ConnectError::new_err(sentence),
            BoardFailure::Parameter(_) => errors::ParameterError::new_err(sentence),
            BoardFailure::Refused(_) => errors::RefusedError::new_err(sentence),
            BoardFailure::Closed => errors::LinkLostError::new_err(sentence),
        }
    }
}

/// The words of a servo's state, in the order of their codes.
pub fn states() -> Vec<&'static str> {
    State::ALL.map(State::as_str).to_vec()
}

/// The words of the reasons for a limited torque, in the order of their codes.
pub fn limits() -> Vec<&'static str> {
    LimitReason::ALL.map(LimitReason::as_str).to_vec()
}

/// A connection to a board, until it is closed.
#[pyclass(frozen)]
pub struct Connection {
    link: Mutex<Option<Link>>,
    /// Whether a stream has the link: it may never end, and its function may call the board.
    streams: AtomicBool,
}

impl Connection {
    /// Uses the link while other threads of Python run.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        of: impl FnOnce(&mut Link) -> Result<T, BoardFailure> + Send,
    ) -> Result<T, BoardFailure> {
        py.detach(|| of(self.lock()?.as_mut().ok_or(BoardFailure::Closed)?))
    }

    fn lock(&self) -> Result<MutexGuard<'_, Option<Link>>, BoardFailure> {
        // A link is valid after a panic, too.
        match self.link.try_lock() {
            Ok(link) => Ok(link),
            Err(TryLockError::Poisoned(link)) => Ok(link.into_inner()),
            Err(_) if self.streams.load(Ordering::Relaxed) => Err(BoardFailure::Streams),
            Err(_) => Ok(self.link.lock().unwrap_or_else(PoisonError::into_inner)),
        }
    }

    fn ask(&self, py: Python<'_>, request: Request) -> Result<(), BoardFailure> {
        self.with(py, |link| match link.request(request.clone())? {
            RequestResult::Done => Ok(()),
            RequestResult::Refused(why) => {
                Err(BoardFailure::Refused(format!("{}: {why}", request.words())))
            }
        })
    }
}

#[pymethods]
impl Connection {
    #[new]
    fn open(py: Python<'_>, port: &str) -> Result<Self, BoardFailure> {
        let address: Address = port.parse().map_err(BoardFailure::Address)?;
        let link = py.detach(|| Link::open(&address))?;
        Ok(Self { link: Mutex::new(Some(link)), streams: AtomicBool::new(false) })
    }

    fn close(&self, py: Python<'_>) -> Result<(), BoardFailure> {
        py.detach(|| {
            *self.lock()? = None;
            Ok(())
        })
    }

    /// Name of the program, and the period of its servo in s.
    fn identity(&self, py: Python<'_>) -> Result<(String, f64), BoardFailure> {
        self.with(py, |link| Ok((link.board().program.clone(), link.board().units.period)))
    }

    /// The object of `haptic tune --json`.
    fn status(&self, py: Python<'_>) -> Result<String, BoardFailure> {
        self.with(py, |link| {
            let (running, status) = (link.parameters()?, link.status()?);
            Ok(serde_json::json!(Report::of(link.board(), None, &running, &status)).to_string())
        })
    }

    fn parameters(&self, py: Python<'_>) -> Result<Vec<(&'static str, f64)>, BoardFailure> {
        self.with(py, |link| {
            let running = link.parameters()?;
            let named = |(parameter, value): &(_, f64)| (formatting::name(*parameter), *value);
            let budget = link.board().budget.map(budget::numbers).into_iter().flatten();
            Ok(running.values.iter().map(named).chain(budget).collect())
        })
    }

    /// Changes parameters, all or none.
    fn set(&self, py: Python<'_>, changes: Vec<(String, f64)>) -> Result<(), BoardFailure> {
        let known = self.parameters(py)?;
        let each = changes.into_iter().map(|(name, value)| {
            let found =
                change::Name::find(&name).filter(|_| known.iter().any(|(known, _)| *known == name));
            let Some(found) = found else {
                let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
                let names = names.join(", ");
                return Err(BoardFailure::Parameter(format!(
                    "there is no parameter `{name}` on this board; its parameters are {names}"
                )));
            };
            if !value.is_finite() {
                return Err(BoardFailure::Parameter(format!(
                    "`{name}` = {value} is out of bounds; it must be a finite number"
                )));
            }
            Ok((found, value))
        });
        let changes = each.collect::<Result<Vec<_>, _>>()?;
        let request = change::collect(&changes)
            .map_err(|error| BoardFailure::Parameter(error.to_string()))?;
        self.ask(py, request)
    }

    fn arm(&self, py: Python<'_>) -> Result<(), BoardFailure> {
        self.ask(py, Request::Arm)
    }

    fn disarm(&self, py: Python<'_>) -> Result<(), BoardFailure> {
        self.ask(py, Request::Disarm)
    }

    fn align(&self, py: Python<'_>) -> Result<(), BoardFailure> {
        self.ask(py, Request::Align)
    }

    /// Columns of one of so many ticks; `every` is 0 for as many as a serial line carries.
    fn telemetry<'py>(
        &self,
        py: Python<'py>,
        seconds: f64,
        every: u32,
    ) -> Result<Bound<'py, PyDict>, BoardFailure> {
        let duration = Duration::try_from_secs_f64(seconds).map_err(|_| {
            let bound = "it must be a number of seconds from 0";
            BoardFailure::Parameter(format!("`seconds` = {seconds} is out of bounds; {bound}"))
        })?;
        let samples = self.with(py, |link| {
            let (mut samples, mut signal) = (Vec::new(), Ok(()));
            let default = stream_every(link.board().units.period);
            let every = NonZeroU32::new(every).unwrap_or(default);
            link.telemetry(duration, every, |sample| {
                samples.push(*sample);
                signal = check_signals();
                signal.is_ok()
            })?;
            signal?;
            Ok(samples)
        })?;
        let columns = Columns { py, rows: &samples, columns: PyDict::new(py) };
        columns.numbers("tick", |sample| sample.tick as f64)?;
        columns.numbers("time", |sample| sample.time)?;
        columns.numbers("position", |sample| sample.position)?;
        columns.numbers("torque", |sample| sample.torque)?;
        columns.numbers("slack", |sample| sample.slack)?;
        columns.codes("state", |sample| sample.state as u8)?;
        columns.codes("limit", |sample| sample.limit as u8)?;
        Ok(columns.columns)
    }

    /// Streams the torques that a function returns for position, velocity and time. Returns columns of what became
    /// of them, or none of a stream without an end.
    fn stream<'py>(
        &self,
        py: Python<'py>,
        function: Py<PyAny>,
        rate: f64,
        duration: f64,
        smooth: bool,
    ) -> Result<Bound<'py, PyDict>, BoardFailure> {
        let most = self.with(py, |link| {
            Ok(link.board().budget.map_or(f64::INFINITY, |budget| budget.torque))
        })?;
        let (mut ticks, mut is_told) = (Vec::new(), [false; 2]);
        let torque = |tick: &StreamTick| {
            if tick.time >= duration {
                return Ok(None);
            }
            if duration.is_finite() {
                ticks.push(*tick);
            }
            Python::attach(|py| {
                py.check_signals()?;
                let returned = function.call1(py, (tick.position, tick.velocity, tick.time))?;
                let torque = returned.extract::<f64>(py).map_err(|_| {
                    let (returned, time) = (shortened(&returned.to_string(), 60), tick.time);
                    errors::StreamError::new_err(format!(
                        "the function returned {returned} at {time} s; it must be a torque in N m. The \
                         torque is switched off"
                    ))
                })?;
                warn_of(py, tick, (torque, most), &mut is_told)?;
                Ok(Some(torque))
            })
        };
        self.with(py, |link| {
            self.streams.store(true, Ordering::Relaxed);
            let streamed = link.stream(rate, smooth, torque);
            self.streams.store(false, Ordering::Relaxed);
            streamed
        })?;
        let columns = Columns { py, rows: &ticks, columns: PyDict::new(py) };
        columns.numbers("time", |tick| tick.time)?;
        columns.numbers("position", |tick| tick.position)?;
        columns.numbers("velocity", |tick| tick.velocity)?;
        columns.numbers("torque", |tick| tick.torque)?;
        columns.numbers("refused", |tick| tick.refused)?;
        columns.numbers("energy", |tick| tick.energy)?;
        columns.codes("limit", |tick| tick.limit as u8)?;
        columns.codes("state", |tick| tick.state as u8)?;
        Ok(columns.columns)
    }
}

/// Warns once in a stream of a servo that gives no torque, and once of a torque in N m that is above the host's.
fn warn_of(
    py: Python<'_>,
    tick: &StreamTick,
    (torque, most): (f64, f64),
    [is_idle, is_clipped]: &mut [bool; 2],
) -> PyResult<()> {
    let warn = |sentence: String| {
        let category = py.get_type::<PyUserWarning>();
        PyErr::warn(py, &category, &CString::new(sentence)?, 2)
    };
    let (time, state) = (tick.time, tick.state);
    if !state.is_armed() && !core::mem::replace(is_idle, true) {
        warn(format!(
            "the board is {state} at {time} s of the stream and gives none of its torques: arm it before, with \
             arm()"
        ))?;
    }
    if torque.is_finite() && torque.abs() > most && !core::mem::replace(is_clipped, true) {
        warn(format!(
            "the function returned a torque of {torque} N m at {time} s; the board gives at most the \
             {most} N m of host.torque and refuses the rest"
        ))?;
    }
    Ok(())
}

/// Rows as columns for NumPy.
struct Columns<'py, 'r, T> {
    py: Python<'py>,
    rows: &'r [T],
    columns: Bound<'py, PyDict>,
}

impl<T> Columns<'_, '_, T> {
    fn numbers(&self, name: &str, of: fn(&T) -> f64) -> PyResult<()> {
        let numbers: Vec<f64> = self.rows.iter().map(of).collect();
        self.columns.set_item(name, arrays::to_python(self.py, &numbers)?)
    }

    fn codes(&self, name: &str, of: fn(&T) -> u8) -> PyResult<()> {
        let codes: Vec<u8> = self.rows.iter().map(of).collect();
        self.columns.set_item(name, PyByteArray::new(self.py, &codes))
    }
}

/// A simulated board, until it is closed.
#[pyclass(frozen)]
pub struct Simulated {
    board: Mutex<Option<simulated::SimulatedBoard>>,
    #[pyo3(get)]
    port: String,
}

#[pymethods]
impl Simulated {
    #[new]
    fn start(py: Python<'_>, scene: Source) -> Result<Self, Refusal> {
        py.detach(|| {
            let file = scene.read(Purpose::Simulate)?;
            let address = Address::Tcp("127.0.0.1:0".to_owned());
            let board = simulated::SimulatedBoard::of_file(&file, &address, Pacing::RealTime)
                .map_err(|error: SimulatedBoardError| {
                    Refusal::Scene(format!("{}: {error}", file.name))
                })?;
            let port = board.address().to_string();
            Ok(Self { board: Mutex::new(Some(board)), port })
        })
    }

    fn close(&self, py: Python<'_>) {
        py.detach(|| *self.board.lock().unwrap_or_else(PoisonError::into_inner) = None);
    }
}
