use haptic_servo::certificate::{
    AssumptionStatus, Assumptions, Parameter, Rejection, assess, certify,
};
use haptic_servo::number::Format as Numbers;
use haptic_servo::scene::{Coupling, Scene};

use crate::design::{DesignLimit, Quantity, Terms, largest};
use crate::file::constant::constants;
use crate::file::{Format, SceneFile, parse, write};
use crate::verdict::{Verdict, judge_file};

/// A scene file with these keys of `[device]`, `[servo]` and `[encoder]`, and further tables.
fn file(device: &str, servo: &str, encoder: &str, rest: &str) -> SceneFile {
    let text = format!(
        "name = \"a\"\n[device]\ninertia = 2.2e-5\n{device}\n[servo]\n{servo}\n[encoder]\n{encoder}\n{rest}"
    );
    parse("a.toml", Format::Toml, &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn spring(delay: usize) -> String {
    format!("[environment]\ntype = \"delayed-spring\"\nstiffness = 1.0\ndelay = {delay}\n")
}

fn near(is: f64, expected: f64) {
    assert!((is / expected - 1.0).abs() < 1e-11, "{is} instead of {expected}");
}

/// The largest stiffness that certifies, of all digits, and its index at the port.
fn stiffest(file: &SceneFile) -> (f64, f64) {
    let terms = Terms { exact: true, ..Terms::KEPT };
    let DesignLimit::Limit(_, scene) = largest(&file.scene, Quantity::Stiffness, &terms) else {
        panic!("no limit: {file:?}");
    };
    let stiffness = scene.get(Parameter::Stiffness).unwrap();
    let report = judge_file(&SceneFile { scene, ..file.clone() }, Numbers::F64);
    assert_eq!(report.verdict, Verdict::Certified);
    (stiffness, report.alpha_port.unwrap().hi.unwrap())
}

/// Largest stiffness of springs read by an encoder, computed independently with 40 digits.
#[test]
fn the_stiffest_springs_are_those_of_an_independent_computation() {
    for (period, delta, delay, servo, encoder, expected) in [
        (1e-3, 0.022, 1, "", "age = [1e-4, 1.1e-4]", 13.537_953_566_6),
        (1e-4, 0.001, 1, "", "age = 1e-4", 4.0),
        (1e-4, 0.001, 0, "output_delay = 2e-5", "age = 5e-6", 12.376_043_070_3),
        (1e-3, 0.022, 1, "", "age = 1e-5\nlag = 6.4e-5", 13.925_990_389_1),
        (1e-4, 0.001, 0, "output_delay = 3e-5", "age = 3e-6\nlag = 1.6e-4", 4.099_300_494_56),
        (1e-3, 0.022, 1, "", "linearity = 0.03", 14.239_482_200_6),
        (1e-4, 0.001, 1, "", "age = [0, 1.1e-4]\nlinearity = 0.056", 3.630_148_497_58),
        (
            1e-3,
            0.022,
            0,
            "output_delay = 5e-6",
            "age = [0, 1e-4]\nlinearity = 0.3",
            26.375_688_507_6,
        ),
        // Two dropped readings in a row are an age of two periods.
        (1e-3, 0.022, 1, "", "dropped = 2", 44.0 / 7.0),
    ] {
        let device = format!("damping = {delta}");
        for limit in ["", "[limits]\ntorque = 1.0\n"] {
            let file = file(
                &device,
                &format!("period = {period}\n{servo}"),
                encoder,
                &format!("{}{limit}", spring(delay)),
            );
            let (stiffness, needed) = stiffest(&file);
            near(stiffness, expected);
            near(needed, delta);
            // One digit more is too much.
            let scene = file.scene.with(Parameter::Stiffness, stiffness * (1.0 + 1e-9)).unwrap();
            assert!(certify(&scene).is_err());
        }
    }
}

/// Indices of damper walls and of springs behind a coupling, computed independently.
#[test]
fn linear_scenes_need_what_an_independent_computation_needs() {
    let wall = |stiffness: f64, damping: f64, delay: usize| {
        format!(
            "[environment]\ntype = \"damper-wall\"\nstiffness = {stiffness:?}\ndamping = {damping:?}\ndelay = {delay}\n"
        )
    };
    let coupled = |stiffness: f64, delay: usize| {
        format!(
            "[coupling]\nstiffness = 44.0\n{}",
            spring(delay).replace("1.0", &format!("{stiffness:?}"))
        )
    };
    for (period, servo, encoder, rest, expected) in [
        (1e-3, "", "age = 1e-4", wall(10.0, 0.004, 1), 0.012_635_019_557_5),
        (1e-3, "output_delay = 5e-6", "age = 1e-4", wall(20.0, 0.002, 0), 0.011_239_515_594_0),
        (1e-4, "", "age = 8.5e-5", wall(3.0, 2e-4, 1), 0.000_529_757_571_059),
        (1e-3, "", "linearity = 0.03", coupled(11.0, 1), 0.011_924),
        (1e-3, "", "linearity = 0.1", coupled(6.0, 2), 0.013_170_900_739_1),
    ] {
        let servo = format!("period = {period}\n{servo}");
        let needed = |damping: f64| {
            let file = file(&format!("damping = {damping:?}"), &servo, encoder, &rest);
            judge_file(&file, Numbers::F64)
        };
        let report = needed(0.022);
        let index = report.alpha_port.unwrap();
        // As tight as the index of any scene that lags.
        assert!((index.lo.unwrap() / expected - 1.0).abs() < 2e-10, "{index:?}");
        assert!((index.hi.unwrap() / expected - 1.0).abs() < 2e-10, "{index:?}");
        assert_eq!(report.verdict, Verdict::Certified);
        let margin = report.margin.unwrap();
        assert!((margin / (0.022 - expected) - 1.0).abs() < 1e-9, "{margin}");
        if encoder.contains("age") {
            assert_eq!(needed(expected * (1.0 + 1e-9)).verdict, Verdict::Certified);
            assert_eq!(needed(expected * (1.0 - 1e-9)).verdict, Verdict::Rejected);
        }
    }
}

/// The stiffest coupling of a wall that is not late, through a nonlinear encoder.
#[test]
fn a_wall_of_any_stiffness_stands_behind_a_soft_enough_coupling() {
    for stiffness in [1.0, 1e6] {
        let scene = |coupling: f64| {
            Scene {
            coupling: Coupling::Spring { stiffness: coupling },
            ..file(
                "damping = 0.022",
                "period = 0.001",
                "linearity = 0.03",
                &format!(
                    "[environment]\ntype = \"damper-wall\"\nstiffness = {stiffness:?}\ndamping = 0.0\ndelay = 0\n\
                     one_sided = true\nface = 0.0\n"
                ),
            )
            .scene
        }
        };
        let passes = |coupling: f64| certify(&scene(coupling)).is_ok();
        assert!(passes(42.718_446_601_9 * (1.0 - 1e-11)));
        assert!(!passes(42.718_446_601_9 * (1.0 + 1e-11)));
    }
}

const KNOB: &str = "[environment]\ntype = \"profile\"\ndelay = 1\n[[environment.shape]]\ntype = \"detents\"\n\
                    count = 8\ntorque = 0.02\n";

#[test]
fn an_endless_profile_needs_friction_beside_a_nonlinear_encoder() {
    let knob = |friction: &str, encoder: &str| {
        file(&format!("damping = 0.022\n{friction}"), "period = 0.001", encoder, KNOB)
    };
    let needed = 0.02 * 0.028 / (1.0 - 0.028);
    for friction in ["", "friction = 0.00057"] {
        let rejection = certify(&knob(friction, "linearity = 0.028").scene).unwrap_err();
        let Rejection::MotorByInl { mean, .. } = rejection else { panic!("{rejection}") };
        near(mean.hi(), needed);
        assert_eq!(rejection.reason(), "motor");
        assert!(rejection.to_string().contains("0.000576"), "{rejection}");
    }
    let holds = judge_file(&knob("friction = 0.00058", "linearity = 0.028"), Numbers::F64);
    assert_eq!(holds.verdict, Verdict::Certified);
    assert!(
        holds
            .assumptions
            .iter()
            .any(|it| it.contains("the device has 0.000577 N m of Coulomb friction"))
    );
    let ideal = judge_file(&knob("", "age = 0.0"), Numbers::F64);
    assert!(
        ideal.assumptions.iter().any(|it| it.contains("as a motor does")),
        "{:?}",
        ideal.assumptions
    );
    // With end stops the profile pushes back.
    let stopped = format!(
        "{KNOB}[[environment.shape]]\ntype = \"end_stops\"\nfrom = -2.0\nto = 2.0\nstiffness = 3.0\n"
    );
    let stopped = file("damping = 0.022", "period = 0.001", "linearity = 0.028", &stopped);
    assert!(certify(&stopped.scene).is_ok());
}

/// Friction that holds the mean torque is not there against the torque errors at rest.
#[test]
fn friction_holds_the_mean_torque_before_it_ends_a_limit_cycle() {
    let rest = |friction: f64| {
        let device = format!("damping = 0.022\nfriction = {friction:?}");
        let encoder = "counts_per_turn = 16384\nlinearity = 0.028\nnoise = 2";
        let full_scale = "[limits]\nfull_scale = 0.1\n";
        let file = file(&device, "period = 0.001", encoder, &format!("{KNOB}{full_scale}"));
        judge_file(&file, Numbers::F64).rest.unwrap()
    };
    let mean = 0.02 * 0.028 / (1.0 - 0.028);
    let hum = rest(mean * 1.001).hum;
    assert!(hum > 1e-4, "{hum}");
    near(rest(1.0).friction_for_rest, mean + hum);
    for (friction, rests) in [(mean.max(hum) * 1.001, false), ((mean + hum) * 1.001, true)] {
        assert_eq!(rest(friction).comes_to_rest, Some(rests), "{friction}");
    }
}

#[test]
fn noise_and_hysteresis_are_steps_of_the_encoder() {
    let at_rest = |encoder: &str| {
        let encoder = format!("counts_per_turn = 16384\n{encoder}");
        let file = file("damping = 0.022", "period = 0.001", &encoder, &spring(1));
        judge_file(&file, Numbers::F64).rest.unwrap().encoder.unwrap()
    };
    let half_a_count = std::f64::consts::PI / 16384.0;
    near(at_rest(""), half_a_count);
    near(at_rest("noise = 2"), 5.0 * half_a_count);
    near(at_rest("noise = 2\nhysteresis = 3"), 8.0 * half_a_count);
}

#[test]
fn dropped_readings_hold_a_torque_that_is_not_of_one_position() {
    let wall =
        "[environment]\ntype = \"damper-wall\"\nstiffness = 3.0\ndamping = 0.001\ndelay = 1\n";
    let read = file("damping = 0.022", "period = 0.001", "dropped = 2", wall).scene;
    assert_eq!(read.timing.worst_period, Some(0.003));
    let mut short = read;
    short.timing.worst_period = None;
    let refused = certify(&short).unwrap_err();
    assert!(refused.to_string().contains("at least 0.003 s"), "{refused}");
    let alone = file("damping = 0.022", "period = 0.001", "dropped = 2", &spring(1)).scene;
    assert_eq!(alone.timing.worst_period, None);
}

#[test]
fn the_assumptions_name_what_is_taken_of_the_encoder() {
    let file = file(
        "damping = 0.022",
        "period = 0.001",
        "age = [0, 1e-5]\nlinearity = 0.03\ndropped = 1",
        &spring(1),
    );
    let assessment = assess(&file.scene);
    let all = Assumptions::of(&file.scene, &assessment, &file.steps());
    let text = all
        .iter()
        .filter(|it| it.standing() == AssumptionStatus::Assumed)
        .map(ToString::to_string)
        .find(|it| it.contains("does not predict"))
        .unwrap();
    for part in
        ["0x3FFE", "between 0 and 0.00001 s old", "at most 0.03 (INL)", "at most 1 in a row"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn what_has_no_proof_is_rejected() {
    let behind = |coupling: &str, environment: &str| {
        let rest = format!("[coupling]\n{coupling}\n{environment}[limits]\ntorque = 1.0\n");
        let device = "damping = 0.022\nfriction = 1.0";
        let scene = file(device, "period = 0.001", "linearity = 0.03", &rest).scene;
        certify(&scene).err().map(|refused| refused.to_string())
    };
    // A late spring behind a soft coupling is proved, and a profile or the matched coupling is not.
    assert_eq!(behind("stiffness = 30.0", &spring(1)), None);
    for (coupling, environment) in
        [("type = \"matched\"", spring(1)), ("stiffness = 30.0", KNOB.to_owned())]
    {
        let refused = behind(coupling, &environment).unwrap();
        assert!(refused.contains("leave the coupling out"), "{refused}");
    }
}

/// The certificate of a constant in a program is that of the file.
#[test]
fn a_file_is_written_with_its_encoder() {
    let first = file(
        "damping = 0.022\nfriction = 0.001",
        "period = 0.001\noutput_delay = 5e-6\ncount_jitter = 1e-6",
        "age = [1e-5, 1.1e-4]\nlinearity = 0.028\nnoise = 2\ncounts_per_turn = 16384",
        KNOB,
    );
    let text = write::toml(&first);
    assert!(text.contains("output_delay = 5e-6\n"), "{text}");
    assert_eq!(parse("b.toml", Format::Toml, &text).unwrap(), first);
    let constants = constants(&first).unwrap();
    let parts = [
        "EncoderReading, Latency, Scene, TimeRange",
        "encoder: &EncoderReading {",
        "age: TimeRange::between(1e-5, 0.00011)",
        "friction: 0.001",
    ];
    assert!(parts.iter().all(|part| constants.contains(part)), "{constants}");
}
