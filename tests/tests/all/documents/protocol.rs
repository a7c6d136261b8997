//! `firmware/PROTOCOL.md` is the protocol: its tables are the types of the messages, its numbers the
//! constants.

use haptic_servo::board::BAUD;
use haptic_servo::excitation::SWEEP_PROTOCOL;
use haptic_servo::fault::Fault;
use haptic_servo::parameter::{Parameter, TUNABLE};
use haptic_servo::wire::message::{LONGEST_TO_BOARD, LONGEST_TO_HOST, MAX_CHANGES, ToBoard};
use haptic_servo::wire::session::MESSAGES_AHEAD;
use haptic_servo::wire::sweep::SweepRequest;
use haptic_servo::wire::telemetry::BATCH;
use haptic_servo::wire::{PROTOCOL, encode, largest_frame};

use super::{column, read, regex, table};

const DOCUMENT: &str = "firmware/PROTOCOL.md";
const MESSAGES: &str = "firmware/src/wire/message.rs";
const HOST: &str = "firmware/src/wire/host.rs";
const WALL: &str = "firmware/src/environment/wall.rs";

/// The text in the braces of a type in a source file, or of the table of its values.
fn body(path: &str, kind: &str, name: &str) -> String {
    let source = read(path);
    let of =
        regex(&format!(r"(?s)\n(?:pub(?:\(\w+\))? )?{kind} {name}(?:<[\w, =]+>)? \{{\n(.*?)\n\}}"));
    let table = regex(&format!(
        r"(?s)\n\w+! \{{\n(?:    [/#][^\n]*\n)+    {name}(?:: \w+)? \{{\n(.*?)\n    \}}"
    ));
    let found = of.captures(&source).or_else(|| table.captures(&source));
    found.unwrap_or_else(|| panic!("{path} has no {kind} {name}"))[1].to_owned()
}

/// The fields of a struct in a source file that go over the wire, in order, each with its type.
fn fields(path: &str, name: &str) -> Vec<(String, String)> {
    let field = regex(r"(?m)^    (?:pub )?(\w+): (.+),$");
    let skipped = regex(r"(?m)^.*serde\(skip\)\)\]\n.*\n");
    let body = skipped.replace_all(&body(path, "struct", name), "").into_owned();
    field.captures_iter(&body).map(|field| (field[1].to_owned(), field[2].to_owned())).collect()
}

/// The variants of an enumeration in order, each with its fields as one text.
pub fn variants(path: &str, name: &str) -> Vec<(String, String)> {
    let variant =
        regex(r#"(?ms)^    (\w+)(?: = \d+)?(?:\((.*?)\)| \{(.*?)(?:^    | )\})?(?:,$| => | ")"#);
    let body = body(path, "enum", name);
    let fields = |variant: &regex::Captures<'_>| match (variant.get(2), variant.get(3)) {
        (Some(tuple), _) => tuple.as_str().to_owned(),
        (_, Some(named)) => {
            let field = regex(r"(?m)^        (\w+): (.+),$");
            let named = field.captures_iter(named.as_str());
            named
                .map(|field| format!("{}: {}", &field[1], &field[2]))
                .collect::<Vec<_>>()
                .join(", ")
        }
        _ => String::new(),
    };
    variant.captures_iter(&body).map(|one| (one[1].to_owned(), fields(&one))).collect()
}

#[test]
fn every_field_of_every_message_is_there_in_order() {
    let document = read(DOCUMENT);
    for (path, name) in [
        (MESSAGES, "BoardUnits"),
        (MESSAGES, "ActiveParameters"),
        (MESSAGES, "Status"),
        ("firmware/src/power_reading.rs", "PowerReading"),
        ("firmware/src/current/phase.rs", "IndexOffset"),
        (HOST, "HostCommand"),
        ("firmware/src/host/mod.rs", "HostTorque"),
        (HOST, "HostState"),
        (MESSAGES, "FaultCode"),
        (MESSAGES, "PreviousFault"),
        ("firmware/src/wire/decoder.rs", "Discarded"),
        ("firmware/src/wire/description.rs", "Description"),
        ("firmware/src/scene.rs", "Scene"),
        ("firmware/src/environment/parts.rs", "Parts"),
        ("firmware/src/environment/canceller.rs", "Canceller"),
        ("firmware/src/environment/drag.rs", "Drag"),
        (WALL, "Wall"),
        (WALL, "Damper"),
        ("firmware/src/environment/profile/data.rs", "Profile"),
        ("firmware/src/environment/profile/knots.rs", "Table"),
        ("firmware/src/environment/profile/knots.rs", "Outline"),
        ("firmware/src/transducers.rs", "Transducers"),
        ("firmware/src/servo/prepared_servo.rs", "RenderingOptions"),
        ("firmware/src/wire/telemetry.rs", "Packed"),
    ] {
        let table = table(&document, &format!("### {name}"));
        let said: Vec<_> = table.iter().map(|row| (row[0].clone(), row[1].clone())).collect();
        assert_eq!(said, fields(path, name), "{name}");
        assert!(table.iter().all(|row| !row[2].is_empty()), "{name}: a field without a meaning");
    }
    let batch = fields("firmware/src/wire/telemetry.rs", "Batch");
    let [(name, kind)] = &batch[..] else { panic!("{batch:?}") };
    assert!(document.contains(&format!("One field, `{name}: {kind}`")));
    let source = read("firmware/src/wire/changes.rs");
    let changes = regex(r"pub type Changes = (.+);").captures(&source).unwrap()[1].to_owned();
    assert!(document.contains(&format!("`Changes` is `{changes}`")));
}

