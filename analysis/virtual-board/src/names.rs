//! Names of registers in the reference manuals (RM0440, RM0090), for messages about registers that are
//! not modelled.

use crate::unit::Unit;

/// Registers one after the other, a word each; "" for a gap.
type Row = &'static [&'static str];

/// Timers of every kind.
const TIMER: Row = &[
    "CR1", "CR2", "SMCR", "DIER", "SR", "EGR", "CCMR1", "CCMR2", "CCER", "CNT", "PSC", "ARR",
    "RCR", "CCR1", "CCR2", "CCR3", "CCR4", "BDTR",
];
/// The advanced timer.
const PWM_TIMER: Row = &[
    "CR1", "CR2", "SMCR", "DIER", "SR", "EGR", "CCMR1", "CCMR2", "CCER", "CNT", "PSC", "ARR",
    "RCR", "CCR1", "CCR2", "CCR3", "CCR4", "BDTR", "CCR5", "CCR6", "CCMR3", "DTR2", "ECR", "TISEL",
    "AF1", "AF2",
];
/// A converter of the G4.
const ADC_G4: Row = &[
    "ISR", "IER", "CR", "CFGR", "CFGR2", "SMPR1", "SMPR2", "", "TR1", "TR2", "TR3", "", "SQR1",
    "SQR2", "SQR3", "SQR4", "DR", "", "", "JSQR", "", "", "", "", "OFR1", "OFR2", "OFR3", "OFR4",
    "", "", "", "", "JDR1", "JDR2", "JDR3", "JDR4", "", "", "", "", "AWD2CR", "AWD3CR", "", "",
    "DIFSEL", "CALFACT", "", "", "GCOMP",
];
const ADC_COMMON_G4: Row = &["CSR", "", "CCR", "CDR"];
const COMPARATORS_G4: Row = &["COMP1_CSR", "COMP2_CSR", "COMP3_CSR", "COMP4_CSR"];
const OP_AMPS_G4: Row = &[
    "OPAMP1_CSR",
    "OPAMP2_CSR",
    "OPAMP3_CSR",
    "",
    "",
    "",
    "OPAMP1_TCMR",
    "OPAMP2_TCMR",
    "OPAMP3_TCMR",
];
/// Ports of pins.
const PINS: Row =
    &["MODER", "OTYPER", "OSPEEDR", "PUPDR", "IDR", "ODR", "BSRR", "LCKR", "AFRL", "AFRH", "BRR"];
/// The DAC; the F4's ends with the status.
const DAC: Row = &[
    "CR", "SWTRGR", "DHR12R1", "DHR12L1", "DHR8R1", "DHR12R2", "DHR12L2", "DHR8R2", "DHR12RD",
    "DHR12LD", "DHR8RD", "DOR1", "DOR2", "SR", "CCR", "MCR", "SHSR1", "SHSR2", "SHHR", "SHRR", "",
    "", "STR1", "STR2", "STMODR",
];
/// The watchdog; the F4's ends with the status.
const WATCHDOG: Row = &["KR", "PR", "RLR", "SR", "WINR"];
/// The debug unit.
const DEBUG: Row = &["IDCODE", "CR", "APB1FZR1", "APB1FZR2", "APB2FZR"];

const CLOCK_G4: Row = &[
    "CR",
    "ICSCR",
    "CFGR",
    "PLLCFGR",
    "",
    "",
    "CIER",
    "CIFR",
    "CICR",
    "",
    "AHB1RSTR",
    "AHB2RSTR",
    "AHB3RSTR",
    "",
    "APB1RSTR1",
    "APB1RSTR2",
    "APB2RSTR",
    "",
    "AHB1ENR",
    "AHB2ENR",
    "AHB3ENR",
    "",
    "APB1ENR1",
    "APB1ENR2",
    "APB2ENR",
    "",
    "AHB1SMENR",
    "AHB2SMENR",
    "AHB3SMENR",
    "",
    "APB1SMENR1",
    "APB1SMENR2",
    "APB2SMENR",
    "",
    "CCIPR",
    "",
    "BDCR",
    "CSR",
    "CRRCR",
    "CCIPR2",
];
const POWER_G4: Row = &["CR1", "CR2", "CR3", "CR4", "SR1", "SR2", "SCR"];
const FLASH_G4: Row = &["ACR", "PDKEYR", "KEYR", "OPTKEYR", "SR", "CR", "ECCR", "", "OPTR"];
const SERIAL_G4: Row =
    &["CR1", "CR2", "CR3", "BRR", "GTPR", "RTOR", "RQR", "ISR", "ICR", "RDR", "TDR", "PRESC"];
const CONFIGURATION_G4: Row = &[
    "MEMRMP", "CFGR1", "EXTICR1", "EXTICR2", "EXTICR3", "EXTICR4", "SCSR", "CFGR2", "SWPR", "SKR",
];

