//! From reset to a measurement: the same codes as on the host, one a tick, from the first tick on.

use super::start::{begin, connect, period};
use super::{lines, pace};
use crate::board::place::Place;
use crate::excitation::{Exciter, Sweep};

#[cfg(feature = "log")]
use super::{
    log::{Log, NoParts},
    start::calibrate,
};

/// Where a sweep's interrupt finds what it plays.
pub type SweepPlace = Place<Exciter<'static>>;

/// Plays a sweep.
pub fn measure<const N: usize>(sweep: &'static Sweep<N>, place: &'static SweepPlace) -> ! {
    let timer = begin();
    #[cfg(feature = "log")]
    // SAFETY: the interrupt is not enabled yet.
    let mut log = unsafe { Log::open(calibrate(), NoParts) };
    let period = period(sweep.period());
    // SAFETY: the interrupt that uses the place is not enabled yet.
    unsafe { place.fill(Exciter::new(sweep)) };
    connect();
    lines::amplifier(true);
    pace::start(timer, period);
    loop {
        #[cfg(feature = "log")]
        log.poll();
        core::hint::spin_loop();
    }
}
