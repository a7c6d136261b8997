//! The state of the servo, its status and its replies.

use core::fmt;

use crate::fault::Fault;
use crate::text::words;

words! {
    /// The servo's state.
    #[derive(Default)]
    #[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
    #[repr(u8)]
    State {
    /// The amplifier is off.
    #[default]
    Disarmed = 0 "disarmed",
    /// The clamp is opening.
    FadingIn = 1 "fading-in",
    /// The servo renders the scene.
    Running = 2 "running",
    /// The clamp is closing, to disarm or to swap a set of parameters in.
    FadingOut = 3 "fading-out",
    /// The clamp is shut while samples fill the memory of a new set, or the torque output starts up.
    Settling = 4 "settling",
    /// A fault stopped it; the amplifier is off.
    Faulted = 5 "faulted",
    /// A brushless motor is being aligned: its field turns the handle, and no scene is rendered.
    Aligning = 6 "aligning",
    }
}

impl State {
    /// Whether the amplifier is on.
    pub const fn is_armed(self) -> bool {
        !matches!(self, Self::Disarmed | Self::Faulted)
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// The servo's reply to a request for its status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    /// The state.
    pub state: State,
    /// The fault that stopped the servo, or a fault from before the last reset; `None` after arming.
    pub fault: Option<Fault>,
    /// Periods since the start, wrapping.
    pub tick: u32,
    /// Position in counts.
    pub count: i64,
    /// Timer counts in a period.
    pub period: u32,
    /// The smallest slack since the start, in timer counts: left of a period, or with a fixed phase until the
    /// output of the code.
    pub worst_slack: u32,
    /// Updates missed since the start.
    pub missed: u32,
    /// Frames dropped since the start.
    pub dropped: u32,
    /// Net energy put into the hand since the servo was armed, in counts times codes.
    pub energy: i64,
    /// The largest value of the net energy since then, in counts times codes.
    pub worst_deficit: i64,
    /// Whether the host has been silent for too long.
    pub link_lost: bool,
}

impl Status {
    pub(super) const WORDS: usize = 15;

    pub(super) fn to_words(self) -> [u32; Self::WORDS] {
        let state = u32::from(self.link_lost) << LINK_LOST | self.state as u32;
        let [code, a, b] = fault_words(self.fault);
        let [count, energy, deficit] = [self.count, self.energy, self.worst_deficit].map(halves);
        [
            state,
            code,
            a,
            b,
            self.tick,
            count[0],
            count[1],
            self.period,
            self.worst_slack,
            self.missed,
            self.dropped,
            energy[0],
            energy[1],
            deficit[0],
            deficit[1],
        ]
    }

    pub(super) fn from_words(words: [u32; Self::WORDS]) -> Self {
        let [state, code, a, b, tick, words @ ..] = words;
        let [low, high, period, worst_slack, missed, dropped, words @ ..] = words;
        let [energy_low, energy_high, deficit_low, deficit_high] = words;
        Self {
            state: State::ALL.get((state & 0xff) as usize).copied().unwrap_or_default(),
            fault: Fault::decode(code, [a, b]),
            tick,
            count: whole(low, high),
            period,
            worst_slack,
            missed,
            dropped,
            energy: whole(energy_low, energy_high),
            worst_deficit: whole(deficit_low, deficit_high),
            link_lost: state >> LINK_LOST != 0,
        }
    }
}

/// The bit of a lost link beside the state.
const LINK_LOST: u32 = 8;

/// A fault as words; no fault has the code 0.
fn fault_words(fault: Option<Fault>) -> [u32; 3] {
    let (code, [a, b]) = fault.map_or((0, [0; 2]), Fault::encode);
    [code, a, b]
}

/// The low and the high half.
const fn halves(value: i64) -> [u32; 2] {
    let value = value.cast_unsigned();
    [value as u32, (value >> 32) as u32]
}

const fn whole(low: u32, high: u32) -> i64 {
    (((high as u64) << 32) | low as u64).cast_signed()
}

/// The servo's reply to a request to arm it or to align its motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply {
    /// The servo is armed, also if it was armed before; or the alignment has begun, and [`State::Aligning`]
    /// ends by itself.
    Done,
    /// Not done: this fault is present.
    Fault(Fault),
    /// The motor is not aligned, because the servo is armed.
    Armed,
    /// Not done, because disarming was requested at the same time.
    Disarming,
}

impl Reply {
    pub(super) const WORDS: usize = 4;

    pub(super) fn to_words(self) -> [u32; Self::WORDS] {
        let (kind, fault) = match self {
            Self::Done => (0, None),
            Self::Fault(fault) => (1, Some(fault)),
            Self::Armed => (2, None),
            Self::Disarming => (3, None),
        };
        let [code, a, b] = fault_words(fault);
        [kind, code, a, b]
    }

    pub(super) fn from_words([kind, code, a, b]: [u32; Self::WORDS]) -> Option<Self> {
        match kind {
            0 => Some(Self::Done),
            1 => Fault::decode(code, [a, b]).map(Self::Fault),
            2 => Some(Self::Armed),
            3 => Some(Self::Disarming),
            _ => None,
        }
    }
}
