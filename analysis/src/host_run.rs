//! A run with a host that wants energy: what it was refused, and what the hand has taken of the budget.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;

use haptic_model::board::client::frame;
use haptic_model::host::{
    HostEnergy, HostLaw, HostRun, HostSender, HostedServo, HostileHost, unlimited,
};
use haptic_servo::host::{HostError, HostTorque};
use haptic_servo::number::Format;
use haptic_servo::scene::{Latency, Scene, TimeRange};
use haptic_servo::servo::{OutputTiming, Transducers};
use haptic_servo::wire::host::{HostCommand, HostReport, HostRequest, HostState};
use haptic_servo::wire::message::{LONGEST_TO_HOST, ToBoard};
use haptic_servo::wire::{CHECKSUM, Decoder};

use crate::bridge_board::BridgeBoard;
use crate::compare_run::{Backend, BoardMeasurement, RunError, RunOutcome};
use crate::controller::Controller;
use crate::device::Energy;
use crate::emulator::{Emulator, EmulatorError};
use crate::link::Message;
use crate::lockstep::{PlantIo, Run, SimulatedDevice};
use crate::shaft::HandHeldShaft;
use crate::virtual_board::VirtualBoard;

/// Largest number of ticks after a run on a board in which the last report arrives.
const MOST_TICKS: usize = 100_000;

/// A servo, and the host that stands beside it.
pub struct BesideHost {
    /// The scene, certified with the host's share.
    pub scene: Scene,
    /// Encoder and motor.
    pub transducers: Transducers,
    /// What the host may do.
    pub budget: HostTorque,
    /// Its law.
    pub law: HostLaw,
    /// Whether the budget holds; without a tank the servo gives every torque.
    pub has_tank: bool,
    /// The servo's number format.
    pub format: Format,
    /// Whether the supply of a board's own bridge takes no energy back.
    pub stores: bool,
}

