use super::*;
use crate::chain::{Link, Mass};
use crate::file::{Format, parse, write};
use crate::fixture::{file_on_paddle, on_paddle};
use haptic_servo::environment::{Canceller, Environment, Wall};
use haptic_servo::scene::{Latency, TimeRange};
use proptest::prelude::*;

fn scene(environment: Environment) -> Scene {
    on_paddle(environment, Coupling::Rigid)
}

fn passes(scene: &Scene) -> bool {
    Judge::Certificate.passes(scene)
}

fn wall(stiffness: f64, damping: f64, delay: usize) -> Environment {
    Wall::damped(stiffness, damping, delay).alone()
}

fn file(scene: Scene) -> SceneFile {
    let chain = Chain::rigid(scene.device.inertia, scene.device.damping).unwrap();
    let any = "[environment]\ntype = \"delayed-spring\"\nstiffness = 1.0\ndelay = 1\n";
    SceneFile { scene, chain, ..file_on_paddle(any) }
}

/// The scene, written to a file and read back.
fn read(file: &SceneFile) -> Scene {
    let text = write::toml(file);
    parse("designed.toml", Format::Toml, &text)
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .scene
}

fn limit<T>(answer: DesignLimit<T>) -> (f64, T) {
    match answer {
        DesignLimit::Limit(value, scene) => (value, scene),
        _ => panic!("no limit"),
    }
}

fn near(is: f64, should: f64) {
    assert!((is / should - 1.0).abs() < 1e-9, "{is} instead of {should}");
}

fn delayed_spring(stiffness: f64) -> Scene {
    let coupling = Coupling::Spring { stiffness: 1e12 };
    Scene { coupling, ..scene(Wall::spring(stiffness, 1).alone()) }
}

/// For a spring behind `n + eps` samples, nearly rigid: with `e = 1 + 2 n + 2 eps + 2 tau / T`,
/// `K T / delta < (sqrt(e^2 + 4 D) - e) / D`.
#[test]
fn the_longest_latency_and_the_slowest_current_loop_are_those_of_the_closed_form() {
    let kept = Terms { coupling: Choice::Kept, ..Terms::default() };
    let bound = |e: f64, d: f64| 22.0 * ((e * e + 4.0 * d).sqrt() - e) / d;
    let (eps, ratio) = (0.3, 0.4_f64);
    let stiffness = bound(3.0 + 2.0 * eps, eps * (1.0 - eps));
    let (delay, found) = limit(largest(&delayed_spring(stiffness), Quantity::OutputDelay, &kept));
    assert!((delay / (eps * 1e-3) - 1.0).abs() < 1e-6, "{delay}");
    assert!(passes(&found) && read(&file(found)) == found);
    let half = 0.5 / ratio;
    let stiffness = bound(3.0 + 2.0 * ratio, ratio * ratio * (half / half.tanh() - 1.0));
    let (lag, found) = limit(largest(&delayed_spring(stiffness), Quantity::ActuatorLag, &kept));
    assert!((lag / (ratio * 1e-3) - 1.0).abs() < 1e-6, "{lag}");
    assert!(passes(&found) && read(&file(found)) == found);
}

#[test]
fn a_latency_is_at_most_what_a_scene_may_have_and_a_matched_coupling_stays() {
    let kept = Terms { coupling: Choice::Kept, ..Terms::default() };
    let soft = delayed_spring(1e-6);
    assert_eq!(limit(largest(&soft, Quantity::OutputDelay, &kept)).0, 0.008);
    assert_eq!(limit(largest(&soft, Quantity::ActuatorLag, &kept)).0, 0.1);
    let stiff = delayed_spring(23.0);
    assert!(matches!(largest(&stiff, Quantity::OutputDelay, &kept), DesignLimit::Nothing));
    let mut matched = scene(wall(10.0, 0.0, 0));
    matched.coupling = Coupling::Matched;
    let (_, found) = limit(largest(&matched, Quantity::Delay, &Terms::default()));
    assert_eq!(found.coupling, Coupling::Matched);
    let mut lagging = delayed_spring(1.0);
    lagging.latency = Latency::delayed(1e-5);
    assert_eq!(prepared(&lagging, &Terms::default()).coupling, lagging.coupling);
}

