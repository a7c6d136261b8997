//! The start of a program: from reset to a running servo.

use core::task::Poll;

use embassy_executor::{Executor, SpawnError, SpawnToken};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac;
use static_cell::StaticCell;

use super::quadrature::Counter;
use super::registers::Registers;
use super::serial::Serial;
use super::stop::stop;
use super::wiring;
#[cfg(not(feature = "magnetic"))]
use super::wiring::ENCODER;
use super::{family, output};
#[cfg(not(feature = "magnetic"))]
use crate::board::input_filter::InputFilter;
use crate::board::isr_cell::{IsrCell, MailboxCell, endpoints};
use crate::board::{critical, stack};
use crate::boot::{Booted, Program, Startup, boot};
use crate::fault::FaultRecord;
use crate::number::Number;
use crate::period as periods;
use crate::rendering::Rendering;
use crate::reset::ResetCause;
#[cfg(not(feature = "magnetic"))]
use crate::servo::Transducers;
use crate::servo::{OutputMode, OutputTiming, SupportsTiming};
use crate::servo_loop::{Endpoints, Reason, ServoIsr};
use crate::tuning::Tunable;
use crate::wire::{BoardInfo, Link, Session};

/// The servo's interrupt, which a bridge pends.
#[cfg(any(feature = "bridge", not(feature = "magnetic")))]
pub const TICK: pac::Interrupt = pac::Interrupt::TIM6_DAC;
/// The servo's interrupt: the end of a transfer.
#[cfg(all(feature = "magnetic", not(feature = "bridge")))]
pub const TICK: pac::Interrupt = pac::Interrupt::DMA1_CHANNEL1;

/// The state of the servo's interrupt.
pub type ServoCell<E, N, M, const FROZEN: u32> = IsrCell<ServoIsr<Registers<FROZEN>, E, N, M>>;

/// The link to the host, for the task below the servo.
pub type HostLink<E, N, M> = Link<Serial, E, N, M>;

/// The static of that link: a task would keep a copy for each step that passes it on.
pub type LinkCell<E, N, M> = StaticCell<HostLink<E, N, M>>;

/// A program's task that serves its [`HostLink`].
pub type Task<E, N, M, S> = fn(&'static mut HostLink<E, N, M>) -> Result<SpawnToken<S>, SpawnError>;

/// The statics of a program, with its scene's types.
pub struct Statics<E: Rendering<N> + 'static, N: Number, M: 'static, const FROZEN: u32> {
    /// State of the servo's interrupt.
    pub servo: &'static ServoCell<E, N, M, FROZEN>,
    /// The mailbox between the interrupt and the task below.
    pub mailbox: &'static MailboxCell<E, N, M>,
    /// The task's link to the host.
    pub link: &'static LinkCell<E, N, M>,
    /// The encoder's data of the program.
    pub encoder: EncoderSetup,
    /// The output's data of the program.
    pub output: output::Setup,
}

/// Runs a scene: its servo in the pacing timer's interrupt, and the host's `task` below it.
pub fn run<E, N, M, S, const FROZEN: u32>(
    name: &'static str,
    program: Program<E>,
    statics: Statics<E, N, M, FROZEN>,
    task: Task<E, N, M, S>,
) -> !
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    let link = bring_up(name, program, statics);
    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    EXECUTOR.init_with(Executor::new).run(|spawner| match task(link) {
        Ok(token) => spawner.spawn(token),
        // Spawning fails only if the task was spawned before, which does not happen.
        Err(_) => halt_with("the task of the host's link runs already"),
    })
}

/// The encoder's data of a program: the filter of its inputs, or its chip.
#[cfg(not(feature = "magnetic"))]
pub type EncoderSetup = InputFilter;
/// The encoder's data of a program.
#[cfg(feature = "magnetic")]
pub type EncoderSetup = &'static super::magnetic::Setup;

/// The program with the counter width of this board instead of its own, or a compile error. An absolute encoder has
/// the width of its chip.
#[track_caller]
pub const fn with_board_counter<E: Copy>(program: Program<E>) -> Program<E> {
    #[cfg(not(feature = "magnetic"))]
    let transducers = Transducers { counter: width(ENCODER), ..program.transducers };
    #[cfg(not(feature = "magnetic"))]
    let program = Program { transducers, ..program };
    program.checked()
}

