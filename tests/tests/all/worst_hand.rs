//! Above the limit for hands that do not vary in time the search shows a passive hand in which the loop grows,
//! and none below it. The limit is summed up here over the aliases, and the loop in the hand that was shown
//! is simulated by a model of its own.

use std::f64::consts::{PI, TAU};

use analysis::chain::Chain;
use analysis::worst_hand::{HandImpedance, search};
use haptic_servo::scene::{Device, Scene};
use nalgebra::Complex;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::hands::Hand;
use tests::scenes::log_uniform;

use super::lagging::Loop;

/// Aliases to each side that are summed up.
const ALIASES: i32 = 160;
/// Angles at which the limit is looked for.
const ANGLES: usize = 360;

/// The limit of a loop: the damping below which some hand that does not vary destabilises it.
fn limit(drawn: &Loop) -> f64 {
    let needed = |theta: f64| needed(drawn, theta);
    let step = PI / ANGLES as f64;
    let angles = (1..=ANGLES).map(|n| step * n as f64);
    let worst = angles.max_by(|a, b| needed(*a).total_cmp(&needed(*b))).unwrap();
    let around = (-40..=40).map(|n| (worst + step * f64::from(n) / 40.0).clamp(1e-3, PI));
    around.map(needed).fold(0.0, f64::max)
}

/// The damping with which `-1/H` lies on the boundary of the disk that the aliases reach.
fn needed(drawn: &Loop, theta: f64) -> f64 {
    let z = Complex::from_polar(1.0, theta);
    let one = Complex::new(1.0, 0.0);
    let (mut g, mut size) = (Complex::new(0.0, 0.0), 0.0);
    for k in -ALIASES..=ALIASES {
        let jw = Complex::new(0.0, theta + TAU * f64::from(k));
        let amplifier = (-jw * drawn.output_delay).exp() * lagging(drawn, jw);
        let held = (one - one / z) / jw * amplifier;
        let seen = one / (jw * (one + jw * drawn.sensor_lag));
        g += held * seen;
        size += (held * seen).norm();
    }
    let value = |p: &[f64]| p.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * z + c);
    let (numerator, denominator) = drawn.controller();
    let h = value(&numerator) / value(&denominator);
    let real = (h * g).re;
    let ripple = size * size - g.norm_sqr();
    0.5 * ((real * real + ripple * h.norm_sqr()).sqrt() - real)
}

/// The amplifier: a lag, or straight lines between its updates, whose response to a pulse is a row of steps.
fn lagging(drawn: &Loop, jw: Complex<f64>) -> Complex<f64> {
    let one = Complex::new(1.0, 0.0);
    if drawn.updates == 0 {
        return one / (one + jw * drawn.actuator_lag);
    }
    let between = 1.0 / f64::from(drawn.updates);
    let left = (-between / drawn.actuator_lag).exp();
    let step = (one - (-jw * between).exp()) / (jw * between);
    let steps = (0..4000).map(f64::from);
    let weight = |n: f64| (1.0 - left) * left.powf(n);
    let steps = steps.take_while(|&n| n < 1.0 || weight(n) > 1e-14);
    steps.map(|n| (-jw * between * n).exp() * step * weight(n)).sum()
}

fn on(scene: &Scene, inertia: f64, damping: f64) -> Scene {
    Scene { device: Device { inertia, damping, passivity: None }, ..*scene }
}

/// How the loop grows a tick in a hand on a device, by the other model.
pub fn radius(drawn: &Loop, inertia: f64, damping: f64, hand: &HandImpedance) -> f64 {
    assert!(hand.link.is_none() || hand.absorbers.is_empty());
    let link = hand.link.map(|link| tests::hands::Segment {
        link_stiffness: link.stiffness,
        link_damping: link.damping,
        inertia: hand.inertia,
        stiffness: hand.stiffness,
        damping: hand.damping,
    });
    let held = link.is_none();
    let on_device = |value: f64| if held { value } else { 0.0 };
    let body = Hand {
        inertia: inertia + on_device(hand.inertia),
        // The model counts a damping of 1 for the device.
        damping: damping - 1.0 + on_device(hand.damping),
        stiffness: on_device(hand.stiffness),
        segments: link.into_iter().collect(),
    };
    let absorbers: Vec<_> = hand.absorbers.iter().map(|a| [a.inertia, a.stiffness]).collect();
    drawn.radius(&body, &absorbers)
}