/// A delay between two updates of an amplifier is invalid, and the number of updates in a period stays the
/// same.
#[test]
fn an_amplifier_in_updates_keeps_a_delay_of_whole_updates() {
    let kept = Terms { coupling: Choice::Kept, ..Terms::default() };
    let sampled = Scene { latency: Latency::sampled(3, 2e-4, 1e-3), ..delayed_spring(7.5) };
    assert!(passes(&sampled));
    let (delay, found) = limit(largest(&sampled, Quantity::OutputDelay, &kept));
    assert!(passes(&found) && found.latency.output_delay.most == delay);
    assert_eq!(found.latency.nearest_update(1e-3), 3);
    let later = Latency { output_delay: TimeRange::exactly(4e-3 / 3.0), ..sampled.latency };
    assert!(!passes(&Scene { latency: later, ..sampled }));
    let DesignLimit::Limit(longest, scenes) = period(&[file(sampled)], &kept) else { panic!() };
    let scene = scenes[0].scene;
    assert!(longest > 1.1e-3 && passes(&scene));
    assert!((scene.latency.output_delay.most * 3.0 / longest - 1.0).abs() < 1e-9);
    let (lag, found) = limit(largest(&sampled, Quantity::ActuatorLag, &kept));
    assert!(lag > 2e-4 && passes(&found));
}

/// `K T / 2 + B < b` (theory, section 5).
#[test]
fn papers_wall_in_all_directions() {
    let paper = scene(wall(22.0, 0.01, 1));
    let terms = Terms::default();
    near(limit(largest(&paper, Quantity::Stiffness, &terms)).0, 24.0);
    near(limit(largest(&paper, Quantity::Damping, &terms)).0, 0.011);
    assert_eq!(limit(largest(&paper, Quantity::Delay, &terms)).0, 1.0);
    near(limit(device(&[file(paper), file(scene(wall(30.0, 0.0, 1)))], &terms)).0, 0.021);
    near(limit(period(&[file(paper)], &terms)).0, 0.012 / 11.0);
    near(limit(rate(&[file(paper)], &terms)).0, 11.0 / 0.012);
    let careful = Terms { safety: 0.95, ..terms };
    near(limit(largest(&paper, Quantity::Stiffness, &careful)).0, 21.8);
    near(limit(device(&[file(paper)], &careful)).0, 0.021 / 0.95);
    // K T / (2 (1 - K T / (2 b))) < b / 2: a spring whose torque is latched, half of whose updates
    // may be missed.
    let mut missing = scene(wall(22.0, 0.0, 1));
    missing.timing.worst_period = Some(0.002);
    near(limit(largest(&missing, Quantity::Stiffness, &terms)).0, 44.0 / 3.0);
}

#[test]
fn what_has_no_limit_and_what_has_no_such_number() {
    let terms = Terms::default();
    let undelayed = scene(wall(22.0, 0.01, 0));
    let DesignLimit::Unlimited(found) = largest(&undelayed, Quantity::Stiffness, &terms) else {
        panic!("a limit")
    };
    assert!(passes(&read(&file(found))) && found.environment == undelayed.environment);
    // A wall that pulls does not certify as it is, but all that push do.
    let pulling = scene(wall(-5.0, 0.01, 0));
    let DesignLimit::Unlimited(found) = largest(&pulling, Quantity::Stiffness, &terms) else {
        panic!("a limit")
    };
    assert!(passes(&read(&file(found))));
    let free = scene(Canceller::to(0.01).alone());
    assert_eq!(largest(&free, Quantity::Stiffness, &terms), DesignLimit::NoSuchNumber);
    near(limit(largest(&free, Quantity::Cancellation, &terms)).0, 0.022);
    let DesignLimit::Unlimited(found) = period(&[file(free)], &terms) else { panic!("a limit") };
    assert!(passes(&read(&found[0])) && found[0].scene.timing == free.timing);
}

#[test]
fn answers_are_files_that_certify_and_nothing_more_would() {
    for delay in 1..4 {
        let (value, found) = limit(largest(
            &scene(wall(1.0, 0.002, delay)),
            Quantity::Stiffness,
            &Terms { safety: 0.9, ..Terms::default() },
        ));
        assert!(passes(&read(&file(found))));
        let more = Quantity::Stiffness.set(&found, value.next_up()).unwrap();
        assert!(!passes(&more));
    }
}

#[test]
fn border_of_stiffness_and_damping() {
    let points = border(
        &scene(wall(22.0, 0.01, 1)),
        [Quantity::Stiffness, Quantity::Damping],
        5,
        &Terms::default(),
    );
    assert_eq!(points.len(), 5);
    for &(stiffness, damping) in &points[..4] {
        near(stiffness * 0.0005 + damping, 0.022);
    }
}

