//! A magnetic absolute encoder on SPI, whose transfer the pacing timer's update begins without a program.
//!
//! ```text
//! TIM6 update ---- DMA 3 writes SPE: selects the chip, and the SPI sends what DMA 2 has put into its buffer
//!   |              DMA 1 stores each word received
//! DMA1_CHANNEL1    after the last word: the angle, or the one before [`read`]; pends the servo's interrupt, or leaves
//!                  a tick out
//! TIM6_DAC         the servo's tick, with the count of the update
//! ```
//!
//! The chip is selected within some clocks of the update (RM0440, SPI: a master begins when it is enabled with data in
//! its buffer). So the transfer takes time of the tick and adds nothing to the age of the reading.

use core::sync::atomic::{AtomicU16, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac;
use embassy_stm32::pac::bdma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::gpio::vals::{Moder, Ospeedr, Pupdr};
use embassy_stm32::pac::spi::regs::Cr1;
use embassy_stm32::pac::spi::vals::{Br, Cpha, Cpol, Ds, Mstr};

use super::wiring::{BUS, TIMER_CLOCK};
use crate::board::critical;
use crate::encoder::RawCount;
use crate::fault::Fault;
use crate::magnetic::{Chip, Frame, Interface, LONGEST, ReadingError, Readings};
use crate::servo_loop::OutputEvent;

/// A pin of the bus, and the alternate function that connects it.
#[derive(Clone, Copy)]
pub struct BusPin {
    /// Its port.
    pub port: pac::gpio::Gpio,
    /// Its number in the port, 0 to 15.
    pub pin: usize,
    /// The alternate function.
    pub function: u8,
}

/// The bus of a board: an SPI, its pins, and its requests among those of the DMA.
pub struct Bus {
    /// The SPI.
    pub spi: pac::spi::Spi,
    /// NSS, which is low during a transfer and pulled up.
    pub select: BusPin,
    /// SCK.
    pub clock: BusPin,
    /// MISO, pulled up, so that a broken wire reads all ones.
    pub input: BusPin,
    /// MOSI.
    pub output: BusPin,
    /// The request with a received word.
    pub received: u8,
    /// The request for a word to send.
    pub wants: u8,
    /// The request that begins a transfer: an event of the timer that paces the position.
    pub begins: u8,
    /// Gives the SPI its clock.
    pub enable: fn(),
}

/// The data of a program that the encoder needs.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Setup {
    /// The chip's name, by which a virtual board knows it.
    pub name: [u8; Chip::LONGEST_NAME],
    /// The chip.
    pub chip: &'static Chip,
    /// Readings in a row that may fail.
    pub dropped: u16,
    /// Whether their ticks are left out.
    pub leaves_out: bool,
}

const DMA: pac::bdma::Dma = pac::DMA1;
/// Channels, from zero: stores received words, sends words, enables the SPI.
const RECEIVE: usize = 0;
const SEND: usize = 1;
const BEGIN: usize = 2;

/// What the interrupt of a transfer uses: in one place, so that one address reaches all of it.
struct Memory {
    /// The words of the last transfer.
    frame: [AtomicU16; LONGEST],
    /// CR1 of the SPI that begins a transfer.
    enabled: AtomicU16,
    /// The error of a failed reading, in the low half and from one on, and how many may fail; 0: none.
    failed: AtomicU32,
    readings: Readings,
}

static MEMORY: Memory = Memory {
    frame: [const { AtomicU16::new(0) }; LONGEST],
    enabled: AtomicU16::new(0),
    failed: AtomicU32::new(0),
    readings: Readings::none(),
};

/// The count at the beginning of the period.
#[inline(always)]
pub fn count() -> RawCount {
    RawCount::from(MEMORY.readings.count())
}

/// The fault of the readings, if there is one since the last call.
#[inline(always)]
pub fn event() -> Option<OutputEvent> {
    if MEMORY.failed.load(Ordering::Relaxed) == 0 { None } else { take_event() }
}

#[cold]
#[inline(never)]
fn take_event() -> Option<OutputEvent> {
    let failed = MEMORY.failed.swap(0, Ordering::Relaxed);
    let (error, allowed) = ((failed & 0xFFFF).checked_sub(1)?, failed >> 16);
    Some(OutputEvent::Fault(Fault::EncoderReading { error, allowed }))
}

/// The end of a transfer, for the handler of the receiving channel after [`set_up`].
#[inline(always)]
pub fn read(setup: &'static Setup) {
    let words = setup.chip.interface.words;
    end();
    load_again(words);
    match MEMORY.readings.take(setup.chip, &received(words), setup.dropped) {
        Ok(true) => {}
        // The next tick finds that a period has been missed.
        Ok(false) if setup.leaves_out => return,
        Ok(false) => {}
        Err(error) => fail(error, setup.dropped),
    }
    NVIC::pend(interrupt::TIM6_DAC);
}