/// A loop of any kind: half of them have a resonance or a notch as well.
fn draw(rng: &mut ChaCha8Rng) -> Loop {
    let mut drawn = Loop::draw(rng);
    let size = log_uniform(rng, 0.05, 5.0);
    (drawn.stiffness, drawn.damping) = (size * drawn.stiffness, size * drawn.damping);
    if rng.random_bool(0.5) {
        let mut pair = || {
            let (radius, angle) = (rng.random_range(0.0..0.9_f64), rng.random_range(0.0..PI));
            [-2.0 * radius * angle.cos(), radius * radius]
        };
        let ([b, c], [d, e]) = (pair(), pair());
        drawn.section = Some([b, c, d, e]);
    }
    drawn
}

#[derive(Debug, Default)]
struct Found {
    loops: usize,
    /// Of those above the limit.
    shown: usize,
    /// With absorbers, which only the construction has.
    constructed: usize,
    /// Of those below the limit.
    shown_below: usize,
}

impl Found {
    fn examine(&mut self, drawn: &Loop, inertia: f64, limit: f64) {
        let search = |damping: f64| {
            let scene = on(&drawn.scene(), inertia, damping);
            search(&scene, &Chain::rigid(inertia, damping).unwrap()).unwrap()
        };
        self.loops += 1;
        let below = search(limit / 0.995);
        self.shown_below += usize::from(below.oscillates || below.lighter.is_some());
        let found = search(limit / 1.02);
        if !found.oscillates {
            println!("not shown: {drawn:?} {inertia} {limit}");
            return;
        }
        let hand = &found.worst.hand;
        let above = radius(drawn, inertia, limit / 1.02, hand);
        assert!(above > 1.0, "{drawn:?} {hand:?} {above}");
        // The worst known hand does not shake certified loops.
        let below = radius(drawn, inertia, limit / 0.995, hand);
        assert!(below < 1.0 + 1e-7, "{drawn:?} {hand:?} {below}");
        self.shown += 1;
        self.constructed += usize::from(!hand.absorbers.is_empty());
    }
}

fn number(name: &str) -> Option<u64> {
    let value = std::env::var(name).ok()?;
    Some(value.parse().unwrap_or_else(|_| panic!("{name}: {value}")))
}

fn examined(loops: usize, seed: u64, draw: impl Fn(&mut ChaCha8Rng) -> Loop) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut found = Found::default();
    while found.loops < loops {
        let drawn = draw(&mut rng);
        let inertia = log_uniform(&mut rng, 0.1, 100.0);
        let limit = limit(&drawn);
        // A controller that is stable by itself is certified with enough damping.
        if on(&drawn.scene(), inertia, 2.0 * limit).certify().is_ok() {
            found.examine(&drawn, inertia * limit, limit);
        }
    }
    println!("{found:?}");
    assert_eq!(found.shown_below, 0, "{found:?}");
    assert!(100 * found.shown >= 99 * found.loops && found.constructed > 0, "{found:?}");
}

/// `WORST_HAND_LOOPS` and `WORST_HAND_SEED` for more of them.
#[test]
fn above_the_limit_a_hand_is_shown_and_below_it_none() {
    let loops = number("WORST_HAND_LOOPS").unwrap_or(24) as usize;
    examined(loops, number("WORST_HAND_SEED").unwrap_or(1), draw);
}

/// The same of amplifiers that are updated some times in a period.
#[test]
fn above_the_limit_of_an_amplifier_in_updates_a_hand_is_shown_and_below_it_none() {
    let loops = number("WORST_HAND_LOOPS").unwrap_or(16) as usize;
    let draw = |rng: &mut ChaCha8Rng| {
        let drawn = Loop::draw_sampled(rng);
        let size = log_uniform(rng, 0.05, 5.0);
        Loop { stiffness: size * drawn.stiffness, damping: size * drawn.damping, ..drawn }
    };
    examined(loops, number("WORST_HAND_SEED").unwrap_or(2), draw);
}
