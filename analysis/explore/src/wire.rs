//! The page's conversation with a board. The page carries the bytes and has the clock.
//!
//! Bytes are text here: a letter for each, of U+0000 to U+00FF, as `String.fromCharCode` makes them. Times are
//! the page's, in ms since any beginning.

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::time::Duration;

use haptic_model::board::client;
use haptic_model::board::request::{Reply, Request};
use haptic_model::board::sample::{COLUMNS, Sample};
use haptic_model::board::timing::RETRY;
use haptic_model::board::{Power, change, formatting};
use haptic_model::chain::Chain;
use haptic_model::file::{self, Format, SceneFile, write};
use haptic_servo::board::BAUD;
use haptic_servo::certificate::Parameter;
use haptic_servo::environment::{Environment, Parts};
use haptic_servo::parameter::Range;
use haptic_servo::wire::PROTOCOL;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::PageResult;
use crate::client::{Client, Connected, Slow, WINDOW};

thread_local! {
    static WIRE: RefCell<Wire> = const { RefCell::new(Wire { client: None, is_recording: false }) };
}

/// The state between calls.
struct Wire {
    client: Option<Client>,
    /// Whether ticks are also returned as rows of a table.
    is_recording: bool,
}

/// The request for a new conversation.
#[derive(Deserialize)]
struct Start {
    address: String,
    now: f64,
    /// Any number, different each time.
    id: u16,
}

/// Asks the board for something.
#[derive(Deserialize)]
struct Asked {
    now: f64,
    /// `set`, `arm`, `disarm` or `align`.
    request: String,
    /// Changes as they are typed: `stiffness=20 damping=0.01`.
    #[serde(default)]
    changes: String,
}

/// News of a turn.
#[derive(Default, Serialize)]
struct Turn {
    /// Bytes to the board.
    send: String,
    /// The results of requests.
    replies: Vec<String>,
    /// Rows of the record.
    rows: String,
    /// The state of the board, if it is new.
    board: Option<Value>,
    /// The reason if the conversation has ended.
    lost: Option<String>,
}

/// Nothing: the speed of a serial line in bit/s, the version of the protocol, the head of a record, the time
/// between two tries to connect in ms, and the width of the curves in s.
pub fn facts(_: &str, _: &mut Vec<f64>) -> PageResult {
    let retry = RETRY.as_millis() as u64;
    Ok(json!({ "baud": BAUD, "protocol": PROTOCOL, "columns": COLUMNS, "retry": retry, "window": WINDOW })
        .to_string())
}

/// Begins a conversation: `{"address": .., "now": .., "id": ..}`.
pub fn start(question: &str, _: &mut Vec<f64>) -> PageResult {
    let Start { address, now, id } = serde_json::from_str(question).map_err(|e| e.to_string())?;
    let now = time(now)?;
    WIRE.with_borrow_mut(|wire| {
        wire.client = Some(Client::start(address, id, now));
        wire.turn(None)
    })
}

/// Takes bytes, and sends the requests that are due: the time, a line feed, and the bytes.
pub fn turn(question: &str, _: &mut Vec<f64>) -> PageResult {
    let (now, letters) = question.split_once('\n').unwrap_or((question, ""));
    let number: f64 = now.parse().map_err(|_| format!("`{now}` is not a time in ms"))?;
    let now = time(number)?;
    let bytes = bytes(letters)?;
    WIRE.with_borrow_mut(|wire| {
        let mut rows = wire.is_recording.then(String::new);
        let mut lost = None;
        if let Some(client) = &mut wire.client {
            let each = |sample: &Sample| {
                if let Some(rows) = &mut rows {
                    *rows += &format!("{sample}\n");
                }
            };
            lost = client.turn(&bytes, now, each).err();
        }
        let turn = wire.news(rows, lost);
        crate::judge::json(&turn)
    })
}

/// The link is lost: pending requests are not answered any more.
pub fn lost(_: &str, _: &mut Vec<f64>) -> PageResult {
    WIRE.with_borrow_mut(|wire| wire.turn(Some(String::new())))
}

/// Sends a request: `{"now": .., "request": "set", "changes": "stiffness=20"}`. A set that the board would
/// refuse is refused here, with the same text.
pub fn request(question: &str, _: &mut Vec<f64>) -> PageResult {
    let Asked { now, request, changes } =
        serde_json::from_str(question).map_err(|error| error.to_string())?;
    let now = time(now)?;
    let request = match request.as_str() {
        "set" => change::line(&changes)?,
        "arm" => Request::Arm,
        "disarm" => Request::Disarm,
        "align" => Request::Align,
        other => {
            return Err(format!(
                "there is no request `{other}`; the requests are set, arm, disarm, align"
            ));
        }
    };
    WIRE.with_borrow_mut(|wire| {
        match &mut wire.client {
            Some(client) => client.request(request, now)?,
            None => return Err(Reply::NoLink.line(&request)),
        }
        wire.turn(None)
    })
}

/// Judges changes as they are typed, with the board's running scene. A refusal is the reason.
pub fn judge(changes: &str, _: &mut Vec<f64>) -> PageResult {
    let request = change::line(changes)?;
    WIRE.with_borrow(|wire| match &wire.client {
        Some(client) => client.judge(&request).map(|()| String::new()),
        None => Err(Reply::NoLink.line(&request)),
    })
}

/// The scene that runs on the board, of the shape of a scene file; null until it is known, and where the board
/// alone has its table.
pub fn scene(_: &str, _: &mut Vec<f64>) -> PageResult {
    WIRE.with_borrow(|wire| crate::judge::json(&wire.client.as_ref().and_then(scene_of)))
}

