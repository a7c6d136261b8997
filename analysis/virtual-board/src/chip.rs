//! The chips: address and clock of each peripheral, and the connections of its pins.

use crate::peripheral::pins::Pins;
use crate::peripheral::registers::Table;
use crate::peripheral::{clock, dac, serial};

/// A peripheral of either chip, by what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Reset and clock control.
    Clock,
    /// Power control.
    Power,
    /// The flash memory's interface.
    Flash,
    /// System configuration.
    Configuration,
    /// The debug registers.
    Debug,
    /// A port of pins: 0 is A.
    Pins(usize),
    /// TIM6.
    TickTimer,
    /// TIM7.
    PhaseTimer,
    /// The free-running clock.
    FreeClock,
    /// The encoder's counter.
    Encoder,
    /// The DAC.
    Dac,
    /// The serial port.
    Serial,
    /// The SPI of a magnetic encoder.
    Spi,
    /// DMA1.
    Dma,
    /// Its multiplexer.
    DmaMultiplexer,
    /// The detector of edges.
    Edges,
    /// The unit for checksums.
    Checksum,
    /// The independent watchdog.
    Watchdog,
    /// A unit of the power stage.
    Stage(Stage),
}

/// A unit of the power stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// TIM1, the modulator.
    PwmTimer,
    /// ADC1 or ADC2: 0 is the first.
    Adc(usize),
    /// What both converters share.
    AdcCommon,
    /// The comparators.
    Comparators,
    /// The operational amplifiers.
    OpAmps,
    /// DAC3, the comparators' thresholds.
    ThresholdDac,
}

/// Entry of the memory map: address and name of a unit.
#[derive(Clone, Copy, Debug)]
pub struct MapEntry {
    /// Its first address.
    pub base: u32,
    /// Its name in the reference manual.
    pub name: &'static str,
    /// What it is.
    pub unit: Unit,
    /// The register of the clock control that clocks it, the register that resets it, and its bit there;
    /// `None` if it is always clocked.
    pub clocked: Option<(u32, u32, u32)>,
}

/// First address of flash, which is also at address 0 after reset.
pub const FLASH: u32 = 0x0800_0000;
/// First address of the core-coupled memory.
pub const COUPLED: u32 = 0x1000_0000;
/// First address of RAM.
pub const RAM: u32 = 0x2000_0000;

/// Size of a unit in the map in bytes.
pub const SPAN: u32 = 0x400;

/// A magnetic encoder's bus.
#[derive(Clone, Copy, Debug)]
pub struct Bus {
    /// NSS, SCK, MISO and MOSI, and their alternate function.
    pub pins: ([(usize, u32); 4], u32),
    /// Requests of the DMA: a received word.
    pub received: u32,
    /// A word to send.
    pub wanted: u32,
    /// What begins a transfer: TIM6's update, or with a bridge channel 4 of TIM1.
    pub begins: u32,
}

/// A chip on its board.
#[derive(Debug)]
pub struct Chip {
    /// Name of its board in `haptic`.
    pub name: &'static str,
    /// Bytes of [`FLASH`].
    pub flash: u32,
    /// Bytes of [`RAM`].
    pub ram: u32,
    /// Bytes of [`COUPLED`] memory, and whether it can hold instructions.
    pub coupled: (u32, bool),
    /// The board's crystal in Hz.
    pub crystal: u64,
    /// The core's clock in Hz after the program's set-up.
    pub core: u64,
    /// The map of its peripherals, in parts.
    pub map: &'static [&'static [MapEntry]],
    /// Bits of the encoder's counter.
    pub counter: u32,
    /// The pin that switches the amplifier on, as port and number; high is on, on every board.
    pub amplifier: (usize, u32),
    /// The gates of its power stage, if it has one: high sides, then low sides of the phases U, V and W, each
    /// with the alternate function that is TIM1.
    pub gates: Option<&'static [((usize, u32), u32); 6]>,
    /// The encoder's two pins and the alternate function that is its timer.
    pub encoder: ([(usize, u32); 2], u32),
    /// The pin of the encoder's index and the alternate function of its timer's channel 3, if there is one.
    pub index: Option<((usize, u32), u32)>,
    /// The bus of a magnetic encoder, if it is wired.
    pub bus: Option<Bus>,
    /// The serial port's two pins and the alternate function that is that port.
    pub serial: ([(usize, u32); 2], u32),
    /// The serial port's interrupt.
    pub serial_interrupt: u16,
    /// Registers of its clock control.
    pub clock: &'static clock::Layout,
    /// Its DAC's bits.
    pub dac: dac::Layout,
    /// Its serial port's registers.
    pub usart: &'static serial::Variant,
    /// Its power control.
    pub power: Table,
    /// Its flash interface.
    pub flash_interface: Table,
    /// The offset of the option bytes in it.
    pub options: u32,
    /// Its system configuration.
    pub configuration: Table,
    /// Its unit for debugging.
    pub debug: Table,
    /// Its ports after reset.
    pub ports: fn(usize) -> Pins,
}

