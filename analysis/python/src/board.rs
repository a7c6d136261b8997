//! A board behind a port, and a simulated board. `haptic/board.py` makes mappings and arrays of them.

use std::num::NonZeroU32;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use haptic_client::simulated::{self, Pacing, SimulatedBoardError};
use haptic_client::{
    Address, Link, LinkError, Request, RequestResult, StreamError, StreamTick, change,
};
use haptic_model::board::sample::Sample;
use haptic_model::board::timing::stream_every;
use haptic_model::board::{Report, budget, formatting};
use haptic_model::file::Purpose;
use haptic_servo::servo_loop::State;
use haptic_servo::torque::LimitReason;
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
            BoardFailure::Stream(_) => errors::StreamError::new_err(sentence),
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
pub struct Connection(Mutex<Option<Link>>);

impl Connection {
    /// Uses the link while other threads of Python run.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        of: impl FnOnce(&mut Link) -> Result<T, BoardFailure> + Send,
    ) -> Result<T, BoardFailure> {
        py.detach(|| {
            // A link is valid after a panic, too.
            let mut link = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            of(link.as_mut().ok_or(BoardFailure::Closed)?)
        })
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
        Ok(Self(Mutex::new(Some(link))))
    }

    fn close(&self, py: Python<'_>) {
        py.detach(|| *self.0.lock().unwrap_or_else(PoisonError::into_inner) = None);
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
        let columns = PyDict::new(py);
        let number = |name, of: fn(&Sample) -> f64| {
            let numbers: Vec<f64> = samples.iter().map(of).collect();
            columns.set_item(name, arrays::to_python(py, &numbers)?)
        };
        number("tick", |sample| sample.tick as f64)?;
        number("time", |sample| sample.time)?;
        number("position", |sample| sample.position)?;
        number("torque", |sample| sample.torque)?;
        number("slack", |sample| sample.slack)?;
        let code = |name, of: fn(&Sample) -> u8| {
            let codes: Vec<u8> = samples.iter().map(of).collect();
            columns.set_item(name, PyByteArray::new(py, &codes))
        };
        code("state", |sample| sample.state as u8)?;
        code("limit", |sample| sample.limit as u8)?;
        Ok(columns)
    }

    /// Streams the torques that a function returns for position, velocity and time.
    fn stream(
        &self,
        py: Python<'_>,
        function: Py<PyAny>,
        rate: f64,
        duration: f64,
        smooth: bool,
    ) -> Result<(), BoardFailure> {
        let torque = |tick: &StreamTick| {
            if tick.time >= duration {
                return Ok(None);
            }
            Python::attach(|py| {
                py.check_signals()?;
                let returned = function.call1(py, (tick.position, tick.velocity, tick.time))?;
                returned.extract::<f64>(py).map(Some).map_err(|_| {
                    let StreamTick { time, .. } = tick;
                    BoardFailure::Python(errors::StreamError::new_err(format!(
                        "the function returned {returned} at {time} s; it must be a torque in N m. The \
                         torque is switched off"
                    )))
                })
            })
        };
        self.with(py, |link| link.stream(rate, smooth, torque))
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
