//! The end of a sweep, which is the last word of the record on the wire.

/// Version of the protocol of a board that plays a sweep.
pub const SWEEP_PROTOCOL: u32 = 3;

/// Time in s without a request of the host after which an unsupervised sweep ends.
pub const SILENCE: f64 = 0.5;

/// The end of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepEnd {
    /// The sweep is complete.
    Done,
    /// The host stopped it.
    Stopped,
    /// The host has sent no request for [`SILENCE`].
    Silent,
    /// A tick came late or not at all, so that a torque was held for too long.
    MissedTick,
    /// A row was lost because the queue to the host was full.
    LostRow,
    /// The device left the limits of its travel.
    Travel,
    /// The device was faster than its limit.
    Speed,
    /// The encoder moved further than a device can.
    Jump,
    /// The board's bridge removed the torque.
    OutputFault,
}

impl SweepEnd {
    /// All ends.
    pub const ALL: [Self; 9] = [
        Self::Done,
        Self::Stopped,
        Self::Silent,
        Self::MissedTick,
        Self::LostRow,
        Self::Travel,
        Self::Speed,
        Self::Jump,
        Self::OutputFault,
    ];

    /// The word on the wire.
    ///
    /// ```
    /// use haptic_servo::excitation::SweepEnd;
    /// for end in SweepEnd::ALL {
    ///     assert_eq!(SweepEnd::find(end.as_str()), Some(end));
    /// }
    /// ```
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Stopped => "stopped",
            Self::Silent => "silent",
            Self::MissedTick => "missed-tick",
            Self::LostRow => "lost-row",
            Self::Travel => "travel",
            Self::Speed => "speed",
            Self::Jump => "jump",
            Self::OutputFault => "output-fault",
        }
    }

    /// The end with this word.
    pub fn find(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|end| end.as_str() == word)
    }
}