impl BesideHost {
    /// The host beside the servo of the scene.
    ///
    /// # Errors
    /// If there is no proof for it.
    pub fn servo<'c>(
        &self,
        controller: &'c mut dyn Controller,
        output: OutputTiming,
    ) -> Result<HostedServo<'c>, HostError> {
        let Self { scene, transducers, .. } = self;
        let open = unlimited(&self.budget, scene.timing.period);
        let budget = if self.has_tank { self.budget } else { open };
        let kind = (self.format, self.stores);
        HostedServo::new(Box::new(controller), &budget, scene, transducers, output, kind)
    }

    fn sender(&self) -> HostSender {
        let host = HostileHost::new(self.law, self.budget.torque);
        HostSender::new(host, self.scene.timing.period, &self.transducers, 0)
    }

    fn energy(&self, output: OutputTiming, latency: &Latency) -> HostEnergy {
        let ticks = usize::from(output == OutputTiming::Latched);
        HostEnergy::new(&self.budget, latency, self.scene.timing.period, ticks)
    }

    fn host_run(&self) -> HostRun {
        let (law, budget, period) = (self.law, self.budget, self.scene.timing.period);
        HostRun { law, budget, period, ticks: Vec::new(), taken: Vec::new() }
    }

    /// Runs a servo on this machine for so many ticks, with each torque at its count.
    ///
    /// # Errors
    /// If there is no proof for the host.
    pub fn run(
        &self,
        controller: &mut dyn Controller,
        mut device: SimulatedDevice,
        ticks: usize,
        mut progress: impl FnMut(),
    ) -> Result<RunOutcome, HostError> {
        let output = OutputTiming::Simultaneous;
        let mut run = Run::from_rest(controller);
        let mut servo = self.servo(controller, output)?.driven_by(self.sender());
        let (mut host, mut energy) = (self.host_run(), self.energy(output, &self.scene.latency));
        while run.ticks.len() < ticks
            && let Some(count) = device.count()
        {
            let tick = servo.tick(count);
            let before = device.motion().position;
            device.hold(tick.code);
            host.ticks.push(servo.last());
            let moved = device.motion().position - before;
            host.taken.push(energy.tick(servo.last().given, moved));
            run.add(count, tick, tick.code);
            progress();
        }
        Ok(outcome(run, end_of(&device), host, None))
    }

    /// Runs the scene's program on a board, whose host sends its commands over the serial port. Then the servo
    /// on this machine gets the same counts, and each command in the tick in which the board took it.
    ///
    /// # Errors
    /// If the board stops or does not report all commands.
    pub fn run_on(
        &self,
        board: Backend<'_>,
        controller: &mut dyn Controller,
        device: SimulatedDevice,
        ticks: usize,
        progress: impl FnMut(),
    ) -> Result<RunOutcome, RunError> {
        match board {
            Backend::Emulator(elf) => {
                let mut emulator = Emulator::boot(elf)?;
                let mut port = emulator.arm_and_wait()?;
                port.set_nonblocking(true).map_err(EmulatorError::Serial)?;
                let exchange = |count, bytes: &[u8]| {
                    Ok(exchange_with_port(&mut emulator, &mut port, count, bytes)?)
                };
                let mut held = Held { exchange, device, count: 0 };
                let recorded = self.record(&mut held, ticks, progress)?;
                let report = BoardMeasurement::Emulated(Box::new(emulator.finish()?));
                self.replayed(recorded, controller, OutputTiming::Simultaneous, report)
            }
            Backend::VirtualBoard { program, board, elf, period, is_magnetic } => {
                let mut board = VirtualBoard::boot(program, board, elf, None, is_magnetic)?;
                board.arm_and_wait(period)?;
                let exchange = |count, bytes: &[u8]| Ok(board.exchange(count, bytes)?);
                let mut held = Held { exchange, device, count: 0 };
                let recorded = self.record(&mut held, ticks, progress)?;
                let report = BoardMeasurement::Virtual(board.finish()?);
                self.replayed(recorded, controller, self.output(), report)
            }
        }
    }

    /// The same on a virtual board whose own bridge drives the motor of this shaft. The board is aligned and armed
    /// before.
    ///
    /// # Errors
    /// If the board stops or does not report all commands.
    pub fn run_on_bridge(
        &self,
        mut board: BridgeBoard,
        controller: &mut dyn Controller,
        shaft: HandHeldShaft,
        ticks: usize,
        progress: impl FnMut(),
    ) -> Result<RunOutcome, RunError> {
        board.align_and_arm(&self.scene)?;
        let before = board.past().to_vec();
        let mut held = HeldShaft { board, shaft };
        // The steps of the shaft are those of the board's ticks, and its torques come without the encoder's age.
        let output_delay = TimeRange::exactly(self.scene.latency.stated_delay());
        let latency = Latency { output_delay, ..self.scene.latency };
        let recorded = Recorded { before, latency, ..self.record(&mut held, ticks, progress)? };
        let report = BoardMeasurement::Virtual(held.board.finish()?);
        self.replayed(recorded, controller, self.output(), report)
    }

    /// When the scene's program on a board puts out the torque of a count.
    const fn output(&self) -> OutputTiming {
        OutputTiming::of_delay(self.scene.latency.code_delay(self.scene.timing.period))
    }

    fn record(
        &self,
        held: &mut impl BoardInHand,
        ticks: usize,
        mut progress: impl FnMut(),
    ) -> Result<Recorded, RunError> {
        let (mut sender, mut bytes) = (self.sender(), Vec::new());
        let mut decoder = FromBoard::new();
        let (mut ran, mut torques, mut states) = (Vec::new(), Vec::new(), Vec::new());
        while ran.len() < ticks
            && let Some((exchanged, heard)) = held.tick(&std::mem::take(&mut bytes))?
        {
            states.extend(heard.into_iter().filter_map(|byte| reported(&mut decoder, byte)));
            // As the client of a board, the host waits for the report of its command before it sends the next.
            let may_send = states.len() == torques.len();
            if let Some(torque) = sender.after(exchanged.count).filter(|_| may_send) {
                let number = torques.len() as u16;
                torques.push(torque);
                bytes = frame(&ToBoard::Host(HostRequest::Torque(HostCommand {
                    number,
                    torque,
                    ramp: 0,
                })));
            }
            ran.push(exchanged);
            progress();
        }
        let (energy, final_speed) = held.end();
        for _ in 0..MOST_TICKS {
            if states.len() == torques.len() {
                break;
            }
            let heard = held.stand(&std::mem::take(&mut bytes))?;
            states.extend(heard.into_iter().filter_map(|byte| reported(&mut decoder, byte)));
        }
        let (before, latency) = (Vec::new(), self.scene.latency);
        Ok(Recorded { before, latency, ran, torques, states, energy, final_speed })
    }

    fn replayed(
        &self,
        recorded: Recorded,
        controller: &mut dyn Controller,
        output: OutputTiming,
        board: BoardMeasurement,
    ) -> Result<RunOutcome, RunError> {
        let (begin, commands) = recorded.commands()?;
        let mut run = Run::from_rest(controller);
        let mut servo = self.servo(controller, output)?;
        match recorded.before.len().checked_sub(begin as usize) {
            Some(first) => servo.follow(&recorded.before[first..]),
            None => servo.rest(begin),
        }
        let (mut host, mut energy) = (self.host_run(), self.energy(output, &recorded.latency));
        for (exchanged, command) in recorded.ran.iter().zip(commands) {
            let &Exchanged { count, code, moved } = exchanged;
            if let Some(torque) = command {
                servo.send(torque, 0);
            }
            let tick = servo.tick(count);
            host.ticks.push(servo.last());
            host.taken.push(energy.tick(servo.last().given, moved));
            run.add(count, tick, code);
        }
        let Recorded { energy, final_speed, .. } = recorded;
        Ok(outcome(run, (energy, final_speed), host, Some(board)))
    }
}

