//! A scene as the constants of a Rust program, as in `firmware/src/bin`.

pub mod layout;

use std::collections::BTreeSet;

use haptic_servo::environment::{
    Anticogging, Canceller, Coefficients, Damper, Environment, Parts, Profile, Rational, Shape,
    Side, Wall,
};
use haptic_servo::scene::{EncoderReading, Latency, TimeRange};

use super::SceneFile;
use super::profile::Shapes;

/// A text of Rust, or the reason why there is none.
pub type Written = Result<String, String>;

/// The constants of a program.
pub struct Constants {
    /// What it imports of the library's environments and hosts.
    pub environment: String,
    /// What it imports of the library's scenes.
    pub scene: String,
    /// The items.
    pub items: String,
}

/// The constants of a scene: the table of its torque profile, the scene, its certificate, and its host.
///
/// # Errors
/// Where its environment has no constant.
pub fn constants(file: &SceneFile) -> Written {
    let Constants { environment, scene, items } = of(file)?;
    Ok(format!("use haptic_servo::certificate::Certified;\n{environment}\n{scene}\n\n{items}"))
}

/// The same in parts.
///
/// # Errors
/// As above.
pub fn of(file: &SceneFile) -> Result<Constants, String> {
    let SceneFile { scene, shapes, .. } = file;
    let shapes = shapes.as_ref();
    let mut environment = environment(&scene.environment, shapes)?;
    let mut knots = match (scene.environment.profile(), shapes) {
        (Some(profile), Some(shapes)) => knots(shapes, profile.outline().knots) + "\n",
        _ => String::new(),
    };
    if let Some(learnt) = &scene.environment.parts().anticogging {
        knots += &(cogging(learnt) + "\n");
        environment += &format!(".beside(Anticogging::of(&COGGING, {:?}))", learnt.share);
    }
    let names: BTreeSet<_> = types(&knots).chain(types(&environment)).collect();
    let names = Vec::from_iter(names);
    let mut of_scene = vec!["Coupling", "Device", "Latency", "Scene", "Timing"];
    if scene.latency != Latency::NONE {
        of_scene.insert(4, "TimeRange");
    }
    if *scene.latency.encoder != EncoderReading::IDEAL {
        of_scene.insert(2, "EncoderReading");
    }
    let constant = format!(
        "Scene {{ device: {:?}, timing: {:?}, coupling: Coupling::{:?}, environment: {environment}, \
         latency: {}, torque_limit: {:?} }}",
        scene.device,
        scene.timing,
        scene.coupling,
        latency(&scene.latency),
        scene.torque_limit
    );
    let items = format!(
        "{knots}\
         /// The scene.\n\
         pub const SCENE: Scene = {};\n\n\
         /// Its certificate: a scene that could oscillate in a hand is a compile error here.\n\
         pub const CERTIFIED: Certified<Scene> = SCENE.certified();\n",
        layout::broken(0, &constant)
    );
    let environment = imports("haptic_servo::environment", &names);
    let scene = imports("haptic_servo::scene", &of_scene);
    let Some(host) = &file.host else { return Ok(Constants { environment, scene, items }) };
    let environment = environment + "\nuse haptic_servo::host::HostTorque;";
    let start = "pub const HOST: HostTorque =";
    let items = format!(
        "{items}\n/// What a host may do beside it.\n{start}{};\n",
        layout::after(start.len(), &format!("{host:?}"))
    );
    Ok(Constants { environment, scene, items })
}

/// The types that lines of code name by themselves, and not within another.
fn types(code: &str) -> impl Iterator<Item = &str> {
    let is_apart = |letter: char| !letter.is_alphanumeric() && !"_:".contains(letter);
    let lines = code.lines().filter(|line| !line.starts_with("//"));
    let names = lines.flat_map(move |line| line.split(is_apart));
    let first = names.map(|name| name.split(':').next().unwrap_or(name));
    first.filter(|name| {
        let is_type = name.starts_with(char::is_uppercase) && name.contains(char::is_lowercase);
        is_type && !["Some", "None"].contains(name)
    })
}

