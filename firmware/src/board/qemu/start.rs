//! From reset to a running servo, or to a measurement.

use core::hint::black_box;

use cortex_m::peripheral::SYST;
use embassy_executor::{Executor, SpawnError, SpawnToken};
use static_cell::StaticCell;

use super::{EXIT_REFUSED, SERVO_EXECUTOR, ServoInterrupt, lockstep, pace};
use crate::board::StartError;
use crate::certificate::{Certified, Rejection};
use crate::dac::Dac;
use crate::encoder::{Encoder, RawCount};
use crate::environment::Renderable;
use crate::excitation::{Exciter, Sweep};
use crate::number::Number;
use crate::scene::Scene;
use crate::servo::{Output, Servo, Transducers};
use crate::torque::LimitReason;

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

/// What has a code for every count.
pub trait Drive {
    /// One tick.
    fn tick(&mut self, raw: RawCount) -> Output;
}

impl<E: Renderable<N>, N: Number> Drive for Servo<E, N> {
    #[inline(always)]
    fn tick(&mut self, raw: RawCount) -> Output {
        Servo::tick(self, raw)
    }
}

/// Open loop: the host, which has the counts, does the measuring.
impl Drive for Exciter<'_> {
    #[inline(always)]
    fn tick(&mut self, _: RawCount) -> Output {
        Output { code: self.next().code, limit: LimitReason::None }
    }
}

/// What drives the motor, with its place between encoder and DAC.
pub struct Seat<D> {
    drive: D,
    counts: lockstep::Counts,
    codes: lockstep::Codes,
    #[cfg(feature = "log")]
    frames: super::log::Frames,
}

impl<D: Drive> Seat<D> {
    /// The loop, one tick a period, until the host closes the pipe.
    #[cfg(not(feature = "log"))]
    pub async fn serve(mut self) {
        loop {
            pace::next().await;
            let raw = self.counts.read();
            if !self.counts.open() {
                semihosting::process::exit(super::EXIT_DONE);
            }
            let output = self.drive.tick(raw);
            self.codes.write(output.code);
        }
    }

    /// The loop, one tick a period, until the host closes the pipe; each tick is measured
    /// and leaves a frame.
    #[cfg(feature = "log")]
    pub async fn serve(mut self) {
        use super::{log::Frame, meter};
        loop {
            let due = pace::next().await;
            let (interrupt, lockstep) = (meter::INTERRUPT.take(), meter::LOCKSTEP.take());
            let raw = self.counts.read();
            if !self.counts.open() {
                return self.frames.end();
            }
            let (output, compute) = meter::tick(raw, |raw| self.drive.tick(raw));
            self.codes.write(output.code);
            self.frames.push(Frame { code: output.code, due, compute, interrupt, lockstep });
        }
    }
}

/// Certifies the scene again, builds its servo, and runs it with the task `serve`.
pub fn run<E, N, S>(
    program: SceneProgram<E>,
    serve: fn(Seat<Servo<E, N>>) -> Result<SpawnToken<S>, SpawnError>,
) -> !
where
    E: Copy + Renderable<N>,
    N: Number,
    S: Send,
{
    let clock = Clock::take();
    let (servo, reload) = prepare(&program);
    paced(clock, servo, reload, serve)
}

/// Plays a sweep with the task `serve`.
pub fn measure<const N: usize, S: Send>(
    sweep: &'static Sweep<N>,
    serve: fn(Seat<Exciter<'static>>) -> Result<SpawnToken<S>, SpawnError>,
) -> ! {
    let clock = Clock::take();
    let reload = pace::reload(sweep.period()).unwrap_or_else(|error| refuse(&error));
    paced(clock, Exciter::new(sweep), reload, serve)
}

/// What keeps time on the board.
struct Clock {
    timer: SYST,
    #[cfg(feature = "log")]
    scale: super::meter::Scale,
}

impl Clock {
    /// The timer, and the scale of the log's times. To be called once.
    fn take() -> Self {
        let core = cortex_m::Peripherals::take().expect("the core is taken once");
        #[cfg(feature = "log")]
        let scale = super::meter::Scale::calibrate();
        #[cfg(feature = "log")]
        defmt::info!("per_instruction={} overhead={}", scale.per_instruction, scale.overhead);
        Self {
            timer: core.SYST,
            #[cfg(feature = "log")]
            scale,
        }
    }
}

/// Opens the pipes and has what drives the motor run once a period.
fn paced<D, S: Send>(
    clock: Clock,
    drive: D,
    reload: u32,
    serve: fn(Seat<D>) -> Result<SpawnToken<S>, SpawnError>,
) -> ! {
    let Ok((counts, codes)) = lockstep::open() else { refuse(&"no host holds the pipes") };

    #[cfg(feature = "log")]
    let (frames, end) = super::log::frames();
    let seat = Seat {
        drive,
        counts,
        codes,
        #[cfg(feature = "log")]
        frames,
    };
    SERVO_EXECUTOR.start(ServoInterrupt).spawn(task(serve(seat)));
    pace::start(clock.timer, reload);

    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        #[cfg(feature = "log")]
        spawner.spawn(task(super::log::log(end, clock.scale)));
        spawner.spawn(task(idle()));
    })
}

/// Certifies on the board, and builds the servo from that certificate.
///
/// In a frame of its own, and ending here where the scene is refused: judging takes most of the
/// stack that a small board has, and must not find the rest of the program below itself.
#[inline(never)]
fn prepare<E, N>(program: &SceneProgram<E>) -> (Servo<E, N>, u32)
where
    E: Copy + Renderable<N>,
    N: Number,
{
    #[cfg(feature = "log")]
    let start = super::meter::now();
    // Hidden from the optimiser, which would otherwise judge a constant scene when it compiles.
    let certified = match (program.certify)(*black_box(program.certified.scene())) {
        Ok(certified) => certified,
        Err(rejection) => refuse(&StartError::Rejected(rejection)),
    };
    #[cfg(feature = "log")]
    {
        let time = super::meter::now().wrapping_sub(start);
        super::log::certificate("compiler", program.certified.assessment());
        super::log::certificate("board", certified.assessment());
        let (used, size) = super::meter::stack();
        defmt::info!("certify_time={} stack_used={} stack_size={}", time, used, size);
    }
    let servo = match Servo::new(&certified, program.transducers) {
        Ok(servo) => servo,
        Err(error) => refuse(&StartError::Unbuildable(error)),
    };
    match pace::reload(certified.scene().timing.period) {
        Ok(reload) => (servo, reload),
        Err(error) => refuse(&error),
    }
}

/// Ends a program that cannot start.
fn refuse(reason: &dyn core::fmt::Display) -> ! {
    #[cfg(feature = "log")]
    defmt::error!("{}", defmt::Display2Format(reason));
    #[cfg(not(feature = "log"))]
    let _ = reason;
    semihosting::process::exit(EXIT_REFUSED)
}

/// A task's token; each task here is spawned once, so its place is free.
fn task<S>(token: Result<SpawnToken<S>, SpawnError>) -> SpawnToken<S> {
    token.unwrap_or_else(|error| refuse(&error))
}

/// Sleeps until the next interrupt whenever nothing else wants to run. The executor's own way to
/// sleep, WFE, is no sleep in the emulator: time would pass an instruction at a time.
#[embassy_executor::task]
async fn idle() {
    loop {
        cortex_m::asm::wfi();
        yield_now().await;
    }
}

/// Lets the other tasks run once.
pub(super) async fn yield_now() {
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
