//! `haptic chart` as a process.

use std::path::Path;
use std::process::Output;

use crate::common::{WALL, program};

fn chart(folder: &Path, arguments: &[&str]) -> Output {
    program(&["chart"]).args(arguments).current_dir(folder).output().unwrap()
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write("wall.toml", WALL.to_owned());
    write("late.toml", WALL.replace("delay = 1", "delay = 3").replace("delayed wall", "late"));
    let limited = "[simulation]\nsamples = 50\nvelocity = 20.0\n[limits]\ntorque = 0.1\n";
    write("moving.toml", format!("{WALL}{limited}"));
    let head = WALL.split_once("type").unwrap().0;
    write("free.toml", format!("{head}type = \"free-mode\"\nresidual = 0.001\n"));
    let uncoupled = WALL.replace("[coupling]\nstiffness = 44.0\n", "");
    write("damped.toml", uncoupled.replace("damping = 0.01", "damping = 0.03"));
    folder
}

#[test]
fn every_picture_in_every_format() {
    let folder = folder();
    let pictures: [(&[&str], &[&str]); 6] = [
        (&["nyquist", "wall.toml"], &["critical line", "-delta = -0.022", "-alpha = -0.021"]),
        (
            &["nyquist", "wall.toml", "late.toml", "free.toml"],
            &["1: delayed wall", "2: late", "real part"],
        ),
        (
            &["map", "wall.toml", "--points", "2500"],
            &["stiffness (N m/rad)", "closed form", "scene"],
        ),
        (
            &["limits", "wall.toml"],
            &[
                "sample rate (Hz)",
                "torque ripple",
                "delay 4",
                "1000 Hz",
                "the scene, 22 N m/rad at 1000 Hz",
            ],
        ),
        (
            &["trace", "moving.toml"],
            &["time (s)", "angle (rad)", "velocity (rad/s)", "torque limit, 0.1 N m", "signs: "],
        ),
        (
            &["bode", "wall.toml", "late.toml"],
            &[
                "frequency (Hz)",
                "phase (degrees)",
                "gain margin",
                "phase margin",
                "late, in no hand",
            ],
        ),
    ];
    for (arguments, words) in pictures {
        let run = chart(folder.path(), &[arguments, &["-o", "out.svg"]].concat());
        assert_eq!(run.status.code(), Some(0), "{run:?}");
        let prints = arguments[0] == "bode";
        assert!(run.stdout.is_empty() != prints && run.stderr.is_empty(), "{run:?}");
        let svg = std::fs::read_to_string(folder.path().join("out.svg")).unwrap();
        for word in words {
            assert!(svg.contains(word), "{arguments:?}: {word}");
        }
        // Greys only: red, green and blue are the same in every colour.
        for colour in svg.split("\"#").skip(1).map(|rest| &rest[..6]) {
            assert!(colour[..2] == colour[2..4] && colour[2..4] == colour[4..], "{colour}");
        }
    }
}

#[test]
fn the_numbers_of_every_picture_are_a_table() {
    let folder = folder();
    let tables: [(&[&str], &str, usize); 5] = [
        (&["nyquist", "wall.toml"], "scene,curve,angle (rad),frequency (Hz)", 1000),
        (&["bode", "wall.toml"], "scene,frequency (Hz),gain (1),phase (degrees)", 1000),
        (
            &["map", "wall.toml", "--points", "100"],
            "stiffness (N m/rad),damping (N m s/rad),region",
            100,
        ),
        (&["limits", "wall.toml"], "delay (samples),sample rate (Hz),largest stiffness", 200),
        (&["trace", "moving.toml"], "time,position,velocity,torque,hand,limit", 50),
    ];
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    for (arguments, header, rows) in tables {
        let beside =
            chart(folder.path(), &[arguments, &["-o", "a.svg", "--csv", "b.csv"]].concat());
        assert_eq!(beside.status.code(), Some(0), "{beside:?}");
        let alone = chart(folder.path(), &[arguments, &["-o", "c.CSV"]].concat());
        assert_eq!(alone.status.code(), Some(0), "{alone:?}");
        let table = read("b.csv");
        assert!(table == read("c.CSV") && read("a.svg").contains("<svg"));
        assert!(table.starts_with(header), "{arguments:?}: {}", &table[..100]);
        assert!(table.lines().count() > rows, "{arguments:?}: {}", table.lines().count());
    }
    // A trace draws the table that a trace has written.
    let trace = chart(folder.path(), &["trace", "moving.toml", "-o", "trace.csv"]);
    assert_eq!(trace.status.code(), Some(0), "{trace:?}");
    assert!(svg(folder.path(), &["trace", "trace.csv"]).contains("torque limit"));
    // The curve that is judged, and the line: the certificate's alpha is in the table.
    let run = chart(folder.path(), &["nyquist", "wall.toml", "-o", "n.csv"]);
    assert_eq!(run.status.code(), Some(0));
    let table = read("n.csv");
    let reals =
        table.lines().skip(1).map(|row| row.split(',').nth(4).unwrap().parse::<f64>().unwrap());
    assert!((reals.fold(f64::INFINITY, f64::min) + 0.021).abs() < 1e-9);
}

