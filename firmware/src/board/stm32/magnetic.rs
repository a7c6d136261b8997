//! A magnetic absolute encoder on SPI, whose transfers hardware begins and ends without a program.
//!
//! ```text
//! the timer's update  ---- DMA 4 takes the fall of the data line away
//!   its event         ---- DMA 3 writes SPE some times: selects the chip, and lets it get ready
//!   its event after the last ---- DMA 2 may move as many words to the SPI as a transfer has
//!                          DMA 1 stores each word received
//!   its event after the last one ---- DMA 5 writes CR1 until SPE is off: releases the chip
//! DMA1_CHANNEL1       the last word is there: the servo's tick, with the count of the update, or [`take`] by
//!                     another interrupt that needs the position, as that of a bridge
//! ```
//!
//! An event of one channel of the multiplexer is the synchronisation of another, or triggers a generator of requests
//! (RM0440, DMAMUX). All channels move in circles, so that no program sets them up again.
//!
//! The chip is selected within some clocks of the update. So the transfer takes time of the tick and adds nothing to
//! the age of the reading.
//!
//! Not read in the manual [M]: that an event of a channel is as good an edge for a synchronisation as another input
//! (tables of the multiplexer's inputs list it). Between transfers the SPI drives none of its wires, so that each has a
//! pull to its level at rest.

use core::sync::atomic::{AtomicU16, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;
use embassy_stm32::pac;
use embassy_stm32::pac::bdma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::crc::vals::Polysize;
use embassy_stm32::pac::dmamux::regs::Ccr;
use embassy_stm32::pac::dmamux::vals::Pol;
use embassy_stm32::pac::gpio::vals::{Moder, Ospeedr, Pupdr};
use embassy_stm32::pac::spi::regs::Cr1;
use embassy_stm32::pac::spi::vals::{Br, Cpha, Cpol, Ds, Mstr};

use super::wiring::{BUS, TIMER_CLOCK};
use crate::board::isr_cell::IsrCell;
use crate::encoder::RawCount;
use crate::fault::Fault;
use crate::magnetic::{
    Checksum, Chip, Frame, Interface, LONGEST, RISE, ReadingError, Readings, Receiver, Remainder,
    TRANSFER_WITHIN, Unread,
};

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
    /// The request with a received word, among those of the DMA.
    pub received: u8,
    /// The request for a word to send.
    pub wants: u8,
    /// The request that begins a transfer: the update of the timer that paces the position.
    pub begins: u8,
    /// Gives the SPI its clock.
    pub enable: fn(),
    /// Resets the SPI.
    pub reset: fn(),
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
/// Channels, from zero: stores received words, sends words, begins a transfer, takes the fall of the data line away
/// before that, ends it. The multiplexer has events of the first four.
const RECEIVE: usize = 0;
const SEND: usize = 1;
const BEGIN: usize = 2;
const CLEAR: usize = 3;
const END: usize = 4;
/// All; each has nothing to do before those behind it begin.
const CHANNELS: [usize; 5] = [RECEIVE, SEND, END, BEGIN, CLEAR];
/// Looks at the SPI in which a transfer that goes on has surely ended.
const LOOKS: u32 = 500;
/// The event of a channel among the multiplexer's inputs for synchronisation and for generators.
const EVENT_OF: u8 = 16;
/// The generators of requests of two channels, and the request of the first.
const GENERATORS: [(usize, usize, u8); 2] =
    [(RECEIVE, END, ENDING as u8), (CLEAR, BEGIN, BEGINNING)];
const GENERATED: u8 = 1;
/// Writes of CR1 that begin a transfer, all the same: the first selects the chip, and the clock begins after the last. An
/// AS5048A wants 350 ns between (not confirmed), and each write takes six clocks or more.
const BEGINNING: u8 = 10;
/// The same in clocks, for a transfer that the program makes.
const READY: u32 = 60;
/// Writes of CR1 that end a transfer, of which the last takes SPE away: half a clock after its last bit is sampled the
/// SPI is busy with it (RM0440, SPI: SPE goes off when BSY is), and each of these writes takes some clocks.
const ENDING: usize = 8;

/// The line of the detector of edges: that of its pin.
static FALL: u32 = 1 << BUS.input.pin;

/// What a transfer and its reading use: in one place, so that one address reaches all of it.
#[repr(C, align(4))]
struct Memory {
    /// CR1 of the SPI that begins a transfer.
    begins: AtomicU16,
    /// The words of the last transfer; the second and the third are a pair in one place of four bytes.
    frame: [AtomicU16; LONGEST],
    /// CR1 of the SPI, as often as it takes to end a transfer.
    ends: [AtomicU16; ENDING],
    reader: IsrCell<Reader>,
}

static MEMORY: Memory = Memory {
    begins: AtomicU16::new(0),
    frame: [const { AtomicU16::new(0) }; LONGEST],
    ends: [const { AtomicU16::new(0) }; ENDING],
    reader: IsrCell::empty(),
};

/// The readings, for the one interrupt that takes them.
struct Reader {
    readings: Readings,
    /// Their fault.
    fault: Option<Fault>,
    /// The reason why the chip cannot be used until the next reset.
    unfit: Option<ReadingError>,
    setup: &'static Setup,
}

/// The readings.
#[inline(always)]
fn reader() -> &'static mut Reader {
    // SAFETY: only the interrupt that takes readings uses them, after the set-up, which is before it is enabled.
    unsafe { MEMORY.reader.borrow_mut() }
}

