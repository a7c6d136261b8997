//! Requests to a board and their results, in words.

use haptic_servo::host::HostTorque;
use haptic_servo::number::Format;
use haptic_servo::parameter::Parameter;
use haptic_servo::servo::Step;
use haptic_servo::tuning::{self, Parameters, RenderError};
use haptic_servo::wire::description::Description;
use haptic_servo::wire::message::{ActiveParameters, Changes, Id, Outcome, Refusal, ToBoard};

use super::formatting;
use crate::remedy_search::{RemedySearch, would_pass};

/// A request to a board.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Other parameters, all or none.
    Set(Changes),
    /// Switch the amplifier on; clears a fault.
    Arm,
    /// Fade the torque out and switch the amplifier off.
    Disarm,
    /// Align a brushless motor, which moves the handle.
    Align,
}

impl Request {
    /// Its message to the board.
    pub fn message(&self, id: Id) -> ToBoard {
        match self {
            Self::Set(changes) => ToBoard::Set { id, changes: changes.clone() },
            Self::Arm => ToBoard::Arm { id },
            Self::Disarm => ToBoard::Disarm { id },
            Self::Align => ToBoard::Align { id },
        }
    }

    /// The parameters that are to be changed.
    pub fn changes(&self) -> Changes {
        match self {
            Self::Set(changes) => changes.clone(),
            Self::Arm | Self::Disarm | Self::Align => Changes::new(),
        }
    }

    /// The request, in words.
    pub fn words(&self) -> String {
        match self {
            Self::Set(changes) => formatting::changes(changes),
            Self::Arm => "arm".to_owned(),
            Self::Disarm => "disarm".to_owned(),
            Self::Align => "align".to_owned(),
        }
    }
}

/// The state of a request.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// It was sent.
    Asked,
    /// The board has answered.
    Answered(RequestResult),
    /// There was no answer.
    Unanswered,
    /// It was not sent: the board has not answered the request before.
    Busy,
    /// It was not sent: there was no link.
    NoLink,
}

impl Reply {
    /// Its line in the view.
    pub fn line(&self, request: &Request) -> String {
        let what = request.words();
        match self {
            Self::Asked => format!("{what} ..."),
            Self::Answered(RequestResult::Done) => format!("{what}: done"),
            Self::Answered(RequestResult::Refused(sentence)) => format!("{what}: {sentence}"),
            Self::Unanswered => format!(
                "{what}: the board has not answered; it may have executed \
                                         the request"
            ),
            Self::Busy => {
                format!("{what}: not sent; the board has not answered the last request yet")
            }
            Self::NoLink => format!("{what}: not sent; there was no link to the board"),
        }
    }
}

/// The board's answer to a request, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RequestResult {
    /// The request has taken effect.
    Done,
    /// It is refused, for this reason, and nothing has changed.
    Refused(String),
}

impl From<Outcome> for RequestResult {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Done => Self::Done,
            Outcome::Refused(refusal) => Self::Refused(refusal.to_string()),
        }
    }
}

/// The scene that runs on a board.
#[derive(Clone, Copy, Debug)]
pub struct RunningScene<'a> {
    /// Its description.
    pub description: &'a Description,
    /// Its parameters.
    pub parameters: &'a ActiveParameters,
    /// What a host may do beside it.
    pub host: Option<&'a HostTorque>,
}

impl RunningScene<'_> {
    /// The reason why the board refuses changes.
    ///
    /// # Errors
    /// The reason.
    pub fn explain(&self, changes: &Changes) -> Result<(), RenderError> {
        let has = self.parameters.values.iter().map(|(parameter, _)| *parameter);
        self.description.explain(Parameters::of(has), changes)?;
        self.host.map_or(Ok(()), |host| self.description.explain_host(host, changes))
    }

    /// The refusal of the board's step in words.
    pub fn refusal_in_words(&self, step: Step, changes: &Changes) -> RequestResult {
        if let Err(reason) = self.explain(changes)
            && reason.step() == step
        {
            return RequestResult::Refused(self.in_words(&reason, changes));
        }
        if let Some(mode) = self.description.other_mode(changes) {
            return RequestResult::Refused(RenderError::OtherMode { mode }.to_string());
        }
        Outcome::Refused(Refusal::Set(step)).into()
    }

    /// The reason of a refusal, with the changes of one number that the board would take instead.
    pub fn in_words(&self, reason: &RenderError, changes: &Changes) -> String {
        let Ok(scene) = tuning::apply(&self.description.scene, changes) else {
            return reason.to_string();
        };
        let passes = |parameter: Parameter, value: f64| {
            let others = changes.iter().filter(|(other, _)| *other != parameter).copied();
            let mut changes: Changes = others.collect();
            changes.push((parameter, value)).is_ok() && self.explain(&changes).is_ok()
        };
        let search = RemedySearch { scene: &scene, passes };
        match reason {
            RenderError::Rejected(rejection) => {
                let found = search.behind(&rejection.remedies());
                rejection.reason_in(Format::F64).as_str().to_owned() + &would_pass(None, &found)
            }
            RenderError::Timing(error) => error.to_string() + &would_pass(None, &search.searched()),
            other => other.to_string(),
        }
    }
}
