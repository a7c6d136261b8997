//! A scene as the constants of a Rust program, as in `firmware/src/bin`.

mod expression;

use std::collections::BTreeSet;

use haptic_model::file::SceneFile;
use haptic_model::file::profile::Shapes;
use haptic_servo::environment::{Coefficients, Composed, Ends, Environment, Rational, Shape, Wall};
use haptic_servo::scene::{Coupling, Latency, Scene, TimeRange};

use crate::PageResult;
use crate::scene_text::read;
use expression::{Expression, number, optional, structure, word};

/// Which walls there are a type of.
const FREE_MODE_WALLS: &str = "beside free motion a wall is at rest at angle 0, or has one side";

/// The constants of a scene: the environment's type, the scene, and its certificate.
pub fn constant(text: &str, _: &mut Vec<f64>) -> PageResult {
    let file = read(text).map_err(|error| error.to_string())?;
    of(&file)
}

/// A type with a value, the names that both use, and their table.
struct Typed {
    name: String,
    value: Expression,
    uses: BTreeSet<&'static str>,
    knots: Option<String>,
}

impl Typed {
    fn new(used: &'static str, name: String, value: Expression) -> Self {
        Self { name, value, uses: BTreeSet::from([used]), knots: None }
    }

    /// A type around others, each in a field of its name, after fields that are numbers.
    fn around(
        used: &'static str,
        numbers: Vec<(&'static str, Expression)>,
        inner: Vec<(&'static str, Self)>,
    ) -> Self {
        let mut fields = numbers;
        let (mut names, mut uses, mut knots) = (Vec::new(), BTreeSet::from([used]), None);
        for (field, typed) in inner {
            fields.push((field, typed.value));
            names.push(typed.name);
            uses.extend(typed.uses);
            knots = knots.or(typed.knots);
        }
        let name = format!("{used}<{}>", names.join(", "));
        Self { name, value: structure(used, fields), uses, knots }
    }
}

/// The text of the program's constants.
fn of(file: &SceneFile) -> PageResult {
    let SceneFile { scene, shapes, .. } = file;
    let own = environment(&scene.environment, shapes.as_ref())?;
    let Typed { name, value, uses, knots } = match scene.coupling {
        Coupling::Matched => matched(scene, own),
        _ => own,
    };
    let is_late = scene.latency != Latency::NONE;
    let time_range = if is_late { ", TimeRange" } else { "" };
    let uses = imports("haptic_servo::environment", &uses.into_iter().collect::<Vec<_>>());
    let knots = knots.map_or_else(String::new, |knots| format!("{knots}\n"));
    let constant = structure(
        "Scene",
        vec![
            ("device", device(scene)),
            ("timing", timing(scene)),
            ("coupling", coupling(scene.coupling)),
            ("environment", value),
            ("latency", latency(&scene.latency)),
            ("torque_limit", optional(scene.torque_limit)),
        ],
    );
    Ok(format!(
        "use haptic_servo::certificate::Certified;\n\
         {uses}\n\
         use haptic_servo::scene::{{Coupling, Device, Latency, Scene{time_range}, Timing}};\n\n\
         /// The environment that the hand feels.\n\
         pub type Environment = {name};\n\n\
         {knots}\
         /// The scene.\n\
         pub const SCENE: Scene<Environment> = {};\n\n\
         /// Its certificate: a scene that could oscillate in a hand is a compile error here.\n\
         pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();\n",
        constant.broken(0)
    ))
}

/// An item that imports names of a module, in lines as wide as rustfmt makes them.
fn imports(module: &str, names: &[&str]) -> String {
    const WIDTH: usize = 100;
    if let [name] = names {
        return format!("use {module}::{name};");
    }
    let line = format!("use {module}::{{{}}};", names.join(", "));
    if line.len() <= WIDTH {
        return line;
    }
    let (mut lines, mut last) = (String::new(), String::new());
    for name in names {
        if !last.is_empty() && last.len() + name.len() + ", ,".len() > WIDTH {
            lines += &format!("{last},\n");
            last.clear();
        }
        last += if last.is_empty() { "    " } else { ", " };
        last += name;
    }
    format!("use {module}::{{\n{lines}{last},\n}};")
}

fn device(scene: &Scene) -> Expression {
    let device = &scene.device;
    structure(
        "Device",
        vec![
            ("inertia", number(device.inertia)),
            ("damping", number(device.damping)),
            ("passivity", optional(device.passivity)),
        ],
    )
}

fn timing(scene: &Scene) -> Expression {
    let timing = &scene.timing;
    structure(
        "Timing",
        vec![("period", number(timing.period)), ("worst_period", optional(timing.worst_period))],
    )
}

fn coupling(coupling: Coupling) -> Expression {
    match coupling {
        Coupling::Rigid => word("Coupling::Rigid"),
        Coupling::Spring { stiffness } => {
            structure("Coupling::Spring", vec![("stiffness", number(stiffness))])
        }
        Coupling::Matched => word("Coupling::Matched"),
    }
}

/// Only the nonzero parts.
fn latency(latency: &Latency) -> Expression {
    let Latency {
        output_delay,
        output_jitter,
        count_jitter,
        actuator_lag,
        sensor_lag,
        actuator_response,
        actuator_updates,
    } = *latency;
    let times = [
        ("output_delay", output_delay),
        ("actuator_lag", actuator_lag),
        ("sensor_lag", sensor_lag),
        ("actuator_response", actuator_response),
    ];
    let mut fields: Vec<_> = times
        .into_iter()
        .filter(|(_, time)| *time != TimeRange::ZERO)
        .map(|(name, it)| (name, time(it)))
        .collect();
    for (name, jitter) in [("output_jitter", output_jitter), ("count_jitter", count_jitter)] {
        if jitter != 0.0 {
            fields.push((name, number(jitter)));
        }
    }
    if actuator_updates != 0 {
        fields.push(("actuator_updates", word(actuator_updates)));
    }
    if fields.is_empty() {
        return word("Latency::NONE");
    }
    structure("Latency", fields).with_rest("Latency::NONE")
}

fn time(TimeRange { least, most }: TimeRange) -> Expression {
    if least == most {
        return word(format!("TimeRange::exactly({least:?})"));
    }
    word(format!("TimeRange::between({least:?}, {most:?})"))
}

/// Behind the matched coupling with the memory that the scene's latency needs.
fn matched(scene: &Scene, own: Typed) -> Typed {
    let latency = &scene.latency;
    let (whole, lags) = (latency.whole_samples(scene.timing.period), latency.trails());
    let numbers = match (whole, lags, latency.actuator_updates) {
        (0, 0, 0) => String::new(),
        (_, 0, 0) => format!(", {whole}"),
        (_, _, 0) => format!(", {whole}, {lags}"),
        _ => format!(", {whole}, {lags}, true"),
    };
    let name = format!("Matched<{}{numbers}>", own.name);
    Typed { name, ..Typed::around("Matched", vec![], vec![("environment", own)]) }
}

fn environment(environment: &Environment, shapes: Option<&Shapes>) -> Result<Typed, String> {
    match environment {
        Environment::DelayedSpring(wall) => Ok(placed(wall, spring(wall))),
        Environment::DamperWall(wall) => Ok(placed(wall, damper(wall))),
        Environment::FreeMode { residual, delay } => Ok(Typed::new(
            "FreeMode",
            format!("FreeMode<{delay}>"),
            structure("FreeMode", vec![("residual", number(*residual))]),
        )),
        Environment::FreeModeWall { residual, wall } => {
            let wall = beside(wall, damper(wall))?;
            let residual = vec![("residual", number(*residual))];
            Ok(Typed::around("FreeModeWall", residual, vec![("wall", wall)]))
        }
        Environment::Rational(rational) => Ok(self::rational(rational)),
        Environment::Profile(_) | Environment::Composed(_) => profiled(environment, shapes),
        Environment::Stated(_) => {
            Err("an environment of another crate has no constant here".to_owned())
        }
    }
}

fn spring(wall: &Wall) -> Typed {
    let stiffness = vec![("stiffness", number(wall.stiffness))];
    let name = format!("DelayedSpring<{}>", wall.delay);
    Typed::new("DelayedSpring", name, structure("DelayedSpring", stiffness))
}

fn damper(wall: &Wall) -> Typed {
    let name = if wall.filter.is_some() { "FilteredWall" } else { "DamperWall" };
    let mut fields = vec![("stiffness", number(wall.stiffness)), ("damping", number(wall.damping))];
    fields.extend(wall.filter.map(|filter| ("filter", number(filter))));
    Typed::new(name, format!("{name}<{}>", wall.delay), structure(name, fields))
}

/// With its face, if it has one.
fn placed(wall: &Wall, own: Typed) -> Typed {
    let face = vec![("face", number(wall.face))];
    if wall.one_sided {
        return Typed::around("OneSided", face, vec![("wall", own)]);
    }
    if wall.face == 0.0 { own } else { Typed::around("Placed", face, vec![("wall", own)]) }
}

/// A wall in a sum, which must be one-sided or centred.
fn beside(wall: &Wall, own: Typed) -> Result<Typed, String> {
    if !wall.one_sided && wall.face != 0.0 {
        return Err(format!("{FREE_MODE_WALLS}; `face` is {:?} rad", wall.face));
    }
    Ok(placed(wall, own))
}

fn rational(rational: &Rational) -> Typed {
    let coefficients = |all: &Coefficients| {
        let all: Vec<_> = all.as_slice().iter().map(|one| format!("{one:?}")).collect();
        word(format!("Coefficients::new(&[{}]).unwrap()", all.join(", ")))
    };
    let fields = vec![
        ("numerator", coefficients(&rational.numerator)),
        ("denominator", coefficients(&rational.denominator)),
        ("delay", word(rational.delay)),
        ("unit_zeros", word(rational.unit_zeros)),
    ];
    let mut typed = Typed::new("Rational", "Rational".to_owned(), structure("Rational", fields));
    typed.uses.insert("Coefficients");
    typed
}

/// A torque profile with its table, alone or in a sum with a wall and a canceller.
fn profiled(environment: &Environment, shapes: Option<&Shapes>) -> Result<Typed, String> {
    let shapes = shapes.ok_or("the profile has no shapes")?;
    let composed = match environment {
        Environment::Composed(composed) => *composed,
        Environment::Profile(profile) => Composed { residual: None, wall: None, profile: *profile },
        _ => return Err("the environment is not a torque profile".to_owned()),
    };
    let Composed { residual, wall, profile } = composed;
    let (is_alone, has_snap) = (residual.is_none() && wall.is_none(), profile.snap.is_some());
    if profile.damping != 0.0 && (!is_alone || has_snap) {
        return Err(format!(
            "a profile with a damping has no snap point, no canceller and no wall beside it; `damping` is \
             {:?} N m s/rad",
            profile.damping
        ));
    }
    if has_snap && !is_alone {
        return Err("a profile with a snap point has no canceller and no wall beside it".to_owned());
    }
    let own = shapes.sampled(profile.delay).map_err(|error| error.to_string())?;
    let cells = own.outline().knots;
    let kind = if has_snap { "SnapProfile" } else { "Profile" };
    let built = format!("{kind}::of(&KNOTS)");
    let mut changed = Vec::new();
    let mut differs = |name, now: f64, was: f64| {
        if now.to_bits() != was.to_bits() {
            changed.push((name, number(now)));
        }
    };
    differs("torque", profile.torque, own.torque);
    differs("count", profile.count, own.count);
    differs("centre", profile.centre, own.centre);
    if profile.ends != own.ends {
        changed.push(("ends", ends(profile.ends)));
    }
    if has_snap && !changed.is_empty() {
        return Err("a profile with a snap point is that of its shapes: change these".to_owned());
    }
    let has_ends = changed.iter().any(|(name, _)| *name == "ends");
    let value =
        if changed.is_empty() { word(built) } else { structure(kind, changed).with_rest(built) };
    let mut typed = Typed::new(kind, format!("{kind}<{cells}, {}>", profile.delay), value);
    if profile.damping != 0.0 {
        let fields = vec![("profile", typed.value), ("damping", number(profile.damping))];
        typed.name = format!("DampedProfile<{cells}, {}>", profile.delay);
        typed.value = structure("DampedProfile", fields);
        typed.uses.insert("DampedProfile");
    }
    typed.uses.extend(["Knots", "Shape"]);
    typed.uses.extend(has_ends.then_some("Ends"));
    typed.knots = Some(knots(shapes, cells));
    let wall = wall.as_ref().map(wall_beside_profile).transpose()?;
    let left = residual.map(|residual| ("residual", number(residual)));
    let numbers: Vec<_> = left.into_iter().collect();
    Ok(match (numbers.is_empty(), wall) {
        (true, None) => typed,
        (false, None) => Typed::around("FreeModeProfile", numbers, vec![("profile", typed)]),
        (is_free, Some(wall)) => {
            let name = if is_free { "WallAndProfile" } else { "FreeModeWallAndProfile" };
            Typed::around(name, numbers, vec![("wall", wall), ("profile", typed)])
        }
    })
}

fn wall_beside_profile(wall: &Wall) -> Result<Typed, String> {
    if let Some(filter) = wall.filter {
        return Err(format!("a wall beside a profile has no filter; `filter` is {filter:?}"));
    }
    beside(wall, damper(wall))
}

fn ends(ends: Option<Ends>) -> Expression {
    let Some(Ends { from, to, stiffness }) = ends else { return word("None") };
    structure(
        "Ends",
        vec![("from", number(from)), ("to", number(to)), ("stiffness", number(stiffness))],
    )
    .within("Some")
}

/// The table, which stays in flash.
fn knots(shapes: &Shapes, cells: u32) -> String {
    let ends =
        shapes.ends.map(|Ends { from, to, stiffness }| Shape::EndStops { from, to, stiffness });
    let all = shapes.shapes.iter().copied().chain(ends).map(|shape| self::shape(&shape)).collect();
    let table = Expression::list(all).within("Knots::of");
    let start = format!("static KNOTS: Knots<{cells}> =");
    format!(
        "/// Torque over angle: a table, which stays in flash.\n{start}{};\n",
        table.after(start.len())
    )
}

fn shape(shape: &Shape) -> Expression {
    word(match *shape {
        Shape::Detents { count, torque, centre: 0.0 } => {
            format!("Shape::detents({count}, {torque:?})")
        }
        Shape::SnapDetents { count, torque, centre: 0.0, snap } => {
            format!("Shape::detents({count}, {torque:?}).snap({snap:?})")
        }
        Shape::Detents { count, torque, centre } => {
            format!("Shape::Detents {{ count: {count}, torque: {torque:?}, centre: {centre:?} }}")
        }
        Shape::SnapDetents { count, torque, centre, snap } => {
            let fields =
                format!("count: {count}, torque: {torque:?}, centre: {centre:?}, snap: {snap:?}");
            format!("Shape::SnapDetents {{ {fields} }}")
        }
        Shape::EndStops { from, to, stiffness } => {
            format!("Shape::end_stops({from:?}, {to:?}, {stiffness:?})")
        }
        Shape::Centre { width, stiffness } => format!("Shape::centre({width:?}, {stiffness:?})"),
        Shape::Bistable { distance, torque } => {
            format!("Shape::bistable({distance:?}, {torque:?})")
        }
        Shape::Texture { pitch, amplitude } => format!("Shape::texture({pitch:?}, {amplitude:?})"),
        Shape::Magnet { angle, width, torque } => {
            format!("Shape::magnet({angle:?}, {width:?}, {torque:?})")
        }
        Shape::Table(knots) => format!("Shape::Table(&{knots:?})"),
        Shape::Periodic(knots) => format!("Shape::Periodic(&{knots:?})"),
    })
}