/// The count at the beginning of the period.
#[inline(always)]
pub fn count() -> RawCount {
    RawCount::from(reader().readings.count())
}

/// The fault of the readings, if there is one since the last call, or if there is one until the next reset.
#[inline(always)]
pub fn fault() -> Option<Fault> {
    if reader().fault.is_none() { None } else { take_fault() }
}

#[cold]
#[inline(never)]
fn take_fault() -> Option<Fault> {
    let Reader { fault, unfit, .. } = reader();
    let taken = fault.take();
    if let Some(error) = *unfit {
        fail(error);
    }
    taken
}

/// The line's detector of edges, and the unit for checksums.
struct Units;

impl Receiver for Units {
    const REMAINDER: Remainder = remainder;

    /// The line is pulled up, and nothing drives it while the chip is not selected: so a word of zeros begins with a
    /// fall. That stays in the detector, whose interrupt the core does not enable (RM0440, EXTI).
    #[inline(always)]
    fn has_fallen(&self) -> bool {
        pac::EXTI.pr(0).read().0 & FALL != 0
    }

    #[inline(always)]
    fn fail(&self, chip: &Chip) {
        begin_checksum(chip);
    }
}

/// The remainder by the unit, which begins at zero, where each transfer without an error leaves it.
#[inline(always)]
fn remainder(_: &Checksum, bits: u32) -> u32 {
    pac::CRC.dr32().write_value(bits);
    pac::CRC.dr32().read()
}

/// Takes the reading of the transfer that has ended since the last call, for any interrupt. Without such a transfer, or
/// in the next one, the reading has failed. Whether there is a tick with it; with what a fault requires.
#[inline(always)]
pub fn take(setup: &'static Setup, on_fault: impl FnOnce()) -> bool {
    let words = setup.chip.interface.words;
    if DMA.isr().read().tcif(RECEIVE) && left() == words {
        return take_ended(setup, on_fault);
    }
    note(missing(setup), setup, on_fault)
}

/// Words left of the transfer that the DMA stores, or of the next one.
#[inline(always)]
fn left() -> usize {
    DMA.ch(RECEIVE).ndtr().read().ndt().into()
}

#[cold]
#[inline(never)]
fn missing(setup: &'static Setup) -> Result<(), Unread> {
    restart(setup.chip, &[]);
    Err(reader().readings.fail(ReadingError::Missing, setup.dropped))
}

/// The same at the end of a transfer.
#[inline(always)]
pub fn take_ended(setup: &'static Setup, on_fault: impl FnOnce()) -> bool {
    note(take_words(setup), setup, on_fault)
}

/// The reading of the words that are there.
#[inline(always)]
fn take_words(setup: &'static Setup) -> Result<(), Unread> {
    acknowledge();
    let (Setup { chip, dropped, .. }, readings) = (setup, &mut reader().readings);
    readings.take(chip, &received(chip.interface.words), *dropped, Units)
}

/// Whether a reading has a tick. Without one, the next tick finds that a period has been missed.
#[inline(always)]
fn note(taken: Result<(), Unread>, setup: &'static Setup, on_fault: impl FnOnce()) -> bool {
    match taken {
        Ok(()) => true,
        Err(unread) => note_unread(unread, setup, on_fault),
    }
}

#[cold]
#[inline(never)]
fn note_unread(unread: Unread, setup: &'static Setup, on_fault: impl FnOnce()) -> bool {
    let Unread::Fault(error) = unread else { return !setup.leaves_out };
    fail(error);
    on_fault();
    if error == ReadingError::Flag {
        // The flag of some chips stays until it is read.
        restart(setup.chip, setup.chip.set_up);
    }
    true
}