/// A pole of free mode's environment, `be / (K T + be)` with `K T = 2 b` and `be = b - epsilon`,
/// meets the circle at -1 where `4 b = 2 epsilon`.
#[test]
fn the_border_of_free_mode_is_where_a_pole_meets_the_circle() {
    for residual in [0.001, 0.03, 7.0] {
        let free = scene(Canceller::to(residual).alone());
        let (damping, found) = limit(device(&[file(free)], &Terms::default()));
        assert!(damping > 0.5 * residual);
        assert!((damping / (0.5 * residual) - 1.0).abs() < 1e-12, "{damping} for {residual}");
        assert!(passes(&read(&found[0])));
    }
}

/// Two masses have the passivity `b_1 + b_2 c / (b_2 + c)` (theory, section 3.2), of which a design gives
/// `b_1`.
#[test]
fn a_chain_stays_as_it_is_but_for_its_motor() {
    let masses = [0.02, 0.005].map(|damping| Mass { inertia: 1.1e-5, damping });
    let links = vec![Link { stiffness: 40.0, damping: 0.015 }];
    let chain = Chain::new(masses.to_vec(), links).unwrap();
    let paper = scene(wall(22.0, 0.01, 1));
    let device_of_chain = chain.as_rigid().unwrap();
    let file = SceneFile {
        scene: Scene { device: device_of_chain, ..paper },
        chain: chain.clone(),
        ..file(paper)
    };
    for safety in [1.0, 0.9] {
        let terms = Terms { safety, ..Terms::default() };
        let (damping, found) = limit(device(std::slice::from_ref(&file), &terms));
        near(damping + 0.005 * 0.015 / 0.02, 0.021 / safety);
        assert_eq!(found[0].chain, chain.clone().with_motor_damping(damping).unwrap());
        assert!(passes(&read(&found[0])));
        let less = chain.clone().with_motor_damping(damping.next_down()).unwrap();
        let scene = Scene { device: less.as_rigid().unwrap(), ..file.scene };
        assert!(!passes(&prepared(&scene, &terms)));
    }
    // So soft a spring that the damping of the rest of the chain is enough.
    let soft = Scene { device: device_of_chain, ..scene(wall(1.0, 0.0, 1)) };
    let (damping, found) = limit(device(&[SceneFile { scene: soft, ..file }], &Terms::default()));
    assert!(damping == 0.0 && passes(&read(&found[0])));
}

#[test]
fn a_device_of_which_nothing_is_known_is_designed_too() {
    let mut unknown = scene(wall(22.0, 0.01, 1));
    unknown.device.damping = 0.0;
    near(limit(device(&[file(unknown)], &Terms::default())).0, 0.021);
}

/// A scene as people write them: most of them have a limit, some no board renders.
fn any_scene() -> impl Strategy<Value = Scene> {
    let numbers = (1e-4..2e-2_f64, 1e-3..0.2_f64, 0.0..1.2_f64, 0usize..3, 0.0..1.0_f64);
    let kinds = (0..3, any::<bool>(), any::<bool>(), any::<bool>());
    (numbers, kinds).prop_map(
        |((period, damping, part, delay, lag), (kind, one, limit, filter))| {
            let mut wall = Wall::damped(1.0, part * damping, delay);
            wall = if one { wall.behind(0.1) } else { wall };
            wall = if filter { wall.filtered(0.5) } else { wall };
            let mut scene = scene(wall.alone());
            (scene.timing.period, scene.device.damping) = (period, damping);
            scene.torque_limit = limit.then_some(1.0);
            scene.coupling = match kind {
                0 => Coupling::Rigid,
                1 => Coupling::Spring { stiffness: 2.0 * damping / period },
                _ => Coupling::Matched,
            };
            if lag > 0.5 {
                scene.latency = Latency { output_jitter: 1e-6, ..Latency::delayed(5e-6) };
                scene.latency = scene.latency.with_actuator_lag((lag - 0.5) * period);
            }
            scene
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(100) })]

    #[test]
    fn what_a_design_writes_for_a_board_certifies_on_it(scene in any_scene(), exact in any::<bool>()) {
        let terms = Terms { judge: Judge::BOARD, exact, ..Terms::default() };
        let asked = [file(scene)];
        let of_quantity = |quantity| largest(&scene, quantity, &terms).map(|scene| vec![file(scene)]);
        for found in [
            of_quantity(Quantity::Stiffness),
            of_quantity(Quantity::Damping),
            of_quantity(Quantity::OutputDelay),
            device(&asked, &terms),
            period(&asked, &terms),
            rate(&asked, &terms),
        ] {
            let (_, files) = found.value_and_result();
            for file in files.into_iter().flatten() {
                let report = crate::verdict::judge("designed", &read(file));
                prop_assert_eq!(report.verdict, crate::verdict::Verdict::Certified);
                prop_assert_eq!(report.board, None);
            }
        }
    }
}

