//! A sweep played to a simulated device, by this process or by the emulated board, and recorded.

use std::path::Path;

use haptic_servo::excitation::{Exciter, Sweep};

use super::record::{Record, Recorder};
use super::rig::{MeasuredDevice, torque_of};
use crate::compare_run::RunError;
use crate::emulator::Emulator;
use crate::lockstep::Difference;
use crate::quantity::significant;

/// A record, and whether the board's codes equal those of this process.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The record; its torque is that of the codes that drove the device.
    pub record: Record,
    /// Codes of the board that were equal to this process's; `None` where no board took part.
    pub equal: Option<usize>,
    /// The first difference, if there is one.
    pub difference: Option<Difference>,
}

/// Plays a sweep to a device at rest and records it. With a program `elf` the emulated board's codes drive
/// the device, and each is compared. The recorder gets a CSV file that can be [read](super::record::load) again.
/// Calls `progress` on each tick.
pub fn measure<const N: usize>(
    sweep: &Sweep<N>,
    device: &mut MeasuredDevice,
    elf: Option<&Path>,
    recorder: &mut Recorder<'_>,
    mut progress: impl FnMut(),
) -> Result<Measurement, RunError> {
    let mut board = elf.map(Emulator::boot).transpose()?;
    let mut exciter = Exciter::new(sweep);
    let (mut torque, mut counts, mut frequency) = (vec![], vec![], vec![]);
    let (mut equal, mut difference) = (0, None);
    recorder.begin("time,torque,counts,frequency");
    for tick in 0..sweep.ticks() as usize {
        let (count, excitation) = (device.count(), exciter.next());
        let host = excitation.code.get();
        let code = match &mut board {
            Some(board) => {
                board.exchange(count).map_err(|source| RunError::EmulatedBoard { tick, source })?
            }
            None => host,
        };
        if code == host {
            equal += 1;
        } else if difference.is_none() {
            difference = Some(Difference { tick, count, host, target: code });
        }
        let command = torque_of(code, sweep.full_scale_torque());
        device.hold(command);
        let hertz = excitation.measured.map_or(0.0, |tone| sweep.tones()[tone].frequency);
        // Without the last digits, which are the product's rounding.
        let time = significant(tick as f64 * sweep.period(), 15);
        recorder.row(&format!("{time},{command},{count},{hertz}"));
        torque.push(command);
        counts.push(f64::from(count));
        frequency.push(hertz);
        progress();
    }
    let equal = board.is_some().then_some(equal);
    if let Some(board) = board {
        board.end()?;
    }
    let record = Record { period: sweep.period(), torque, counts, frequency: Some(frequency) };
    Ok(Measurement { record, equal, difference })
}