/// The decoder of a board's messages.
type FromBoard = Decoder<{ LONGEST_TO_HOST + CHECKSUM }>;

/// The report of a command, if it ends with this byte.
fn reported(decoder: &mut FromBoard, byte: u8) -> Option<HostState> {
    match decoder.push(byte) {
        Some(Message::Host(HostReport::State(state))) => Some(state),
        _ => None,
    }
}

fn outcome(
    run: Run,
    (energy, final_speed): (Energy, f64),
    host: HostRun,
    board: Option<BoardMeasurement>,
) -> RunOutcome {
    let (energy, final_speed) = (Some(energy), Some(final_speed));
    RunOutcome { run, energy, final_speed, board, host: Some(host) }
}

/// Energy that passed between hand and device, and the speed of the device in rad/s.
fn end_of(device: &SimulatedDevice) -> (Energy, f64) {
    (device.energy(), device.motion().velocity.abs())
}

/// A tick of a board.
struct Exchanged {
    count: i32,
    code: u16,
    /// Step of the position in rad in the period that begins with the count.
    moved: f64,
}

/// A run on a board.
struct Recorded {
    /// The count of each tick before the run, and whether an alignment moved the handle in it, where a motor did.
    before: Vec<(i32, bool)>,
    /// From the instants of the recorded steps to their torques.
    latency: Latency,
    ran: Vec<Exchanged>,
    /// The torques of the commands, in N m.
    torques: Vec<f32>,
    /// The ticks that took them.
    states: Vec<HostState>,
    energy: Energy,
    final_speed: f64,
}

impl Recorded {
    /// The board's ticks before the run, and for each tick of the run the torque of the command that it took.
    fn commands(&self) -> Result<(u32, Vec<Option<f32>>), RunError> {
        let (sent, reported) = (self.torques.len(), self.states.len());
        let numbers = self.states.iter().map(|state| state.number);
        let unreported = RunError::Unreported { sent, reported };
        if sent != reported || !numbers.eq((0..sent).map(|number| number as u16)) {
            return Err(unreported);
        }
        let mut commands = vec![None; self.ran.len()];
        let Some(first) = self.states.first() else { return Ok((0, commands)) };
        let tick_of = |state: &HostState, begin: u32| state.tick.wrapping_sub(begin) as usize;
        // The last command may be taken after the run.
        let fits = |state: &HostState, begin: u32| {
            let ran = self.ran.get(tick_of(state, begin));
            ran.is_none_or(|ran| ran.count == state.count)
        };
        // The number of the run's first tick, by the counts.
        let begin = (0..self.ran.len())
            .map(|tick| first.tick.wrapping_sub(tick as u32))
            .find(|&begin| self.states.iter().all(|state| fits(state, begin)))
            .ok_or(unreported)?;
        for (state, torque) in self.states.iter().zip(&self.torques) {
            if let Some(command) = commands.get_mut(tick_of(state, begin)) {
                *command = Some(*torque);
            }
        }
        // A board's first tick has the number 1.
        Ok((begin.saturating_sub(1), commands))
    }
}

