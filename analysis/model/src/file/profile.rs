//! The torque profile of a file: knots and named shapes, which add up to one table.

use haptic_servo::environment::{
    Canceller, Damper, Ends, Environment, MOST_KNOTS as MOST_IN_A_TURN, Parts, Profile, Shape,
    ShapeError, Wall,
};
use haptic_servo::parameter::Parameter;
use std::f64::consts::TAU;

use super::faults::{Read, Reported, all};
use super::key::{self, Key, Presence};
use super::kind;
use super::problem::Problem;
use super::section::{Pair, Section};
use super::shape::ShapeKind;
use super::tree::Span;
use crate::quantity::significant;

/// Largest number of shapes in a profile.
const MOST_SHAPES: usize = 16;
/// Largest number of knots in a table: each piece between two of them takes two cells to show.
const MOST_KNOTS: usize = 2048;
/// Cells of the smallest and of the largest table.
const CELLS: [usize; 2] = [16, 4096];
/// Cells in the narrowest straight piece, so that at least one cell is completely within it.
const CELLS_OF_A_PIECE: f64 = 2.0;
/// Largest distance of the last knot from the end of the period, as a fraction of the period: it is written
/// with few digits.
const CLOSED: f64 = 1e-6;

/// The shapes of a torque profile as a file has them.
#[derive(Clone, Debug, PartialEq)]
pub struct Shapes {
    /// Those of `environment.knots` first.
    pub shapes: Vec<Shape>,
    /// End stops that keys of `[environment]` itself give.
    pub ends: Option<Ends>,
    /// Number of the table's cells, if the file states it.
    pub cells: Option<usize>,
}

impl Shapes {
    /// All of them, with the end stops as one more.
    pub fn with_ends(&self) -> Vec<Shape> {
        let ends = self.ends;
        let ends = ends.map(|Ends { from, to, stiffness }| Shape::EndStops { from, to, stiffness });
        self.shapes.iter().copied().chain(ends).collect()
    }

    /// Their sum as a table, with enough cells to show every straight piece.
    ///
    /// # Errors
    /// If they are not a valid profile.
    pub fn sampled(&self, delay: usize) -> Result<Profile, ShapeError> {
        let shapes = self.with_ends();
        let sampled = |cells: usize| Profile::sampled(&shapes, vec![0; cells].leak(), delay);
        if let Some(cells) = self.cells {
            return sampled(cells);
        }
        let [least, most] = CELLS;
        let narrowest = shapes.iter().map(narrowest_piece).fold(f64::INFINITY, f64::min);
        let mut cells = least;
        loop {
            let found = sampled(cells).and_then(|profile| {
                let in_piece = narrowest * profile.knots_per_rad();
                if in_piece >= CELLS_OF_A_PIECE * (1.0 - 1e-9) {
                    return Ok(profile);
                }
                let needed = (cells as f64 * CELLS_OF_A_PIECE / in_piece).ceil();
                Err(ShapeError::TooFewKnots { knots: cells, needed })
            });
            match found {
                Err(ShapeError::TooFewKnots { .. }) if cells < most => cells *= 2,
                done => return done,
            }
        }
    }
}

/// Width in rad of the narrowest straight piece of a shape.
fn narrowest_piece(shape: &Shape) -> f64 {
    match shape {
        Shape::Table(knots) | Shape::Periodic(knots) => {
            knots.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(f64::INFINITY, f64::min)
        }
        named => named.narrowest(),
    }
}

/// A torque profile, and the places of its numbers in the file.
pub struct ProfileTable {
    /// The environment.
    pub environment: Environment,
    /// The shapes that it was sampled from.
    pub shapes: Shapes,
    places: Vec<Place>,
    torque: Option<Span>,
}

