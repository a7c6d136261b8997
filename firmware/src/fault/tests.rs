use proptest::prelude::*;

use super::*;
use crate::current::AlignmentError;

fn all(numbers: [u32; 2]) -> Vec<Fault> {
    (0..100).filter_map(|code| Fault::decode(code, numbers)).collect()
}

#[test]
fn every_fault_has_a_code_and_a_word_of_its_own() {
    let all = all([3, 1]);
    assert_eq!(all.len(), 31);
    for (i, fault) in all.iter().enumerate() {
        let (code, numbers) = fault.encode();
        assert_ne!(code, 0);
        assert_eq!(Fault::decode(code, numbers), Some(*fault));
        for other in &all[..i] {
            assert_ne!(other.encode().0, code);
            assert_ne!(other.as_str(), fault.as_str());
        }
    }
    let blocked = AlignmentError::Blocked { moved: -3, expected: 2340 };
    assert_eq!(blocked.encode(), (25, [u32::MAX - 2, 2340]));
}

#[test]
fn a_check_sum_of_zeros_is_no_record() {
    assert_eq!(FaultRecord::decode(&FaultRecord::NOTHING), None);
    assert_eq!(FaultRecord::decode(&[u32::MAX; FaultRecord::WORDS]), None);
}

proptest! {
    #[test]
    fn a_record_comes_back_and_a_changed_one_does_not(
        code in 0..100_u32,
        numbers: [u32; 2],
        tick: u32,
        count: i32,
        word in 0..FaultRecord::WORDS,
        flipped in 1..=u32::MAX,
    ) {
        let Some(fault) = Fault::decode(code, numbers) else { return Ok(()) };
        let record = FaultRecord { fault, tick, count };
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
