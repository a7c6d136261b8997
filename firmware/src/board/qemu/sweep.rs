//! A program of a sweep: the same codes as on the host, one per tick, from the first tick on.

use super::start::{open_pipes, period, start_timer};
use super::{lines, tick_timer};
use crate::board::isr_cell::IsrCell;
use crate::excitation::{Exciter, Sweep};

#[cfg(feature = "log")]
use super::{
    log::{Log, NoParts},
    start::calibrate,
};

/// The state of a sweep's interrupt.
pub type SweepCell = IsrCell<Exciter<'static>>;

/// Plays a sweep.
pub fn measure<const N: usize>(sweep: &'static Sweep<N>, cell: &'static SweepCell) -> ! {
    let timer = start_timer();
    #[cfg(feature = "log")]
    // SAFETY: the interrupt is not enabled yet.
    let mut log = unsafe { Log::open(calibrate(), NoParts) };
    let period = period(sweep.period());
    // SAFETY: the interrupt that uses the cell is not enabled yet.
    unsafe { cell.init(Exciter::new(sweep)) };
    open_pipes();
    lines::amplifier(true);
    tick_timer::start(timer, period);
    loop {
        #[cfg(feature = "log")]
        log.poll();
        core::hint::spin_loop();
    }
}
