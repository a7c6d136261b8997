//! Scene files with a torque profile: shapes, snap points, and a wall and a canceller beside them.

use std::f64::consts::TAU;

use analysis::file::{self, FileError, Format, Purpose, SceneFile, parse_for, write};
use analysis::profile_curve::ProfileCurve;
use haptic_servo::environment::{Ends, Profile};
use haptic_servo::parameter::Parameter;

const HEAD: &str = "name = \"knob\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n[servo]\n\
                    period = 0.001\n[coupling]\nstiffness = 44.0\n[environment]\ntype = \"profile\"\n";

fn read(environment: &str) -> Result<SceneFile, FileError> {
    file::parse("knob.toml", Format::Toml, &format!("{HEAD}{environment}"))
}

fn scene(environment: &str) -> SceneFile {
    read(environment).unwrap_or_else(|error| panic!("{error}\n{environment}"))
}

fn profile(environment: &str) -> Profile {
    *scene(environment).scene.environment.profile().unwrap()
}

fn shape(name: &str, keys: &str) -> String {
    format!("[[environment.shape]]\ntype = \"{name}\"\n{keys}\n")
}

const DETENTS: &str =
    "delay = 1\n[[environment.shape]]\ntype = \"detents\"\ncount = 24\ntorque = 0.05\n";
const KNOTS: &str = "delay = 1\nknots = [[0.0, 0.0], [0.1, 0.02], [0.3, -0.02], [0.4, 0.0]]\n";
const STOPS: &str = "from = -1.0\nto = 1.5\nstiffness = 4.0\n";
const WALL: &str = "[environment.wall]\nstiffness = 4.0\ndelay = 2\n";

#[test]
fn shapes_add_up_to_one_table() {
    let detents = profile(DETENTS);
    assert_eq!((detents.count, detents.torque, detents.ends), (24.0, 0.05, None));
    assert_eq!((detents.delay, detents.damping, detents.units().len()), (1, None, 16));
    let stops = shape("end_stops", "from = -2\nto = 2\nstiffness = 15");
    let knob = profile(&format!("damping = 1e-4\n{DETENTS}{stops}"));
    assert_eq!(knob.ends, Some(Ends { from: -2.0, to: 2.0, stiffness: 15.0 }));
    assert_eq!((knob.count, knob.damping, knob.outline().wraps), (24.0, Some(1e-4), true));
    // The keys of the environment override those of the shapes.
    let keys = format!("torque = 0.02\ncount = 30\ncentre = 0.1\nto = 1.5\n{DETENTS}{stops}");
    let changed = profile(&keys);
    assert_eq!((changed.torque, changed.count, changed.centre), (0.02, 30.0, 0.1));
    assert_eq!(changed.ends, Some(Ends { from: -2.0, to: 1.5, stiffness: 15.0 }));
    assert_eq!(profile(&format!("{STOPS}{DETENTS}")).ends.unwrap().to, 1.5);
    for (name, keys) in [
        ("centre", "width = 0.3\nstiffness = 2"),
        ("bistable", "distance = 0.3\ntorque = 0.1"),
        ("texture", "pitch = 0.05\namplitude = 0.003"),
        ("magnet", "angle = 0.5\nwidth = 0.2\ntorque = 0.1"),
        ("table", "knots = [[-1, 0.1], [0, -0.1], [1, 0.1]]"),
        ("table", "knots = [[0, 0], [0.1, 0.1], [0.3, -0.1], [0.4, 0]]\nperiod = 0.4"),
    ] {
        let alone = profile(&format!("delay = 0\n{STOPS}{}", shape(name, keys)));
        assert!(alone.torque > 0.0, "{name}");
        let beside = profile(&format!("{STOPS}{DETENTS}{}", shape(name, keys)));
        assert!(beside.torque > 0.05, "{name}");
    }
}