#[cold]
#[inline(never)]
fn fail(error: ReadingError) {
    let allowed = reader().setup.dropped.into();
    reader().fault = Some(Fault::EncoderReading { error: error as u32, allowed });
}

/// Acknowledges the end of a transfer.
#[inline(always)]
fn acknowledge() {
    DMA.ifcr().write(|w| w.set_tcif(RECEIVE, true));
}

/// A tick after a missed tick may have begun in the transfer of the next update, with words of two transfers. Waits for
/// its end, and takes it. If it does not end in its time, or if the words are out of step, the reading is a fault,
/// however many may fail: the last angle is lost. `elapsed` has the clock's counts since the update.
#[cold]
#[inline(never)]
pub fn take_again(elapsed: impl Fn() -> u32) {
    /// Counts after the update at which the chip is surely selected.
    const SELECTED: u32 = 170;
    let setup = reader().setup;
    let (chip, words) = (setup.chip, setup.chip.interface.words);
    let clock = 2_u32 << divider(chip.interface).to_bits();
    // Half a word less: the time of any words but all is shorter.
    let shortest = (2 * words as u32 - 1) * u32::from(chip.interface.word_bits) * clock / 2;
    let is_in_step = loop {
        let (now, is_selected) = (elapsed(), BUS.spi.cr1().read().spe());
        if !is_selected && now > SELECTED {
            break now > shortest && left() == words;
        }
        if now > (TRANSFER_WITHIN * TIMER_CLOCK) as u32 {
            break false;
        }
    };
    acknowledge();
    NVIC::unpend(interrupt::DMA1_CHANNEL1);
    reader().fault = None;
    if !is_in_step {
        restart(chip, &[]);
        fail(ReadingError::Missing);
    } else if let Err(Unread::Fault(error)) = take_words(setup) {
        fail(error);
    }
}

/// Begins again with the first word of a transfer, and with these transfers before it.
#[cold]
#[inline(never)]
fn restart(chip: &'static Chip, before: &[Frame]) {
    let interrupts = DMA.ch(RECEIVE).cr().read().tcie();
    // A channel that moves something is not stopped half-way.
    for _ in 0..LOOKS {
        if !BUS.spi.cr1().read().spe() {
            break;
        }
    }
    // No request of before waits in either unit.
    for is_held in [true, false] {
        pac::RCC.ahb1rstr().modify(|w| {
            w.set_dma1rst(is_held);
            w.set_dmamux1rst(is_held);
        });
    }
    // The unit loses its words, those to send, too.
    (BUS.reset)();
    connect(chip);
    for frame in before {
        exchange(frame, chip.interface.words);
    }
    if !before.is_empty() {
        // The next transfer answers the last.
        exchange(&chip.command, chip.interface.words);
    }
    connect_channels(chip);
    start(interrupts);
}

/// SPE of CR1.
const SPE: u32 = 1 << 6;

/// The words of the last transfer. Of the longest the first, which answers nothing, is left out.
#[inline(always)]
fn received(words: usize) -> Frame {
    if words == LONGEST {
        // SAFETY: the place of both, by the order of the fields; only the DMA writes it, and not at this time.
        let pair = unsafe { AtomicU32::from_ptr(MEMORY.frame[1].as_ptr().cast()) };
        let pair = pair.load(Ordering::Relaxed);
        return [0, pair as u16, (pair >> 16) as u16];
    }
    let word = |at: usize| if at < words { MEMORY.frame[at].load(Ordering::Relaxed) } else { 0 };
    core::array::from_fn(word)
}

/// Connects the chip, sets it up, and reads its angle; nothing paces its transfers yet.
pub fn set_up(setup: &'static Setup) {
    // Hidden from the optimiser, so that the name stays in the program.
    let Setup { chip, dropped, .. } = *core::hint::black_box(setup);
    let words = chip.interface.words;
    connect(chip);
    begin_checksum(chip);
    cortex_m::asm::delay((chip.start_up * TIMER_CLOCK) as u32);
    for frame in chip.set_up {
        exchange(frame, words);
    }
    let unfit = chip.diagnosis.and_then(|(question, check)| {
        exchange(&question, words);
        check(&exchange(&chip.command, words)).err()
    });
    // The first may answer the set-up.
    exchange(&chip.command, words);
    // From here on the line must fall.
    pac::EXTI.pr(0).write(|w| w.0 = FALL);
    // A failure here is one of the first tick's, too.
    let mut readings = Readings::none();
    let _ = readings.take(chip, &exchange(&chip.command, words), dropped, Units);
    // SAFETY: the interrupt that uses it is not enabled yet.
    unsafe { MEMORY.reader.init(Reader { readings, fault: None, unfit, setup }) };
    if let Some(error) = unfit {
        fail(error);
    }
    connect_channels(chip);
}

