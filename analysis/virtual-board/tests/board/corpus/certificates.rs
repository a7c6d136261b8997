//! Certificates: intervals in software double precision, of scenes that pass, that do not, and that
//! are none.

use analysis::emulator::CertifyClient;
use firmware_harness::scene_codec::{CertifyReply, IntervalBits};
use haptic_servo::certificate::assess;
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::{Coupling, Device, Scene, Timing};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::{floats, scenes, vectors};

use super::{TOOLCHAIN, VirtualGuest};

/// Random scenes of each kind.
const EACH: u64 = 24;
/// Of the reference cases, every one of so many.
const PART: usize = 3;

fn bits(index: Option<Interval>) -> IntervalBits {
    index.map(|index| (index.lo().to_bits(), index.hi().to_bits()))
}

/// A scene some of whose numbers may be anything.
fn broken(rng: &mut ChaCha8Rng) -> Scene {
    let mut scene = scenes::any(rng).scene;
    scene.device = Device { passivity: Some(floats::any(rng)), ..scene.device };
    scene.coupling = Coupling::Spring { stiffness: floats::any(rng) };
    if rng.random() {
        scene.timing = Timing { period: floats::any(rng), worst_period: None };
    }
    scene
}

#[test]
fn certificates_are_equal() {
    let elf = TOOLCHAIN.build_harness("certify_server").unwrap_or_else(|error| panic!("{error}"));
    let mut boards = [
        CertifyClient::with_transport(VirtualGuest::boot(&elf)),
        CertifyClient::boot(&elf).unwrap(),
    ];
    let mut asked: Vec<_> = vectors::all().iter().step_by(PART).map(|case| case.scene()).collect();
    let drawn = (0..EACH).map(ChaCha8Rng::seed_from_u64);
    asked.extend(drawn.flat_map(|mut rng| [scenes::any(&mut rng).scene, broken(&mut rng)]));
    let mut certified = 0;
    for scene in &asked {
        let found = assess(scene);
        certified += usize::from(found.outcome.is_ok());
        let replies = boards.each_mut().map(|board| board.certify(scene).unwrap());
        assert_eq!(replies[0], replies[1], "{scene:?}");
        let expected = CertifyReply {
            alpha: bits(found.alpha),
            alpha_coupled: bits(found.alpha_coupled),
            alpha_port: bits(found.alpha_port),
            paper: found.paper,
            exact: found.exact,
            ..replies[0]
        };
        assert_eq!(replies[0], expected, "{scene:?}");
    }
    boards.into_iter().for_each(|board| board.finish().unwrap());
    let all = asked.len();
    assert!(certified * 5 > all && certified * 5 < 4 * all, "{certified} of {all} certified");
}