#[test]
fn the_stiffest_wall_certifies_is_stiffer_and_more_damping_buys_more() {
    let walls = [
        "[environment]\ntype = \"damper-wall\"\nstiffness = 22\ndamping = 0.01\ndelay = 1\none_sided = true\n",
        "[environment]\ntype = \"damper-wall\"\nstiffness = 9\ndamping = 0.001\ndelay = 1\n[coupling]\nstiffness = 44\n",
    ];
    for wall in walls {
        let file = file_on_paddle(&format!("{wall}[limits]\ntorque = 1.0\n"));
        let terms = Terms { judge: Judge::BOARD, exact: false, ..Terms::default() };
        let search = stiffest::Search::new(&file, &terms).unwrap();
        let found = search.run(|| {}).unwrap();
        let best = found.best;
        assert!(best.felt > 10.0 * crate::felt::stiffness(&file.scene).unwrap(), "{best:?}");
        assert!(found.walls.iter().all(|wall| wall.felt <= best.felt));
        let report = crate::verdict::judge("a", &read(&SceneFile { scene: best.scene, ..file }));
        assert_eq!((report.verdict, report.board), (crate::verdict::Verdict::Certified, None));
        let (_, damped) =
            search.levers().into_iter().find(|(name, _)| name.contains("damping")).unwrap();
        let factor = damped.run(|| {}).unwrap().best.felt / best.felt;
        assert!((1.18..1.22).contains(&factor), "{factor}");
    }
}

/// A device that a board reads by a chip, at the counts or at the updates of its bridge: a reader refuses an age that
/// is not the chip's, and a phase in which its transfer does not end.
#[test]
fn what_a_design_writes_for_a_chip_is_read_again() {
    const DRIVEN: &str = "[supply]\nsinks = true\nlargest_speed = 25\n[motor]\npole_pairs = 7\nresistance = 0.3\ninductance = 1e-4\n\
                          torque_constant = 0.05\nlowest_supply = 20\nhighest_supply = 25.2\n";
    let bridge = "actuator_lag = 1.6e-4\nactuator_updates = 20";
    for (chip, age, bridge, output, driven) in [
        ("mt6701", "[0.0, 1e-5]", "", "", ""),
        ("as5048a", "[5.71e-4, 7.0e-4]", "", "", ""),
        ("as5047p", "[5.6e-4, 6.12e-4]", "", "", ""),
        ("as5048a", "[1.0e-4, 2.3e-4]", bridge, "output_delay = 2.5e-5", DRIVEN),
    ] {
        let text = format!(
            "name = \"a\"\n[device]\ninertia = 3e-5\ndamping = 0.003\npassivity = 0.0029\nfriction = 0.01\n\
             {bridge}\n[servo]\nrate = 2000\n{output}\n[encoder]\nchip = \"{chip}\"\nage = {age}\nnoise = 2\n\
             [environment]\ntype = \"damper-wall\"\nstiffness = 0.8\ndamping = 0.0\ndelay = 1\n\
             [limits]\ntorque = 0.2\nfull_scale = 0.3\n{driven}"
        );
        let file = parse("a.toml", Format::Toml, &text).unwrap_or_else(|error| panic!("{error}"));
        let terms = Terms { judge: Judge::BOARD, exact: false, ..Terms::default() };
        let found = stiffest::Search::new(&file, &terms).unwrap().run(|| {}).unwrap();
        let mut phases = 0;
        for wall in [found.best].into_iter().chain(found.walls) {
            let again = read(&SceneFile { scene: wall.scene, ..file.clone() });
            assert_eq!(again.latency, wall.scene.latency);
            phases += usize::from(again.latency.code_delay(again.timing.period) > 0.0);
        }
        assert!(phases > 0);
        if bridge.is_empty() {
            let (_, slow) = limit(period(std::slice::from_ref(&file), &terms));
            assert!(passes(&read(&slow[0])) && slow[0].scene.timing.period > 5e-4);
        }
    }
}
