//! Random environments of every kind against the exact reference: each enclosure holds the index,
//! no rule passes or fails where the reference says the contrary, and `undecided` is rare.
//!
//! A rounding in the wrong direction, a lost box of the subdivision, a sign in the cross terms of
//! the real part: each puts the index outside its enclosure for some of these scenes.

use haptic_servo::certificate::{RuleAnswer, assess, assess_in};
use haptic_servo::environment::{Coefficients, Environment};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Scene};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::agreement::{check, check_exact};
use tests::exact::of_f64;
use tests::poly::Poly;
use tests::rounding;
use tests::scenes::{self, ExactScene, Poles};

use super::decision::compare;

/// Judges `count` scenes and returns how many the exact and the paper's rule left open.
fn judge(count: u64, draw: impl Fn(&mut ChaCha8Rng) -> ExactScene) -> (u64, u64) {
    let (mut exact, mut paper, mut passed) = (0, 0, 0);
    for seed in 0..count {
        let drawn = draw(&mut ChaCha8Rng::seed_from_u64(seed));
        let assessment = assess(&drawn.scene);
        let open = check(&assessment, &drawn.exact)
            .unwrap_or_else(|why| panic!("seed {seed}: {why}\n{:?}\n{assessment:?}", drawn.scene));
        // Where the subdivision has the most to do, and where it may have to give up.
        compare(&drawn.scene);
        compare(&Scene { coupling: Coupling::Rigid, ..drawn.scene });
        exact += u64::from(open.exact);
        paper += u64::from(open.paper);
        passed += u64::from(assessment.outcome.is_ok());
    }
    println!("scenes={count} certified={passed} undecided exact={exact} paper={paper}");
    assert!(passed * 10 > count, "only {passed} of {count} scenes were certified");
    (exact, paper)
}

fn rare(count: u64, open: (u64, u64)) {
    assert!(open.0 * 50 < count, "the exact rule left {} of {count} open", open.0);
    assert!(open.1 * 50 < count, "the paper's rule left {} of {count} open", open.1);
}

/// Poles at these distances from the circle and more. Next to it being undecided is no fault; being wrong is.
#[test]
#[ignore = "searches for long"]
fn environments_with_poles_near_the_circle() {
    for (scenes, count, nearest) in [(200, 8, 1e-2), (150, 6, 1e-4), (100, 8, 1e-6)] {
        let open = judge(scenes, |rng| scenes::rational(rng, Poles { count, nearest, delay: 8 }));
        if nearest > 1e-6 {
            rare(scenes, open);
        }
    }
}

#[test]
fn walls_springs_free_modes_and_drags() {
    rare(300, judge(300, scenes::wall));
    rare(300, judge(300, scenes::free));
    rare(300, judge(300, scenes::dragging));
}

/// Scenes a hair from the line, behind a coupling a few last places off the standard one, where
/// rounding decides and `undecided` is the honest answer. A pass must still be a pass.
#[test]
fn a_hair_from_the_line() {
    let poles = Poles { count: 6, nearest: 1e-3, delay: 4 };
    let (mut judged, mut passed) = (0, 0);
    for seed in 0..150 {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let mut drawn = scenes::rational(rng, poles);
        let standard = 2.0 * drawn.scene.device.damping / drawn.scene.timing.period;
        let off = rng.random_range(-4_i64..=4);
        let stiffness = f64::from_bits(standard.to_bits().wrapping_add_signed(off));
        drawn.scene.coupling = Coupling::Spring { stiffness };
        drawn.exact.coupling = of_f64(stiffness);
        let spare = scenes::log_uniform(rng, 1e-16, 1e-9);
        if !scale_to_the_line(&mut drawn, 1.0 - spare) {
            continue;
        }
        let assessment = assess(&drawn.scene);
        judged += 1;
        passed += u32::from(assessment.exact == RuleAnswer::Pass);
        // The paper's `K_vc T / 2 <= delta` is read to the digits that are written, so a coupling
        // some last places above the standard one still counts as it; the exact rule may not.
        let judge = if off > 0 { check_exact } else { check };
        judge(&assessment, &drawn.exact)
            .unwrap_or_else(|why| panic!("seed {seed}: {why}\n{:?}\n{assessment:?}", drawn.scene));
    }
    println!("near the line={judged} passed={passed}");
    assert!(judged > 40 && passed > 8, "{passed} of {judged} passed");
}

