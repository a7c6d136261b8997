//! The start of a program: from reset to a running servo.

use cortex_m::peripheral::SYST;
#[cfg(feature = "log")]
use semihosting::println;
use static_cell::StaticCell;

use super::lockstep;
use super::registers::Registers;
use super::serial::{self, Serial};
use super::stop::halt_with;
use super::tick_timer::{self, Period};
use crate::board::isr_cell::{IsrCell, MailboxCell, endpoints};
use crate::board::{critical, stack};
use crate::boot::{Booted, Program, boot};
use crate::certificate::Assessment;
use crate::number::Number;
use crate::servo::{OutputMode, SupportsTiming};
use crate::servo_loop::{Endpoints, ServoIsr};
use crate::tuning::Tunable;
use crate::wire::{BoardInfo, Link, Session};

#[cfg(feature = "log")]
use crate::certificate::{certify_in, scene_data};
#[cfg(feature = "log")]
use crate::servo::Step;

#[cfg(feature = "log")]
use super::{
    log::{self, Log},
    meter::{self, Scale},
    parts::CycleParts,
};

/// The output mode of a program, by default at the instant of the count, as in the simulation.
pub type Mode<M = crate::servo::Simultaneous> = M;

/// The statics of a program, with its scene's types. The interrupt's state is first, within the reach of a
/// floating-point load (1020 bytes), so that no address is computed for it.
#[repr(C)]
pub struct Statics<E: Tunable<N>, N: Number, M: OutputMode> {
    /// The state of the servo's interrupt.
    pub isr: IsrCell<ServoIsr<Registers, E, N, M>>,
    mailbox: MailboxCell<E, N, M>,
    link: StaticCell<Link<Serial, E, N, M>>,
    #[cfg(feature = "log")]
    log: StaticCell<Log<CycleParts<E, N, M>>>,
}

impl<E: Tunable<N>, N: Number, M: OutputMode> Statics<E, N, M> {
    /// Empty statics.
    pub const fn empty() -> Self {
        Self {
            isr: IsrCell::empty(),
            mailbox: StaticCell::new(),
            link: StaticCell::new(),
            #[cfg(feature = "log")]
            log: StaticCell::new(),
        }
    }
}

/// Runs a scene; `compiler` is its assessment at compile time.
pub fn run<E, N, M>(
    name: &'static str,
    program: Program<E>,
    compiler: &Assessment,
    statics: &'static Statics<E, N, M>,
) -> !
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    let timer = start_timer();
    let period = period(program.scene.timing.period);
    #[cfg(feature = "log")]
    let log = {
        let scale = calibrate();
        judge::<E, N>(&program, compiler);
        open_log(scale, &program, statics)
    };
    #[cfg(not(feature = "log"))]
    let _ = compiler;
    let link = prepare(name, program, period, statics);
    open_pipes();
    tick_timer::start(timer, period);
    serve(
        link,
        #[cfg(feature = "log")]
        log,
    )
}

/// Begins the log. Not inlined, like the next functions, so that its frame is not on the stack afterwards.
#[cfg(feature = "log")]
#[inline(never)]
#[expect(clippy::mut_from_ref, reason = "the reference is to a static that is initialised once")]
fn open_log<E: Tunable<N>, N: Number, M: OutputMode>(
    scale: Scale,
    program: &Program<E>,
    statics: &'static Statics<E, N, M>,
) -> &'static mut Log<CycleParts<E, N, M>> {
    // SAFETY: the interrupt is not enabled yet.
    statics.log.init_with(|| unsafe { Log::open(scale, CycleParts::new(program)) })
}

/// The work below the interrupt.
#[inline(never)]
fn serve<E, N, M>(
    link: &mut Link<Serial, E, N, M>,
    #[cfg(feature = "log")] log: &mut Log<CycleParts<E, N, M>>,
) -> !
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    // Does not sleep: with WFI the emulator's time advances by two periods of SysTick at a time.
    loop {
        #[cfg(not(feature = "log"))]
        link.poll();
        #[cfg(feature = "log")]
        {
            log.around(|| link.poll());
            log.poll();
        }
    }
}