/// From now on each update of the timer begins a transfer; whether its end is an interrupt.
pub fn start(interrupts: bool) {
    DMA.ch(RECEIVE).cr().modify(|w| w.set_tcie(interrupts));
    // First, so that the SPI wants a word when the first transfer begins.
    BUS.spi.cr2().modify(|w| {
        w.set_rxdmaen(true);
        w.set_txdmaen(true);
    });
    for number in CHANNELS {
        DMA.ch(number).cr().modify(|w| w.set_en(true));
    }
}

/// A transfer that the program makes; after it the wires are at rest.
fn exchange(words: &Frame, count: usize) -> Frame {
    let (spi, begins) = (BUS.spi, u32::from(MEMORY.begins.load(Ordering::Relaxed)));
    spi.cr1().write_value(Cr1(begins));
    cortex_m::asm::delay(READY);
    let mut frame = [0; LONGEST];
    for (word, received) in words.iter().zip(&mut frame).take(count) {
        while !spi.sr().read().txe() {}
        spi.dr16().write_value(*word);
        while !spi.sr().read().rxne() {}
        *received = spi.dr16().read();
    }
    while spi.sr().read().bsy() {}
    spi.cr1().write_value(Cr1(begins & !SPE));
    cortex_m::asm::delay((RISE * TIMER_CLOCK) as u32);
    frame
}

/// The clocks, the pins and the SPI.
fn connect(chip: &Chip) {
    let (spi, interface) = (BUS.spi, chip.interface);
    (BUS.enable)();
    pac::RCC.ahb1enr().modify(|w| {
        w.set_dma1en(true);
        w.set_dmamux1en(true);
    });
    // Reads back, so that the units have their clocks.
    let _ = pac::RCC.ahb1enr().read();
    let mut begins = Cr1(SPE);
    begins.set_mstr(Mstr::MASTER);
    begins.set_br(divider(interface));
    begins.set_cpha(Cpha::SECOND_EDGE);
    begins.set_cpol(if interface.idle_high { Cpol::IDLE_HIGH } else { Cpol::IDLE_LOW });
    MEMORY.begins.store(begins.0 as u16, Ordering::Relaxed);
    for (at, ends) in MEMORY.ends.iter().enumerate() {
        let last = if at + 1 == ENDING { SPE } else { 0 };
        ends.store((begins.0 & !last) as u16, Ordering::Relaxed);
    }
    // SSOE first: a master without it that finds its NSS low is no master any more.
    spi.cr2().write(|w| {
        w.set_ssoe(true);
        w.set_ds(Ds::from_bits(interface.word_bits - 1));
    });
    spi.cr1().write_value(Cr1(begins.0 & !SPE));
    for pin in [BUS.select, BUS.clock, BUS.input, BUS.output] {
        let BusPin { port, pin, function } = pin;
        port.afr(pin / 8).modify(|w| w.set_afr(pin % 8, function));
        port.ospeedr().modify(|w| w.set_ospeedr(pin, Ospeedr::MEDIUM_SPEED));
        port.moder().modify(|w| w.set_moder(pin, Moder::ALTERNATE));
    }
    let clock = if interface.idle_high { Pupdr::PULL_UP } else { Pupdr::PULL_DOWN };
    for (BusPin { port, pin, .. }, pull) in [
        (BUS.select, Pupdr::PULL_UP),
        (BUS.clock, clock),
        (BUS.input, Pupdr::PULL_UP),
        (BUS.output, Pupdr::PULL_DOWN),
    ] {
        port.pupdr().modify(|w| w.set_pupdr(pin, pull));
    }
    // The ports are as far apart as their numbers.
    let BusPin { port, pin, .. } = BUS.input;
    let [first, second, port] = [pac::GPIOA, pac::GPIOB, port].map(|port| port.as_ptr() as usize);
    let number = (port - first) / (second - first);
    pac::SYSCFG.exticr(pin / 4).modify(|w| w.set_exti(pin % 4, number as u8));
    pac::EXTI.ftsr(0).modify(|w| w.set_line(pin, true));
    pac::EXTI.imr(0).modify(|w| w.set_line(pin, true));
}