/// Everything from reset to the first tick; returns the state of the task below the servo.
///
/// Not inlined, so that its frame is not on the stack when that task certifies a set, which takes most of the
/// stack.
#[inline(never)]
#[expect(clippy::mut_from_ref, reason = "the reference is to a static that is initialised once")]
fn bring_up<E, N, M, const FROZEN: u32>(
    name: &'static str,
    program: Program<E>,
    statics: Statics<E, N, M, FROZEN>,
) -> &'static mut HostLink<E, N, M>
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    let port = init_chip(statics.encoder);
    let mut hardware = registers(statics.output, program.scene.timing.period, M::TIMING);
    let timer_counts = hardware.period();
    let Endpoints { requests, inbox, frames, frame_reader } = endpoints(statics.mailbox);
    let Booted { servo_loop, margin, reset, previous_fault, arms_because } =
        boot(&program, &mut hardware, &requests).unwrap_or_else(|step| halt_with(step.as_str()));
    hardware.start(M::TIMING);
    // SAFETY: the interrupt that uses the cell is not enabled yet.
    unsafe { statics.servo.init(ServoIsr { servo_loop, hardware, inbox, frames }) };
    // SAFETY: its handler finds its cell filled.
    unsafe { TICK.enable() };
    log_banner(name);
    log_reset(reset, previous_fault, arms_because);
    let info = BoardInfo {
        name,
        timer_counts,
        reset,
        low_brown_out: family::has_low_brown_out(),
        previous_fault,
        stack_left: || Some(stack::unused()),
        power: output::power_reading,
    };
    let session = Session::new(program, margin, info, requests, frame_reader);
    statics.link.init(Link { port, session })
}

impl<E: Tunable<N> + SupportsTiming<M>, N: Number, M: OutputMode> HostLink<E, N, M> {
    /// Serves the host, and sleeps between interrupts: all work begins with an interrupt.
    pub async fn serve(&mut self) -> ! {
        loop {
            self.poll();
            cortex_m::asm::wfi();
            yield_now().await;
        }
    }
}

/// The registers of the servo's interrupt for a period in s; ends the program if the period is invalid.
pub fn registers<const FROZEN: u32>(
    setup: output::Setup,
    seconds: f64,
    timing: OutputTiming,
) -> Registers<FROZEN> {
    Registers::new(setup, seconds, timing).unwrap_or_else(|_| {
        let (shortest, longest) = (periods::SHORTEST, periods::LONGEST);
        defmt::error!("the period of {} s is not between {} and {} s", seconds, shortest, longest);
        halt_with("its period")
    })
}

/// Logs the program's name, the board and the free stack.
fn log_banner(name: &str) {
    let (free, size) = (stack::unused(), stack::size());
    defmt::info!("{=str} on {=str}, stack: {} of {} bytes left", name, wiring::NAME, free, size);
}

fn log_reset(reset: ResetCause, previous_fault: Option<FaultRecord>, arms_because: Option<Reason>) {
    defmt::info!("last reset: {=str}", reset.as_str());
    if let Some(FaultRecord { fault, tick, .. }) = previous_fault {
        let (_, [a, b]) = fault.encode();
        defmt::warn!("not armed: {=str} ({}, {}) in tick {}", fault.as_str(), a, b, tick);
    }
    if let Some(reason) = arms_because {
        defmt::warn!("armed at power-on: {=str}", reason.as_str());
    }
}

/// Sets up clocks, interrupts and pins; returns the port to the host. The motor is off, and the next torque is zero.
pub fn init_chip(encoder: EncoderSetup) -> Serial {
    let chip = embassy_stm32::init(wiring::clocks());
    family::full_speed();
    // From here on a stopped crystal is a fault and does not stop the core.
    pac::RCC.cr().modify(|w| w.set_csson(true));
    #[cfg(feature = "fast-memory")]
    super::ccm_sram::load();
    let mut core = cortex_m::Peripherals::take().expect("the core is taken once");
    critical::lower_all(&mut core.NVIC);
    TICK.set_priority(Priority::from(critical::SERVO << 4));
    let port = wiring::connect_pins(chip);
    output::stop();
    #[cfg(not(feature = "magnetic"))]
    ENCODER.complete(encoder);
    #[cfg(feature = "magnetic")]
    super::magnetic::set_up(encoder);
    port
}

/// The width of a counter.
pub const fn width<C: Counter>(_: C) -> crate::encoder::CounterWidth {
    C::WIDTH
}

/// Ends a program that cannot start. The amplifier has never been on. If this machine refuses a scene that
/// passed at compile time, `haptic certify` on the host prints the reason.
#[cold]
pub(super) fn halt_with(reason: &'static str) -> ! {
    stop();
    defmt::error!("refused by {=str}", reason);
    loop {
        cortex_m::asm::wfi();
    }
}

/// Lets the executor poll its other tasks, if there are any.
async fn yield_now() {
    let mut yielded = false;
    core::future::poll_fn(|context| {
        if core::mem::replace(&mut yielded, true) {
            return Poll::Ready(());
        }
        context.waker().wake_by_ref();
        Poll::Pending
    })
    .await
}

