//! The selection of one of several torque profiles.

use super::mode_table::ProfileMode;

/// The selection of one of several torque profiles by its number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct ModeSelection {
    #[cfg_attr(feature = "wire", serde(skip))]
    modes: &'static [ProfileMode],
    /// Number of the selected mode, from 0.
    pub mode: f64,
    /// Number of modes.
    pub count: u32,
}

impl ModeSelection {
    pub(super) const fn of(modes: &'static [ProfileMode], mode: f64) -> Self {
        Self { modes, mode, count: modes.len() as u32 }
    }

    /// The same with another number.
    pub const fn selecting(self, mode: f64) -> Self {
        Self { mode, ..self }
    }

    /// The number as an index; `None` if there is no such mode.
    pub const fn index(&self) -> Option<usize> {
        let whole = self.mode as u32;
        if whole as f64 == self.mode && whole < self.count { Some(whole as usize) } else { None }
    }

    /// The largest number.
    pub const fn last(&self) -> u32 {
        self.count.saturating_sub(1)
    }

    /// All modes by their numbers; empty if the selection came over the wire.
    pub const fn modes(&self) -> &'static [ProfileMode] {
        self.modes
    }

    /// The selected mode; `None` if there is no such mode, or if the selection came over the wire.
    pub(super) const fn selected(&self) -> Option<&'static ProfileMode> {
        match self.index() {
            Some(index) if index < self.modes.len() => Some(&self.modes[index]),
            _ => None,
        }
    }
}