/// TIM6 with the DAC's underrun: the servo's interrupt.
pub const TICK_INTERRUPT: u16 = 54;
/// The first channel of DMA1: the end of a magnetic encoder's transfer, which is the servo's interrupt then.
pub const TRANSFER_INTERRUPT: u16 = 11;
/// ADC1 and ADC2: the current loop's interrupt.
pub const CONVERSION_INTERRUPT: u16 = 18;
/// The pin that the DAC drives: PA4 on both.
pub const TORQUE: (usize, u32) = (0, 4);

const fn map_entry(
    base: u32,
    name: &'static str,
    unit: Unit,
    enable: u32,
    reset: u32,
    bit: u32,
) -> MapEntry {
    MapEntry { base, name, unit, clocked: Some((enable, reset, bit)) }
}

const fn ungated(base: u32, name: &'static str, unit: Unit) -> MapEntry {
    MapEntry { base, name, unit, clocked: None }
}

/// Peripherals that a debugger may stop while it halts the core: bits of [`FREEZE`]. Nothing halts here, so
/// writes have no effect.
pub const WATCHDOG_FREEZES: u32 = 1 << 12;
/// Offset of that register in the unit for debugging.
pub const FREEZE: u32 = 0x08;
/// The G4's register for TIM1, and its bit: the counter stops with the core, and the outputs are then off (RM0440,
/// 28.4).
pub const FREEZE_TIM1: u32 = 0x10;
/// That bit.
pub const TIM1_FREEZES: u32 = 1 << 11;

/// Offset of the G4's CFGR2 in the system configuration; one of its bits makes a locked-up core break the
/// outputs of TIM1 (RM0440, 10.2.8).
pub const BREAKS: u32 = 0x1C;
/// That bit.
pub const LOCK_UP_BREAKS: u32 = 1;

/// The G4's EXTICR1 to 4, the port of each pin's line in the detector of edges (RM0440, 10.2).
const PORTS: [(u32, u32, u32); 4] =
    [(0x08, 0, 0xFFFF), (0x0C, 0, 0xFFFF), (0x10, 0, 0xFFFF), (0x14, 0, 0xFFFF)];
/// The offset of the first.
pub const LINE_PORTS: u32 = 0x08;

/// The debug unit: the chip's identity, and the clocks while the core sleeps.
const DEBUG_G4: Table = &[
    (0x00, 0x2001_6469, 0),
    (0x04, 0, 0b111),
    (FREEZE, 0, WATCHDOG_FREEZES),
    (FREEZE_TIM1, 0, TIM1_FREEZES),
];
const DEBUG_F405: Table =
    &[(0x00, 0x1007_6413, 0), (0x04, 0, 0b111), (FREEZE, 0, WATCHDOG_FREEZES)];

/// Power control (RM0440, 6.4; RM0090, 5.4), whose voltage ranges are reached at once. The G4's CR1 with the
/// voltage range and the access to the backup domain, CR5 with the boost.
const POWER_G4: Table =
    &[(0x00, 0x0000_0200, 1 << 8), (0x08, 0x0000_8000, 1 << 14), (0x80, 0x0000_0100, 1 << 8)];
/// The F405's CR with the voltage scale and the access to the backup domain; CSR says that the regulator is
/// ready. The driver sets two bits of scale, of which this chip has the lower one.
const POWER_F405: Table = &[(0x00, 0x0000_4000, (0b11 << 14) | (1 << 8)), (0x04, 1 << 14, 0)];

/// The flash memory's interface (RM0440, 3.7; RM0090, 3.9): its wait states and caches, which an instruction
/// count does not see, the option bytes as delivered, and its errors: the G4's ACR, ECCR and OPTR.
const FLASH_G4: Table = &[(0x00, 0x0004_0600, 0x0004_0F0F), (0x18, 0, 0), (0x20, 0xFFEF_F8AA, 0)];
/// The F405's ACR and OPTCR.
const FLASH_F405: Table = &[(0x00, 0, 0x0000_0707), (0x14, 0x0FFF_AAED, 0)];

