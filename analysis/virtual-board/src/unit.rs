//! What the chips' peripherals are for.

/// A peripheral of either chip, by what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Reset and clock control.
    Clock,
    /// Power control.
    Power,
    /// The flash memory's interface.
    Flash,
    /// System configuration.
    Configuration,
    /// The debug registers.
    Debug,
    /// A port of pins: 0 is A.
    Pins(usize),
    /// TIM6.
    TickTimer,
    /// TIM7.
    PhaseTimer,
    /// The free-running clock.
    FreeClock,
    /// The encoder's counter.
    Encoder,
    /// The DAC.
    Dac,
    /// The serial port.
    Serial,
    /// The independent watchdog.
    Watchdog,
    /// A unit of the power stage.
    Stage(Stage),
}

/// A unit of the power stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// TIM1, the modulator.
    PwmTimer,
    /// ADC1 or ADC2: 0 is the first.
    Adc(usize),
    /// What both converters share.
    AdcCommon,
    /// The comparators.
    Comparators,
    /// The operational amplifiers.
    OpAmps,
    /// DAC3, the comparators' thresholds.
    ThresholdDac,
}
