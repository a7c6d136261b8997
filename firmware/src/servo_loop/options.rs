//! Options of a cycle.

/// What the servo does when the host falls silent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinkPolicy {
    /// Nothing: the host is not needed.
    #[default]
    Ignore,
    /// Continues with the running set, and reports the lost host in its status.
    Hold,
    /// Fades out and switches the amplifier off: a fault.
    Release,
}

/// When to arm the servo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arming {
    /// Only on the host's request.
    #[default]
    WhenAsked,
    /// Also without a host, when the supply is switched on; after no other reset.
    AtPowerOn(Reason),
}

/// Why a device may arm itself at power-on, stated in the program and in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reason(&'static str);

impl Reason {
    /// A reason in words.
    ///
    /// # Panics
    /// Where it has no words; in a constant that is an error of the compiler.
    #[track_caller]
    pub const fn new(words: &'static str) -> Self {
        assert!(
            !words.trim_ascii().is_empty(),
            "arming at power-on needs a reason: why does nobody get hurt when the device starts by \
             itself?"
        );
        Self(words)
    }

    /// Its words.
    pub const fn as_str(self) -> &'static str {
        self.0
    }
}

/// Options of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What to do when the host falls silent.
    pub link: LinkPolicy,
    /// Time in s without a message after which the host counts as lost.
    pub link_timeout: f64,
    /// When to arm the servo.
    pub arming: Arming,
}

impl Options {
    /// Needs no host to run, and one to be armed.
    pub const DEFAULT: Self =
        Self { link: LinkPolicy::Ignore, link_timeout: 1.0, arming: Arming::WhenAsked };

    /// The same, but armed without a host when the supply is switched on, for this reason.
    ///
    /// ```
    /// use haptic_servo::servo_loop::{Arming, Options};
    ///
    /// const OPTIONS: Options = Options::DEFAULT.armed_at_power_on("a knob without a motor's reach");
    /// assert!(matches!(OPTIONS.arming, Arming::AtPowerOn(_)));
    /// ```
    ///
    /// # Panics
    /// As [`Reason::new`].
    #[must_use]
    #[track_caller]
    pub const fn armed_at_power_on(self, reason: &'static str) -> Self {
        Self { arming: Arming::AtPowerOn(Reason::new(reason)), ..self }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}
