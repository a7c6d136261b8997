//! Torque profiles to draw from: tables of every shape, each sampled once.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use haptic_servo::environment::{KNOB_MODES, Profile, Shape};
use rand::Rng;
use tests::scenes::log_uniform;

/// Knots of a table.
const KNOTS: usize = 64;

/// The tables, late by one sample, with torques about 1 N m.
static TABLES: LazyLock<Vec<Profile>> = LazyLock::new(|| {
    let stops = Shape::end_stops(-1.0, 1.5, 4.0);
    let sums: [&[Shape]; 16] = [
        &[Shape::detents(12, 1.0)],
        &[Shape::detents(3, 1.0)],
        &[Shape::texture(TAU / 24.0, 1.0)],
        &[Shape::magnet(0.4, 0.6, 1.0)],
        &[Shape::Periodic(&[(0.0, 0.0), (0.1, 1.0), (0.5, -0.5), (1.0, 0.25), (TAU / 4.0, 0.0)])],
        &[Shape::detents(8, 1.0).snap(0.5)],
        &[Shape::detents(8, 1.0).snap(0.7)],
        &[Shape::detents(6, 1.0).snap(1.3)],
        &[Shape::detents(12, 1.0).snap(3.0)],
        &[stops],
        &[Shape::detents(6, 1.0), stops],
        &[Shape::detents(6, 1.0).snap(0.6), stops],
        &[Shape::centre(1.0, 2.0)],
        &[Shape::centre(1.0, 2.0), Shape::detents(12, 0.5)],
        &[Shape::bistable(0.5, 1.0), stops],
        &[Shape::Table(&[(-0.8, 0.5), (0.0, -1.0), (0.5, 1.0), (0.9, 0.0)]), stops],
    ];
    let table = |shapes: &[Shape]| {
        let units = Box::leak(Box::new([0_i16; KNOTS]));
        Profile::sampled(shapes, units, 1).ok()
    };
    sums.into_iter().filter_map(table).collect()
});

/// A profile with slopes of about `unit` N m/rad, or a mode of a knob: the tables of all modes are the
/// program's, so that no number of one changes.
pub fn draw(rng: &mut impl Rng, unit: f64, delta: f64, delay: usize) -> Profile {
    if rng.random_bool(0.2) {
        let mode = rng.random_range(1..KNOB_MODES.len());
        return Profile::of_modes(&KNOB_MODES, delay).selecting(mode as f64).expect("a mode");
    }
    table(rng, unit, delta, delay)
}

/// A profile of one table with slopes of about `unit` N m/rad.
pub fn table(rng: &mut impl Rng, unit: f64, delta: f64, delay: usize) -> Profile {
    let mut profile = TABLES[rng.random_range(0..TABLES.len())];
    profile.delay = delay;
    if profile.outline().wraps && profile.ends.is_none() {
        profile.count = f64::from(rng.random_range(1..=16));
        if rng.random_bool(0.3) {
            profile.centre = rng.random_range(-1.0..1.0);
        }
    }
    if profile.snap.is_none() && rng.random_bool(0.25) {
        profile = profile.damped(delta * log_uniform(rng, 0.01, 0.5));
    }
    let slope = crate::norm::slope(&profile);
    scaled(&mut profile, unit / slope.max(f64::MIN_POSITIVE));
    profile
}

/// The same shape with other torques.
pub fn scaled(profile: &mut Profile, by: f64) {
    profile.torque *= by;
    if let Some(ends) = &mut profile.ends {
        ends.stiffness *= by;
    }
}