#[test]
fn axes_end_where_they_are_told_to() {
    let folder = folder();
    let cases: [(&[&str], &str); 6] = [
        (&["nyquist", "wall.toml", "--x=-0.0403..0.01", "--y", "-0.02..0.02"], "-0.04"),
        (&["bode", "wall.toml", "--x", "1..500", "--y", "0.5..20"], "\n1\n"),
        (&["map", "wall.toml", "--points", "100", "--x", "0..777", "--y=0..0.01"], "\n700\n"),
        (&["limits", "wall.toml", "--x", "100..200", "--y", "1..50"], "\n100\n"),
        (&["limits", "wall.toml", "--rates", "100:200"], "\n100\n"),
        (&["trace", "moving.toml", "--x", "0.0005..0.0042", "--y", "-7..7"], "\n0.004\n"),
    ];
    for (arguments, number) in cases {
        let drawn = svg(folder.path(), arguments);
        assert!(drawn.contains(number), "{arguments:?}");
    }
}

#[test]
fn the_ripple_is_that_of_the_scenes_encoder() {
    let folder = folder();
    let step = "[limits]\nencoder_step = 0.00153398\n";
    std::fs::write(folder.path().join("coarse.toml"), format!("{WALL}{step}")).unwrap();
    for (arguments, counts) in [
        (&["limits", "wall.toml"][..], "65536"),
        (&["limits", "coarse.toml"], "4096"),
        (&["limits", "coarse.toml", "--counts-per-rev", "1000"], "1000"),
    ] {
        let note = format!("ripple of half a count of {counts} a turn");
        assert!(svg(folder.path(), arguments).contains(&note), "{arguments:?}");
    }
}