/// A board with its serial port, and the device that its motor moves, in a hand.
trait BoardInHand {
    /// A tick with bytes to the port, and the bytes from it; none if the motion has an end and is over.
    fn tick(&mut self, bytes: &[u8]) -> Result<Option<(Exchanged, Vec<u8>)>, RunError>;
    /// A tick after the run.
    fn stand(&mut self, bytes: &[u8]) -> Result<Vec<u8>, RunError>;
    /// Energy that passed between hand and device, and the speed of the device in rad/s.
    fn end(&self) -> (Energy, f64);
}

/// A board in lockstep with a device, which gets the torques of its codes.
struct Held<E> {
    /// The board's code for a count, with bytes to its port and from it.
    exchange: E,
    device: SimulatedDevice,
    count: i32,
}

impl<E> BoardInHand for Held<E>
where
    E: FnMut(i32, &[u8]) -> Result<(u16, Vec<u8>), RunError>,
{
    fn tick(&mut self, bytes: &[u8]) -> Result<Option<(Exchanged, Vec<u8>)>, RunError> {
        let Some(count) = self.device.count() else { return Ok(None) };
        self.count = count;
        let (code, heard) = (self.exchange)(count, bytes)?;
        let before = self.device.motion().position;
        self.device.hold(code);
        let moved = self.device.motion().position - before;
        Ok(Some((Exchanged { count, code, moved }, heard)))
    }

    fn stand(&mut self, bytes: &[u8]) -> Result<Vec<u8>, RunError> {
        Ok((self.exchange)(self.count, bytes)?.1)
    }

    fn end(&self) -> (Energy, f64) {
        end_of(&self.device)
    }
}

/// A board whose bridge drives the motor of a shaft, which gets the torque of its currents.
struct HeldShaft {
    board: BridgeBoard,
    shaft: HandHeldShaft,
}

impl BoardInHand for HeldShaft {
    fn tick(&mut self, bytes: &[u8]) -> Result<Option<(Exchanged, Vec<u8>)>, RunError> {
        let (count, code) = (self.board.count(), self.board.code());
        let before = self.shaft.motion().angle;
        let heard = self.board.period(&mut self.shaft, bytes)?.sent.clone();
        let moved = self.shaft.motion().angle - before;
        Ok(Some((Exchanged { count, code, moved }, heard)))
    }

    fn stand(&mut self, bytes: &[u8]) -> Result<Vec<u8>, RunError> {
        Ok(self.board.period(&mut self.shaft, bytes)?.sent.clone())
    }

    fn end(&self) -> (Energy, f64) {
        end_of(self.shaft.device())
    }
}

/// The code of the emulated board for a count, with bytes to the socket that is its port, and from it.
fn exchange_with_port(
    emulator: &mut Emulator,
    port: &mut UnixStream,
    count: i32,
    bytes: &[u8],
) -> Result<(u16, Vec<u8>), EmulatorError> {
    port.write_all(bytes).map_err(EmulatorError::Serial)?;
    let code = emulator.exchange(count)?;
    let mut heard = vec![0; 1024];
    match port.read(&mut heard) {
        Ok(length) => heard.truncate(length),
        Err(error) if error.kind() == ErrorKind::WouldBlock => heard.clear(),
        Err(error) => return Err(EmulatorError::Serial(error)),
    }
    Ok((code, heard))
}