/// The smallest power of two whose cells are at most half as wide as the narrowest piece.
#[test]
fn a_table_has_as_many_cells_as_show_every_piece() {
    let cells = |environment: &str| profile(environment).units().len();
    let table = |n: usize| {
        let step = TAU / 8.0 / n as f64;
        let knots = (0..=n).map(|i| {
            format!("[{:?}, {}]", i as f64 * step, ((i % n) as f64 * TAU / n as f64).sin())
        });
        format!(
            "delay = 1\nknots = [{}]\nperiod = {:?}\n",
            knots.collect::<Vec<_>>().join(", "),
            TAU / 8.0
        )
    };
    assert_eq!([8, 9, 16, 17, 100].map(|n| cells(&table(n))), [16, 32, 32, 64, 256]);
    assert_eq!(cells(&format!("cells = 64\n{DETENTS}")), 64);
    // A texture of 40 ridges in the range: an eighth of one, in 2.5 rad.
    let texture = shape("texture", "pitch = 0.0625\namplitude = 0.01");
    assert_eq!(cells(&format!("delay = 1\n{STOPS}{texture}")), 512);
}

#[test]
fn a_snap_point_scales_with_the_whole() {
    let stopped = profile(&format!("{STOPS}{DETENTS}snap = 0.75\n"));
    let snap = stopped.snap.unwrap();
    assert_eq!((stopped.torque, stopped.count, snap.snap()), (0.05, 24.0, 0.75));
    assert!((snap.pitch(&stopped.layout()) - TAU / 24.0).abs() < 1e-12);
    let changed = profile(&format!("torque = 0.025\ncount = 12\n{DETENTS}snap = 0.75\n"));
    let (snap, layout) = (changed.snap.unwrap(), changed.layout());
    assert_eq!((snap.torque(&layout), snap.pitch(&layout)), (0.025, TAU / 12.0));
    assert!(profile(DETENTS).snap.is_none());
}

#[test]
fn what_is_written_reads_back_as_the_same_scene() {
    let again = |file: &SceneFile| {
        let written = write::toml(file);
        parse_for(Purpose::Simulate, "b.toml", Format::Toml, &written)
            .unwrap_or_else(|error| panic!("{error}\n{written}"))
    };
    let stops = shape("end_stops", "from = -2.1\nto = 2\nstiffness = 15");
    let more = shape("detents", "count = 8\ntorque = 0.01");
    for environment in [
        DETENTS.to_owned(),
        format!("damping = 0.001\ncells = 128\n{DETENTS}{stops}"),
        format!("torque = 0.3\ncount = 7\ncentre = -0.0\n{DETENTS}"),
        format!("stiffness = 3.0000000000000004\n{DETENTS}{stops}"),
        format!("period = 0.4\n{STOPS}{KNOTS}"),
        format!("{STOPS}{KNOTS}"),
        format!("{STOPS}{KNOTS}{}", shape("magnet", "width = 0.2\ntorque = 0.1")),
        format!("delay = 2\n{}{stops}", shape("table", "knots = [[-1, 0.1], [1, 0.1]]")),
        format!("delay = 0\n{}", shape("bistable", "distance = 0.3\ntorque = 0.1")),
        format!("delay = 0\n{}", shape("centre", "width = 0.3\nstiffness = 0.1")),
        format!("delay = 0\n{STOPS}{}", shape("texture", "pitch = 0.1\namplitude = 0.01")),
        // With a snap point.
        format!("{DETENTS}snap = 0.75\n"),
        format!("{DETENTS}snap = 0.75\ncentre = 0.01\n{stops}"),
        format!("damping = 1e-3\ntorque = 0.2\ncount = 7\n{DETENTS}snap = 0.75\n{more}"),
        // Beside a wall, a canceller, or both.
        format!("residual = 0.018\n{DETENTS}"),
        format!("residual = -0.0\ndamping = 1e-4\n{DETENTS}{stops}"),
        format!("{DETENTS}{stops}{WALL}"),
        format!(
            "torque = 0.03\nresidual = 0.018\n{DETENTS}{stops}{WALL}face = -0.3\none_sided = true\n"
        ),
        format!("residual = 0.02\n{STOPS}{KNOTS}{WALL}filter = 0.3\ndamping = 1e-30\n"),
    ] {
        let file = scene(&environment);
        assert_eq!(again(&file), file, "{environment}");
        // A design changes the scene beside its shapes.
        for parameter in [
            Parameter::ProfileTorque,
            Parameter::Stiffness,
            Parameter::Damping,
            Parameter::Residual,
            Parameter::Count,
        ] {
            let Some(value) = file.scene.get(parameter) else { continue };
            let has_snap = environment.contains("snap");
            // The others need a whole number, or do not repeat.
            if parameter == Parameter::Count && !has_snap {
                continue;
            }
            let value = if has_snap { 2.0 * value } else { value * 0.7 + 1e-5 };
            let scene = file.scene.with(parameter, value).unwrap();
            let changed = SceneFile { scene, ..file.clone() };
            assert_eq!(again(&changed).scene, scene, "{environment}");
        }
    }
    let json = r#"{"name": "knob", "device": {"inertia": 2.2e-5, "damping": 0.022},
        "servo": {"period": 0.001}, "coupling": {"stiffness": 44}, "environment": {"type": "profile",
        "delay": 1, "residual": 0.018, "wall": {"stiffness": 4, "delay": 2},
        "shape": [{"type": "detents", "count": 24, "torque": 0.05},
        {"type": "end_stops", "from": -2.1, "to": 2, "stiffness": 15}]}}"#;
    let toml = scene(&format!("residual = 0.018\n{DETENTS}{stops}{WALL}"));
    assert_eq!(file::parse("knob.json", Format::Json, json).unwrap(), toml);
}

