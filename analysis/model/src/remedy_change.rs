//! The remedies of a rejected scene, as changes of its file.

use haptic_servo::certificate::Remedy;
use haptic_servo::parameter::Parameter;
use serde::Serialize;
use serde_json::{Value, json};

use crate::file::{SceneFile, key, scene};
use crate::verdict::VerdictReport;

/// A remedy, and the changes of the file that apply it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RemedyChange {
    /// The remedy in words, as the report has it.
    pub sentence: String,
    /// Keys and their values, null for a removed key: the passing value that is nearest to the present one.
    /// Empty where no key of the file has that number.
    pub changes: Vec<(&'static str, Value)>,
}

/// The remedies of a report on a file, in the report's order.
pub fn remedy_changes(file: &SceneFile, report: &VerdictReport) -> Vec<RemedyChange> {
    let matched = report.matched.map(|words| RemedyChange {
        sentence: words.to_owned(),
        changes: vec![
            (key::COUPLING_TYPE.path, scene::MATCHED.into()),
            (key::COUPLING_STIFFNESS.path, Value::Null),
        ],
    });
    let numbers = report.changes.iter().map(|remedy| RemedyChange {
        sentence: remedy.to_string(),
        changes: changes(file, remedy),
    });
    matched.into_iter().chain(numbers).collect()
}

fn changes(file: &SceneFile, remedy: &Remedy) -> Vec<(&'static str, Value)> {
    let path = key_of(file, remedy.parameter);
    let value = nearest(remedy, file.scene.get(remedy.parameter));
    let value = value
        .filter(|&value| remedy.parameter != Parameter::Passivity || is_passivity(file, value));
    let changed = path.zip(value).map(|(path, value)| (path, json!(value)));
    let age = value.and_then(|value| age_beside(file, remedy.parameter, value));
    let removed = match remedy.parameter {
        // A matched coupling takes no stiffness; without a type it is a spring.
        Parameter::CouplingStiffness => Some(key::COUPLING_TYPE.path),
        Parameter::Period => Some(key::RATE.path),
        _ => None,
    };
    let removed = removed.filter(|_| changed.is_some()).map(|path| (path, Value::Null));
    removed.into_iter().chain(changed).chain(age).collect()
}

/// The other age that the chip of an encoder has beside another value of a number.
fn age_beside(file: &SceneFile, parameter: Parameter, value: f64) -> Option<(&'static str, Value)> {
    let other = file.scene.with(parameter, value)?;
    let age = file.chip_on_board()?.age_in(&file.scene, &other);
    let is_other = age != file.scene.latency.encoder.age;
    is_other.then(|| (key::AGE.path, json!([age.least, age.most])))
}

/// The key of a number; `None` where the file has another number in its place.
fn key_of(file: &SceneFile, parameter: Parameter) -> Option<&'static str> {
    let is_chain = file.chain.masses().len() > 1;
    let environment = &file.scene.environment;
    let is_beside_wall = environment.wall().is_some() && environment.profile().is_some();
    Some(match parameter {
        // The damping of a chain follows from its masses.
        Parameter::DeviceDamping if is_chain => return None,
        Parameter::Stiffness if is_beside_wall => key::WALL_STIFFNESS.path,
        Parameter::Damping if is_beside_wall => key::WALL_DAMPING.path,
        parameter => parameter.key(),
    })
}

/// Whether a device may be declared to have that passivity: no more than its masses give.
fn is_passivity(file: &SceneFile, value: f64) -> bool {
    let own = file.chain.as_rigid().ok().map(|own| own.passivity());
    own.is_none_or(|own| value <= own)
}

