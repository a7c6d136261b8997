//! Sines of any number at all: conversions that saturate, subnormals, infinities, long reductions.

use analysis::emulator::BenchClient;
use firmware_harness::bench_request::BenchRequest;
use firmware_harness::sines::Sine;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{TOOLCHAIN, VirtualGuest};

/// Random numbers of each kind.
const EACH: usize = 640;

/// Where single-precision numbers are at an edge.
const EDGES: [f32; 14] = [
    0.0,
    -0.0,
    1.0,
    0.5,
    0.25,
    f32::EPSILON,
    f32::MIN_POSITIVE,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    2_147_483_648.0,
    -2_147_483_904.0,
];

fn inputs() -> Vec<f32> {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut inputs: Vec<_> = EDGES.into_iter().chain([f32::from_bits(1)]).collect();
    for _ in 0..EACH {
        inputs.push(rng.random());
        inputs.push(f32::from_bits(rng.random()));
        inputs.push(f32::from_bits(rng.random_range(0..1 << 23)));
    }
    inputs
}

/// The bits, with all that is not a number as one: its sign and its payload are the core's choice.
fn bits(value: f64) -> u64 {
    if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() }
}

#[test]
fn sines_are_equal() {
    let elf = TOOLCHAIN.build_harness("bench_programs").unwrap_or_else(|error| panic!("{error}"));
    let mut boards =
        [BenchClient::with_transport(VirtualGuest::boot(&elf)), BenchClient::boot(&elf).unwrap()];
    let inputs = inputs();
    let words: Vec<_> = inputs.iter().map(|turn| turn.to_bits()).collect();
    for sine in Sine::ALL {
        let [here, qemu] = boards
            .each_mut()
            .map(|board| board.compute(&BenchRequest::Sine(sine), &words).unwrap());
        for ((turn, here), qemu) in inputs.iter().zip(here).zip(qemu) {
            let name = format!("{sine:?} of {turn:e}, {:08x}", turn.to_bits());
            // Between the two boards there is no choice.
            assert_eq!(here.to_bytes(), qemu.to_bytes(), "{name}");
            assert_eq!(bits(here.value), bits(sine.of_turn(*turn).into()), "{name}");
        }
    }
    boards.into_iter().for_each(|board| board.finish().unwrap());
}
