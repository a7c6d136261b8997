//! `[environment]` of a torque profile: its shapes as they were read, and the numbers that differ from
//! theirs.

use haptic_servo::environment::{Ends, Environment, Profile, Shape, Wall};

use super::{number, quoted};
use crate::file::key::{self, Bound, Key};
use crate::file::kind::PROFILE;
use crate::file::profile::Shapes;
use crate::file::shape;
use crate::file::shape::span;

/// A torque profile, with the parts beside it but the wall.
pub fn profile(
    lines: &mut Vec<String>,
    environment: &Environment,
    profile: &Profile,
    shapes: &Shapes,
) {
    lines.push(format!("type = {}\ndelay = {}", quoted(PROFILE), profile.delay));
    for key in [&key::RESIDUAL].into_iter().chain(key::BESIDE.iter().copied()) {
        number(lines, key.name(), key.parameter.and_then(|parameter| environment.get(parameter)));
    }
    // By its bits: -0.0 is another number than 0.0.
    number(lines, "damping", profile.damping);
    let own = shapes.sampled(profile.delay).ok();
    let mut changed = |key: &Key, value: Option<f64>, own: Option<f64>| {
        let is_same = value.map(f64::to_bits) == own.map(f64::to_bits);
        number(lines, key.name(), value.filter(|_| !is_same));
    };
    let was = |of: fn(&Profile) -> f64| own.as_ref().map(of);
    changed(&key::PROFILE_TORQUE, Some(profile.torque), was(|own| own.torque));
    changed(&key::COUNT, Some(profile.count), was(|own| own.count));
    changed(&key::CENTRE, Some(profile.centre), was(|own| own.centre));
    // End stops from keys are in no shape.
    let of_shapes = own.and_then(|own| own.ends).filter(|_| shapes.ends.is_none());
    let numbers = |Ends { from, to, stiffness }: Ends| [from, to, stiffness].map(Some);
    let [now, before] = [profile.ends, of_shapes].map(|ends| ends.map_or([None; 3], numbers));
    for (i, key) in [&key::FROM, &key::TO, &key::STIFFNESS].into_iter().enumerate() {
        changed(key, now[i], before[i]);
    }
    lines.extend(shapes.cells.map(|cells| format!("cells = {cells}")));
    match shapes.shapes[..] {
        [Shape::Table(knots)] => self::knots(lines, knots, false),
        [Shape::Periodic(knots)] => self::knots(lines, knots, true),
        _ => shapes.shapes.iter().for_each(|shape| named(lines, shape)),
    }
}

/// The wall beside it. It is written below the shapes, whose tables end the environment's own table.
pub fn wall(wall: &Wall) -> Vec<String> {
    let mut lines = vec![format!("[{}]", key::WALL.path)];
    number(&mut lines, key::WALL_STIFFNESS.name(), Some(wall.stiffness));
    number(&mut lines, key::WALL_DAMPING.name(), Some(wall.damping()));
    lines.push(format!("{} = {}", key::WALL_DELAY.name(), wall.delay));
    number(&mut lines, key::WALL_FILTER.name(), wall.filter());
    number(&mut lines, key::WALL_FACE.name(), Some(wall.face()));
    if wall.is_one_sided() {
        lines.push(format!("{} = true", key::WALL_ONE_SIDED.name()));
    }
    lines
}

fn knots(lines: &mut Vec<String>, knots: &[(f64, f64)], is_periodic: bool) {
    let pairs: Vec<String> =
        knots.iter().map(|(angle, torque)| format!("[{angle:?}, {torque:?}]")).collect();
    lines.push(format!("knots = [{}]", pairs.join(", ")));
    number(lines, "period", Some(span(knots)).filter(|_| is_periodic));
}

fn named(lines: &mut Vec<String>, shape: &Shape) {
    let (name, numbers) = shape::written(shape);
    lines.push(format!("[[{}]]\ntype = {}", key::SHAPE.path, quoted(name)));
    if let Shape::Table(knots) | Shape::Periodic(knots) = shape {
        return self::knots(lines, knots, matches!(shape, Shape::Periodic(_)));
    }
    for (key, value) in numbers {
        match key.bound {
            Bound::Number(haptic_servo::parameter::Range::Whole(..)) => {
                lines.push(format!("{} = {value}", key.name()));
            }
            _ => number(lines, key.name(), Some(value)),
        }
    }
}