fn scene_of(client: &Client) -> Option<Value> {
    let (connected, running) = (client.connected.as_ref()?, client.wire.description.as_ref()?);
    let (scene, transducers) = (running.scene, &running.transducers);
    if !matches!(scene.environment, Environment::Parts(Parts { profile: None, .. })) {
        return None;
    }
    let file = SceneFile {
        name: connected.board.program.clone(),
        scene,
        chain: Chain::rigid(scene.device.inertia, scene.device.damping).ok()?,
        simulation: None,
        hand: None,
        host: None,
        encoder_step: Some(TAU / transducers.counts_per_turn),
        full_scale: Some(transducers.full_scale_torque),
        friction: None,
        cogging: None,
        supply: None,
        motor: None,
        shapes: None,
        chip: None,
    };
    file::as_json(&file.name, Format::Toml, &write::toml(&file)).ok()
}

/// Returns ticks as rows of a table from now on, `on`, or no more, `off`.
pub fn record(question: &str, _: &mut Vec<f64>) -> PageResult {
    WIRE.with_borrow_mut(|wire| wire.is_recording = question == "on");
    Ok(String::new())
}

/// The curves of the last seconds, with a number of columns: position in rad, torque in N m, margin in N m
/// s/rad and energy in J, each as the number of its points and the points, a time in s that is not positive
/// and a value.
pub fn curves(columns: &str, numbers: &mut Vec<f64>) -> PageResult {
    let columns: usize =
        columns.parse().map_err(|_| format!("`{columns}` is not a number of columns"))?;
    WIRE.with_borrow(|wire| {
        let connected = wire.client.as_ref().and_then(|client| client.connected.as_ref());
        if let Some(connected) = connected {
            for curve in of(connected, columns) {
                numbers.push(curve.len() as f64);
                numbers.extend(curve.into_iter().flat_map(<[f64; 2]>::from));
            }
        }
    });
    Ok(String::new())
}

fn of(connected: &Connected, columns: usize) -> [Vec<(f64, f64)>; 4] {
    let history = &connected.history;
    let now = connected.slow.back().map_or(0.0, |last| last.time);
    let slow = |value: fn(&Slow) -> Option<f64>| {
        let point = |slow: &Slow| Some((slow.time - now, value(slow)?));
        connected.slow.iter().filter_map(point).collect()
    };
    [
        history.curve(columns, |sample| sample.position),
        history.curve(columns, |sample| sample.torque),
        slow(|slow| slow.margin),
        slow(|slow| Some(slow.energy)),
    ]
}

impl Wire {
    /// The news, as a result for the page.
    fn turn(&mut self, lost: Option<String>) -> PageResult {
        let turn = self.news(None, lost);
        crate::judge::json(&turn)
    }

    fn news(&mut self, rows: Option<String>, lost: Option<String>) -> Turn {
        let rows = rows.unwrap_or_default();
        let Some(client) = &mut self.client else { return Turn { rows, lost, ..Turn::default() } };
        if lost.is_some() {
            client.give_up();
        }
        let send = client.wire.take_outgoing().into_iter().map(char::from).collect();
        let replies = std::mem::take(&mut client.replies);
        let is_new = std::mem::take(&mut client.has_news);
        let board = is_new.then(|| view(client)).flatten();
        if lost.is_some() {
            self.client = None;
        }
        Turn { send, replies, rows, board, lost }
    }
}

/// The state of a board as text, as in `haptic scope`.
fn view(client: &Client) -> Option<Value> {
    let connected = client.connected.as_ref()?;
    let client::Connected { program, units: board, previous_fault, .. } = &connected.board;
    let (parameters, status) = (connected.parameters.as_ref()?, connected.status.as_ref()?);
    let slack = connected.history.last().map(|last| last.slack);
    let numbers = parameters.values.iter().map(|(parameter, value)| number(*parameter, *value));
    Some(json!({
        "program": program,
        "address": client.wire.address(),
        "state": status.state.as_str(),
        "is_armed": status.state.is_armed(),
        "fault": status.fault.map(|fault| fault.to_string()),
        "is_link_lost": status.link_lost,
        "previous_fault": previous_fault.as_ref().map(formatting::previous_fault),
        "reset": formatting::reset(status),
        "sets": parameters.sets,
        "numbers": numbers.collect::<Vec<_>>(),
        "margin": parameters.margin,
        "energy": status.energy as f64 * board.energy_step,
        "gap": formatting::gap(board),
        "power": status.power.map(|reading| in_words(&Power::from(reading))),
        "lines": [
            formatting::reserves(parameters, status, board, slack),
            formatting::energy(status, board),
            formatting::limits(&connected.history),
            formatting::losses(status, client.wire.discarded()),
        ],
    }))
}

/// The measurements of a power stage.
fn in_words(power: &Power) -> String {
    match power.index_offset() {
        Some(offset) => format!("{power}; {offset}"),
        None => power.to_string(),
    }
}

/// An active parameter.
fn number(parameter: Parameter, value: f64) -> Value {
    let (words, unit) = parameter.name_and_unit();
    let whole = match parameter.range() {
        Range::Whole(least, most) => Some([least, most]),
        _ => None,
    };
    json!({
        "name": formatting::name(parameter),
        "words": words,
        "unit": unit,
        "value": value,
        "whole": whole,
    })
}

/// A time of the page.
fn time(now: f64) -> Result<Duration, String> {
    Duration::try_from_secs_f64(now / 1e3).map_err(|_| format!("`{now}` is not a time in ms"))
}

/// Converts letters to bytes.
fn bytes(letters: &str) -> Result<Vec<u8>, String> {
    let byte = |letter: char| {
        u8::try_from(letter).map_err(|_| format!("`{letter}` is not a byte: U+0000 to U+00FF"))
    };
    letters.chars().map(byte).collect()
}