#[test]
fn panels_of_a_tradeoff_are_chosen_by_case_and_error() {
    let folder = folder();
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("pictures/tradeoff");
    let kept = kept.to_str().unwrap();
    let chosen = |more: &[&str]| {
        let common = ["tradeoff", "servo", "--draw-only", "-o", kept, "--picture", "chosen.svg"];
        chart(folder.path(), &[&common, more].concat())
    };
    let run = chosen(&["--case", "damper_wall", "--case", "free_mode", "--error", "cycle"]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let drawn = std::fs::read_to_string(folder.path().join("chosen.svg")).unwrap();
    assert!(drawn.contains("free_mode") && !drawn.contains("delayed_spring"));
    assert!(drawn.contains("limit cycle (rad)") && !drawn.contains("error of the torque"));
    for (more, words) in [
        (
            &["--case", "none"][..],
            "there is no case `none`; there are `delayed_spring`, `damper_wall`",
        ),
        (&["--error", "noise"], "there is no error `noise`; there are `error`, `error_at_1_rad`"),
    ] {
        let run = chosen(more);
        let said = String::from_utf8(run.stderr).unwrap();
        assert!(run.status.code() == Some(2) && said.contains(words), "{said}");
    }
    let nothing = chart(folder.path(), &["tradeoff", "servo", "--draw-only", "-o", "new"]);
    let said = String::from_utf8(nothing.stderr).unwrap();
    let words =
        "new/servo.csv: there is no such table; --draw-only reads the tables from the folder of -o";
    assert!(nothing.status.code() == Some(2) && said.contains(words), "{said}");
    assert!(!folder.path().join("new").exists());
    let all = chart(folder.path(), &["tradeoff", "--draw-only", "-o", kept, "--picture", "a.svg"]);
    assert!(String::from_utf8(all.stderr).unwrap().contains("one chart shows one topic"));
    let alone = chart(folder.path(), &["tradeoff", "servo", "--case", "damper_wall"]);
    assert!(String::from_utf8(alone.stderr).unwrap().contains("--picture"));
}

fn svg(folder: &Path, arguments: &[&str]) -> String {
    let run = chart(folder, &[arguments, &["-o", "picture.svg"]].concat());
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    std::fs::read_to_string(folder.join("picture.svg")).unwrap()
}

#[test]
fn only_a_curve_with_a_pole_on_the_circle_goes_through_infinity() {
    let folder = folder();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    let rational = |polynomials: &str| {
        let head = WALL.split_once("type").unwrap().0;
        format!("{head}type = \"rational\"\n{polynomials}")
    };
    write("pull.toml", WALL.replace("stiffness = 22.0", "stiffness = -5.0"));
    write("tustin.toml", rational("numerator = [20.0, -20.0]\ndenominator = [1.0, 1.0]\n"));
    write("circle.toml", rational("numerator = [1.0, 0.0]\ndenominator = [1.0, -1.2, 1.0]\n"));
    for name in ["wall.toml", "pull.toml", "tustin.toml", "circle.toml"] {
        assert!(svg(folder.path(), &["nyquist", name]).contains("at infinity"), "{name}");
    }
    assert!(!svg(folder.path(), &["nyquist", "free.toml"]).contains("at infinity"));
}

#[test]
fn a_trace_names_the_reasons_that_occur_and_no_others() {
    let folder = folder();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    let rows = ["none", "converter", "converter", "angle", "not-a-number"].iter().enumerate();
    let rows: String =
        rows.map(|(tick, word)| format!("{tick},7,0.{tick},0.5,9,{word}\n")).collect();
    write("run.csv", format!("tick,count,angle,torque,code,limit\n{rows}"));
    let simulation = "[simulation]\nsamples = 50\nvelocity = 1.0\nmissed = { every = 5 }\n";
    write("missing.toml", format!("{WALL}{simulation}"));
    let reasons =
        ["torque limit", "converter limit", "angle out of range", "not a number", "tick missed"];
    let cases: [(&[&str], [bool; 5], &str); 5] = [
        (&["trace", "moving.toml"], [true, false, false, false, false], "time (s)"),
        (&["trace", "missing.toml"], [false, false, false, false, true], "time (s)"),
        (&["trace", "run.csv"], [false, true, true, true, false], "time (ticks)"),
        (&["trace", "run.csv", "--period", "0.001"], [false, true, true, true, false], "time (s)"),
        (&["trace", "run.csv", "--title", "a run"], [false, true, true, true, false], "a run"),
    ];
    for (arguments, named, other) in cases {
        let svg = svg(folder.path(), arguments);
        assert_eq!(reasons.map(|reason| svg.contains(reason)), named, "{arguments:?}");
        assert!(svg.contains(other), "{arguments:?}: {other}");
    }
    // The program also draws the table that it writes.
    let simulated = program(&["simulate", "missing.toml", "--csv"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    write("simulated.csv", String::from_utf8(simulated.stdout).unwrap());
    assert!(svg(folder.path(), &["trace", "simulated.csv"]).contains("tick missed"));
}

#[test]
fn a_line_that_a_trace_does_not_show_is_not_in_its_key() {
    let folder = folder();
    let small = "[simulation]\nsamples = 50\nvelocity = 0.01\n[limits]\ntorque = 0.1\n";
    let text = format!("{WALL}one_sided = true\nface = 9.0\n{small}");
    std::fs::write(folder.path().join("small.toml"), text).unwrap();
    let drawn = svg(folder.path(), &["trace", "small.toml"]);
    for words in ["torque limit, 0.1 N m", "face of the wall, 9 rad"] {
        assert!(drawn.contains(&format!("{words}, outside of the picture")), "{words}");
    }
}

/// Numbers that a file may have and no machine has give a picture, or a sentence that names the number out of
/// range; never an endless computation.
#[test]
fn extreme_numbers_come_to_an_end() {
    let folder = folder();
    let motion = "[simulation]\nsamples = 50\nvelocity = 1.0\n";
    for (from, to) in [
        ("period = 0.001", "period = 5e-324"),
        ("period = 0.001", "period = 1e-300"),
        ("period = 0.001", "period = 1e300"),
        ("inertia = 2.2e-5", "inertia = 5e-324"),
        ("inertia = 2.2e-5", "inertia = 1e300"),
        ("damping = 0.022", "damping = 1e300"),
        ("damping = 0.022", "damping = 1e-300"),
        ("damping = 0.022", "damping = 0.0"),
        ("stiffness = 44.0", "stiffness = 1e300"),
        ("stiffness = 22.0", "stiffness = 1e300"),
    ] {
        let text = format!("{WALL}{motion}").replacen(from, to, 1);
        std::fs::write(folder.path().join("x.toml"), text).unwrap();
        for arguments in [
            &["map", "x.toml", "--points", "100", "-o", "x.svg"][..],
            &["nyquist", "x.toml", "-o", "x.svg"],
            &["limits", "x.toml", "-o", "x.svg"],
            &["trace", "x.toml", "-o", "x.svg"],
            &["bode", "x.toml", "-o", "x.svg"],
        ] {
            let run = chart(folder.path(), arguments);
            let said = String::from_utf8(run.stderr).unwrap();
            let drawn = run.status.code() == Some(0);
            assert!(drawn != said.starts_with("error: "), "{to} {arguments:?}: {said}");
            assert!(!said.contains("panicked") && said.len() < 500, "{to} {arguments:?}: {said}");
        }
    }
    let map = chart(folder.path(), &["map", "wall.toml", "--damping", "0:1e308", "-o", "x.svg"]);
    assert!(
        String::from_utf8(map.stderr).unwrap().contains("is not a range that an axis can show")
    );
}

#[test]
fn what_cannot_be_drawn_is_a_bad_question() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("taken.svg")).unwrap();
    let questions: [(&[&str], &str); 31] = [
        (&["nyquist", "wall.toml", "-o", "a.eps"], "a.eps: the name of a picture must end in"),
        (
            &["nyquist", "wall.toml", "-o", "a.svg", "--csv", "b.txt"],
            "b.txt: the name of a picture's numbers must end in .csv",
        ),
        (
            &["nyquist", "wall.toml", "-o", "b.csv", "--csv", "c.csv"],
            "b.csv has the numbers already; --csv c.csv needs a chart as output",
        ),
        (&["limits", "wall.toml", "-o", "no/b.csv"], "no/b.csv: the numbers cannot be written"),
        (&["nyquist", "wall.toml", "--x", "9..3", "-o", "a.svg"], "9 must be less than 3"),
        (&["nyquist", "wall.toml", "--y", "0..x", "-o", "a.svg"], "`x` is not a number"),
        (&["nyquist", "wall.toml", "--y", "7", "-o", "a.svg"], "two numbers with .. between"),
        (
            &["nyquist", "wall.toml", "--x", "1..1.0000000000001", "-o", "a.svg"],
            "from 1e0 to 1.0000000000001e0 is not a range that an axis can show",
        ),
        (&["bode", "wall.toml", "--x=-1..10", "-o", "a.svg"], "-1 must be above 0"),
        (&["limits", "wall.toml", "--y", "0..10", "-o", "a.svg"], "0 must be above 0"),
        (&["trace", "moving.toml", "--torque-limit", "0", "-o", "a.svg"], "greater than 0"),
        (&["nyquist", "wall.toml", "-o", "picture"], "picture: the name of a picture must end"),
        (&["nyquist", "wall.toml", "-o", "no/a.svg"], "no/a.svg: the picture cannot be written"),
        (&["nyquist", "wall.toml", "-o", "taken.svg"], "taken.svg: the picture cannot be written"),
        (&["nyquist", "none.toml", "-o", "a.svg"], "none.toml"),
        (&["nyquist", "-o", "a.svg"], "FILE"),
        (&["map", "free.toml", "-o", "a.svg"], "a map shows stiffness and damping"),
        (&["map", "wall.toml", "--stiffness", "9:3", "-o", "a.svg"], "9 must be less than 3"),
        (&["map", "wall.toml", "--points", "1", "-o", "a.svg"], "1 is not in 4..=25000000"),
        (&["limits", "damped.toml", "-o", "a.svg"], "no stiffness is certified"),
        (&["limits", "wall.toml", "--rates", "0:10", "-o", "a.svg"], "0 must be above 0"),
        (&["trace", "moving.toml", "--period", "1", "-o", "a.svg"], "has times in seconds"),
        (
            &["trace", "moving.toml", "--x=-5..-1", "-o", "a.svg"],
            "there is nothing to draw from -5 to -1 on the horizontal axis: the data go from 0 to \
             0.05",
        ),
        (&["trace", "moving.toml", "--y=5..7", "-o", "a.svg"], "on the vertical axis"),
        (&["nyquist", "wall.toml", "--x=-5..-1", "-o", "a.svg"], "go from -0.022 to -0.001"),
        (&["nyquist", "free.toml", "--y=5..7", "-o", "a.svg"], "on the vertical axis"),
        (&["bode", "wall.toml", "--x=1e6..1e7", "-o", "a.svg"], "go from 0.005 to 500"),
        (&["bode", "wall.toml", "--y=1e9..1e10", "-o", "a.svg"], "on the vertical axis"),
        (&["limits", "wall.toml", "--y=1e9..1e10", "-o", "a.svg"], "on the vertical axis"),
        (&["trace", "none.csv", "-o", "a.svg"], "none.csv: cannot be read"),
        (&["trace", "wall.toml", "-o", "a.svg"], "a simulation needs a [simulation] table"),
    ];
    for (arguments, words) in questions {
        let run = chart(folder.path(), arguments);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}");
        let said = String::from_utf8(run.stderr).unwrap();
        assert!(said.contains(words), "{arguments:?}: {said}");
        assert!(!folder.path().join("a.svg").exists());
    }
}

#[test]
fn a_range_may_begin_below_zero() {
    let folder = folder();
    let map = ["map", "wall.toml", "--points", "400", "--damping", "-0.01:0.01", "-o", "a.svg"];
    assert_eq!(chart(folder.path(), &map).status.code(), Some(0));
}
