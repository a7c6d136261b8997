//! A motor, its supply, and the bandwidth of its current loop, as a program states them.

/// The kind of a motor's winding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winding {
    /// One winding and a commutator, between the phases U and V.
    Brushed,
    /// Three windings in a star, and magnets.
    Brushless {
        /// Electrical turns in a turn of the handle: the pole pairs of the motor, times its gearing.
        pole_pairs: u16,
    },
}

impl Winding {
    /// Whether the motor has three phases and magnets.
    pub const fn is_brushless(self) -> bool {
        matches!(self, Self::Brushless { .. })
    }

    /// Electrical turns in a turn of the handle; zero for a brushed motor.
    pub const fn pole_pairs(self) -> u16 {
        match self {
            Self::Brushed => 0,
            Self::Brushless { pole_pairs } => pole_pairs,
        }
    }
}

/// The data of a motor for its current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// The kind of its winding.
    pub winding: Winding,
    /// Resistance in ohm: between the terminals of a brushed motor, of one phase of a brushless motor, which
    /// is half of the resistance between two of its terminals.
    pub resistance: f64,
    /// Inductance in H, of the same.
    pub inductance: f64,
    /// Torque at the handle in N m/A: of a brushless motor per ampere of a phase current's amplitude.
    pub torque_constant: f64,
}

impl Motor {
    /// Induced voltage in V s/rad of the handle's speed: between the terminals of a brushed motor; for a
    /// brushless motor the amplitude in a phase, where each phase has 2/3 of a direct current's power.
    pub const fn back_emf(&self) -> f64 {
        match self.winding {
            Winding::Brushed => self.torque_constant,
            Winding::Brushless { .. } => self.torque_constant * 2.0 / 3.0,
        }
    }
}

/// A range of a supply's voltage in V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupplyRange {
    /// The lowest.
    pub lowest: f64,
    /// The highest.
    pub highest: f64,
}

/// A supply: the range of its voltage in V, and what becomes of the energy that the motor returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply {
    /// The lowest voltage, under load.
    pub lowest: f64,
    /// The highest voltage, when the motor feeds it: above this, over-voltage is a fault.
    pub highest: f64,
    /// What becomes of the energy that the motor returns.
    pub regeneration: Regeneration,
}

/// What becomes of the energy that a motor returns to its supply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regeneration {
    /// The supply takes it and keeps its voltage: a battery, or a brake resistor with its own switch.
    Sinks,
    /// The supply takes nothing: the energy stays in the capacitance at the bridge, and its voltage rises.
    Stores {
        /// The highest voltage in V that the supply itself delivers, with its tolerance.
        voltage: f64,
        /// The least capacitance in F, with its tolerance and at the end of its life.
        capacitance: f64,
    },
}

impl Supply {
    /// A supply that takes energy back, with this lowest and highest voltage in V.
    pub const fn sinking(lowest: f64, highest: f64) -> Self {
        Self { lowest, highest, regeneration: Regeneration::Sinks }
    }

    /// The range of its voltage.
    pub const fn range(&self) -> SupplyRange {
        SupplyRange { lowest: self.lowest, highest: self.highest }
    }

    /// Voltage in V while the motor returns nothing: the supply's own, or the middle of its range.
    pub const fn open_voltage(&self) -> f64 {
        match self.regeneration {
            Regeneration::Sinks => 0.5 * (self.lowest + self.highest),
            Regeneration::Stores { voltage, .. } => voltage,
        }
    }
}

/// The motor at a power stage, and the required speed of the current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// The motor.
    pub motor: Motor,
    /// Its supply.
    pub supply: Supply,
    /// Bandwidth in Hz of the reference model that the current follows.
    pub bandwidth: f64,
    /// Temperature in degrees Celsius at the power stage's sensor above which it is switched off.
    pub largest_temperature: f64,
}