/// The units of an STM32G4, except the timers of the encoder's counter and of the free-running clock, which
/// depend on the board.
static G4_MAP: &[MapEntry] = &[
    map_entry(0x4000_1000, "TIM6", Unit::TickTimer, 0x58, 0x38, 4),
    map_entry(0x4000_1400, "TIM7", Unit::PhaseTimer, 0x58, 0x38, 5),
    ungated(0x4000_3000, "IWDG", Unit::Watchdog),
    map_entry(0x4000_7000, "PWR", Unit::Power, 0x58, 0x38, 28),
    map_entry(0x4001_0000, "SYSCFG", Unit::Configuration, 0x60, 0x40, 0),
    ungated(0x4001_0400, "EXTI", Unit::Edges),
    map_entry(0x4002_0000, "DMA1", Unit::Dma, 0x48, 0x28, 0),
    map_entry(0x4002_0800, "DMAMUX1", Unit::DmaMultiplexer, 0x48, 0x28, 2),
    ungated(0x4002_1000, "RCC", Unit::Clock),
    map_entry(0x4002_2000, "FLASH", Unit::Flash, 0x48, 0x28, 8),
    map_entry(0x4002_3000, "CRC", Unit::Checksum, 0x48, 0x28, 12),
    map_entry(0x4800_0000, "GPIOA", Unit::Pins(0), 0x4C, 0x2C, 0),
    map_entry(0x4800_0400, "GPIOB", Unit::Pins(1), 0x4C, 0x2C, 1),
    map_entry(0x4800_0800, "GPIOC", Unit::Pins(2), 0x4C, 0x2C, 2),
    map_entry(0x4800_0C00, "GPIOD", Unit::Pins(3), 0x4C, 0x2C, 3),
    map_entry(0x4800_1000, "GPIOE", Unit::Pins(4), 0x4C, 0x2C, 4),
    map_entry(0x4800_1400, "GPIOF", Unit::Pins(5), 0x4C, 0x2C, 5),
    map_entry(0x4800_1800, "GPIOG", Unit::Pins(6), 0x4C, 0x2C, 6),
    map_entry(0x5000_0800, "DAC1", Unit::Dac, 0x4C, 0x2C, 16),
    ungated(0xE004_2000, "DBGMCU", Unit::Debug),
];

const USART2: MapEntry = map_entry(0x4000_4400, "USART2", Unit::Serial, 0x58, 0x38, 17);

/// The units of a power stage on an STM32G4.
static POWER_STAGE: &[MapEntry] = &[
    map_entry(0x4001_0200, "COMP", Unit::Stage(Stage::Comparators), 0x60, 0x40, 0),
    map_entry(0x4001_0300, "OPAMP", Unit::Stage(Stage::OpAmps), 0x60, 0x40, 0),
    map_entry(0x4001_2C00, "TIM1", Unit::Stage(Stage::PwmTimer), 0x60, 0x40, 11),
    map_entry(0x5000_0000, "ADC1", Unit::Stage(Stage::Adc(0)), 0x4C, 0x2C, 13),
    map_entry(0x5000_0100, "ADC2", Unit::Stage(Stage::Adc(1)), 0x4C, 0x2C, 13),
    map_entry(0x5000_0300, "ADC12", Unit::Stage(Stage::AdcCommon), 0x4C, 0x2C, 13),
    map_entry(0x5000_1000, "DAC3", Unit::Stage(Stage::ThresholdDac), 0x4C, 0x2C, 18),
];

