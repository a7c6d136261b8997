//! Yes and no without the numbers against the assessment with them: the same answers, far from the
//! line, next to it, and where rounding decides.

use fixed::types::{I8F24, I12F20};
use haptic_servo::certificate::{
    PassivityProblem, Rejection, RuleAnswer, assess, assess_in, timing_checked,
};
use haptic_servo::environment::{Canceller, Environment, Parts, Wall};
use haptic_servo::number::{Format, Number};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::{Latched, OutputMode, Simultaneous, Step, SupportsTiming};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::scenes;

/// Compares the answers of both rules and the verdict; returns whether there is a certificate.
pub fn compare(scene: &Scene) -> bool {
    let assessment = assess(scene);
    match PassivityProblem::of(scene) {
        Ok(posed) => {
            let found = [posed.passes_paper(), posed.passes_exact(), posed.is_certified()];
            let wanted = [
                assessment.paper == RuleAnswer::Pass,
                assessment.exact == RuleAnswer::Pass,
                assessment.outcome.is_ok(),
            ];
            assert_eq!(found, wanted, "{scene:?}\n{assessment:?}");
        }
        Err(rejection) => assert_eq!(assessment.outcome, Err(rejection), "{scene:?}"),
    }
    assessment.outcome.is_ok()
}

/// Compares what a board asks for, the bound of a limited torque alone, with certificate and timing, which
/// search for the index: what the one renders the other has certified.
fn compare_on_board<M: OutputMode>(scene: &Scene, format: Format) -> bool
where
    Environment: SupportsTiming<M>,
{
    let quick = timing_checked::<_, M>(*scene, format);
    // A refused scene is not certified again, which would search for its remedies.
    let certified = match assess_in(scene, format).outcome {
        Ok(()) => scene.certify_in(format),
        Err(rejection) => Err(rejection),
    };
    let (room, margin) = match certified.map(|scene| scene.time::<M>()) {
        Ok(Ok(timed)) => (timed.injectable_damping(), timed.margin()),
        // A search may leave open what the bound in closed form settles, next to the line only.
        Err(Rejection::Undecided { index: Some(index), limit: Some(limit), .. })
            if quick.is_ok() =>
        {
            assert!(limit.hi() - index.lo() < 1e-9 * limit.hi(), "{scene:?} {index:?} {limit:?}");
            return true;
        }
        other => {
            assert_eq!(quick.err(), Some(Step::Certificate), "{scene:?}\n{other:?}");
            return false;
        }
    };
    let quick = quick.unwrap_or_else(|_| panic!("{scene:?}"));
    assert_eq!((quick.injectable_damping(), quick.margin()), (room, margin), "{scene:?}");
    true
}

/// The same in each number format and each mode that the environment may have; returns whether one of them
/// renders it.
fn compare_on_boards(scene: &Scene) -> bool {
    let formats = [Format::F64, Format::F32, <I8F24 as Number>::FORMAT, <I12F20 as Number>::FORMAT];
    let modes = formats.map(|format| {
        [
            compare_on_board::<Latched>(scene, format),
            compare_on_board::<Simultaneous>(scene, format),
        ]
    });
    modes.as_flattened().contains(&true)
}

/// Couplings from half the standard one to a rigid one.
fn couplings(delta: f64, period: f64) -> [Coupling; 5] {
    let spring = |part: f64| Coupling::Spring { stiffness: part * 2.0 * delta / period };
    [spring(0.5), spring(0.999), spring(1.0), spring(3.0), Coupling::Rigid]
}

/// A wall of every kind on the paper's device.
fn wall(rng: &mut ChaCha8Rng, delay: usize, coupling: Coupling) -> Scene {
    let (damping, period) = (0.022, 0.001);
    let mut wall = Wall::damped(1.0, rng.random_range(-0.6..1.25) * damping, delay);
    if rng.random_bool(0.3) {
        wall = wall.filtered(rng.random_range(0.0..0.95));
    }
    if rng.random_bool(0.2) {
        wall = wall.behind(0.0);
    }
    let residual = rng.random_bool(0.3).then(|| rng.random_range(0.0..1.0) * damping);
    let canceller = residual.map(Canceller::to);
    Scene {
        device: Device { inertia: 2.2e-5, damping, passivity: None },
        timing: Timing { period, worst_period: rng.random_bool(0.2).then_some(0.0015) },
        coupling,
        environment: Parts { canceller, wall: Some(wall), ..Parts::NONE }.sum(),
        latency: Latency::NONE,
        torque_limit: rng.random_bool(0.1).then_some(1.0),
    }
}

fn with_stiffness(scene: &Scene, value: f64) -> Scene {
    let mut changed = *scene;
    changed.environment.wall_mut().expect("only walls are drawn").stiffness = value;
    changed
}

/// Stiffnesses all over the range, and from a tenth to one last place beside each line that a
/// bisection with the assessment finds in it.
#[test]
fn walls_of_every_delay_behind_every_coupling() {
    let (mut judged, mut certified, mut rendered) = (0, 0, 0);
    let mut count = |scene: &Scene| {
        judged += 1;
        certified += u32::from(compare(scene));
        rendered += u32::from(compare_on_boards(scene));
    };
    for delay in 0..=8 {
        for (kind, coupling) in couplings(0.022, 0.001).into_iter().enumerate() {
            let seed = (delay * 100 + kind) as u64;
            let rng = &mut ChaCha8Rng::seed_from_u64(seed);
            for _ in 0..2 {
                let scene = wall(rng, delay, coupling);
                let stiffest = 80.0 / (1.0 + delay as f64);
                let at = |stiffness: f64| with_stiffness(&scene, stiffness);
                let passes = |stiffness: f64| assess(&at(stiffness)).outcome.is_ok();
                let mut before = stiffest;
                for _ in 0..20 {
                    let next = rng.random_range(0.0..stiffest);
                    count(&at(next));
                    if passes(before) != passes(next) {
                        let (mut a, mut b) = (before, next);
                        while 0.5 * (a + b) != a && 0.5 * (a + b) != b {
                            let middle = 0.5 * (a + b);
                            if passes(middle) == passes(a) { a = middle } else { b = middle }
                        }
                        for power in 1..=16 {
                            let step = 10_f64.powi(-power);
                            count(&at(a * (1.0 - step)));
                            count(&at(b * (1.0 + step)));
                        }
                        count(&at(a));
                        count(&at(b));
                    }
                    before = next;
                }
            }
        }
    }
    println!("scenes={judged} certified={certified} rendered={rendered}");
    assert!(judged > 6_000 && certified * 5 > judged && certified * 5 < 4 * judged);
    assert!(rendered * 10 > judged && rendered < certified);
}

#[test]
fn environments_of_every_kind() {
    let (mut certified, mut rendered) = (0, 0);
    for seed in 0..3000 {
        let scene = scenes::any(&mut ChaCha8Rng::seed_from_u64(seed)).scene;
        certified += u32::from(compare(&scene));
        rendered += u32::from(compare_on_boards(&scene));
    }
    assert!(certified > 300 && rendered > 30, "{certified} {rendered}");
}
