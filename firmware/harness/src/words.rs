//! What the emulated board's programs are asked in: words of 64 bits, little-endian.

use firmware::encoder::CounterWidth;
use firmware::number::Arithmetic;
use firmware::servo::Transducers;

/// Words of a sensor and a motor with the format to compute in.
pub type MachineWords = [u64; 5];

/// A sensor and a motor with the format to compute in.
pub fn ask(transducers: &Transducers, arithmetic: Arithmetic) -> MachineWords {
    let Transducers { counts_per_turn, counter, full_scale_torque, largest_speed } = *transducers;
    [
        counts_per_turn.to_bits(),
        u64::from(counter == CounterWidth::Bits16),
        full_scale_torque.to_bits(),
        largest_speed.to_bits(),
        place(&Arithmetic::ALL, &arithmetic),
    ]
}

/// Those of the words; `None` if they are none.
pub fn read(
    [counts, narrow, torque, speed, arithmetic]: MachineWords,
) -> Option<(Transducers, Arithmetic)> {
    let transducers = Transducers {
        counts_per_turn: f64::from_bits(counts),
        counter: if narrow == 0 { CounterWidth::Bits32 } else { CounterWidth::Bits16 },
        full_scale_torque: f64::from_bits(torque),
        largest_speed: f64::from_bits(speed),
    };
    Some((transducers, at(&Arithmetic::ALL, arithmetic)?))
}

/// Where one of a list is in it.
pub fn place<T: PartialEq>(all: &[T], one: &T) -> u64 {
    all.iter().take_while(|other| *other != one).count() as u64
}

/// The one at a place.
pub fn at<T: Copy>(all: &[T], place: u64) -> Option<T> {
    all.get(usize::try_from(place).ok()?).copied()
}