/// Everything up to the first tick; returns the link to the host.
///
/// Not inlined, so that its frame is not on the stack while the host's sets are certified.
#[inline(never)]
#[expect(clippy::mut_from_ref, reason = "the reference is to a static that is initialised once")]
fn prepare<E, N, M>(
    name: &'static str,
    program: Program<E>,
    period: Period,
    statics: &'static Statics<E, N, M>,
) -> &'static mut Link<Serial, E, N, M>
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    let mut hardware = Registers::new(period);
    let Endpoints { requests, inbox, frames, frame_reader } = endpoints(&statics.mailbox);
    let Booted { servo_loop, margin, reset, previous_fault, .. } =
        boot(&program, &mut hardware, &requests).unwrap_or_else(|step| halt_with(step.as_str()));
    #[cfg(feature = "log")]
    println!("reset={}", reset.as_str());
    #[cfg(feature = "log")]
    if let Some(previous_fault) = previous_fault {
        let (code, [a, b]) = previous_fault.fault.encode();
        println!("left={} code={code} numbers={a},{b}", previous_fault.fault.as_str());
    }
    hardware.start();
    // SAFETY: the interrupt that uses the cell is not enabled yet.
    unsafe { statics.isr.init(ServoIsr { servo_loop, hardware, inbox, frames }) };
    let timer_counts = period.clock_counts();
    let info = BoardInfo {
        name,
        timer_counts,
        reset,
        low_brown_out: false,
        previous_fault,
        stack_left: || Some(stack::unused()),
        power: || None,
    };
    statics.link.init_with(|| Link {
        port: serial::open(),
        session: Session::new(program, margin, info, requests, frame_reader),
    })
}

/// Starts the clock and sets the priorities. Call it once.
pub(super) fn start_timer() -> SYST {
    let mut core = cortex_m::Peripherals::take().expect("the core is taken once");
    tick_timer::start_clock();
    // SysTick keeps its reset priority, which is higher.
    critical::lower_all(&mut core.NVIC);
    core.SYST
}

/// The period; ends the program if it is invalid.
pub(super) fn period(seconds: f64) -> Period {
    Period::of(seconds).unwrap_or_else(|_| halt_with("the timer cannot pace its period"))
}

/// Opens the pipes to the host. The interrupt that uses the pipes must not be enabled yet.
pub(super) fn open_pipes() {
    // SAFETY: called before the timer starts.
    if unsafe { lockstep::open() }.is_err() {
        halt_with("no host holds the pipes");
    }
}

#[cfg(feature = "log")]
pub(super) fn calibrate() -> Scale {
    let scale = Scale::calibrate();
    let Scale { per_instruction, overhead, around } = scale;
    println!("per_instruction={per_instruction} overhead={overhead} around={around}");
    scale
}

/// Certifies the scene, as [`boot`] does again later, and logs the cost and the result.
///
/// Not inlined: certifying takes most of a small board's stack.
#[cfg(feature = "log")]
#[inline(never)]
fn judge<E: Tunable<N>, N: Number>(program: &Program<E>, compiler: &Assessment) {
    // Hidden from the optimiser, which would otherwise certify a constant scene at compile time.
    let scene = scene_data(&program.scene);
    let start = meter::now();
    let judged = certify_in(core::hint::black_box(&scene), N::FORMAT);
    let time = meter::now().wrapping_sub(start);
    let Ok(assessment) = &judged else { halt_with(Step::Certificate.as_str()) };
    log::certificate("compiler", compiler);
    log::certificate("board", assessment);
    let (size, unused) = (stack::size(), stack::unused());
    println!("certify_time={time} stack_used={} stack_size={size}", size - unused);
}
