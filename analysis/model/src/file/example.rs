//! A commented scene file of each type of environment, and one of a device that is a chain.

use super::key::{self, Key, Presence};
use super::kind::{self, Kind, PROFILE};
use super::shape;

/// The example of a device that is a chain of masses.
pub const CHAIN: &str = "chain";

/// The example of a torque profile with a wall and a canceller beside it.
pub const COMPOSED: &str = "profile-and-wall";

/// Optional keys that an example sets, so that there is a spring, the device moves and a hand holds it.
const SET: &[&Key] = &[
    &key::COUPLING_STIFFNESS,
    &key::TORQUE_PULSES,
    &key::HUMAN_INERTIA,
    &key::HUMAN_DAMPING,
    &key::HUMAN_STIFFNESS,
];

/// Columns of a comment.
const WIDTH: usize = 96;

/// The names of the examples.
pub fn names() -> impl Iterator<Item = &'static str> {
    kind::ALL.iter().map(|kind| kind.name).chain([CHAIN, COMPOSED])
}

/// The example of that name: a scene file that certifies, in which most optional keys are comments. `None` if
/// there is no such example.
pub fn toml(name: &str) -> Option<String> {
    let is_chain = name == CHAIN;
    let kind = Kind::find(match name {
        CHAIN => "damper-wall",
        COMPOSED => PROFILE,
        _ => name,
    })?;
    let mut lines = vec![format!("name = \"{name} example\"")];
    for table in key::ALL.iter().filter(|key| key.table().is_empty() && **key != &key::NAME) {
        // A map, a supply or a host that is stated needs values, and most scenes have neither.
        let is_rare = [&key::ANTICOGGING, &key::SUPPLY, &key::HOST, &key::MOTOR].contains(table);
        let comment = if is_rare { "# " } else { "" };
        let header = format!("{comment}[{}]", table.path);
        lines.push("".to_owned());
        lines.extend(textwrap::wrap(table.doc, WIDTH).iter().map(|line| format!("# {line}")));
        lines.push(header);
        let keys = || key::ALL.iter().filter(|key| key.table() == table.path).copied();
        match table.path {
            "environment" => environment(&mut lines, kind, name == COMPOSED),
            "device" => device(&mut lines, keys(), is_chain),
            "anticogging" | "supply" | "host" | "motor" => {
                keys().for_each(|key| line(&mut lines, key, key.example, false))
            }
            _ => keys().for_each(|key| line(&mut lines, key, key.example, is_set(key))),
        }
    }
    Some(lines.join("\n") + "\n")
}

fn is_set(key: &Key) -> bool {
    key.presence == Presence::Needed || SET.contains(&key)
}

fn environment(lines: &mut Vec<String>, kind: &Kind, is_composed: bool) {
    lines.push(format!("# {}", kind.doc));
    lines.push(format!("{} = \"{}\"", key::TYPE.name(), kind.name));
    if kind.name == PROFILE {
        return profile(lines, kind, is_composed);
    }
    for key in kind.keys() {
        let own = kind.values.iter().find(|(own, _)| *own == key);
        let value = own.map_or(key.example, |(_, value)| value);
        line(lines, key, value, kind.needed.contains(&key));
    }
}

/// The keys of a torque profile and two shapes, for which knots are an alternative. If `is_composed`, also a
/// wall and a canceller.
fn profile(lines: &mut Vec<String>, kind: &Kind, is_composed: bool) {
    let is_table =
        |key: &&Key| ![&key::KNOTS, &key::KNOTS_PERIOD, &key::SHAPE, &key::WALL].contains(key);
    for key in kind.keys().filter(is_table) {
        let value = if *key == key::STIFFNESS { "15.0" } else { key.example };
        let is_beside = is_composed && *key == key::RESIDUAL;
        line(lines, key, value, is_beside || kind.needed.contains(&key));
    }
    lines.push(format!("# {} Types, with their keys:", key::SHAPE.doc));
    for kind in shape::ALL {
        let keys: Vec<&str> = kind.keys().map(Key::name).collect();
        let text = format!("\"{}\" ({}): {}", kind.name, keys.join(", "), kind.doc);
        lines.extend(textwrap::wrap(&text, WIDTH - 2).iter().map(|line| format!("#   {line}")));
    }
    for name in ["detents", "end_stops"] {
        let kind = shape::ALL.iter().filter(|kind| kind.name == name);
        lines.push(format!("[[{}]]", key::SHAPE.path));
        lines.push(format!("{} = \"{name}\"", key::SHAPE_TYPE.name()));
        let keys = kind.flat_map(|kind| kind.keys());
        lines.extend(keys.map(|key| match key.presence {
            Presence::Optional(_) => format!("# {}", set(key, key.example)),
            _ => set(key, key.example),
        }));
    }
    lines.push(format!("# {}", key::WALL.doc));
    if !is_composed {
        return lines.push(format!("# The example \"{COMPOSED}\" has one."));
    }
    lines.push(format!("[{}]", key::WALL.path));
    for key in key::ALL.iter().filter(|key| key.table() == key::WALL.path) {
        line(lines, key, key.example, **key != key::WALL_FILTER);
    }
}