#[test]
fn every_variant_is_there_with_its_number() {
    let document = read(DOCUMENT);
    for (path, name, heading, fields) in [
        (MESSAGES, "ToBoardWith", "## To the board", Some(2)),
        (MESSAGES, "ToHostWith", "## To the host", Some(2)),
        (HOST, "HostRequest", "### HostRequest", Some(2)),
        (HOST, "HostReport", "### HostReport", Some(2)),
        ("firmware/src/wire/sweep.rs", "SweepRequest", "## A sweep", Some(2)),
        (MESSAGES, "Outcome", "### Outcome", None),
        (MESSAGES, "Refusal", "### Refusal", Some(2)),
        (WALL, "Side", "### Side", Some(2)),
        ("firmware/src/step.rs", "Step", "### Step", None),
        ("firmware/src/number/mod.rs", "Format", "### Format", None),
        ("firmware/src/output_timing.rs", "OutputTiming", "### OutputTiming", None),
        ("firmware/src/servo_loop/state.rs", "State", "### State", None),
        ("firmware/src/reset.rs", "ResetCause", "### ResetCause", None),
        ("firmware/src/torque.rs", "LimitReason", "### LimitReason", None),
    ] {
        let table = table(&document, heading);
        let variants = variants(path, name);
        let numbers: Vec<_> = (0..variants.len()).map(|number| number.to_string()).collect();
        assert_eq!(column(&table, 0), numbers, "{name}");
        let names: Vec<_> = variants.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(column(&table, 1), names, "{name}");
        if let Some(place) = fields {
            // A program with a host has these in place of the parameters of the types.
            let with_host = |fields| match fields {
                "C" => "HostRequest",
                "R" => "HostReport",
                other => other,
            };
            let fields: Vec<_> =
                variants.iter().map(|(_, fields)| with_host(fields.as_str())).collect();
            assert_eq!(column(&table, place), fields, "{name}");
        }
    }
}

#[test]
fn every_parameter_is_there_with_its_number() {
    let table = table(&read(DOCUMENT), "### Parameter");
    let all: Vec<_> = Parameter::ALL
        .iter()
        .map(|parameter| (format!("{}", *parameter as u32), format!("{parameter:?}")))
        .collect();
    let said: Vec<_> = table.iter().map(|row| (row[0].clone(), row[1].clone())).collect();
    assert_eq!(said, all);
}

#[test]
fn parameters_have_the_names_and_units_of_the_program() {
    for row in table(&read(DOCUMENT), "### Parameter") {
        let [_, variant, name, unit] = &row[..] else { panic!("{row:?}") };
        let tunable = TUNABLE.iter().find(|(_, parameter)| format!("{parameter:?}") == *variant);
        assert_eq!(tunable.map_or("", |(name, _)| name), name, "{variant}");
        if let Some((_, parameter)) = tunable {
            assert_eq!(parameter.name_and_unit().1, unit, "{variant}");
        }
    }
}

/// All faults with their codes, of which one is left out.
pub fn faults() -> Vec<(u32, Fault)> {
    (1..100).filter_map(|code| Some((code, Fault::decode(code, [1, 2])?))).collect()
}

#[test]
fn every_fault_is_there_with_its_code_and_its_numbers() {
    let table = table(&read(DOCUMENT), "### Faults");
    assert_eq!(table.len(), faults().len());
    for (row, (code, fault)) in table.iter().zip(faults()) {
        assert_eq!(row[..2], [code.to_string(), fault.as_str().to_owned()]);
        let (_, numbers) = fault.encode();
        assert_eq!(
            numbers.map(|number| number != 0),
            [2, 3].map(|i| !row[i].is_empty()),
            "{row:?}"
        );
    }
}

#[test]
fn limits_are_the_constants() {
    let table = table(&read(DOCUMENT), "## Limits");
    let said: Vec<_> = table.iter().map(|row| (&*row[0], row[1].parse().unwrap())).collect();
    let constants = [
        ("PROTOCOL", usize::from(PROTOCOL)),
        ("BAUD", BAUD as usize),
        ("MAX_CHANGES", MAX_CHANGES),
        ("LONGEST_TO_BOARD", LONGEST_TO_BOARD),
        ("LONGEST_TO_HOST", LONGEST_TO_HOST),
        ("largest_frame(LONGEST_TO_BOARD)", largest_frame(LONGEST_TO_BOARD)),
        ("largest_frame(LONGEST_TO_HOST)", largest_frame(LONGEST_TO_HOST)),
        ("BATCH", BATCH),
        ("MESSAGES_AHEAD", MESSAGES_AHEAD),
        ("SWEEP_PROTOCOL", SWEEP_PROTOCOL as usize),
    ];
    assert_eq!(said, constants);
}

#[test]
fn the_frames_of_the_examples_are_those_that_are_sent() {
    let document = read(DOCUMENT);
    let mut buffer = [0; 16];
    let hello = encode(&ToBoard::Hello, &mut buffer).unwrap();
    for (name, frame) in [("hello", hello), ("begin", &SweepRequest::BEGIN.frame())] {
        let mark = format!("<!-- {name} -->\n```text\n");
        let shown = document.split(&mark).nth(1).unwrap().lines().next().unwrap();
        let hex: Vec<_> = frame.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(shown, hex.join(" "));
    }
}
