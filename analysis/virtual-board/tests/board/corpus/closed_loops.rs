//! Random scenes as data, each certified by the board before it is that scene's servo.

use analysis::controller::{Controller, controller};
use analysis::emulator::ServoClient;
use analysis::lockstep::RemoteServo;
use firmware_harness::loop_request::{LoopRequest, StartReply};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::number::{Arithmetic, InEach, Number};
use haptic_servo::servo::Transducers;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::scenes;

use super::{TOOLCHAIN, VirtualGuest, counts};

const SCENES: u64 = 8;
const TICKS: usize = 400;

/// What the host does with a play: the same as the board.
struct HostServo<'a>(&'a LoopRequest);

impl InEach for HostServo<'_> {
    type Output = Result<Box<dyn Controller>, StartReply>;

    fn with<N: Number>(self) -> Self::Output {
        let Self(LoopRequest { scene, transducers, .. }) = self;
        let certified = scene.certify_in(N::FORMAT).map_err(|_| StartReply::Rejected)?;
        controller::<_, N>(&certified, transducers).map_err(|_| StartReply::BuildFailed)
    }
}

/// A scene for an encoder and a motor that suit it.
fn draw(rng: &mut ChaCha8Rng) -> LoopRequest {
    let scene = match rng.random() {
        true => scenes::wall(rng).scene,
        false => scenes::free(rng).scene,
    };
    let narrow = rng.random();
    let transducers = Transducers {
        counts_per_turn: rng.random_range(1000.0..100_000.0),
        counter: if narrow { CounterWidth::Bits16 } else { CounterWidth::Bits32 },
        full_scale_torque: rng.random_range(0.1..100.0),
        largest_speed: 100.0,
    };
    let arithmetic = if rng.random() { Arithmetic::F32 } else { Arithmetic::I16F16 };
    LoopRequest { scene, transducers, arithmetic, ticks: TICKS as u32 }
}

#[test]
fn plays_are_equal() {
    let elf = TOOLCHAIN.build_harness("servo_server").unwrap_or_else(|error| panic!("{error}"));
    let mut boards =
        [ServoClient::with_transport(VirtualGuest::boot(&elf)), ServoClient::boot(&elf).unwrap()];
    let mut replies = [0; 3];
    for mut rng in (0..SCENES).map(ChaCha8Rng::seed_from_u64) {
        let request = draw(&mut rng);
        let here = request.arithmetic.choose(HostServo(&request));
        let reply = here.as_ref().err().copied().unwrap_or(StartReply::Ready);
        replies[reply as usize] += 1;
        for board in &mut boards {
            assert_eq!(board.start(&request).unwrap(), reply, "{request:?}");
        }
        let Ok(mut here) = here else { continue };
        for (tick, count) in counts(&mut rng, TICKS).into_iter().enumerate() {
            let code = here.tick(count).code;
            for board in &mut boards {
                assert_eq!(board.exchange(count).unwrap(), code, "tick {tick} of {request:?}");
            }
        }
    }
    boards.into_iter().for_each(|board| board.finish().unwrap());
    assert!(replies[0] > 3 && replies[1] > 1, "open, refused, not to be had: {replies:?}");
}
