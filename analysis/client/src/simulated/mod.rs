//! A simulated board with a simulated device, behind a socket: a thread with the same cycle and wire as a real
//! board.
//!
//! Its time advances by ticks, at the rate of a real board or as fast as possible. No tick is late, unlike on
//! a real board.

mod device;
mod listener;
mod plant_hardware;

use std::error::Error;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use haptic_model::file::SceneFile;
use haptic_model::simulation::SimulationError;
use haptic_servo::board::sim_hardware::SimHardware;
use haptic_servo::boot::{self, Program};
use haptic_servo::number::Number;
use haptic_servo::rendering::EnvironmentBesideHost;
use haptic_servo::scene::Scene;
use haptic_servo::servo::{
    BuildError, Latched, OutputMode, RenderingOptions, Step, SupportsTiming,
};
use haptic_servo::servo_loop::{FrameQueue, Mailbox, Options};
use haptic_servo::tuning::{self, RenderError, Tunable};
use haptic_servo::wire::{BoardInfo, Session};

pub use self::device::{PlantIo, SimulatedDevice};
pub use self::listener::Listener;
use self::plant_hardware::PlantHardware;
use crate::Address;
pub use haptic_model::simulation::device_in_hand::ReadingOutcome;

/// Timer counts in a period: a 170 MHz timer at 1 kHz.
const TIMER_COUNTS: u32 = 170_000;
/// Frames that wait for the wire.
const FRAMES: usize = 64;
/// Largest number of frames that are sent at a time.
const FRAMES_AT_A_TIME: usize = 16;
/// Longest time between two polls of the socket.
const POLL_INTERVAL: Duration = Duration::from_millis(1);
/// Duration in s for which the hand of a scene file's board repeats its trajectory: an hour.
const HAND_DURATION: f64 = 3600.0;
/// The longest name that a board tells its host, in bytes.
const LONGEST_NAME: usize = 32;

/// How fast a simulated board's time passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pacing {
    /// At the rate of a real board.
    RealTime,
    /// As fast as possible.
    Unthrottled,
}

/// A board that is a thread; ends when dropped.
#[derive(Debug)]
pub struct SimulatedBoard {
    address: Address,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<(), BoardEnd>>>,
}

/// The reason for which a board has ended before it was asked to.
pub type BoardEnd = Box<dyn Error + Send + Sync>;

/// Why a program could not start on a simulated board.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum SimulatedBoardError {
    #[error("refused by its {}: {reason}", .step.as_str())]
    Render { step: Step, reason: Box<RenderError> },
    /// Its program could not start, though nothing is wrong with its scene.
    #[error("refused by its {}", .0.as_str())]
    Start(Step),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error("cannot listen on {address}: {source}")]
    Listen { address: Address, source: io::Error },
}

impl SimulatedBoard {
    /// Boots a program and listens there.
    pub fn start<E, N, M>(
        name: &'static str,
        program: Program<E>,
        plant: Box<dyn PlantIo + Send>,
        address: &Address,
        pacing: Pacing,
    ) -> io::Result<Self>
    where
        E: Tunable<N> + SupportsTiming<M> + Send + 'static,
        N: Number,
        M: OutputMode,
    {
        Self::listen(address, move |listener, over| {
            let board = SimHardware::new(PlantHardware::new(plant, M::TIMING), TIMER_COUNTS);
            Ok(serve::<E, N, M>(name, program, board, listener, pacing, over)?)
        })
    }

    /// Boots a program of a scene file in a simulated hand, the file's if it has one, and listens there, with the
    /// host of the file beside its servo, if it has one. The device has the file's friction and cogging, and its
    /// encoder readings that fail. The sensor and the motor that the file does not state are the defaults of a
    /// simulation.
    ///
    /// # Errors
    /// No board renders the scene, or the address cannot be listened on.
    pub fn of_file(
        file: &SceneFile,
        address: &Address,
        pacing: Pacing,
    ) -> Result<Self, SimulatedBoardError> {
        let Some(host) = file.host else {
            return Self::of_scene(file, file.scene, address, pacing);
        };
        let environment = EnvironmentBesideHost { environment: file.scene.environment, host };
        Self::of_scene(file, file.scene.in_environment(environment), address, pacing)
    }

