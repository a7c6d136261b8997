//! Options of a servo loop.

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
    /// Only when the host requests it.
    #[default]
    WhenAsked,
    /// Also without a host, when the supply is switched on; after no other reset.
    AtPowerOn(Reason),
}

/// The reason why a device may arm itself at power-on, stated in the program and in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reason(&'static str);

impl Reason {
    /// A reason in words.
    ///
    /// # Panics
    /// If the text is empty; in a constant this is a compile error.
    #[track_caller]
    pub const fn new(words: &'static str) -> Self {
        assert!(
            !words.trim_ascii().is_empty(),
            "arming at power-on needs a reason: why does nobody get hurt when the device starts by \
             itself?"
        );
        Self(words)
    }

    /// The text.
    pub const fn as_str(self) -> &'static str {
        self.0
    }
}

/// Options of a servo loop.
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
    /// The servo runs without a host, and only a host arms it.
    pub const DEFAULT: Self =
        Self { link: LinkPolicy::Ignore, link_timeout: 1.0, arming: Arming::WhenAsked };

    /// The same options, but the servo is armed at power-on without a host, for this reason.
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
