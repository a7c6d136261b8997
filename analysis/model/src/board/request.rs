//! Requests to a board and their results, in words.

use haptic_servo::host::HostTorque;
use haptic_servo::number::Format;
use haptic_servo::parameter::Parameter;
use haptic_servo::servo::Step;
use haptic_servo::tuning::{self, Parameters, RenderError};
use haptic_servo::wire::description::Description;
use haptic_servo::wire::host::HostRequest;
use haptic_servo::wire::message::{ActiveParameters, Changes, Id, Outcome, Refusal, ToBoard};

use super::{budget, formatting};
use crate::remedy_search::{RemedySearch, would_pass};

/// A request to a board.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Other parameters, all or none.
    Set(Changes),
    /// Other numbers of its host's budget, by their names.
    Budget(Vec<(&'static str, f64)>),
    /// Switch the amplifier on; clears a fault.
    Arm,
    /// Fade the torque out and switch the amplifier off.
    Disarm,
    /// Align a brushless motor, which moves the handle.
    Align,
}

impl Request {
    /// Its message to a board with this budget in force; `None` if it needs a host, which the board has not.
    pub fn message(&self, id: Id, host: Option<HostTorque>) -> Option<ToBoard> {
        Some(match self {
            Self::Set(changes) => ToBoard::Set { id, changes: changes.clone() },
            Self::Budget(_) => {
                ToBoard::Host(HostRequest::Budget { id, budget: self.budget(host)? })
            }
            Self::Arm => ToBoard::Arm { id },
            Self::Disarm => ToBoard::Disarm { id },
            Self::Align => ToBoard::Align { id },
        })
    }

    /// The budget after it, of that in force.
    pub fn budget(&self, host: Option<HostTorque>) -> Option<HostTorque> {
        match self {
            Self::Budget(changes) => host.map(|host| budget::changed(host, changes)),
            Self::Set(_) | Self::Arm | Self::Disarm | Self::Align => host,
        }
    }

    /// The parameters that are to be changed.
    pub fn changes(&self) -> Changes {
        match self {
            Self::Set(changes) => changes.clone(),
            Self::Budget(_) | Self::Arm | Self::Disarm | Self::Align => Changes::new(),
        }
    }

    /// The request, in words.
    pub fn words(&self) -> String {
        match self {
            Self::Set(changes) => formatting::changes(changes),
            Self::Budget(changes) => formatting::named(changes),
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

/// The refusal of another budget by a program without a host.
pub fn no_host() -> RequestResult {
    let names = budget::NAMES.join(", ");
    RequestResult::Refused(format!("this program takes no torques of a host: it has no {names}"))
}

/// Why a board has refused a request at this step, with its budget then: the host judges them again, with the remedies that a board
/// has no room to look for.
pub fn refusal_in_words(
    step: Step,
    request: &Request,
    budget: Option<HostTorque>,
    description: &Description,
    parameters: &ActiveParameters,
) -> RequestResult {
    let changes = request.changes();
    let judged = |request: &Request| judge(request, budget, description, parameters);
    let without_changes = || judged(&Request::Set(Changes::new())).err();
    // What holds without the changes, too, is not the board's reason: it certifies with the readings of its encoder,
    // which it does not send.
    if let Err(refused) = judged(request)
        && refused.0.step() == step
        && without_changes().is_none_or(|before| before.1 != refused.1)
    {
        return RequestResult::Refused(refused.1);
    }
    if step == Step::Servo
        && let Err(reason) = description.check_torques(&changes)
    {
        return RequestResult::Refused(reason.to_string());
    }
    if let Some(mode) = description.other_mode(&changes) {
        return RequestResult::Refused(RenderError::OtherMode { mode }.to_string());
    }
    Outcome::Refused(Refusal::Set(step)).into()
}

/// Judges a request like the board that has this budget.
///
/// # Errors
/// The reason of a refusal; and in words, with the changes of one number that the board would take instead.
pub fn judge(
    request: &Request,
    budget: Option<HostTorque>,
    description: &Description,
    parameters: &ActiveParameters,
) -> Result<(), Box<(RenderError, String)>> {
    let (changes, host) = (request.changes(), request.budget(budget));
    let explained = description.explain(names(parameters), host.as_ref(), &changes);
    explained.map_err(|reason| {
        let words = in_words(&reason, &changes, host.as_ref(), description, parameters);
        Box::new((reason, words))
    })
}

fn in_words(
    reason: &RenderError,
    changes: &Changes,
    host: Option<&HostTorque>,
    description: &Description,
    parameters: &ActiveParameters,
) -> String {
    let Ok(scene) = tuning::apply(&description.scene, changes) else { return reason.to_string() };
    let passes = |parameter: Parameter, value: f64| {
        let others = changes.iter().filter(|(other, _)| *other != parameter).copied();
        let mut changes: Changes = others.collect();
        changes.push((parameter, value)).is_ok()
            && description.explain(names(parameters), host, &changes).is_ok()
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

/// The parameters that can be changed.
pub fn names(parameters: &ActiveParameters) -> Parameters {
    Parameters::of(parameters.values.iter().map(|(parameter, _)| *parameter))
}