    /// The same with the scene as a program has it.
    fn of_scene<E>(
        file: &SceneFile,
        scene: Scene<E>,
        address: &Address,
        pacing: Pacing,
    ) -> Result<Self, SimulatedBoardError>
    where
        E: Tunable<f32> + SupportsTiming<Latched> + Send + 'static,
    {
        let transducers = file.transducers(None, None);
        let (rendering, options) = (RenderingOptions::DEFAULT, Options::DEFAULT);
        let program = Program { scene, transducers, rendering, options };
        program.check()?;
        tuning::explain::<_, f32, Latched>(&program.scene, &[], &transducers, &rendering)
            .map_err(|reason| not_rendered(reason.step(), reason))?;
        let hand = file.demonstration().repeated_until(HAND_DURATION);
        let plant = SimulatedDevice::new(&file.scene, hand, &transducers)?;
        let plant = Box::new(plant.with_disturbance(file.disturbance()).failing(file.dropped()));
        // A board's name is a constant.
        let name = &file.name[..file.name.floor_char_boundary(LONGEST_NAME)];
        let name = Box::leak(name.to_owned().into_boxed_str());
        Self::start::<E, f32, Latched>(name, program, plant, address, pacing)
            .map_err(|source| SimulatedBoardError::Listen { address: address.clone(), source })
    }

    /// Listens at an address, and serves what connects there in a thread.
    ///
    /// # Errors
    /// The address cannot be listened on.
    pub fn listen(
        address: &Address,
        serve: impl FnOnce(Listener, &AtomicBool) -> Result<(), BoardEnd> + Send + 'static,
    ) -> io::Result<Self> {
        let (listener, address) = Listener::bind(address)?;
        let ended = Arc::new(AtomicBool::new(false));
        let over = ended.clone();
        let thread = thread::spawn(move || serve(listener, &over));
        Ok(Self { address, ended, thread: Some(thread) })
    }

    /// Where it listens.
    pub fn address(&self) -> &Address {
        &self.address
    }

    /// Whether it has ended by itself, as [`Self::end`] explains.
    pub fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Ends it.
    ///
    /// # Errors
    /// Where its program could not start, or its board has stopped.
    ///
    /// # Panics
    /// If its thread has.
    pub fn end(mut self) -> Result<(), BoardEnd> {
        self.ended.store(true, Ordering::Relaxed);
        self.thread.take().map_or(Ok(()), |thread| thread.join().expect("the board panicked"))
    }
}

impl Drop for SimulatedBoard {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // `end` reports errors of the thread; here they are dropped.
            let _ = thread.join();
        }
    }
}

/// Why a program did not start.
fn not_started<E, N, M>(program: &Program<E>, step: Step) -> SimulatedBoardError
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    let Program { scene, transducers, rendering, .. } = program;
    match tuning::explain::<E, N, M>(scene, &[], transducers, rendering) {
        Err(reason) => not_rendered(step, reason),
        Ok(()) => SimulatedBoardError::Start(step),
    }
}

fn not_rendered(step: Step, reason: RenderError) -> SimulatedBoardError {
    SimulatedBoardError::Render { step, reason: Box::new(reason) }
}

/// The program, from boot to the end.
fn serve<E, N, M>(
    name: &'static str,
    program: Program<E>,
    mut board: SimHardware<PlantHardware>,
    mut listener: Listener,
    pacing: Pacing,
    over: &AtomicBool,
) -> Result<(), SimulatedBoardError>
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    let (mut mailbox, mut queue) = (Mailbox::new(), FrameQueue::<FRAMES>::new());
    let (requests, mut inbox) = mailbox.split();
    let (mut frames, ticks) = queue.split();
    let booted = boot::boot::<E, N, M>(&program, &mut board, &requests)
        .map_err(|step| not_started::<E, N, M>(&program, step))?;
    let (mut servo_loop, margin) = (booted.servo_loop, booted.margin);
    let (reset, previous_fault) = (booted.reset, booted.previous_fault);
    let (stack_left, power) = (|| None, || None);
    let timer_counts = TIMER_COUNTS;
    let low_brown_out = false;
    let info =
        BoardInfo { name, timer_counts, reset, low_brown_out, previous_fault, stack_left, power };
    let mut session = Session::new(program, margin, info, requests, ticks);
    let period = Duration::from_secs_f64(program.scene.timing.period);
    let (mut next, mut outgoing) = (Instant::now(), Vec::new());
    while !over.load(Ordering::Relaxed) {
        session.receive(&listener.receive());
        // At most half as many ticks as the queue holds frames; then the socket is served.
        for _ in 0..FRAMES / 2 {
            if pacing == Pacing::RealTime && Instant::now() < next {
                break;
            }
            next += period;
            if board.lines.begin() {
                servo_loop.run(&mut board, &mut inbox, &mut frames);
            }
        }
        // A client that does not read keeps the rest in the session, which drops ticks.
        if outgoing.is_empty() {
            for _ in 0..FRAMES_AT_A_TIME {
                session.poll();
                let length = session.outgoing().len();
                outgoing.extend_from_slice(session.outgoing());
                session.sent(length);
            }
        }
        listener.send(&mut outgoing);
        if pacing == Pacing::RealTime {
            thread::sleep(next.saturating_duration_since(Instant::now()).min(POLL_INTERVAL));
        }
    }
    Ok(())
}
