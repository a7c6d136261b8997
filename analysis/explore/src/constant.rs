//! A scene as the constants of a Rust program, as in `firmware/src/bin`.

mod expression;

use haptic_model::file::SceneFile;
use haptic_model::file::profile::Shapes;
use haptic_servo::environment::{
    Canceller, Coefficients, Damper, Ends, Environment, Profile, Rational, Shape, Side, Wall,
};
use haptic_servo::scene::{Coupling, Latency, Scene, TimeRange};

use crate::PageResult;
use crate::scene_text::read;
use expression::{Expression, number, optional, structure, word};

/// The constants of a scene: the table of its torque profile, the scene, and its certificate.
pub fn constant(text: &str, _: &mut Vec<f64>) -> PageResult {
    let file = read(text).map_err(|error| error.to_string())?;
    of(&file)
}

/// The text of the program's constants.
fn of(file: &SceneFile) -> PageResult {
    let SceneFile { scene, shapes, .. } = file;
    let shapes = shapes.as_ref();
    let environment = environment(&scene.environment, shapes)?;
    let uses = imports("haptic_servo::environment", &uses(&scene.environment, shapes)?);
    let is_late = scene.latency != Latency::NONE;
    let time_range = if is_late { ", TimeRange" } else { "" };
    let knots = match (scene.environment.profile(), shapes) {
        (Some(profile), Some(shapes)) => knots(shapes, profile.outline().knots) + "\n",
        _ => String::new(),
    };
    let constant = structure(
        "Scene",
        vec![
            ("device", device(scene)),
            ("timing", timing(scene)),
            ("coupling", coupling(scene.coupling)),
            ("environment", environment),
            ("latency", latency(&scene.latency)),
            ("torque_limit", optional(scene.torque_limit)),
        ],
    );
    Ok(format!(
        "use haptic_servo::certificate::Certified;\n\
         {uses}\n\
         use haptic_servo::scene::{{Coupling, Device, Latency, Scene{time_range}, Timing}};\n\n\
         {knots}\
         /// The scene.\n\
         pub const SCENE: Scene = {};\n\n\
         /// Its certificate: a scene that could oscillate in a hand is a compile error here.\n\
         pub const CERTIFIED: Certified<Scene> = SCENE.certified();\n",
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

/// The names that the expression of an environment uses.
fn uses(environment: &Environment, shapes: Option<&Shapes>) -> Result<Vec<&'static str>, String> {
    let parts = environment.parts();
    let changed = match &parts.profile {
        Some(profile) => changes(profile, shapes)?,
        None => Vec::new(),
    };
    let has_ends = changed.iter().any(|(name, _)| *name == "ends");
    let is_rational = environment.rational().is_some();
    let profile = parts.profile.is_some();
    let names = [
        ("Canceller", parts.canceller.is_some()),
        ("Coefficients", is_rational),
        ("Ends", has_ends),
        ("Environment", is_rational),
        ("Knots", profile),
        ("Parts", parts.count() > 1),
        ("Profile", profile),
        ("Rational", is_rational),
        ("Shape", profile),
        ("Wall", parts.wall.is_some()),
    ];
    Ok(names.into_iter().filter(|(_, is_used)| *is_used).map(|(name, _)| name).collect())
}

fn environment(environment: &Environment, shapes: Option<&Shapes>) -> PageExpression {
    let parts = match environment {
        Environment::Parts(parts) => parts,
        Environment::Rational(rational) => return Ok(self::rational(rational)),
        Environment::Stated(_) => {
            return Err("an environment of another crate has no constant here".to_owned());
        }
    };
    let mut all = Vec::new();
    all.extend(parts.canceller.map(|it| ("canceller", canceller(&it))));
    all.extend(parts.wall.map(|it| ("wall", wall(&it))));
    if let Some(it) = &parts.profile {
        all.push(("profile", profile(it, shapes)?));
    }
    Ok(match <[_; 1]>::try_from(all) {
        Ok([(_, part)]) => part.method("alone"),
        Err(all) => {
            let is_whole = all.len() == 3;
            let some = all.into_iter().map(|(name, part)| (name, part.within("Some"))).collect();
            let parts = structure("Parts", some);
            if is_whole { parts } else { parts.with_rest("Parts::NONE") }.method("sum")
        }
    })
}

type PageExpression = Result<Expression, String>;

fn canceller(Canceller { residual, delay }: &Canceller) -> Expression {
    match delay {
        0 => word(format!("Canceller::to({residual:?})")),
        _ => structure("Canceller", vec![("residual", number(*residual)), ("delay", word(delay))]),
    }
}

fn wall(wall: &Wall) -> Expression {
    let Wall { stiffness, damper, side, delay } = *wall;
    let spring = match damper {
        None => format!("Wall::spring({stiffness:?}, {delay})"),
        Some(Damper { damping, filter }) => {
            let filter = filter.map_or_else(String::new, |pole| format!(".filtered({pole:?})"));
            format!("Wall::damped({stiffness:?}, {damping:?}, {delay}){filter}")
        }
    };
    word(match side {
        Side::Centred => spring,
        Side::Displaced(position) => format!("{spring}.placed({position:?})"),
        Side::Face(face) => format!("{spring}.behind({face:?})"),
    })
}

fn rational(rational: &Rational) -> Expression {
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
    structure("Rational", fields).within("Environment::Rational")
}

/// A torque profile of the table, with the numbers that are not those of its shapes.
fn profile(profile: &Profile, shapes: Option<&Shapes>) -> PageExpression {
    let of_shapes = format!("Profile::of(&KNOTS, {})", profile.delay);
    let changed = changes(profile, shapes)?;
    if changed.is_empty() {
        return Ok(word(of_shapes));
    }
    Ok(structure("Profile", changed).with_rest(of_shapes))
}

/// The numbers of a profile that are not those of its shapes.
fn changes(
    profile: &Profile,
    shapes: Option<&Shapes>,
) -> Result<Vec<(&'static str, Expression)>, String> {
    let shapes = shapes.ok_or("the profile has no shapes")?;
    let own = shapes.sampled(profile.delay).map_err(|error| error.to_string())?;
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
    if profile.damping.is_some() {
        changed.push(("damping", optional(profile.damping)));
    }
    Ok(changed)
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