/// An item that imports names of a module, in lines as wide as rustfmt makes them.
pub fn imports(module: &str, names: &[&str]) -> String {
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

/// Only the nonzero parts.
fn latency(latency: &Latency) -> String {
    let times = [
        ("output_delay", latency.output_delay),
        ("actuator_lag", latency.actuator_lag),
        ("sensor_lag", latency.sensor_lag),
        ("actuator_response", latency.actuator_response),
    ];
    let times = times.into_iter().filter(|(_, time)| *time != TimeRange::ZERO);
    let jitters =
        [("output_jitter", latency.output_jitter), ("count_jitter", latency.count_jitter)];
    let jitters = jitters.into_iter().filter(|(_, jitter)| *jitter != 0.0);
    let updates = Some(latency.actuator_updates).filter(|updates| *updates != 0);
    let encoder = Some(latency.encoder).filter(|encoder| **encoder != EncoderReading::IDEAL);
    let fields: Vec<_> = times
        .map(|(name, it)| format!("{name}: {}", time(it)))
        .chain(jitters.map(|(name, jitter)| format!("{name}: {jitter:?}")))
        .chain(updates.map(|updates| format!("actuator_updates: {updates}")))
        .chain(encoder.map(|encoder| format!("encoder: {}", reading(encoder))))
        .collect();
    match fields[..] {
        [] => "Latency::NONE".to_owned(),
        _ => format!("Latency {{ {}, ..Latency::NONE }}", fields.join(", ")),
    }
}

/// Only the nonzero parts.
fn reading(encoder: &EncoderReading) -> String {
    let EncoderReading { age, window, linearity, noise, hysteresis, friction, dropped } = *encoder;
    let numbers = [
        ("window", window),
        ("linearity", linearity),
        ("noise", noise),
        ("hysteresis", hysteresis),
        ("friction", friction),
    ];
    let numbers = numbers.into_iter().filter(|(_, number)| *number != 0.0);
    let fields: Vec<_> = Some(age)
        .filter(|age| !age.is_zero())
        .map(|age| format!("age: {}", time(age)))
        .into_iter()
        .chain(numbers.map(|(name, number)| format!("{name}: {number:?}")))
        .chain((dropped > 0).then(|| format!("dropped: {dropped}")))
        .collect();
    format!("&EncoderReading {{ {}, ..EncoderReading::IDEAL }}", fields.join(", "))
}

fn time(TimeRange { least, most }: TimeRange) -> String {
    if least == most {
        return format!("TimeRange::exactly({least:?})");
    }
    format!("TimeRange::between({least:?}, {most:?})")
}

fn environment(environment: &Environment, shapes: Option<&Shapes>) -> Written {
    let parts = match environment {
        Environment::Parts(parts) => parts,
        Environment::Rational(rational) => return Ok(self::rational(rational)),
        Environment::Stated(_) => {
            return Err("an environment of another crate has no constant here".to_owned());
        }
    };
    let mut some = Vec::new();
    for (name, part) in parts.named() {
        let part = match (name, parts) {
            ("canceller", Parts { canceller: Some(it), .. }) => canceller(it),
            ("wall", Parts { wall: Some(it), .. }) => wall(it),
            ("profile", Parts { profile: Some(it), .. }) => profile(it, shapes)?,
            _ => format!("{part:?}"),
        };
        if parts.count() == 1 {
            return Ok(format!("{part}.alone()"));
        }
        some.push(format!("{name}: Some({part})"));
    }
    Ok(format!("Parts {{ {}, ..Parts::NONE }}.sum()", some.join(", ")))
}

fn canceller(canceller: &Canceller) -> String {
    match canceller {
        Canceller { residual, delay: 0 } => format!("Canceller::to({residual:?})"),
        late => format!("{late:?}"),
    }
}

fn wall(wall: &Wall) -> String {
    let Wall { stiffness, damper, side, delay } = *wall;
    let spring = match damper {
        None => format!("Wall::spring({stiffness:?}, {delay})"),
        Some(Damper { damping, filter }) => {
            let filter = filter.map_or_else(String::new, |pole| format!(".filtered({pole:?})"));
            format!("Wall::damped({stiffness:?}, {damping:?}, {delay}){filter}")
        }
    };
    match side {
        Side::Centred => spring,
        Side::Displaced(position) => format!("{spring}.placed({position:?})"),
        Side::Face(face) => format!("{spring}.behind({face:?})"),
    }
}

fn rational(rational: &Rational) -> String {
    let Rational { numerator, denominator, delay, unit_zeros } = rational;
    let [numerator, denominator] = [numerator, denominator]
        .map(|all: &Coefficients| format!("Coefficients::new(&{:?}).unwrap()", all.as_slice()));
    format!(
        "Environment::Rational(Rational {{ numerator: {numerator}, denominator: {denominator}, \
         delay: {delay}, unit_zeros: {unit_zeros} }})"
    )
}

/// A torque profile of the table, with the numbers that are not those of its shapes.
fn profile(profile: &Profile, shapes: Option<&Shapes>) -> Written {
    let of_shapes = format!("Profile::of(&KNOTS, {})", profile.delay);
    let changed = changes(profile, shapes)?;
    if changed.is_empty() {
        return Ok(of_shapes);
    }
    let fields = changed.iter().map(|(name, value)| format!("{name}: {value}, "));
    Ok(format!("Profile {{ {}..{of_shapes} }}", fields.collect::<String>()))
}

/// The numbers of a profile that are not those of its shapes.
fn changes(
    profile: &Profile,
    shapes: Option<&Shapes>,
) -> Result<Vec<(&'static str, String)>, String> {
    let shapes = shapes.ok_or("the profile has no shapes")?;
    let own = shapes.sampled(profile.delay).map_err(|error| error.to_string())?;
    let numbers = [
        ("torque", profile.torque, own.torque),
        ("count", profile.count, own.count),
        ("centre", profile.centre, own.centre),
    ];
    // By their bits: -0.0 is another number than 0.0.
    let differ = numbers.into_iter().filter(|(_, now, was)| now.to_bits() != was.to_bits());
    let mut changed: Vec<_> = differ.map(|(name, now, _)| (name, format!("{now:?}"))).collect();
    if profile.ends != own.ends {
        changed.push(("ends", format!("{:?}", profile.ends)));
    }
    if profile.damping.is_some() {
        changed.push(("damping", format!("{:?}", profile.damping)));
    }
    Ok(changed)
}

/// The table, which stays in flash.
fn knots(shapes: &Shapes, cells: u32) -> String {
    let all: Vec<_> = shapes.with_ends().iter().map(shape).collect();
    let table = format!("Knots::of(&[{}])", all.join(", "));
    let start = format!("static KNOTS: Knots<{cells}> =");
    format!(
        "/// Torque over angle: a table, which stays in flash.\n{start}{};\n",
        layout::after(start.len(), &table)
    )
}

/// The learnt cogging, which stays in flash.
fn cogging(learnt: &Anticogging) -> String {
    let torques: Vec<_> = learnt.torques().map(|torque| format!("{torque:?}")).collect();
    let lines: Vec<_> =
        torques.chunks(4).map(|line| format!("    {},\n", line.join(", "))).collect();
    format!(
        "/// Cogging torque of the motor over a turn of the encoder in N m: a table, which stays in flash.\n\
         static COGGING: CoggingMap<{}> = CoggingMap::of(&[\n{}]);\n",
        torques.len(),
        lines.concat()
    )
}

fn shape(shape: &Shape) -> String {
    match *shape {
        Shape::Detents { count, torque, centre: 0.0 } => {
            format!("Shape::detents({count}, {torque:?})")
        }
        Shape::SnapDetents { count, torque, centre: 0.0, snap } => {
            format!("Shape::detents({count}, {torque:?}).snap({snap:?})")
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
        other => format!("Shape::{other:?}"),
    }
}
