//! Codec of the transducers and the number format: words of 64 bits, little-endian.

use haptic_servo::encoder::CounterWidth;
use haptic_servo::number::Arithmetic;
use haptic_servo::servo::Transducers;

/// Words of a sensor and a motor with the number format.
pub type TransducerWords = [u64; 5];

/// Encodes a sensor and a motor with the number format.
pub fn encode(transducers: &Transducers, arithmetic: Arithmetic) -> TransducerWords {
    let Transducers { counts_per_turn, counter, full_scale_torque, largest_speed } = *transducers;
    [
        counts_per_turn.to_bits(),
        u64::from(counter == CounterWidth::Bits16),
        full_scale_torque.to_bits(),
        largest_speed.to_bits(),
        index_of(&Arithmetic::ALL, &arithmetic),
    ]
}

/// Decodes the words; `None` if they are malformed.
pub fn decode(
    [counts, narrow, torque, speed, arithmetic]: TransducerWords,
) -> Option<(Transducers, Arithmetic)> {
    let transducers = Transducers {
        counts_per_turn: f64::from_bits(counts),
        counter: if narrow == 0 { CounterWidth::Bits32 } else { CounterWidth::Bits16 },
        full_scale_torque: f64::from_bits(torque),
        largest_speed: f64::from_bits(speed),
    };
    Some((transducers, from_index(&Arithmetic::ALL, arithmetic)?))
}

/// The index of a value in a list.
pub fn index_of<T: PartialEq>(all: &[T], one: &T) -> u64 {
    all.iter().take_while(|other| *other != one).count() as u64
}

/// The value at an index.
pub fn from_index<T: Copy>(all: &[T], index_of: u64) -> Option<T> {
    all.get(usize::try_from(index_of).ok()?).copied()
}
