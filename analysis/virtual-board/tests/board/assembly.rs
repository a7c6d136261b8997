//! Programs that were assembled by hand.

/// Instructions as the core reads them: those of 32 bits have their first half above.
pub fn bytes(code: &[u32]) -> Vec<u8> {
    let halves = |&word: &u32| {
        let (first, second) = ((word >> 16) as u16, word as u16);
        [first, second].into_iter().skip(usize::from(first == 0))
    };
    code.iter().flat_map(halves).flat_map(u16::to_le_bytes).collect()
}
