//! A board: its registers for the servo's interrupt, and its interrupts by [RTIC](https://rtic.rs). To use
//! the servo with another chip or framework, write this file again. "Yours" marks the requirements of the
//! firmware's guarantees.

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use haptic_servo::fault::{Fault, FaultRecord};
use haptic_servo::servo::{Latched, PreparedServo};
use haptic_servo::servo_loop::{self as servo, Hardware, PeriodClock, READ_WITHIN};
use haptic_servo::{board::fault_memory, boot::Startup, reset::ResetCause};
use haptic_servo::{dac::DacCode, encoder::RawCount, period, wire};
use heapless::spsc::{Producer, Queue};
use stm32_metapac::{DAC1, DBGMCU, GPIOC, IWDG, RCC, TIM3, TIM5, TIM6, iwdg::vals::Key};

use crate::chip::{self, PERIOD, TIMER_CLOCK};
use crate::scene::{PROGRAM, Rendered};
use crate::serial::{self, Serial};

/// The board in the servo's interrupt.
pub struct Board(PeriodClock);

impl Hardware for Board {
    fn count(&mut self) -> RawCount {
        RawCount::from(TIM3.cnt().read().cnt())
    }
    /// Yours: the motor gets the torque at the next period's beginning, by hardware, and not earlier.
    fn write(&mut self, code: DacCode) {
        DAC1.dhr12r(0).write(|w| w.set_dhr(code.get()));
    }
    /// Yours: off by this one access, and off while the pin floats, by a pull-down resistor.
    fn amplifier(&mut self, on: bool) {
        GPIOC.bsrr().write(|w| if on { w.set_bs(3, true) } else { w.set_br(3, true) });
    }
    /// Yours: by a clock that runs while the interrupt is delayed; without it lateness is not detected.
    fn periods_since_last(&mut self) -> u32 {
        TIM6.sr().write(|w| w.set_uif(false));
        self.0.begun_by(TIM5.cnt().read())
    }
    fn time_in_period(&mut self) -> u32 {
        self.0.elapsed_at(TIM5.cnt().read())
    }
    /// Yours: fed only here.
    fn feed_watchdog(&mut self) {
        IWDG.kr().write(|w| w.set_key(Key::RESET));
    }
    fn store_fault(&mut self, record: &[u32; FaultRecord::WORDS]) {
        fault_memory::store(record);
    }
}

impl Startup for Board {
    fn zero_encoder(&mut self) {
        TIM3.cnt().write(|w| w.set_cnt(0));
    }
    /// Yours: with its own clock, and not halted by a debugger.
    fn start_watchdog(&mut self) {
        DBGMCU.apb1fzr().modify(|w| w.set_iwdg(false));
        IWDG.kr().write(|w| w.set_key(Key::START));
        IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        let counts = period::watchdog_counts(PROGRAM.scene.timing.period);
        IWDG.rlr().write(|w| w.set_rl(counts));
    }
    fn stored_fault(&mut self) -> [u32; FaultRecord::WORDS] {
        fault_memory::stored()
    }
    /// Yours: no other reset may count as a power-on, at which a program may arm itself.
    fn reset_cause(&mut self) -> ResetCause {
        let watchdog = RCC.csr().read().wdgrstf();
        RCC.csr().modify(|w| w.set_rmvf(true));
        if watchdog { ResetCause::IndependentWatchdog } else { ResetCause::Unknown }
    }
    fn period(&self) -> u32 {
        self.0.counts()
    }
}

#[rtic::app(device = stm32_metapac, peripherals = false)]
mod app {
    use super::*;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        isr: servo::ServoIsr<Board, Rendered, f32, Latched>,
        link: wire::Link<Serial, Rendered, f32, Latched>,
        received: Producer<'static, u8>,
    }

    #[init(local = [
        mailbox: servo::Mailbox<PreparedServo<Rendered, f32, Latched>> = servo::Mailbox::new(),
        queue: servo::FrameQueue<{ servo::FRAMES }> = servo::FrameQueue::new(),
        bytes: Queue<u8, 257> = Queue::new(),
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        chip::init();
        let (received, bytes) = context.local.bytes.split();
        let board = Board(PeriodClock::new(PERIOD, (TIMER_CLOCK * READ_WITHIN) as u32));
        let endpoints = servo::Endpoints::of(context.local.mailbox, context.local.queue);
        // Certifies the scene again, on this processor. The host arms the servo.
        let (isr, link) = wire::bring_up("own-board", PROGRAM, board, Serial(bytes), endpoints)
            .unwrap_or_else(|step| panic!("refused by {}", step.as_str()));
        chip::start();
        (Shared {}, Local { isr, link, received })
    }

    /// Yours: the highest priority, and no shared data behind a lock that could delay it.
    #[task(binds = TIM6_DAC, priority = 16, local = [isr])]
    fn tick(context: tick::Context) {
        context.local.isr.tick();
    }

    #[task(binds = USART3, priority = 1, local = [received])]
    fn receive(context: receive::Context) {
        serial::receive(context.local.received);
    }

    #[idle(local = [link])]
    fn idle(context: idle::Context) -> ! {
        loop {
            context.local.link.poll();
        }
    }
}

/// Yours: the end of the program removes the torque, and does not feed the watchdog.
fn end(fault: Fault) -> ! {
    cortex_m::interrupt::disable();
    GPIOC.bsrr().write(|w| w.set_br(3, true));
    fault_memory::store_fault(fault);
    loop {} // until the watchdog's reset
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end(Fault::of_panic(info))
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    end(Fault::HardFault { address: frame.pc(), status: 0 })
}

#[exception]
unsafe fn NonMaskableInt() -> ! {
    end(Fault::ClockLost) // the only cause on this chip
}