/// The unit for checksums divides by that of a chip, and begins at zero (RM0440, CRC).
#[cold]
#[inline(never)]
fn begin_checksum(chip: &Chip) {
    let Some(Checksum { polynomial, .. }) = chip.checksum else { return };
    pac::RCC.ahb1enr().modify(|w| w.set_crcen(true));
    let _ = pac::RCC.ahb1enr().read();
    pac::CRC.init().write_value(0);
    pac::CRC.pol().write_value(polynomial & 0xFF);
    pac::CRC.cr().write(|w| {
        w.set_polysize(Polysize::POLYSIZE8);
        w.set_reset(true);
    });
}

/// The channels, which move nothing yet.
fn connect_channels(chip: &'static Chip) {
    let words = chip.interface.words;
    let (control, data) = (BUS.spi.cr1().as_ptr() as u32, BUS.spi.dr16().as_ptr() as u32);
    let [frame, ends] = [MEMORY.frame.as_ptr() as u32, MEMORY.ends.as_ptr() as u32];
    let (pending, fall) = (pac::EXTI.pr(0).as_ptr() as u32, &raw const FALL as u32);
    channel(RECEIVE, Dir::FROM_PERIPHERAL, data, frame, words);
    channel(SEND, Dir::FROM_MEMORY, data, chip.command.as_ptr() as u32, words);
    channel(BEGIN, Dir::FROM_MEMORY, control, MEMORY.begins.as_ptr() as u32, 1);
    channel(CLEAR, Dir::FROM_MEMORY, pending, fall, 1);
    // The registers of the detector take whole words only (RM0440, EXTI).
    DMA.ch(CLEAR).cr().modify(|w| {
        w.set_msize(Size::BITS32);
        w.set_psize(Size::BITS32);
    });
    channel(END, Dir::FROM_MEMORY, control, ends, ENDING);
    let of_transfer = words as u8 - 1;
    request(RECEIVE, BUS.received, of_transfer, |w| w.set_ege(true));
    request(SEND, BUS.wants, of_transfer, |w| {
        w.set_sync_id(EVENT_OF + BEGIN as u8);
        w.set_spol(Pol::RISING_EDGE);
        w.set_se(true);
    });
    request(CLEAR, BUS.begins, 0, |w| w.set_ege(true));
    for (number, (from, to, requests)) in GENERATORS.into_iter().enumerate() {
        let generator = pac::DMAMUX1.rgcr(number);
        generator.write(|w| {
            w.set_sig_id(EVENT_OF + from as u8);
            w.set_gpol(Pol::RISING_EDGE);
            w.set_gnbreq(requests - 1);
        });
        generator.modify(|w| w.set_ge(true));
        let more = if to == BEGIN { requests - 1 } else { 0 };
        request(to, GENERATED + number as u8, more, |w| w.set_ege(to == BEGIN));
    }
}

/// A channel that moves halfwords in a circle.
fn channel(number: usize, direction: Dir, peripheral: u32, memory: u32, count: usize) {
    let channel = DMA.ch(number);
    channel.par().write_value(peripheral);
    channel.mar().write_value(memory);
    channel.ndtr().write(|w| w.set_ndt(count as u16));
    channel.cr().write(|w| {
        w.set_circ(true);
        w.set_minc(true);
        w.set_dir(direction);
        w.set_msize(Size::BITS16);
        w.set_psize(Size::BITS16);
        w.set_pl(Pl::HIGH);
    });
}

/// The request of a channel; so many more than one are counted, before its events or its synchronisation are enabled
/// (RM0440, DMAMUX: the number may not be written after that).
fn request(number: usize, request: u8, more: u8, enable: impl FnOnce(&mut Ccr)) {
    let multiplexer = pac::DMAMUX1.ccr(number);
    multiplexer.write(|w| {
        w.set_dmareq_id(request);
        w.set_nbreq(more);
    });
    multiplexer.modify(enable);
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

        /// Ticks without a step of a chip that has stopped.
        const FROZEN: u32 = $chip.frozen();
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

/// The handler of the servo's interrupt, the end of a transfer, for the state in `ISR_STATE`.
#[cfg(not(feature = "bridge"))]
#[doc(hidden)]
#[macro_export]
macro_rules! board_tick {
    () => {
        $crate::in_fast_memory! {
            /// A tick.
            #[unsafe(no_mangle)]
            unsafe extern "C" fn DMA1_CHANNEL1() {
                // SAFETY: this is the handler of the interrupt that is enabled after the cell is filled, and no
                // interrupt interrupts itself.
                let isr = unsafe { ISR_STATE.borrow_mut() };
                if isr.hardware.take_reading(&ENCODER_SETUP) {
                    isr.tick();
                }
            }
        }
    };
}
