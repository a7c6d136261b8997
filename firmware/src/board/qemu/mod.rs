//! The emulated board: QEMU's `netduinoplus2`, an STM32F405, in lockstep with a process on the host.
//!
//! SysTick paces the servo, which runs in an interrupt executor; a thread executor below it logs.
//! There is no encoder and no motor: the host's device simulation gives a count and takes a DAC
//! code for each tick ([`lockstep`]).
//!
//! The clocks are the ones that the emulator gives the chip out of reset; the set-up that a real
//! F405 needs never returns there.

#[cfg(feature = "log")]
pub mod judge;
pub mod lockstep;
#[cfg(feature = "log")]
pub mod log;
#[cfg(feature = "log")]
pub mod meter;
pub mod pace;
mod start;

pub use start::{Drive, Judgement, SceneProgram, Seat, measure, run};

use embassy_executor::InterruptExecutor;

/// Runs the servo's task, above everything else but SysTick.
static SERVO_EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// The interrupt that the servo's executor borrows: that of a timer which this board does not use.
#[derive(Clone, Copy)]
struct ServoInterrupt;

impl ServoInterrupt {
    /// TIM7 in the F405's vector table.
    const NUMBER: u16 = 55;
}

// SAFETY: the F405 has 82 interrupts, and 55 is one of them for as long as the program runs.
unsafe impl cortex_m::interrupt::InterruptNumber for ServoInterrupt {
    fn number(self) -> u16 {
        Self::NUMBER
    }
}

/// All interrupts arrive here, since the program brings no table of the chip's names.
#[cortex_m_rt::exception]
unsafe fn DefaultHandler(number: i16) {
    assert!(number == ServoInterrupt::NUMBER as i16, "interrupt {} was never enabled", number);
    #[cfg(feature = "log")]
    let start = meter::now();
    // SAFETY: this is the handler of the executor's interrupt, which `start` alone enables.
    unsafe { SERVO_EXECUTOR.on_interrupt() };
    #[cfg(feature = "log")]
    meter::INTERRUPT.add(start);
}

/// A fault ends the emulation, so that the host sees an error and not silence.
#[cortex_m_rt::exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    #[cfg(feature = "log")]
    defmt::error!("hard fault");
    semihosting::process::exit(EXIT_FAULT)
}

/// A panic ends the emulation likewise. None is reachable by input; this is for mistakes.
#[panic_handler]
fn panic(_info: &core::panic::PanicInfo<'_>) -> ! {
    #[cfg(feature = "log")]
    defmt::error!("{}", defmt::Display2Format(_info));
    semihosting::process::exit(EXIT_FAULT)
}

/// Exit status of a run that the host ended.
const EXIT_DONE: i32 = 0;
/// Exit status of a program that could not start; the log says why.
const EXIT_REFUSED: i32 = 1;
/// Exit status of a fault or a panic.
const EXIT_FAULT: i32 = 2;

/// The program of a scene on this board.
#[doc(hidden)]
#[macro_export]
macro_rules! board_program {
    ($scene:ident: $environment:ty, $certified:ident, $transducers:ident, $number:ty) => {
        /// The servo's task; a task may not be generic, so each program has its own.
        #[embassy_executor::task]
        async fn serve(
            seat: $crate::board::qemu::Seat<$crate::servo::Servo<$environment, $number>>,
        ) {
            seat.serve().await
        }

        #[cortex_m_rt::entry]
        fn main() -> ! {
            let program = $crate::board::qemu::SceneProgram {
                certified: &$certified,
                certify: $crate::scene::Scene::<$environment>::certify,
                transducers: &$transducers,
            };
            $crate::board::qemu::run(program, serve)
        }
    };
}

/// The program of a sweep on this board.
#[doc(hidden)]
#[macro_export]
macro_rules! board_sweep {
    ($sweep:ident) => {
        /// The exciter's task.
        #[embassy_executor::task]
        async fn serve(seat: $crate::board::qemu::Seat<$crate::excitation::Exciter<'static>>) {
            seat.serve().await
        }

        #[cortex_m_rt::entry]
        fn main() -> ! {
            $crate::board::qemu::measure(&$sweep, serve)
        }
    };
}
