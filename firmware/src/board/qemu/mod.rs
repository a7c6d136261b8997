//! The emulated board: QEMU's `netduinoplus2`, an STM32F405, in lockstep with a process on the host.
//!
//! SysTick's interrupt is the servo's, with the highest priority. There is no encoder and no motor: the
//! host's simulation of the device provides a count and takes a code around each tick ([`lockstep`]), and a
//! tick accesses words of memory in place of registers ([`lines`]). Count and code are of the same instant,
//! because the simulation waits for the code. A program with a fixed phase has the time up to the phase for
//! its tick; the simulation ignores that time.
//!
//! The clocks keep their reset state in the emulator, where the set-up of a real F405's clocks would never
//! return.

pub mod lines;
pub mod lockstep;
#[cfg(feature = "log")]
pub mod log;
#[cfg(feature = "log")]
pub mod meter;
#[cfg(feature = "log")]
mod parts;
pub mod registers;
pub mod serial;
mod start;
pub(super) mod stop;
mod sweep;
pub mod tick;
pub mod tick_timer;

pub use start::{Mode, Statics, run};
pub use stop::{EXIT_DONE, EXIT_REFUSED};
pub use sweep::{SweepCell, measure};

/// All interrupts except SysTick's arrive here, because the program has no table of the chip's interrupts.
#[cortex_m_rt::exception]
unsafe fn DefaultHandler(number: i16) {
    assert!(number == serial::INTERRUPT.cast_signed(), "interrupt {number} was never enabled");
    // SAFETY: this is that interrupt's handler.
    unsafe { serial::receive() };
}

/// The program of a scene on this board.
#[doc(hidden)]
#[macro_export]
macro_rules! board_program {
    // The emulator has no bridge and no chip.
    (
        $environment:ty,
        $program:ident,
        $certified:ident,
        $number:ty,
        [$($mode:ty)?],
        $bridge:tt,
        $encoder:tt
    ) => {
        type ProgramMode = $crate::board::qemu::Mode<$($mode)?>;

        /// The scene, with its delay checked.
        const TIMED: $crate::certificate::TimingChecked<$crate::scene::Scene<$environment>, ProgramMode> =
            $certified.timing_checked();

        static STATICS: $crate::board::qemu::Statics<$environment, $number, ProgramMode> =
            $crate::board::qemu::Statics::empty();

        /// The counterpart of other boards' timer interrupt.
        #[inline(never)]
        extern "C" fn tick() {
            // SAFETY: called by the handler of the interrupt that `run` enables after filling the cell, and
            // no interrupt interrupts itself.
            unsafe { STATICS.isr.borrow_mut() }.tick();
        }

        /// A tick with the exchange with the host around it.
        #[unsafe(export_name = "SysTick")]
        unsafe extern "C" fn sys_tick() {
            // SAFETY: the cell is filled before the interrupt is enabled, and this is called before and after
            // a tick, when no reference to its content is alive.
            let state = || unsafe { STATICS.isr.borrow_mut() }.servo_loop.state();
            // SAFETY: as above.
            let lose = |missed| unsafe { STATICS.isr.borrow_mut() }.hardware.lose(missed);
            // SAFETY: the pipes are open before the interrupt is enabled.
            unsafe { $crate::board::qemu::tick::with(tick, state, lose) };
        }

        #[$crate::__private::cortex_m_rt::entry]
        fn main() -> ! {
            let program = $crate::boot::Program { scene: *TIMED.scene(), ..$program };
            let compiler = $certified.assessment();
            $crate::board::qemu::run(env!("CARGO_BIN_NAME"), program, compiler, &STATICS)
        }
    };
}

/// The program of a sweep on this board.
#[doc(hidden)]
#[macro_export]
macro_rules! board_sweep {
    // A simulated device stays within all limits.
    ($sweep:ident, $transducers:ident, $limits:ident, $bridge:tt, $encoder:tt) => {
        static ISR_STATE: $crate::board::qemu::SweepCell =
            $crate::board::isr_cell::IsrCell::empty();

        /// The counterpart of other boards' timer interrupt.
        #[inline(never)]
        extern "C" fn tick() {
            // SAFETY: called by the handler of the interrupt that `measure` enables after filling the cell,
            // and no interrupt interrupts itself.
            $crate::board::qemu::lines::write(unsafe { ISR_STATE.borrow_mut() }.next().code);
        }

        /// A tick with the exchange with the host around it.
        #[unsafe(export_name = "SysTick")]
        unsafe extern "C" fn sys_tick() {
            let state = || $crate::servo_loop::State::Running;
            // A sweep ignores periods that the host has skipped.
            let lose = |_| ();
            // SAFETY: the pipes are open and the cell is filled before the interrupt is enabled.
            unsafe { $crate::board::qemu::tick::with(tick, state, lose) };
        }

        #[$crate::__private::cortex_m_rt::entry]
        fn main() -> ! {
            $crate::board::qemu::measure(&$sweep, &ISR_STATE)
        }
    };
}
