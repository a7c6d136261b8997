use proptest::prelude::*;

use super::*;
use crate::current::AlignmentError;

const ALL: [Fault; 30] = [
    Fault::MissedTick { missed: 3, tolerated: 1 },
    Fault::EncoderJump { counts: 5000, largest: 979 },
    Fault::NotANumber,
    Fault::LinkLost { allowed: 2000 },
    Fault::Watchdog,
    Fault::Panic { line: 7, column: 13 },
    Fault::HardFault { address: 0x0800_1234, status: 0x0001_0000 },
    Fault::LateTick { late: 40, allowed: 31 },
    Fault::ClockLost,
    Fault::FlashEcc { address: 0x1238, status: 0x8000_1238 },
    Fault::RamParity,
    Fault::NonMaskable,
    Fault::Power(PowerFault::OverCurrent { current: 4500, largest: 4310 }),
    Fault::Power(PowerFault::OverVoltage { voltage: 26_100, highest: 25_200 }),
    Fault::Power(PowerFault::UnderVoltage { voltage: 17_000, lowest: 23_000 }),
    Fault::Power(PowerFault::OverTemperature { temperature: 905, largest: 800 }),
    Fault::Power(PowerFault::CurrentOffset { phase: 1, count: 4095 }),
    Fault::Power(PowerFault::CurrentNotFollowing { deviation: 900, largest: 862 }),
    Fault::Power(PowerFault::SaturatedDuty { instants: 33, allowed: 32 }),
    Fault::Power(PowerFault::IndexMismatch { count: 7, aligned: 12 }),
    Fault::Power(PowerFault::CurrentInterruptLate { late: 8500, allowed: 6375 }),
    Fault::Power(PowerFault::NotAligned { by_index: true }),
    Fault::Power(PowerFault::Alignment(AlignmentError::NotNeeded)),
    Fault::Power(PowerFault::Alignment(AlignmentError::Blocked { moved: -3, expected: 2340 })),
    Fault::Power(PowerFault::Alignment(AlignmentError::PolePairs { moved: -1200, expected: 2340 })),
    Fault::Power(PowerFault::Alignment(AlignmentError::NotReturned { moved: 2340, returned: 90 })),
    Fault::Power(PowerFault::Alignment(AlignmentError::Uneven { degrees: 41, largest: 30 })),
    Fault::Power(PowerFault::Thermistor { count: 4090, limit: 4032 }),
    Fault::Power(PowerFault::Comparator { phase: 2, threshold: 141 }),
    Fault::Power(PowerFault::IndexOffset { across: -3, along: 40 }),
];

#[test]
fn every_fault_has_a_code_and_a_word_of_its_own() {
    for (i, fault) in ALL.into_iter().enumerate() {
        let (code, numbers) = fault.encode();
        assert_ne!(code, 0);
        assert_eq!(Fault::decode(code, numbers), Some(fault));
        for other in &ALL[..i] {
            assert_ne!(other.encode().0, code);
            assert_ne!(other.as_str(), fault.as_str());
        }
    }
    assert_eq!(Fault::decode(0, [0; 2]), None);
    assert_eq!(Fault::decode(32, [0; 2]), None);
}

#[test]
fn sentences_have_the_value_the_bound_and_the_way_out() {
    for (fault, parts) in [
        (ALL[0], ["3 update(s)", "allows 1", "arm again"]),
        (ALL[1], ["5000 counts", "allows 979", "reset"]),
        (ALL[3], ["2000 ticks", "allowed", "arm again"]),
        (ALL[5], ["line 7", "column 13", "arm again"]),
        (ALL[6], ["0x08001234", "0x00010000", "arm again"]),
        (ALL[7], ["40 timer counts", "31 are allowed", "arm again"]),
        (ALL[8], ["crystal", "supply", "arm again"]),
        (ALL[9], ["0x00001238", "0x80001238", "flash the program again"]),
    ] {
        let sentence = fault.to_string();
        for part in parts {
            assert!(sentence.contains(part), "{part:?} is not in {sentence:?}");
        }
    }
}

#[test]
fn a_check_sum_of_zeros_is_no_record() {
    assert_eq!(FaultRecord::decode(&FaultRecord::NOTHING), None);
    assert_eq!(FaultRecord::decode(&[u32::MAX; FaultRecord::WORDS]), None);
}

proptest! {
    #[test]
    fn a_record_comes_back_and_a_changed_one_does_not(
        which in 0..ALL.len(),
        tick: u32,
        count: i32,
        word in 0..FaultRecord::WORDS,
        flipped in 1..=u32::MAX,
    ) {
        let record = FaultRecord { fault: ALL[which], tick, count };
        let mut words = record.encode();
        prop_assert_eq!(FaultRecord::decode(&words), Some(record));
        // Up to 32 flipped bits in a row are always noticed.
        words[word] ^= flipped;
        prop_assert_eq!(FaultRecord::decode(&words), None);
    }

    #[test]
    fn what_the_memory_held_before_is_no_record(words: [u32; FaultRecord::WORDS]) {
        prop_assert_eq!(FaultRecord::decode(&words), None);
    }
}
