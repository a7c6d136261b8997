//! From reset to a running servo.

use core::hint::black_box;

use embassy_executor::Executor;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use static_cell::StaticCell;

use super::pace::{Pace, Period};
use super::quadrature::Counter;
use super::serial::Serial;
use super::stop::stop;
use super::wiring::{self, CONVERTER, ENCODER};
use crate::board::StartError;
use crate::board::critical;
use crate::board::place::Place;
use crate::certificate::{Certified, Rejection};
use crate::environment::Renderable;
use crate::number::Number;
use crate::scene::Scene;
use crate::servo::{Servo, Transducers};

/// What `certify` gives.
pub type Judgement<E> = Result<Certified<Scene<E>>, Rejection>;

/// What a program brings.
pub struct SceneProgram<E: 'static> {
    /// The certificate from the compiler.
    pub certified: &'static Certified<Scene<E>>,
    /// The same judgement, for the board to repeat.
    pub certify: fn(Scene<E>) -> Judgement<E>,
    /// Sensor and motor.
    pub transducers: &'static Transducers,
}

/// What drives the motor, with its place between encoder and converter.
pub struct Seat<E: Renderable<N>, N: Number> {
    servo: Servo<E, N>,
    pace: Pace,
}

impl<E: Renderable<N>, N: Number> Seat<E, N> {
    /// One tick.
    #[inline(always)]
    pub fn tick(&mut self) {
        self.pace.passed();
        let output = self.servo.tick(ENCODER.count());
        CONVERTER.write(output.code);
    }
}

/// Runs a scene.
pub fn run<E, N>(program: SceneProgram<E>, place: &'static Place<Seat<E, N>>) -> !
where
    E: Copy + Renderable<N>,
    N: Number,
{
    let chip = embassy_stm32::init(wiring::clocks());
    #[cfg(feature = "fast-memory")]
    super::fast::load();
    let mut core = cortex_m::Peripherals::take().expect("the core is taken once");
    critical::lower_all(&mut core.NVIC);
    interrupt::TIM6_DAC.set_priority(Priority::P0);
    let connected = wiring::connect(chip);
    CONVERTER.stop();
    ENCODER.complete();
    let (servo, period) = prepare(&program);
    let mut pace = Pace::prepare(period);
    CONVERTER.latch();
    ENCODER.zero();
    pace.start();
    // SAFETY: the interrupt that uses the place is not enabled yet.
    unsafe { place.fill(Seat { servo, pace }) };
    // SAFETY: its handler finds its place filled.
    unsafe { interrupt::TIM6_DAC.enable() };
    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        spawner.spawn(link(connected.serial).unwrap());
    })
}

#[embassy_executor::task]
async fn link(mut serial: Serial) {
    loop {
        let mut bytes = [0; 16];
        let count = serial.read(&mut bytes);
        serial.write(&bytes[..count]);
        cortex_m::asm::wfi();
        yield_now().await;
    }
}

/// Certifies on the board, and builds the servo from that certificate.
///
/// In a frame of its own: judging takes most of the stack that a small board has, and must not
/// find the rest of the program below itself.
#[inline(never)]
fn prepare<E, N>(program: &SceneProgram<E>) -> (Servo<E, N>, Period)
where
    E: Copy + Renderable<N>,
    N: Number,
{
    // Hidden from the optimiser, which would otherwise judge a constant scene when it compiles.
    let certified = match (program.certify)(*black_box(program.certified.scene())) {
        Ok(certified) => certified,
        Err(rejection) => refuse(&StartError::Rejected(rejection)),
    };
    let servo = match Servo::new(&certified, program.transducers) {
        Ok(servo) => servo,
        Err(error) => refuse(&StartError::Unbuildable(error)),
    };
    match Period::of(certified.scene().timing.period) {
        Ok(reload) => (servo, reload),
        Err(error) => refuse(&error),
    }
}

/// Ends a program that cannot start.
fn refuse(reason: &dyn core::fmt::Display) -> ! {
    stop();
    defmt::error!("{}", defmt::Display2Format(reason));
    loop {
        cortex_m::asm::wfi();
    }
}

/// Lets the other tasks run once.
async fn yield_now() {
    let mut yielded = false;
    core::future::poll_fn(|context| {
        if core::mem::replace(&mut yielded, true) {
            return core::task::Poll::Ready(());
        }
        context.waker().wake_by_ref();
        core::task::Poll::Pending
    })
    .await
}

/// The program of a scene on this board.
#[doc(hidden)]
#[macro_export]
macro_rules! board_program {
    ($scene:ident: $environment:ty, $certified:ident, $transducers:ident, $number:ty) => {
        static SEAT: $crate::board::place::Place<
            $crate::board::stm32::Seat<$environment, $number>,
        > = $crate::board::place::Place::empty();

        /// The chip that this program is for, where probe-rs looks for it.
        #[used]
        #[unsafe(no_mangle)]
        #[unsafe(link_section = ".probe-rs.chip")]
        static PROBE_RS_CHIP: [u8; $crate::board::stm32::wiring::CHIP.len()] =
            *$crate::board::stm32::wiring::CHIP;

        /// A tick: the pacing timer's interrupt.
        #[unsafe(no_mangle)]
        #[cfg_attr(feature = "fast-memory", unsafe(link_section = ".fast"))]
        unsafe extern "C" fn TIM6_DAC() {
            // SAFETY: this is the handler of the interrupt that `run` enables once it has filled
            // the place, and no interrupt interrupts itself.
            unsafe { SEAT.get() }.tick();
        }

        #[cortex_m_rt::entry]
        fn main() -> ! {
            let program = $crate::board::stm32::SceneProgram {
                certified: &$certified,
                certify: $crate::scene::Scene::<$environment>::certify,
                transducers: &$transducers,
            };
            $crate::board::stm32::run(program, &SEAT)
        }
    };
}