/// `[device]`: a rigid body, or a motor and a handle on a shaft.
fn device(lines: &mut Vec<String>, keys: impl Iterator<Item = &'static Key>, is_chain: bool) {
    let of_a_body = [&key::INERTIA, &key::DEVICE_DAMPING];
    let of_a_chain = [&key::ENCODER];
    for key in keys.filter(|key| ![&key::MASS, &key::LINK].contains(key)) {
        let belongs = if is_chain { !of_a_body.contains(&key) } else { !of_a_chain.contains(&key) };
        // The example's passivity is not that of the chain.
        if belongs && !(is_chain && *key == key::PASSIVITY) {
            line(lines, key, key.example, is_set(key));
        }
    }
    if is_chain {
        lines.push(format!("# {}", key::MASS.doc));
        for [inertia, damping] in [["2.0e-5", "0.02"], ["3.0e-5", "0.005"]] {
            lines.push(format!("[[{}]]", key::MASS.path));
            lines.push(set(&key::MASS_INERTIA, inertia));
            lines.push(set(&key::MASS_DAMPING, damping));
        }
        lines.extend([format!("# {}", key::LINK.doc), format!("[[{}]]", key::LINK.path)]);
        lines.extend([&key::LINK_STIFFNESS, &key::LINK_DAMPING].map(|key| set(key, key.example)));
    }
}

/// A key with its description above it; an unset key is a comment.
fn line(lines: &mut Vec<String>, key: &Key, value: &str, is_set: bool) {
    let unit = if key.unit.is_empty() { String::new() } else { format!(" In {}.", key.unit) };
    let text = format!("{}{unit}", key.doc);
    lines.extend(textwrap::wrap(&text, WIDTH).iter().map(|line| format!("# {line}")));
    let comment = if is_set { "" } else { "# " };
    lines.push(format!("{comment}{} = {value}", key.name()));
}

fn set(key: &Key, value: &str) -> String {
    let unit = if key.unit.is_empty() { String::new() } else { format!(" # {}", key.unit) };
    format!("{} = {value}{unit}", key.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::{Format, parse};

    /// The text with this key, which is a comment in it.
    fn with(text: &str, key: &Key) -> String {
        let commented = format!("# {} =", key.name());
        let mut table = "";
        let lines = text.lines().map(|line| {
            if line.starts_with('[') {
                table = line.trim_matches(['[', ']']);
            } else if line.starts_with("# [") {
                // A table that is a comment as a whole.
                table = "";
            }
            let is_torque = key.name().starts_with("torque") && line.starts_with("torque_pulses");
            match line.strip_prefix("# ") {
                Some(rest) if line.starts_with(&commented) && table == key.table() => rest,
                // Updates need a lag.
                Some(rest)
                    if *key == key::ACTUATOR_UPDATES && line.starts_with("# actuator_lag") =>
                {
                    rest
                }
                // A chip needs its age.
                Some(rest) if *key == key::CHIP && line.starts_with("# age") => rest,
                _ if is_torque => "",
                _ if *key == key::RATE && line.starts_with("period") => "",
                _ => line,
            }
        });
        let text = lines.collect::<Vec<_>>().join("\n");
        // Its torques need a host.
        if *key != key::HOST_TORQUES || text.lines().all(|line| !line.starts_with("host =")) {
            return text;
        }
        text + "\n[host]\nenergy = 0.05\npower = 0.5\ndamping = 0.001\ntorque = 0.5\n"
    }

    #[test]
    fn every_example_reads_and_certifies() {
        for name in names() {
            let text = toml(name).unwrap();
            let file = parse(name, Format::Toml, &text);
            let file = file.unwrap_or_else(|error| panic!("{error}\n{text}"));
            assert!(file.scene.certify().is_ok(), "{name}: {:?}", file.scene.certify());
            assert!(file.simulation.is_some() && file.hand.is_some());
        }
        assert!(toml("wall").is_none());
    }

    #[test]
    fn every_key_of_an_example_that_is_a_comment_reads_without_it() {
        let mut keys = 0;
        for name in names() {
            let text = toml(name).unwrap();
            for key in key::ALL {
                let more = with(&text, key);
                if text.contains(&format!("\n# {} =", key.name())) && more != text {
                    keys += 1;
                    let read = parse(name, Format::Toml, &more);
                    assert!(read.is_ok(), "{}: {}\n{more}", key.path, read.unwrap_err());
                }
            }
        }
        assert!(keys > 60, "{keys}");
    }
}