/// The place of a shape in the file.
struct Place {
    /// The table that its keys stand in.
    table: String,
    span: Span,
    /// Its numbers by name.
    numbers: Vec<(&'static str, f64, Span)>,
    /// Its knots, each an angle and a torque.
    knots: Vec<Pair>,
}

/// A shape and its place.
type Placed = (Shape, Place);

/// Reads `[environment]` of a torque profile.
pub fn profile(section: &mut Section<'_>) -> Read<ProfileTable> {
    let delay = section.whole(&key::DELAY_SAMPLES);
    let numbers = [&key::DAMPING, &key::PROFILE_TORQUE, &key::COUNT, &key::CENTRE]
        .map(|key| section.optional(key));
    let ends = [&key::FROM, &key::TO, &key::STIFFNESS].map(|key| section.optional(key));
    let residual = section.optional(&key::RESIDUAL);
    let beside = key::BESIDE.iter().filter_map(|key| Some((key, key.parameter?)));
    let beside = all(beside.map(|(key, parameter)| Ok((parameter, section.optional(key)?))));
    let wall = section.table(&key::WALL).and_then(|wall| wall.map(wall_of).transpose());
    let cells = cells(section);
    let knots = table(section, &key::KNOTS, &key::KNOTS_PERIOD, key::ENVIRONMENT.path);
    let shapes = shapes(section);
    let (delay, cells, knots, shapes) = (delay?, cells?, knots?, shapes?);
    let (residual, wall, beside) = (residual?, wall?, beside?);
    let [damping, torque, count, centre] = numbers;
    let [from, to, stiffness] = ends;
    let (from, to, stiffness) = (from?, to?, stiffness?);
    let (damping, torque, count, centre) = (damping?, torque?, count?, centre?);
    let (shapes, mut places): (Vec<Shape>, Vec<Place>) = knots.into_iter().chain(shapes).unzip();
    if shapes.is_empty() {
        return Err(section.missing(&key::SHAPE));
    }
    let has_ends = shapes.iter().any(|shape| {
        matches!(shape, Shape::EndStops { .. } | Shape::Centre { .. } | Shape::Bistable { .. })
    });
    let is_given = from.is_some() || to.is_some() || stiffness.is_some();
    let mut shapes = Shapes { shapes, ends: None, cells };
    if is_given && !has_ends {
        let ends = [(&key::FROM, from), (&key::TO, to), (&key::STIFFNESS, stiffness)];
        shapes.ends = Some(own_ends(section, ends, &mut places)?);
    }
    let mut profile =
        shapes.sampled(delay).map_err(|error| refused(section, &shapes, &places, &error))?;
    if count.is_none() {
        fine_enough(section, &shapes, &places, &profile)?;
    }
    if !profile.outline().wraps {
        for (key, number) in [(&key::COUNT, count), (&key::CENTRE, centre)] {
            if number.is_some() {
                let reason = "stands beside shapes that do not repeat, which stay where they are";
                return Err(section.conflict(key, reason));
            }
        }
    }
    profile.damping = damping;
    profile.torque = torque.unwrap_or(profile.torque);
    profile.count = count.unwrap_or(profile.count);
    profile.centre = centre.unwrap_or(profile.centre);
    if let (Some(ends), true) = (&mut profile.ends, has_ends) {
        ends.from = from.unwrap_or(ends.from);
        ends.to = to.unwrap_or(ends.to);
        ends.stiffness = stiffness.unwrap_or(ends.stiffness);
    }
    let canceller = residual.map(Canceller::to);
    let mut environment = Parts { canceller, wall, ..*profile.alone().parts() }.sum();
    for (parameter, value) in beside {
        let changed = value.and_then(|value| environment.with(parameter, value));
        environment = changed.unwrap_or(environment);
    }
    Ok(ProfileTable {
        environment,
        shapes,
        places,
        torque: torque.map(|_| section.place_of(&key::PROFILE_TORQUE)),
    })
}

/// The wall beside a torque profile.
fn wall_of(mut section: Section<'_>) -> Read<Wall> {
    let numbers =
        [&key::WALL_STIFFNESS, &key::WALL_DAMPING, &key::WALL_FACE].map(|key| section.number(key));
    let (delay, filter) = (section.whole(&key::WALL_DELAY), section.optional(&key::WALL_FILTER));
    let one_sided = section.boolean(&key::WALL_ONE_SIDED);
    section.finish();
    let [stiffness, damping, face] = numbers;
    let (stiffness, damping, face) = (stiffness?, damping?, face?);
    let (delay, filter) = (delay?, filter?);
    let (damper, side) = (Some(Damper { damping, filter }), kind::side(face, one_sided?));
    Ok(Wall { stiffness, damper, side, delay })
}

fn cells(section: &mut Section<'_>) -> Read<Option<usize>> {
    let Some(cells) = section.optional(&key::CELLS)? else { return Ok(None) };
    let cells = cells as usize;
    if cells.is_power_of_two() {
        return Ok(Some(cells));
    }
    let below = cells.next_power_of_two() / 2;
    let reason = format!("is not a power of two; the nearest are {below} and {}", 2 * below);
    Err(section.conflict(&key::CELLS, reason))
}

/// The end stops from the environment's own keys, which needs all three of them.
fn own_ends(
    section: &mut Section<'_>,
    keys: [(&'static Key, Option<f64>); 3],
    places: &mut Vec<Place>,
) -> Read<Ends> {
    let mut numbers = Vec::new();
    for (key, value) in keys {
        match value {
            Some(value) => numbers.push((key.name(), value, section.place_of(key))),
            None => return Err(section.missing(key)),
        }
    }
    let [from, to, stiffness] = [0, 1, 2].map(|i| numbers[i].1);
    let (table, span) = (key::ENVIRONMENT.path.to_owned(), section.span());
    places.push(Place { table, span, numbers, knots: Vec::new() });
    Ok(Ends { from, to, stiffness })
}

fn shapes(section: &mut Section<'_>) -> Read<Vec<Placed>> {
    let Some(tables) = section.tables(&key::SHAPE)? else { return Ok(Vec::new()) };
    if tables.is_empty() || tables.len() > MOST_SHAPES {
        let reason = format!("are {} shapes; there must be 1 to {MOST_SHAPES}", tables.len());
        return Err(section.conflict(&key::SHAPE, reason));
    }
    all(tables.into_iter().enumerate().map(|(index, table)| shape(index, table)))
}

fn shape(index: usize, mut section: Section<'_>) -> Read<Placed> {
    let name = format!("{}[{index}]", key::SHAPE.path);
    section.number_as(name.clone());
    let kind = section.needed_text(&key::SHAPE_TYPE).and_then(|name| {
        ShapeKind::find(&name).ok_or_else(|| section.out_of_bounds(&key::SHAPE_TYPE))
    });
    let shape = match kind {
        Ok(kind) => {
            let span = section.place_of(&key::SHAPE_TYPE);
            section.specialize(format!("a {} [[{}]]", kind.name, key::SHAPE.path), kind.needed);
            of_kind(kind, name, span, &mut section)
        }
        Err(reported) => {
            // The intended type is unknown: a key of any type is accepted.
            let keys = key::ALL.iter().filter(|key| key.table() == key::SHAPE.path);
            keys.for_each(|key| section.skip(key));
            Err(reported)
        }
    };
    section.finish();
    shape
}

fn of_kind(kind: &ShapeKind, table: String, span: Span, section: &mut Section<'_>) -> Read<Placed> {
    if kind.name == super::shape::TABLE {
        let found = self::table(section, &key::SHAPE_KNOTS, &key::SHAPE_PERIOD, &table)?;
        return found.ok_or_else(|| section.missing(&key::SHAPE_KNOTS));
    }
    let numbers = all(kind.keys().map(|key| {
        Ok(match (section.optional(key)?, key.presence) {
            (Some(value), _) => Some((key, value, section.place_of(key))),
            (None, Presence::Optional(_)) => None,
            // With its default, or missing.
            (None, _) => Some((key, section.number(key)?, span.clone())),
        })
    }))?;
    let numbers: Vec<_> = numbers.into_iter().flatten().collect();
    let number = |key: &Key| {
        numbers.iter().find(|(other, ..)| *other == key).map_or(0.0, |(_, value, _)| *value)
    };
    let shape = kind.shape(number).ok_or_else(|| section.missing(&key::SHAPE_KNOTS))?;
    let numbers = numbers.into_iter().map(|(key, value, span)| (key.name(), value, span)).collect();
    Ok((shape, Place { table, span, numbers, knots: Vec::new() }))
}

/// The table of knots with these keys, if it is there.
fn table(
    section: &mut Section<'_>,
    key: &'static Key,
    period_key: &'static Key,
    name: &str,
) -> Read<Option<Placed>> {
    let knots = section.pairs(key);
    let period = section.optional(period_key)?;
    let Some(knots) = knots? else {
        return match period {
            None => Ok(None),
            Some(_) => {
                let reason = format!("stands without `{}`", section.name_of(key));
                Err(section.conflict(period_key, reason))
            }
        };
    };
    if knots.len() < 2 || knots.len() > MOST_KNOTS {
        let reason = format!("are {} knots; there must be 2 to {MOST_KNOTS}", knots.len());
        return Err(section.conflict(key, reason));
    }
    let pairs: Vec<(f64, f64)> =
        knots.iter().map(|[angle, torque]| (angle.value, torque.value)).collect();
    let (table, span) = (name.to_owned(), section.place_of(key));
    let place = Place { table, span, numbers: Vec::new(), knots };
    if let Some(period) = period {
        closes(section, key, period, &place)?;
    }
    let pairs: &'static [(f64, f64)] = pairs.leak();
    let shape = if period.is_some() { Shape::Periodic(pairs) } else { Shape::Table(pairs) };
    Ok(Some((shape, place)))
}

/// Checks that the last knot is at the end of the period.
fn closes(section: &Section<'_>, key: &Key, period: f64, place: &Place) -> Read<()> {
    let ([first, _], [last, _]) = (&place.knots[0], &place.knots[place.knots.len() - 1]);
    let end = first.value + period;
    if (last.value - end).abs() <= CLOSED * period {
        return Ok(());
    }
    let name = format!("{}[{}][0]", section.name_of(key), place.knots.len() - 1);
    let bound = format!(
        "{end}, where the period of {period} rad ends: the last knot closes it, with the torque of \
         the first"
    );
    Err(section.not_within(&name, &last.span, &bound))
}

/// Reports shapes that do not add up to a torque profile.
fn no_profile(section: &Section<'_>, key: String, span: Span, reason: &str) -> Reported {
    section.report(span, Problem::key_and(key, &format!(": {reason}")))
}

/// Reports the library's error in the shapes, with its place in the file.
fn refused(
    section: &Section<'_>,
    shapes: &Shapes,
    places: &[Place],
    error: &ShapeError,
) -> Reported {
    let whole =
        |key: &Key, span: Span| no_profile(section, section.name_of(key), span, &error.to_string());
    match *error {
        ShapeError::Number { shape, name, bound, .. } => {
            let place = &places[shape];
            let number = place.numbers.iter().find(|(other, ..)| *other == name);
            let span = number.map_or(&place.span, |(.., span)| span);
            section.not_within(&format!("{}.{name}", place.table), span, bound)
        }
        ShapeError::Knot { shape, knot, value, bound, limit } => {
            let place = &places[shape];
            let [angle, torque] = &place.knots[knot];
            let (part, span) =
                if angle.value == value { (0, &angle.span) } else { (1, &torque.span) };
            let limit = limit.map_or_else(String::new, |limit| format!(" {limit}"));
            let name = format!("{}.{}[{knot}][{part}]", place.table, key::KNOTS.name());
            section.not_within(&name, span, &format!("{bound}{limit}"))
        }
        ShapeError::Endless { shape } => {
            let place = &places[shape];
            no_profile(section, place.table.clone(), place.span.clone(), NEEDS_ENDS)
        }
        ShapeError::SecondSnap { shape } => {
            let Place { table, span, .. } = &places[shape];
            no_profile(section, table.clone(), span.clone(), SECOND_SNAP)
        }
        ShapeError::TooFewKnots { needed, .. } => {
            let [least, most] = CELLS;
            let cells = shapes.cells.unwrap_or(most);
            let (piece, span) = narrowest_of(shapes, places);
            let reason = format!(
                "are {cells}, and the narrowest straight piece, {piece}, takes {needed} cells; a table has \
                 {least} to {most}"
            );
            no_profile(section, section.name_of(&key::CELLS), span, &reason)
        }
        ShapeError::Mean { .. } => {
            let tables = places.iter().find(|place| !place.knots.is_empty());
            whole(&key::KNOTS, tables.map_or(section.span(), |place| place.span.clone()))
        }
        ShapeError::Flat | ShapeError::Empty => whole(&key::SHAPE, places[0].span.clone()),
    }
}

/// Checks that a turn has room for the cells that the narrowest straight piece takes.
fn fine_enough(
    section: &Section<'_>,
    shapes: &Shapes,
    places: &[Place],
    profile: &Profile,
) -> Read<()> {
    let in_a_turn = TAU * profile.knots_per_rad();
    if in_a_turn <= f64::from(MOST_IN_A_TURN) {
        return Ok(());
    }
    let (piece, span) = narrowest_of(shapes, places);
    let (cells, in_a_turn) = (profile.outline().knots, in_a_turn.round());
    // Their number is halved until they fit.
    let halvings = (in_a_turn / f64::from(MOST_IN_A_TURN)).log2().ceil();
    let wide = CELLS_OF_A_PIECE * halvings.exp2() / profile.knots_per_rad();
    let wide = significant(wide, 3);
    let reason = format!(
        "would be {cells} for the narrowest straight piece, {piece}, or {in_a_turn} in a turn, and a turn has \
         at most {MOST_IN_A_TURN}: the piece must be at least about {wide} rad wide"
    );
    Err(no_profile(section, section.name_of(&key::CELLS), span, &reason))
}

/// The narrowest straight piece of all shapes, in words, and where it stands.
fn narrowest_of(shapes: &Shapes, places: &[Place]) -> (String, Span) {
    let widths = shapes.shapes.iter().map(narrowest_piece).zip(places);
    let Some((width, place)) = widths.min_by(|(one, _), (other, _)| one.total_cmp(other)) else {
        return (String::new(), places[0].span.clone());
    };
    let width = significant(width, 6);
    let is_it = |pair: &[Pair]| significant(pair[1][0].value - pair[0][0].value, 6) == width;
    match place.knots.windows(2).position(is_it) {
        Some(knot) => {
            let (knots, next) = (key::KNOTS.name(), knot + 1);
            let piece = format!("{width} rad from `{}.{knots}[{knot}]` to [{next}]", place.table);
            (piece, place.knots[next][0].span.clone())
        }
        None => (format!("{width} rad of `{}`", place.table), place.span.clone()),
    }
}
const SECOND_SNAP: &str = "this is the second shape with `snap`; a torque profile has one at most";

const NEEDS_ENDS: &str = "does not repeat a whole number of times in a turn, so that it needs end stops, which hold the angle \
     within its range: a shape of type \"end_stops\", or `from`, `to` and `stiffness`";

impl ProfileTable {
    /// Checks that no torque of the profile is beyond the DAC's full scale in N m.
    pub fn within(&self, section: &Section<'_>, full_scale: Option<f64>) -> Read<()> {
        let (Some(full_scale), Some(torque)) =
            (full_scale, self.environment.get(Parameter::ProfileTorque))
        else {
            return Ok(());
        };
        if torque <= full_scale {
            return Ok(());
        }
        let bound = format!("a torque of at most `{}` = {full_scale} N m", key::FULL_SCALE.path);
        if let Some(span) = &self.torque {
            return Err(section.not_within(key::PROFILE_TORQUE.path, span, &bound));
        }
        for Place { table, numbers, knots, .. } in &self.places {
            let is_torque = |name: &str| name == "torque" || name == "amplitude";
            if let Some((name, _, span)) =
                numbers.iter().find(|(name, value, _)| is_torque(name) && *value > full_scale)
            {
                return Err(section.not_within(&format!("{table}.{name}"), span, &bound));
            }
            let beyond = knots.iter().position(|[_, torque]| torque.value.abs() > full_scale);
            if let Some(knot) = beyond {
                let name = format!("{table}.{}[{knot}][1]", key::KNOTS.name());
                return Err(section.not_within(&name, &knots[knot][1].span, &bound));
            }
        }
        let reason = format!("the shapes add up to {torque} N m, and must give {bound}");
        Err(no_profile(section, key::SHAPE.path.to_owned(), self.places[0].span.clone(), &reason))
    }
}