#[test]
fn too_many_knots_are_counted() {
    let many = (0..2049).map(|i| format!("[{i}, 0]")).collect::<Vec<_>>().join(",");
    let said = read(&format!("delay = 1\nknots = [{many}]\n{STOPS}")).unwrap_err().to_string();
    assert!(said.contains("are 2049 knots") && said.contains("2 to 2048"), "{said}");
}

#[test]
fn the_chart_has_a_line_for_each_detent() {
    let snap = DETENTS.replace("0.05", "0.1") + "snap = 0.75\n";
    let stops = shape("end_stops", "from = -2.0\nto = 2.0\nstiffness = 12.0");
    let file = scene(&format!("{snap}{stops}"));
    let curve = ProfileCurve::of(&file.scene).unwrap();
    // Seven detents on either side of the detent at zero are between the end stops.
    assert_eq!(curve.branches.len(), 15);
    let middle = &curve.branches[7];
    let reach = 0.75 * TAU / 24.0;
    for (snap, sign) in middle.snaps.iter().zip([-1.0, 1.0]) {
        assert!((snap[0] - sign * reach).abs() < 1e-9, "{snap:?}");
        assert!((snap[1] - sign * 0.1).abs() < 1e-5, "{snap:?}");
        // A quarter of a pitch on the other side of the next detent's centre.
        assert!((snap[2] + sign * 0.1 * 0.25 / 0.75).abs() < 1e-5, "{snap:?}");
    }
    assert_eq!(curve.branches[0].snaps.len(), 1);
    let line = 0.1 * 24.0 / (TAU * 0.75);
    assert!((curve.rise.slope / (line + 12.0) - 1.0).abs() < 1e-6, "{:?}", curve.rise);
    assert!((curve.certified.unwrap() / 44.0 - 1.0).abs() < 1e-3, "{:?}", curve.certified);
    let alone = ProfileCurve::of(&scene(&snap).scene).unwrap();
    assert!((alone.rise.slope / line - 1.0).abs() < 1e-6, "{:?}", alone.rise);
    assert!((alone.certified.unwrap() / 44.0 - 1.0).abs() < 1e-3, "{:?}", alone.certified);
    assert_eq!(alone.fall.slope, 0.0);
}
