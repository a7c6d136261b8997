//! From reset to a running servo.

use core::fmt::Display;

use embassy_executor::Executor;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use static_cell::StaticCell;

use super::pace::Period;
use super::quadrature::Counter;
use super::registers::Registers;
use super::stop::stop;
use super::wiring::{self, CONVERTER, ENCODER};
use super::{Connected, Mode};
use crate::board::place::Place;
use crate::board::seat::{Ends, Meeting, Seat, ends};
use crate::board::{critical, stack};
use crate::boot::{Booted, Program, boot};
use crate::number::Number;
use crate::servo::{OutputMode, OutputTiming, Renders, Transducers};
use crate::tuning::Tunable;

/// Where the servo's interrupt finds its seat.
pub type ServoPlace<E, N> = Place<Seat<Registers, E, N, Mode>>;

/// Runs a scene.
pub fn run<E, N>(
    program: Program<E>,
    place: &'static ServoPlace<E, N>,
    meeting: &'static Meeting<E, N, Mode>,
) -> !
where
    E: Tunable<N> + Renders<Mode>,
    N: Number,
{
    let connected = connect();
    let period = program.scene.timing.period;
    let period = Period::of(period).unwrap_or_else(|error| refuse(&error));
    // The counter's width is the board's, whatever the program was first written for.
    let transducers = Transducers { counter: width(ENCODER), ..program.transducers };
    let program = Program { transducers, ..program };
    let mut registers = Registers::new(period);
    let Ends { requests, inbox, frames, told } = ends(meeting);
    let Booted { cycle, left, .. } =
        boot(&program, &mut registers, &requests).unwrap_or_else(|error| refuse(&error));
    if let Some(left) = left {
        defmt::warn!("left from before the reset: {}", defmt::Display2Format(&left.fault));
    }
    if Mode::TIMING == OutputTiming::Latched {
        CONVERTER.latch();
    }
    registers.start();
    // SAFETY: the interrupt that uses the place is not enabled yet.
    unsafe { place.fill(Seat { cycle, hardware: registers, inbox, frames }) };
    // SAFETY: its handler finds its place filled.
    unsafe { interrupt::TIM6_DAC.enable() };
    defmt::info!("{}: stack left {} of {}", wiring::NAME, stack::left(), stack::size());
    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        let _ = (&spawner, &connected, &requests, &told);
    })
}

/// Clocks, interrupts and pins. The amplifier is off and the converter at mid-scale.
pub(super) fn connect() -> Connected {
    let chip = embassy_stm32::init(wiring::clocks());
    #[cfg(feature = "fast-memory")]
    super::fast::load();
    let mut core = cortex_m::Peripherals::take().expect("the core is taken once");
    critical::lower_all(&mut core.NVIC);
    interrupt::TIM6_DAC.set_priority(Priority::P0);
    let connected = wiring::connect(chip);
    CONVERTER.stop();
    ENCODER.complete();
    connected
}

/// The width of a counter.
pub(super) const fn width<C: Counter>(_: C) -> crate::encoder::CounterWidth {
    C::WIDTH
}

/// Ends a program that cannot start. The amplifier has never been on.
pub(super) fn refuse(reason: &dyn Display) -> ! {
    stop();
    defmt::error!("{}", defmt::Display2Format(reason));
    loop {
        cortex_m::asm::wfi();
    }
}

/// The program of a scene on this board.
#[doc(hidden)]
#[macro_export]
macro_rules! board_program {
    ($scene:ident: $environment:ty, $certified:ident, $transducers:ident, $number:ty) => {
        $crate::board_chip!();

        /// The scene, as late as the board's converter: where it is not, this does not compile.
        const TIMED: $crate::certificate::Timed<
            $crate::scene::Scene<$environment>,
            $crate::board::stm32::Mode,
        > = $certified.timed::<$crate::board::stm32::Mode>();

        static PLACE: $crate::board::stm32::ServoPlace<$environment, $number> =
            $crate::board::place::Place::empty();
        static MEETING: $crate::board::seat::Meeting<
            $environment,
            $number,
            $crate::board::stm32::Mode,
        > = static_cell::StaticCell::new();

        $crate::board_tick!();

        #[cortex_m_rt::entry]
        fn main() -> ! {
            let program = $crate::boot::Program {
                scene: *TIMED.scene(),
                transducers: $transducers,
                rendering: $crate::servo::RenderingOptions::DEFAULT,
                options: $crate::cycle::Options::DEFAULT,
            };
            $crate::board::stm32::run(program, &PLACE, &MEETING)
        }
    };
}

/// The chip that a program is for, where probe-rs looks for it.
#[doc(hidden)]
#[macro_export]
macro_rules! board_chip {
    () => {
        /// The chip that this program is for.
        #[used]
        #[unsafe(no_mangle)]
        #[unsafe(link_section = ".probe-rs.chip")]
        static PROBE_RS_CHIP: [u8; $crate::board::stm32::wiring::CHIP.len()] =
            *$crate::board::stm32::wiring::CHIP;
    };
}

/// The handler of the pacing timer's interrupt, for what is in the place `PLACE`.
#[doc(hidden)]
#[macro_export]
macro_rules! board_tick {
    () => {
        /// A tick.
        #[unsafe(no_mangle)]
        #[cfg_attr(feature = "fast-memory", unsafe(link_section = ".fast"))]
        unsafe extern "C" fn TIM6_DAC() {
            // SAFETY: this is the handler of the interrupt that is enabled once the place is
            // filled, and no interrupt interrupts itself.
            unsafe { PLACE.get() }.tick();
        }
    };
}