/// Takes the transfer that has ended since the last call; without one the reading has failed.
///
/// # Errors
/// If more readings in a row have failed than are allowed.
#[cfg(feature = "bridge")]
#[inline(always)]
pub fn take(setup: &'static Setup) -> Result<bool, ReadingError> {
    let words = setup.chip.interface.words;
    let has_ended = DMA.isr().read().tcif(RECEIVE);
    end();
    if !has_ended {
        return MEMORY.readings.fail(ReadingError::Missing, setup.dropped);
    }
    load_again(words);
    MEMORY.readings.take(setup.chip, &received(words), setup.dropped)
}

#[cold]
#[inline(never)]
fn fail(error: ReadingError, allowed: u16) {
    MEMORY.failed.store(u32::from(allowed) << 16 | (error as u32 + 1), Ordering::Relaxed);
}

/// Takes the select away from the chip, whose last word is there.
#[inline(always)]
fn end() {
    DMA.ifcr().write(|w| w.set_tcif(RECEIVE, true));
    BUS.spi.cr1().write_value(Cr1(u32::from(MEMORY.enabled.load(Ordering::Relaxed)) & !SPE));
}

/// The words of the last transfer.
#[inline(always)]
fn received(words: usize) -> Frame {
    let word = |at: usize| if at < words { MEMORY.frame[at].load(Ordering::Relaxed) } else { 0 };
    core::array::from_fn(word)
}

/// SPE of CR1.
const SPE: u32 = 1 << 6;

/// Has the words of the next transfer put into the buffer of the SPI, as far as they fit.
fn load(words: &'static Frame, count: usize) {
    let channel = DMA.ch(SEND);
    channel.cr().modify(|w| w.set_en(false));
    channel.mar().write_value(words.as_ptr() as u32);
    load_again(count);
}

/// The same with the words of the last one, which the channel begins again when it is enabled (RM0440, DMA).
#[inline(always)]
fn load_again(count: usize) {
    let channel = DMA.ch(SEND);
    let mut control = pac::bdma::regs::Cr(0);
    control.set_dir(Dir::FROM_MEMORY);
    control.set_minc(true);
    control.set_msize(Size::BITS16);
    control.set_psize(Size::BITS16);
    channel.cr().write_value(control);
    channel.ndtr().write(|w| w.set_ndt(count as u16));
    control.set_en(true);
    channel.cr().write_value(control);
}

/// Connects the chip, sets it up, and reads its angle; nothing paces its transfers yet.
pub fn set_up(setup: &'static Setup) {
    // Hidden from the optimiser, so that the name stays in the program.
    let Setup { chip, dropped, .. } = *core::hint::black_box(setup);
    let words = chip.interface.words;
    connect(chip);
    cortex_m::asm::delay((chip.start_up * TIMER_CLOCK) as u32);
    for frame in chip.set_up {
        exchange(frame, words);
    }
    // The first may answer the set-up.
    exchange(&chip.command, words);
    // A failure here is one of the first tick's, too.
    let _ = MEMORY.readings.take(chip, &exchange(&chip.command, words), dropped);
    load(&chip.command, words);
    interrupt::DMA1_CHANNEL1.set_priority(Priority::from(critical::SERVO << 4));
}

/// From now on each update of the pacing timer begins a transfer, whose end is the tick.
pub fn start() {
    DMA.ch(BEGIN).cr().modify(|w| w.set_en(true));
    // The updates of a bridge take their transfers themselves.
    if cfg!(feature = "bridge") {
        return;
    }
    DMA.ch(RECEIVE).cr().modify(|w| w.set_tcie(true));
    // SAFETY: the handler shares nothing but atomics.
    unsafe { interrupt::DMA1_CHANNEL1.enable() };
}

/// A transfer that the program begins and waits for.
fn exchange(words: &'static Frame, count: usize) -> Frame {
    load(words, count);
    BUS.spi.cr1().write_value(Cr1(MEMORY.enabled.load(Ordering::Relaxed).into()));
    while !DMA.isr().read().tcif(RECEIVE) {}
    // A load in between would be sent.
    end();
    received(count)
}