const CLOCK_F405: Row = &[
    "CR",
    "PLLCFGR",
    "CFGR",
    "CIR",
    "AHB1RSTR",
    "AHB2RSTR",
    "AHB3RSTR",
    "",
    "APB1RSTR",
    "APB2RSTR",
    "",
    "",
    "AHB1ENR",
    "AHB2ENR",
    "AHB3ENR",
    "",
    "APB1ENR",
    "APB2ENR",
    "",
    "",
    "AHB1LPENR",
    "AHB2LPENR",
    "AHB3LPENR",
    "",
    "APB1LPENR",
    "APB2LPENR",
    "",
    "",
    "BDCR",
    "CSR",
    "",
    "",
    "SSCGR",
    "PLLI2SCFGR",
];
const POWER_F405: Row = &["CR", "CSR"];
const FLASH_F405: Row = &["ACR", "KEYR", "OPTKEYR", "SR", "CR", "OPTCR"];
const SERIAL_F405: Row = &["SR", "DR", "BRR", "CR1", "CR2", "CR3", "GTPR"];
const CONFIGURATION_F405: Row =
    &["MEMRMP", "PMC", "EXTICR1", "EXTICR2", "EXTICR3", "EXTICR4", "", "", "CMPCR"];

/// A register of the G4.
pub fn g4(unit: Unit, offset: u32) -> Option<&'static str> {
    let row = match unit {
        Unit::Clock => CLOCK_G4,
        // Behind the pulls of all ports.
        Unit::Power if offset == 0x80 => return Some("CR5"),
        Unit::Power => POWER_G4,
        Unit::Flash => FLASH_G4,
        Unit::Configuration => CONFIGURATION_G4,
        Unit::Serial => SERIAL_G4,
        Unit::Adc(_) => ADC_G4,
        Unit::AdcCommon => ADC_COMMON_G4,
        Unit::Comparators => COMPARATORS_G4,
        Unit::OpAmps => OP_AMPS_G4,
        other => common(other),
    };
    at(row, offset)
}

/// A register of the F405.
pub fn f405(unit: Unit, offset: u32) -> Option<&'static str> {
    let row = match unit {
        Unit::Clock => CLOCK_F405,
        Unit::Power => POWER_F405,
        Unit::Flash => FLASH_F405,
        Unit::Configuration => CONFIGURATION_F405,
        Unit::Serial => SERIAL_F405,
        other => common(other),
    };
    at(row, offset)
}

/// The common registers of both families.
fn common(unit: Unit) -> Row {
    match unit {
        Unit::TickTimer | Unit::PhaseTimer | Unit::FreeClock | Unit::Encoder => TIMER,
        Unit::Pins(_) => PINS,
        Unit::PwmTimer => PWM_TIMER,
        Unit::Dac | Unit::ThresholdDac => DAC,
        Unit::Watchdog => WATCHDOG,
        Unit::Debug => DEBUG,
        Unit::Clock | Unit::Power | Unit::Flash | Unit::Configuration | Unit::Serial => &[],
        Unit::Adc(_) | Unit::AdcCommon | Unit::Comparators | Unit::OpAmps => &[],
    }
}

fn at(row: Row, offset: u32) -> Option<&'static str> {
    row.get(offset as usize / 4).copied().filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Offsets that the manuals give for the last register of a row, where a gap would show.
    #[test]
    fn rows_have_their_registers_where_the_manuals_have_them() {
        for (unit, offset, name) in [
            (Unit::Clock, 0x9C, "CCIPR2"),
            (Unit::Clock, 0x58, "APB1ENR1"),
            (Unit::TickTimer, 0x2C, "ARR"),
            (Unit::Dac, 0x2C, "DOR1"),
            (Unit::Dac, 0x3C, "MCR"),
            (Unit::Serial, 0x24, "RDR"),
            (Unit::Pins(1), 0x18, "BSRR"),
            (Unit::Power, 0x80, "CR5"),
            (Unit::PwmTimer, 0x44, "BDTR"),
            (Unit::PwmTimer, 0x64, "AF2"),
            (Unit::Adc(0), 0x30, "SQR1"),
            (Unit::Adc(0), 0x4C, "JSQR"),
            (Unit::Adc(1), 0x80, "JDR1"),
            (Unit::Adc(1), 0xC0, "GCOMP"),
            (Unit::OpAmps, 0x18, "OPAMP1_TCMR"),
            (Unit::ThresholdDac, 0x14, "DHR12R2"),
        ] {
            assert_eq!(g4(unit, offset), Some(name));
        }
        for (unit, offset, name) in [
            (Unit::Clock, 0x84, "PLLI2SCFGR"),
            (Unit::Clock, 0x74, "CSR"),
            (Unit::Clock, 0x40, "APB1ENR"),
            (Unit::Serial, 0x0C, "CR1"),
        ] {
            assert_eq!(f405(unit, offset), Some(name));
        }
        assert_eq!(g4(Unit::Clock, 0x10), None);
    }
}