/// Scales the numerator so that the index is `share` of the device's passivity.
fn scale_to_the_line(drawn: &mut ExactScene, share: f64) -> bool {
    let Environment::Rational(mut rational) = drawn.scene.environment else { return false };
    let Some(alpha) = assess(&drawn.scene).alpha else { return false };
    let factor = drawn.scene.device.damping * share / alpha.midpoint();
    if !(1e-6..1e6).contains(&factor) {
        return false;
    }
    let scaled: Vec<f64> = rational.numerator.as_slice().iter().map(|c| c * factor).collect();
    rational.numerator = Coefficients::new(&scaled).expect("as many as before");
    drawn.scene.environment = Environment::Rational(rational);
    drawn.exact.numerator = Poly::of(&scaled);
    true
}

/// The same wall with another stiffness; `None` for an environment without one.
fn with_stiffness(scene: &Scene, value: f64) -> Option<Scene> {
    let mut changed = *scene;
    changed.environment.wall_mut()?.stiffness = value;
    Some(changed)
}

/// The stiffness at which the verdict on a scene changes, to a last place; `None` where it does
/// not within a factor of eight.
fn line(scene: &Scene, own: f64) -> Option<f64> {
    let passes = |value| Some(assess(&with_stiffness(scene, value)?).outcome.is_ok());
    let (mut inside, mut outside) = (own / 8.0, own * 8.0);
    if !passes(inside)? || passes(outside)? {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        *(if passes(middle)? { &mut inside } else { &mut outside }) = middle;
    }
    Some(inside)
}

/// Coefficients as rounded to a format, next to the line: their certificate holds for them exactly, and near
/// the line differs from the verdict on the numbers as written, in both directions.
#[test]
fn coefficients_as_they_run() {
    let formats =
        [Format::F32, Format::Fixed { fraction_bits: 24 }, Format::Fixed { fraction_bits: 16 }];
    let (mut judged, mut refused, mut saved) = (0, [0; 3], [0; 3]);
    for seed in 0..24 {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let drawn = match seed % 4 {
            0 => scenes::free(rng),
            1 => scenes::dragging(rng),
            _ => scenes::wall(rng),
        };
        let own = drawn.scene.device.damping / drawn.scene.timing.period;
        let Some(line) = line(&drawn.scene, own) else { continue };
        for step in [-1e-3, -1e-6, -1e-7, -2e-8, -3e-9, 3e-9, 2e-8, 1e-7, 1e-6, 1e-3] {
            let scene = with_stiffness(&drawn.scene, line * (1.0 + step)).unwrap();
            let as_written = assess(&scene).outcome.is_ok();
            for (i, format) in formats.into_iter().enumerate() {
                let exact = rounding::as_it_runs(&scene, format).unwrap();
                let assessment = assess_in(&scene, format);
                judged += 1;
                if is_standard(&drawn) {
                    // Judged by the paper's rule, which is stricter by the rounding.
                    let passes = exact.passes_exact();
                    let strict = passes && step > -1e-5 || assessment.outcome.is_ok() == passes;
                    assert!(strict, "seed {seed} {step:e} {format}");
                    assert!(passes || assessment.outcome.is_err(), "seed {seed} {step:e} {format}");
                } else {
                    check(&assessment, &exact).unwrap_or_else(|why| {
                        panic!("seed {seed} {step:e} {format}: {why}\n{scene:?}\n{assessment:?}")
                    });
                }
                let runs = assessment.outcome.is_ok();
                refused[i] += u32::from(as_written && !runs);
                saved[i] += u32::from(!as_written && runs);
            }
        }
    }
    println!("judged={judged} refused={refused:?} saved={saved:?}");
    assert!(judged > 300 && refused.iter().chain(&saved).all(|&count| count > 0));
}

fn is_standard(drawn: &ExactScene) -> bool {
    let Coupling::Spring { stiffness } = drawn.scene.coupling else { return false };
    stiffness == 2.0 * drawn.scene.device.damping / drawn.scene.timing.period
}