/// STM32G474RE on a NUCLEO-G474RE.
pub static NUCLEO_G474RE: Chip = Chip {
    name: "nucleo-g474re",
    flash: 512 << 10,
    ram: 96 << 10,
    coupled: (32 << 10, true),
    crystal: 24_000_000,
    core: 170_000_000,
    map: &[
        &[
            map_entry(0x4000_0000, "TIM2", Unit::Encoder, 0x58, 0x38, 0),
            map_entry(0x4000_0C00, "TIM5", Unit::FreeClock, 0x58, 0x38, 3),
            map_entry(0x4000_3800, "SPI2", Unit::Spi, 0x58, 0x38, 14),
            USART2,
        ],
        G4_MAP,
    ],
    counter: 32,
    amplifier: (1, 10),
    gates: None,
    // TIM2_CH1 and TIM2_CH2.
    encoder: ([(0, 0), (0, 1)], 1),
    index: None,
    // SPI2.
    bus: Some(Bus {
        pins: ([(1, 12), (1, 13), (1, 14), (1, 15)], 5),
        received: 12,
        wanted: 13,
        begins: 8,
    }),
    // USART2_TX and USART2_RX.
    serial: ([(0, 2), (0, 3)], 7),
    serial_interrupt: 38,
    clock: &clock::G4,
    dac: dac::G4,
    usart: &serial::G4,
    power: POWER_G4,
    flash_interface: FLASH_G4,
    options: 0x20,
    // CFGR2, with the flag of a wrong parity.
    configuration: &[(BREAKS, 0, 0), PORTS[0], PORTS[1], PORTS[2], PORTS[3]],
    debug: DEBUG_G4,
    ports: |port| match port {
        // The debug port's pins are not analog out of reset; A's and B's differ.
        0 => Pins::new(0xABFF_FFFF, 0x0C00_0000, 0x6400_0000),
        1 => Pins::new(0xFFFF_FEBF, 0x0000_00C0, 0x0000_0100),
        _ => Pins::new(0xFFFF_FFFF, 0, 0),
    },
};

const ESC1_TIMERS: [MapEntry; 2] = [
    map_entry(0x4000_0000, "TIM2", Unit::FreeClock, 0x58, 0x38, 0),
    map_entry(0x4000_0800, "TIM4", Unit::Encoder, 0x58, 0x38, 2),
];

/// STM32G431CB on a B-G431B-ESC1.
pub static B_G431B_ESC1: Chip = Chip {
    name: "b-g431b-esc1",
    flash: 128 << 10,
    ram: 22 << 10,
    coupled: (10 << 10, true),
    crystal: 8_000_000,
    map: &[&ESC1_TIMERS, &[USART2], G4_MAP, POWER_STAGE],
    bus: None,
    counter: 16,
    amplifier: (0, 15),
    // TIM1_CH1 to CH3 and TIM1_CH1N to CH3N.
    gates: Some(&[
        ((0, 8), 6),
        ((0, 9), 6),
        ((0, 10), 6),
        ((2, 13), 4),
        ((0, 12), 6),
        ((1, 15), 4),
    ]),
    // CFGR2 as above, with the bit for a locked-up core.
    configuration: &[(BREAKS, 0, LOCK_UP_BREAKS), PORTS[0], PORTS[1], PORTS[2], PORTS[3]],
    // TIM4_CH1 and TIM4_CH2.
    encoder: ([(1, 6), (1, 7)], 2),
    // TIM4_CH3.
    index: Some(((1, 8), 2)),
    // USART2_TX and USART2_RX.
    serial: ([(1, 3), (1, 4)], 7),
    ..NUCLEO_G474RE
};

/// The same without R23 and R24, and with a magnetic encoder at SPI3: the serial port is USART1.
pub static B_G431B_ESC1_MAGNETIC: Chip = Chip {
    map: &[
        &ESC1_TIMERS,
        &[
            map_entry(0x4000_3C00, "SPI3", Unit::Spi, 0x58, 0x38, 15),
            map_entry(0x4001_3800, "USART1", Unit::Serial, 0x60, 0x40, 14),
        ],
        G4_MAP,
        POWER_STAGE,
    ],
    bus: Some(Bus {
        pins: ([(0, 15), (1, 3), (1, 4), (1, 5)], 6),
        received: 14,
        wanted: 15,
        begins: 45,
    }),
    // USART1_TX and USART1_RX.
    serial: ([(1, 6), (1, 7)], 7),
    serial_interrupt: 37,
    ..B_G431B_ESC1
};

