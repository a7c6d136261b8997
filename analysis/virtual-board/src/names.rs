//! Names of registers in the reference manuals (RM0440, RM0090), for messages about registers that are
//! not modelled.

use crate::unit::{Stage, Unit};

// Registers one after the other, a word each; `-` for a gap.

/// Timers of every kind; only the advanced timer has the registers behind BDTR.
const TIMER: &str = "\
    CR1 CR2 SMCR DIER SR EGR CCMR1 CCMR2 CCER CNT PSC ARR RCR CCR1 CCR2 CCR3 CCR4 BDTR CCR5 CCR6 \
    CCMR3 DTR2 ECR TISEL AF1 AF2";
/// A converter of the G4.
const ADC_G4: &str = "\
    ISR IER CR CFGR CFGR2 SMPR1 SMPR2 - TR1 TR2 TR3 - SQR1 SQR2 SQR3 SQR4 DR - - JSQR - - - - OFR1 \
    OFR2 OFR3 OFR4 - - - - JDR1 JDR2 JDR3 JDR4 - - - - AWD2CR AWD3CR - - DIFSEL CALFACT - - GCOMP";
const ADC_COMMON_G4: &str = "CSR - CCR CDR";
const COMPARATORS_G4: &str = "COMP1_CSR COMP2_CSR COMP3_CSR COMP4_CSR";
const OP_AMPS_G4: &str = "\
    OPAMP1_CSR OPAMP2_CSR OPAMP3_CSR - - - OPAMP1_TCMR OPAMP2_TCMR OPAMP3_TCMR";
/// Ports of pins.
const PINS: &str = "MODER OTYPER OSPEEDR PUPDR IDR ODR BSRR LCKR AFRL AFRH BRR";
/// The DAC; the F4's ends with the status.
const DAC: &str = "\
    CR SWTRGR DHR12R1 DHR12L1 DHR8R1 DHR12R2 DHR12L2 DHR8R2 DHR12RD DHR12LD DHR8RD DOR1 DOR2 SR \
    CCR MCR SHSR1 SHSR2 SHHR SHRR - - STR1 STR2 STMODR";
/// The watchdog; the F4's ends with the status.
const WATCHDOG: &str = "KR PR RLR SR WINR";
/// The debug unit.
const DEBUG: &str = "IDCODE CR APB1FZR1 APB1FZR2 APB2FZR";
const CLOCK_G4: &str = "\
    CR ICSCR CFGR PLLCFGR - - CIER CIFR CICR - AHB1RSTR AHB2RSTR AHB3RSTR - APB1RSTR1 APB1RSTR2 \
    APB2RSTR - AHB1ENR AHB2ENR AHB3ENR - APB1ENR1 APB1ENR2 APB2ENR - AHB1SMENR AHB2SMENR AHB3SMENR \
    - APB1SMENR1 APB1SMENR2 APB2SMENR - CCIPR - BDCR CSR CRRCR CCIPR2";
const POWER_G4: &str = "CR1 CR2 CR3 CR4 SR1 SR2 SCR";
const FLASH_G4: &str = "ACR PDKEYR KEYR OPTKEYR SR CR ECCR - OPTR";
const SERIAL_G4: &str = "CR1 CR2 CR3 BRR GTPR RTOR RQR ISR ICR RDR TDR PRESC";
const CONFIGURATION_G4: &str = "MEMRMP CFGR1 EXTICR1 EXTICR2 EXTICR3 EXTICR4 SCSR CFGR2 SWPR SKR";
const CLOCK_F405: &str = "\
    CR PLLCFGR CFGR CIR AHB1RSTR AHB2RSTR AHB3RSTR - APB1RSTR APB2RSTR - - AHB1ENR AHB2ENR AHB3ENR \
    - APB1ENR APB2ENR - - AHB1LPENR AHB2LPENR AHB3LPENR - APB1LPENR APB2LPENR - - BDCR CSR - - \
    SSCGR PLLI2SCFGR";
const POWER_F405: &str = "CR CSR";
const FLASH_F405: &str = "ACR KEYR OPTKEYR SR CR OPTCR";
const SERIAL_F405: &str = "SR DR BRR CR1 CR2 CR3 GTPR";
const CONFIGURATION_F405: &str = "MEMRMP PMC EXTICR1 EXTICR2 EXTICR3 EXTICR4 - - CMPCR";

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
        other => common(other, offset),
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
        other => common(other, offset),
    };
    at(row, offset)
}

/// The registers that are the same in both families, or that one of them has.
fn common(unit: Unit, offset: u32) -> &'static str {
    /// BDTR.
    const LAST_OF_TIMER: u32 = 0x44;
    match unit {
        Unit::TickTimer | Unit::PhaseTimer | Unit::FreeClock | Unit::Encoder
            if offset > LAST_OF_TIMER =>
        {
            ""
        }
        Unit::TickTimer | Unit::PhaseTimer | Unit::FreeClock | Unit::Encoder => TIMER,
        Unit::Pins(_) => PINS,
        Unit::Dac | Unit::Stage(Stage::ThresholdDac) => DAC,
        Unit::Watchdog => WATCHDOG,
        Unit::Debug => DEBUG,
        Unit::Stage(Stage::PwmTimer) => TIMER,
        Unit::Stage(Stage::Adc(_)) => ADC_G4,
        Unit::Stage(Stage::AdcCommon) => ADC_COMMON_G4,
        Unit::Stage(Stage::Comparators) => COMPARATORS_G4,
        Unit::Stage(Stage::OpAmps) => OP_AMPS_G4,
        Unit::Clock | Unit::Power | Unit::Flash | Unit::Configuration | Unit::Serial => "",
    }
}

fn at(row: &'static str, offset: u32) -> Option<&'static str> {
    row.split_whitespace().nth(offset as usize / 4).filter(|name| *name != "-")
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
            (Unit::Stage(Stage::PwmTimer), 0x44, "BDTR"),
            (Unit::Stage(Stage::PwmTimer), 0x64, "AF2"),
            (Unit::Stage(Stage::Adc(0)), 0x30, "SQR1"),
            (Unit::Stage(Stage::Adc(0)), 0x4C, "JSQR"),
            (Unit::Stage(Stage::Adc(1)), 0x80, "JDR1"),
            (Unit::Stage(Stage::Adc(1)), 0xC0, "GCOMP"),
            (Unit::Stage(Stage::OpAmps), 0x18, "OPAMP1_TCMR"),
            (Unit::Stage(Stage::ThresholdDac), 0x14, "DHR12R2"),
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
        assert_eq!((g4(Unit::Clock, 0x10), g4(Unit::TickTimer, 0x60)), (None, None));
    }
}