/// The end of the passing values that is nearer to the present value.
fn nearest(remedy: &Remedy, present: Option<f64>) -> Option<f64> {
    let Remedy { lowest, highest, .. } = *remedy;
    match (lowest, highest, present) {
        (Some(lowest), Some(_), Some(present)) if present < lowest => Some(lowest),
        _ => highest.or(lowest),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::{Format, parse};
    use crate::verdict::{Verdict, judge_file};
    use haptic_servo::number::Format as NumberFormat;

    const DEVICE: &str = "name = \"a\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n";
    const SERVO: &str = "[servo]\nperiod = 0.001\n";

    fn set(scene: &mut Value, path: &str, value: Value) {
        let mut place = scene;
        let (tables, name) = path.rsplit_once('.').unwrap();
        for table in tables.split('.') {
            place = &mut place[table];
            if place.is_null() {
                *place = json!({});
            }
        }
        let table = place.as_object_mut().unwrap();
        if value.is_null() {
            table.remove(name);
        } else {
            table.insert(name.to_owned(), value);
        }
    }

    /// How many remedies change the file, and how many there are.
    fn each_certifies(text: &str) -> [usize; 2] {
        let file = parse("a.toml", Format::Toml, text).unwrap_or_else(|error| panic!("{error}"));
        let report = judge_file(&file, NumberFormat::F64);
        assert!(!report.passes(), "{text}");
        let found = remedy_changes(&file, &report);
        let sentences: Vec<_> = found.iter().map(|remedy| remedy.sentence.clone()).collect();
        assert_eq!(sentences, report.remedies);
        let mut changing = 0;
        for remedy in &found {
            if remedy.changes.is_empty() {
                continue;
            }
            changing += 1;
            let mut scene = crate::file::as_json("a.toml", Format::Toml, text).unwrap();
            for (path, value) in &remedy.changes {
                set(&mut scene, path, value.clone());
            }
            let changed = parse("a.json", Format::Json, &scene.to_string());
            let changed = changed.unwrap_or_else(|error| panic!("{}: {error}", remedy.sentence));
            let verdict = judge_file(&changed, NumberFormat::F64);
            assert!(verdict.passes(), "{}: {scene}: {}", remedy.sentence, verdict.message);
        }
        [changing, found.len()]
    }

    #[test]
    fn every_remedy_certifies_where_it_is_applied() {
        let spring = "[coupling]\nstiffness = 44\n";
        let wall = "[environment]\ntype = \"damper-wall\"\ndelay = 1\n";
        let stiff = format!("{wall}stiffness = 60\ndamping = 0.02\n");
        let detents = "[environment]\ntype = \"profile\"\ndelay = 1\n[[environment.shape]]\n\
                       type = \"detents\"\ncount = 24\ntorque = 5\n";
        let stops =
            "[[environment.shape]]\ntype = \"end_stops\"\nfrom = -1\nto = 1\nstiffness = 300\n";
        let beside = "[environment.wall]\nstiffness = 60\ndamping = 0.01\ndelay = 1\n";
        let soft = detents.replace("torque = 5", "torque = 0.05");
        let cases = [
            format!("{DEVICE}{SERVO}{spring}{stiff}"),
            format!("{DEVICE}[servo]\nrate = 1000\n{stiff}"),
            format!("{DEVICE}passivity = 0.02\n{SERVO}worst_period = 0.0011\n{stiff}")
                .replace("60", "8"),
            format!(
                "{DEVICE}actuator_lag = [1e-4, 2e-4]\nsensor_lag = 3e-5\n{SERVO}output_delay = 5e-5\n\
                 [coupling]\nstiffness = 40\n{wall}stiffness = 20\ndamping = 0.005\n"
            ),
            format!("{DEVICE}{SERVO}[coupling]\ntype = \"spring\"\nstiffness = 400\n{stiff}"),
            format!(
                "{DEVICE}{SERVO}{spring}[environment]\ntype = \"free-mode\"\nresidual = -0.01\n"
            ),
            format!("{DEVICE}{SERVO}{spring}{detents}"),
            format!("{DEVICE}{SERVO}{spring}{soft}{stops}"),
            format!("{DEVICE}{SERVO}{spring}{soft}{}{beside}", stops.replace("300", "10")),
        ];
        let found = cases.each_ref().map(|text| each_certifies(text));
        for ([changing, all], text) in found.iter().zip(&cases) {
            assert_eq!(changing, all, "{text}");
            assert!(*all > 0, "{text}");
        }
    }

    /// Scenes that are rejected, some on a board only, and by its reading time or its limit.
    #[test]
    fn every_remedy_of_a_scene_for_a_board_passes_on_a_board() {
        let limits = ["torque = 1.0\n", "encoder_step = 1e-4\n", "full_scale = 2.0\n"];
        let (mut seen, mut on_a_board) = (0, 0);
        for index in 0..300 {
            // Evenly spread, and never the same twice.
            let [stiff, damped, coupled, fast] = [0.618_034, 0.414_214, 0.732_051, 0.236_068]
                .map(|it: f64| (it * f64::from(index)).fract());
            let period = 1e-3 * (0.1 + 0.9 * fast);
            let standard = 0.044 / period;
            let text = format!(
                "{DEVICE}[servo]\nperiod = {period:?}\n[coupling]\nstiffness = {:?}\n[environment]\n\
                 type = \"damper-wall\"\ndelay = {}\nstiffness = {:?}\ndamping = {:?}\n\
                 one_sided = {}\n[limits]\n{}",
                standard * (0.6 + 0.6 * coupled),
                1 + index % 2,
                standard * (0.2 + 0.8 * stiff),
                0.03 * damped,
                index % 3 == 0,
                limits[index as usize % limits.len()],
            );
            let file = parse("a.toml", Format::Toml, &text).unwrap();
            let report = judge_file(&file, NumberFormat::F64);
            if report.passes() {
                continue;
            }
            on_a_board += usize::from(report.verdict == Verdict::Certified);
            seen += each_certifies(&text)[0];
        }
        assert!(seen > 100 && on_a_board > 5, "{seen} {on_a_board}");
    }

    /// An AS5048A reads what it has sampled a period before.
    #[test]
    fn another_period_has_the_age_of_the_chip() {
        let text = "name = \"a\"\n[device]\ninertia = 3e-5\ndamping = 0.001\n[servo]\nrate = 1000\n\
                    [encoder]\nchip = \"as5048a\"\nage = [0.00107, 0.0012]\nnoise = 10\n\
                    [environment]\ntype = \"delayed-spring\"\nstiffness = 0.45\ndelay = 1\n\
                    [limits]\nfull_scale = 2.0\n";
        let [changing, all] = each_certifies(text);
        assert_eq!(changing, all);
        let file = parse("a.toml", Format::Toml, text).unwrap();
        let changes = remedy_changes(&file, &judge_file(&file, NumberFormat::F64));
        let keys = |change: &RemedyChange| change.changes.iter().map(|it| it.0).collect::<Vec<_>>();
        let period = [key::RATE.path, key::PERIOD.path, key::AGE.path];
        assert!(changes.iter().any(|change| keys(change) == period), "{changes:?}");
    }

    #[test]
    fn a_chain_has_no_more_passivity_than_its_masses() {
        let masses = "[[device.mass]]\ninertia = 2e-5\ndamping = 0.02\n[[device.mass]]\n\
                      inertia = 3e-5\ndamping = 0.005\n[[device.link]]\nstiffness = 40\n\
                      damping = 0.015\n";
        let chain = |passivity: &str, stiffness: f64| {
            format!(
                "name = \"a\"\n[device]\n{passivity}{masses}{SERVO}[environment]\n\
                 type = \"damper-wall\"\ndelay = 1\nstiffness = {stiffness}\ndamping = 0.008\n"
            )
        };
        let [changing, all] = each_certifies(&chain("passivity = 0.012\n", 8.0));
        assert_eq!(changing, all);
        let [changing, all] = each_certifies(&chain("", 20.0));
        assert!(changing > 0 && changing + 1 == all, "{changing} of {all}");
    }
}