/// The program of a scene on this board.
#[doc(hidden)]
#[macro_export]
macro_rules! board_program {
    (
        $environment:ty,
        $program:ident,
        $certified:ident,
        $number:ty,
        [$($mode:ty)?],
        $bridge:tt,
        $encoder:tt
    ) => {
        type ProgramMode = $crate::board::ProgramMode<$($mode)?>;

        $crate::board_chip!();

        $crate::board_output!($bridge);

        $crate::board_encoder!(
            $encoder,
            $bridge,
            $program.transducers,
            $program.scene.latency.encoder,
            $program.scene.timing.period,
            $program
                .scene
                .latency
                .encoder
                .leaves_out($program.scene.timing.period, $program.scene.timing.worst_period)
        );

        /// The scene, whose delay must be that of the board's DAC; otherwise this does not compile.
        const TIMED: $crate::certificate::TimingChecked<$crate::scene::Scene<$environment>, ProgramMode> =
            $certified.timing_checked();

        /// The program with this board's counter.
        const BOARD_PROGRAM: $crate::boot::Program<$environment> =
            $crate::board::stm32::with_board_counter($program);

        static ISR_STATE: $crate::board::stm32::ServoCell<$environment, $number, ProgramMode, FROZEN> =
            $crate::board::isr_cell::IsrCell::empty();
        static MAILBOX: $crate::board::isr_cell::MailboxCell<$environment, $number, ProgramMode> =
            $crate::__private::static_cell::StaticCell::new();

        static LINK: $crate::board::stm32::LinkCell<$environment, $number, ProgramMode> =
            $crate::__private::static_cell::StaticCell::new();

        $crate::board_tick!();

        /// The task below the servo. A task may not be generic, so each program has its own.
        #[$crate::__private::task(embassy_executor = $crate::__private::embassy_executor)]
        async fn serve(
            link: &'static mut $crate::board::stm32::HostLink<$environment, $number, ProgramMode>,
        ) -> ! {
            link.serve().await
        }

        #[$crate::__private::cortex_m_rt::entry]
        fn main() -> ! {
            let program = $crate::boot::Program { scene: *TIMED.scene(), ..BOARD_PROGRAM };
            let name = env!("CARGO_BIN_NAME");
            let statics = $crate::board::stm32::Statics {
                servo: &ISR_STATE,
                mailbox: &MAILBOX,
                link: &LINK,
                encoder: ENCODER,
                output: OUTPUT,
            };
            $crate::board::stm32::run(name, program, statics, serve)
        }
    };
}

/// The program's chip, in the place where probe-rs looks for it.
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

/// The encoder's data of a program whose encoder the board counts; the feature is tested here as above.
#[cfg(not(feature = "magnetic"))]
#[doc(hidden)]
#[macro_export]
macro_rules! board_encoder {
    ([], $bridge:tt, $transducers:expr, $($of_chip:tt)*) => {
        $crate::board_filter!($transducers);

        const ENCODER: $crate::board::input_filter::InputFilter = FILTER;

        const FROZEN: u32 = 0;
    };
    ([$chip:expr], $($any:tt)*) => {
        compile_error!(
            "this program reads a magnetic encoder: build it with the feature `magnetic`"
        );
    };
}

/// The filter of the encoder's inputs for the fastest edges of a program's encoder.
#[doc(hidden)]
#[macro_export]
macro_rules! board_filter {
    ($transducers:expr) => {
        /// If the encoder's edges can be too fast for this board, this does not compile.
        const FILTER: $crate::board::input_filter::InputFilter =
            $crate::board::input_filter::InputFilter::of_encoder(
                &$transducers,
                $crate::board::stm32::wiring::TIMER_CLOCK,
            );
    };
}

/// The handler of the servo's interrupt, for the state in `ISR_STATE`.
#[cfg(any(feature = "bridge", not(feature = "magnetic")))]
#[doc(hidden)]
#[macro_export]
macro_rules! board_tick {
    () => {
        $crate::in_fast_memory! {
            /// A tick.
            #[unsafe(no_mangle)]
            unsafe extern "C" fn TIM6_DAC() {
                // SAFETY: this is the handler of the interrupt that is enabled after the cell is filled, and
                // no interrupt interrupts itself.
                unsafe { ISR_STATE.borrow_mut() }.tick();
            }
        }
    };
}

/// A function in memory without wait states, if the board has such memory. The feature is tested here,
/// because in the macro above it would be a feature of the program's crate.
#[cfg(feature = "fast-memory")]
#[doc(hidden)]
#[macro_export]
macro_rules! in_fast_memory {
    ($($function:tt)*) => {
        #[unsafe(link_section = ".fast")]
        $($function)*
    };
}

/// A function in flash.
#[cfg(not(feature = "fast-memory"))]
#[doc(hidden)]
#[macro_export]
macro_rules! in_fast_memory {
    ($($function:tt)*) => {
        $($function)*
    };
}
