//! Instructions of the parts of a tick, measured below the servo's priority by repeating them: the servo's
//! interrupt stays as it is flashed, without a measurement inside.
//!
//! The addresses of the parts are hidden from the optimiser: known addresses would be too far from
//! a base register, unlike those in the interrupt.

use core::hint::black_box;

use super::log::{InstructionStats, Measured, Parts};
use super::meter::{Scale, measure};
use super::stop::halt_with;
use crate::boot::Program;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::energy::EnergyMonitor;
use crate::number::Number;
use crate::servo::{OutputMode, Servo, Step};
use crate::servo_loop::{FRAMES, Frame, FrameQueue, FrameSink, Frames, State};
use crate::torque::LimitReason;
use crate::tuning::Tunable;

/// The parts of a tick: the servo from count to code, the energy monitor, and the frame.
pub struct CycleParts<E: Tunable<N>, N: Number, M> {
    servo: Servo<E, N>,
    energy: EnergyMonitor,
    last: Option<(u16, u32)>,
    contact: InstructionStats,
    free: InstructionStats,
    energy_cost: InstructionStats,
    frame_cost: InstructionStats,
    mode: core::marker::PhantomData<M>,
}

impl<E: Tunable<N>, N: Number, M: OutputMode> CycleParts<E, N, M> {
    /// The parts of a servo at rest with the program's certified scene. Ends the program if the servo cannot
    /// be built.
    pub fn new(program: &Program<E>) -> Self {
        let built = Servo::build(&program.scene, &program.transducers);
        let servo = built.unwrap_or_else(|_| halt_with(Step::Servo.as_str()));
        let [contact, free, energy_cost, frame_cost] = [InstructionStats::EMPTY; 4];
        let (energy, mode) = (EnergyMonitor::default(), core::marker::PhantomData);
        Self { servo, energy, last: None, contact, free, energy_cost, frame_cost, mode }
    }

    /// A tick counts as free if neither it nor the next tick has torque. The next tick matters because the
    /// torque of a delayed wall comes one tick later.
    fn add_servo(&mut self, next: u16) {
        let Some((code, cost)) = self.last else { return };
        let gives_torque = |code: u16| code != DacCode::MID_SCALE.get();
        let contact = gives_torque(code) || gives_torque(next);
        let spread = if contact { &mut self.contact } else { &mut self.free };
        spread.add(cost);
    }

    /// Instructions from count to code. In a function of its own, so that no code beside it takes
    /// registers.
    #[inline(never)]
    fn servo_cost(&mut self, tick: &Measured, scale: &Scale) -> u32 {
        let servo = black_box(&mut self.servo);
        let time = measure(tick.count.bits(), |count| {
            let output = servo.tick(RawCount::from(count));
            (output.code.get().into(), output.limit as u32)
        });
        scale.measured(time)
    }

    fn energy_cost(&mut self, tick: &Measured, scale: &Scale) -> u32 {
        let code = DacCode::new(tick.code).unwrap_or(DacCode::MID_SCALE);
        let energy = black_box(&mut self.energy);
        let time = measure(tick.count.bits(), |step| {
            energy.observe::<M>(step.cast_signed(), code);
            (step, step)
        });
        scale.measured(time)
    }
}

/// Instructions for putting a frame into the queue.
fn frame_cost(frames: &mut Frames<'_, FRAMES>, tick: &Measured, scale: &Scale) -> u32 {
    let code = DacCode::new(tick.code).unwrap_or(DacCode::MID_SCALE);
    let (limit, state) = (LimitReason::None, State::Running);
    let frames = black_box(frames);
    let time = measure(tick.count.bits(), |count| {
        let frame =
            Frame { tick: count, count: count.cast_signed(), code, limit, state, slack: count };
        frames.push(frame);
        (count, count)
    });
    scale.measured(time)
}

impl<E: Tunable<N>, N: Number, M: OutputMode> Parts for CycleParts<E, N, M> {
    fn take(&mut self, tick: &Measured, scale: &Scale) {
        // Before that the clamp opens while the device is at rest.
        if !tick.was_running {
            return;
        }
        self.add_servo(tick.code);
        self.last = Some((tick.code, self.servo_cost(tick, scale)));
        let energy = self.energy_cost(tick, scale);
        self.energy_cost.add(energy);
        let mut queue = FrameQueue::<FRAMES>::new();
        let frame = frame_cost(&mut queue.split().0, tick, scale);
        self.frame_cost.add(frame);
    }

    fn log(&mut self) {
        self.add_servo(DacCode::MID_SCALE.get());
        self.contact.log("contact");
        self.free.log("free");
        self.energy_cost.log("energy");
        self.frame_cost.log("frame");
    }
}