/// The clocks, the pins, the SPI and the channels.
fn connect(chip: &Chip) {
    let (spi, interface) = (BUS.spi, chip.interface);
    (BUS.enable)();
    pac::RCC.ahb1enr().modify(|w| {
        w.set_dma1en(true);
        w.set_dmamux1en(true);
    });
    // Reads back, so that the units have their clocks.
    let _ = pac::RCC.ahb1enr().read();
    let mut enabled = Cr1(SPE);
    enabled.set_mstr(Mstr::MASTER);
    enabled.set_br(divider(interface));
    enabled.set_cpha(Cpha::SECOND_EDGE);
    enabled.set_cpol(if interface.idle_high { Cpol::IDLE_HIGH } else { Cpol::IDLE_LOW });
    MEMORY.enabled.store(enabled.0 as u16, Ordering::Relaxed);
    spi.cr1().write_value(Cr1(enabled.0 & !SPE));
    spi.cr2().write(|w| {
        w.set_ssoe(true);
        w.set_ds(Ds::from_bits(interface.word_bits - 1));
        w.set_rxdmaen(true);
        w.set_txdmaen(true);
    });
    for pin in [BUS.select, BUS.clock, BUS.input, BUS.output] {
        let BusPin { port, pin, function } = pin;
        port.afr(pin / 8).modify(|w| w.set_afr(pin % 8, function));
        port.ospeedr().modify(|w| w.set_ospeedr(pin, Ospeedr::MEDIUM_SPEED));
        port.moder().modify(|w| w.set_moder(pin, Moder::ALTERNATE));
    }
    for BusPin { port, pin, .. } in [BUS.select, BUS.input] {
        port.pupdr().modify(|w| w.set_pupdr(pin, Pupdr::PULL_UP));
    }
    let data = spi.dr16().as_ptr() as u32;
    channel(RECEIVE, BUS.received, data, MEMORY.frame.as_ptr() as u32, interface.words);
    channel(SEND, BUS.wants, data, 0, 0);
    channel(BEGIN, BUS.begins, spi.cr1().as_ptr() as u32, MEMORY.enabled.as_ptr() as u32, 1);
    DMA.ch(RECEIVE).cr().modify(|w| {
        w.set_minc(true);
        w.set_en(true);
    });
    DMA.ch(BEGIN).cr().modify(|w| w.set_dir(Dir::FROM_MEMORY));
}

/// A channel that moves halfwords in a circle at a request.
fn channel(number: usize, request: u8, peripheral: u32, memory: u32, count: usize) {
    pac::DMAMUX1.ccr(number).write(|w| w.set_dmareq_id(request));
    let channel = DMA.ch(number);
    channel.par().write_value(peripheral);
    channel.mar().write_value(memory);
    channel.ndtr().write(|w| w.set_ndt(count as u16));
    channel.cr().write(|w| {
        w.set_circ(true);
        w.set_msize(Size::BITS16);
        w.set_psize(Size::BITS16);
        w.set_pl(Pl::HIGH);
    });
}

/// The divider of the bus's clock.
fn divider(interface: Interface) -> Br {
    Br::from_bits((interface.divider(TIMER_CLOCK) - 1) as u8)
}

/// The encoder of a program, and the handler of its readings.
#[doc(hidden)]
#[macro_export]
macro_rules! board_encoder {
    ([], $($any:tt)*) => {
        compile_error!(
            "this board reads a magnetic encoder that the program does not state: write `encoder: CHIP` in \
             scene_program! or sweep_program!, or build it without the feature `magnetic`"
        );
    };
    ([$chip:expr], $bridge:tt, $transducers:expr, $reading:expr, $period:expr, $leaves_out:expr) => {
        /// The encoder's data of this program.
        #[unsafe(no_mangle)]
        static ENCODER_SETUP: $crate::board::stm32::magnetic::Setup =
            $crate::board::stm32::magnetic::Setup {
                name: $chip.padded_name(),
                chip: &$chip,
                dropped: $crate::may_fail!($chip, $bridge, $reading, $period),
                leaves_out: $leaves_out,
            };

        const ENCODER: &$crate::board::stm32::magnetic::Setup = &ENCODER_SETUP;

        $crate::transfer_handler!($bridge);
    };
}

/// Readings in a row that may fail: those of a bridge's updates, or those of the servo's periods.
#[doc(hidden)]
#[macro_export]
macro_rules! may_fail {
    ($chip:expr, [], $reading:expr, $period:expr) => {
        $reading.dropped
    };
    ($chip:expr, [$current_loop:ident], $reading:expr, $period:expr) => {
        $current_loop.transfers(&$chip).may_fail(&$chip, $reading, $period)
    };
}

/// The handler of the end of a transfer, which a bridge does not need.
#[doc(hidden)]
#[macro_export]
macro_rules! transfer_handler {
    ([]) => {
        $crate::in_fast_memory! {
            /// The end of a transfer.
            #[unsafe(no_mangle)]
            unsafe extern "C" fn DMA1_CHANNEL1() {
                $crate::board::stm32::magnetic::read(&ENCODER_SETUP);
            }
        }
    };
    ([$current_loop:ident]) => {};
}
