//! The servo's cycles on a real board, over a minute, with the amplifier off.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::{DWT, NVIC};
use haptic_servo::board::isr_cell::{IsrCell, MailboxCell, endpoints};
use haptic_servo::board::stm32::output::Setup;
use haptic_servo::board::stm32::registers::Registers;
use haptic_servo::board::stm32::wiring::AMPLIFIER;
use haptic_servo::board::stm32::{Mode, init_chip, registers};
use haptic_servo::boot::Startup;
use haptic_servo::certificate::TimingChecked;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::RawCount;
use haptic_servo::scene::Scene;
use haptic_servo::scene_type::Typed;
use haptic_servo::servo::{OutputMode, PreparedServo, RenderingOptions};
use haptic_servo::servo_loop::{Endpoints, Hardware, Options, ServoIsr, ServoLoop};

use super::{CERTIFIED, FILTER, Failure, TRANSDUCERS};

haptic_servo::scene_type!(OfTheTests: CERTIFIED);

type Rendered = Typed<OfTheTests>;

/// The scene, as late as the board's DAC.
const TIMED: TimingChecked<Scene<Rendered>, Mode> = Rendered::certified().timing_checked();

/// The board without the outputs that would move the motor.
struct Muted(Registers);

impl Hardware for Muted {
    #[inline(always)]
    fn count(&mut self) -> RawCount {
        self.0.count()
    }

    #[inline(always)]
    fn write(&mut self, code: DacCode) {
        self.0.write(code);
    }

    fn amplifier(&mut self, _: bool) {
        AMPLIFIER.set(false);
    }

    #[inline(always)]
    fn periods_since_last(&mut self) -> u32 {
        self.0.periods_since_last()
    }

    #[inline(always)]
    fn time_in_period(&mut self) -> u32 {
        self.0.time_in_period()
    }

    #[inline(always)]
    fn feed_watchdog(&mut self) {
        self.0.feed_watchdog();
    }
}

static ISR_STATE: IsrCell<ServoIsr<Muted, Rendered, f32, Mode>> = IsrCell::empty();
static MAILBOX: MailboxCell<Rendered, f32, Mode> = static_cell::StaticCell::new();

/// What the interrupt has measured, in cycles.
struct Measured {
    ticks: AtomicU32,
    sum: AtomicU32,
    least: AtomicU32,
    most: AtomicU32,
}

static MEASURED: Measured = Measured {
    ticks: AtomicU32::new(0),
    sum: AtomicU32::new(0),
    least: AtomicU32::new(u32::MAX),
    most: AtomicU32::new(0),
};

impl Measured {
    /// Adds a tick. Only one interrupt writes, so loads and stores replace atomic additions.
    #[inline(always)]
    fn add(&self, cycles: u32) {
        let of = |number: &AtomicU32| number.load(Ordering::Relaxed);
        self.least.store(of(&self.least).min(cycles), Ordering::Relaxed);
        self.most.store(of(&self.most).max(cycles), Ordering::Relaxed);
        self.sum.store(of(&self.sum).wrapping_add(cycles), Ordering::Relaxed);
        self.ticks.store(of(&self.ticks).wrapping_add(1), Ordering::Relaxed);
    }

    fn begin_again(&self) {
        self.least.store(u32::MAX, Ordering::Relaxed);
        for number in [&self.most, &self.sum, &self.ticks] {
            number.store(0, Ordering::Relaxed);
        }
    }
}

/// A tick, measured from the handler's first instruction to its last, without those of the measurement.
#[unsafe(no_mangle)]
#[cfg_attr(feature = "fast-memory", unsafe(link_section = ".fast"))]
unsafe extern "C" fn TIM6_DAC() {
    let start = DWT::cycle_count();
    // SAFETY: this is the handler of the interrupt that is enabled after the cell is filled, and no interrupt
    // interrupts itself.
    unsafe { ISR_STATE.borrow_mut() }.tick();
    MEASURED.add(DWT::cycle_count().wrapping_sub(start));
}

/// The servo's cycles over a minute: minimum, mean and worst.
pub fn measure() -> Result<(), Failure> {
    /// Ticks until the clamp is open: until then a tick takes longer than a rendering tick.
    const OPENING: u32 = 200;
    /// Ticks of a minute. Their sum fits 32 bits up to 70 000 cycles a tick.
    const MINUTE: u32 = 60_000;
    let _ = init_chip(FILTER);
    // SAFETY: `connect` no longer uses the core's peripherals, and no other code does.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    core.DCB.enable_trace();
    core.DWT.enable_cycle_counter();
    let hardware =
        registers(Setup::DAC, CERTIFIED.scene().timing.period, <Mode as OutputMode>::TIMING);
    let Endpoints { requests, inbox, frames, mut frame_reader } = endpoints(&MAILBOX);
    let rendering = PreparedServo::new(&TIMED, &TRANSDUCERS, &RenderingOptions::DEFAULT);
    let rendering = rendering.map_err(|_| "no servo can be built of the scene")?;
    let servo_loop = ServoLoop::new(rendering, &Options::DEFAULT, hardware.period(), None);
    requests.arm();
    let mut hardware = Muted(hardware);
    hardware.0.zero_encoder();
    hardware.0.start(<Mode as OutputMode>::TIMING);
    // SAFETY: the interrupt that uses the cell is not enabled yet, and finds it filled.
    unsafe {
        ISR_STATE.init(ServoIsr { servo_loop, hardware, inbox, frames });
        NVIC::unmask(embassy_stm32::interrupt::TIM6_DAC);
    }
    defmt::info!("move the handle, if you like, for a minute: the amplifier is off");
    for ticks in [OPENING, MINUTE] {
        MEASURED.begin_again();
        while MEASURED.ticks.load(Ordering::Relaxed) < ticks {
            while frame_reader.take().is_some() {}
        }
    }
    let of = |number: &AtomicU32| number.load(Ordering::Relaxed);
    let mean = of(&MEASURED.sum) / of(&MEASURED.ticks).max(1);
    let (least, most) = (of(&MEASURED.least), of(&MEASURED.most));
    defmt::info!("| servo interrupt | minimum | mean | worst |");
    defmt::info!("|---|---|---|---|");
    defmt::info!("| cycles | {=u32} | {=u32} | {=u32} |", least, mean, most);
    Ok(())
}