/// The units of the F405.
static F405_MAP: &[MapEntry] = &[
    map_entry(0x4000_0400, "TIM3", Unit::Encoder, 0x40, 0x20, 1),
    map_entry(0x4000_0C00, "TIM5", Unit::FreeClock, 0x40, 0x20, 3),
    map_entry(0x4000_1000, "TIM6", Unit::TickTimer, 0x40, 0x20, 4),
    map_entry(0x4000_1400, "TIM7", Unit::PhaseTimer, 0x40, 0x20, 5),
    ungated(0x4000_3000, "IWDG", Unit::Watchdog),
    map_entry(0x4000_4800, "USART3", Unit::Serial, 0x40, 0x20, 18),
    map_entry(0x4000_7000, "PWR", Unit::Power, 0x40, 0x20, 28),
    map_entry(0x4000_7400, "DAC", Unit::Dac, 0x40, 0x20, 29),
    map_entry(0x4001_3800, "SYSCFG", Unit::Configuration, 0x44, 0x24, 14),
    map_entry(0x4002_0000, "GPIOA", Unit::Pins(0), 0x30, 0x10, 0),
    map_entry(0x4002_0400, "GPIOB", Unit::Pins(1), 0x30, 0x10, 1),
    map_entry(0x4002_0800, "GPIOC", Unit::Pins(2), 0x30, 0x10, 2),
    map_entry(0x4002_0C00, "GPIOD", Unit::Pins(3), 0x30, 0x10, 3),
    map_entry(0x4002_1000, "GPIOE", Unit::Pins(4), 0x30, 0x10, 4),
    map_entry(0x4002_1400, "GPIOF", Unit::Pins(5), 0x30, 0x10, 5),
    map_entry(0x4002_1800, "GPIOG", Unit::Pins(6), 0x30, 0x10, 6),
    map_entry(0x4002_1C00, "GPIOH", Unit::Pins(7), 0x30, 0x10, 7),
    map_entry(0x4002_2000, "GPIOI", Unit::Pins(8), 0x30, 0x10, 8),
    ungated(0x4002_3800, "RCC", Unit::Clock),
    ungated(0x4002_3C00, "FLASH", Unit::Flash),
    ungated(0xE004_2000, "DBGMCU", Unit::Debug),
];

/// STM32F405RG on an Adafruit Feather STM32F405 Express (its published schematic, commit f10cfb4).
pub static STM32F405: Chip = Chip {
    name: "feather-stm32f405",
    flash: 1 << 20,
    ram: 128 << 10,
    coupled: (64 << 10, false),
    crystal: 12_000_000,
    core: 168_000_000,
    map: &[F405_MAP],
    counter: 16,
    // PC3, D11.
    amplifier: (2, 3),
    gates: None,
    // TIM3_CH1 and TIM3_CH2.
    encoder: ([(2, 6), (2, 7)], 2),
    index: None,
    bus: None,
    // USART3_TX and USART3_RX.
    serial: ([(1, 10), (1, 11)], 7),
    serial_interrupt: 39,
    clock: &clock::F405,
    dac: dac::F405,
    usart: &serial::F405,
    power: POWER_F405,
    flash_interface: FLASH_F405,
    options: 0x14,
    configuration: &[],
    debug: DEBUG_F405,
    ports: |port| match port {
        0 => Pins::new(0xA800_0000, 0x0C00_0000, 0x6400_0000),
        1 => Pins::new(0x0000_0280, 0x0000_00C0, 0x0000_0100),
        _ => Pins::new(0, 0, 0),
    },
};

impl Chip {
    /// The chips of all boards.
    pub const BOARDS: [&'static Self; 3] = [&NUCLEO_G474RE, &B_G431B_ESC1, &STM32F405];

    /// The chips of every test: one of each family.
    pub const ALL: [&'static Self; 2] = [&NUCLEO_G474RE, &STM32F405];

    /// The chip of the board with this name, if there is a virtual board.
    pub fn find(name: &str) -> Option<&'static Self> {
        Self::BOARDS.into_iter().find(|chip| chip.name == name)
    }

    /// The same board with its wires for a magnetic encoder.
    pub fn with_magnetic_encoder(&'static self) -> &'static Self {
        if self.gates.is_some() { &B_G431B_ESC1_MAGNETIC } else { self }
    }

    /// Its peripherals.
    pub fn units(&self) -> impl Iterator<Item = &'static MapEntry> {
        let parts: &'static [&'static [MapEntry]] = self.map;
        parts.iter().copied().flatten()
    }

    /// The unit at an address: of those that share a span, the last that begins before it.
    pub fn at(&self, address: u32) -> Option<&'static MapEntry> {
        let span = address & !(SPAN - 1);
        self.units()
            .filter(|map_entry| map_entry.base & !(SPAN - 1) == span && map_entry.base <= address)
            .max_by_key(|map_entry| map_entry.base)
    }
}
