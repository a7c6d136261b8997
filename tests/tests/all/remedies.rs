//! What a rejection advises is true: the scene passes with the number changed as advised, and no
//! much smaller change of that number would have done.

use firmware::certificate::{Parameter, Relation, Remedy, assess, certify};
use firmware::environment::Environment;
use firmware::scene::{Coupling, Scene};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tests::scenes;

/// The scene with one number changed; `None` if it does not have that number.
fn with(scene: &Scene, parameter: Parameter, value: f64) -> Option<Scene> {
    let mut scene = *scene;
    match (parameter, &mut scene.environment) {
        (Parameter::Period, _) => scene.timing.period = value,
        (Parameter::Passivity, _) => scene.device.passivity = Some(value),
        (Parameter::CouplingStiffness, _) => scene.coupling = Coupling::Spring { stiffness: value },
        (Parameter::Residual, Environment::FreeMode { residual, .. })
        | (Parameter::Residual, Environment::FreeModeWall { residual, .. }) => *residual = value,
        (
            Parameter::Stiffness | Parameter::Damping,
            Environment::DelayedSpring(wall)
            | Environment::DamperWall(wall)
            | Environment::FreeModeWall { wall, .. },
        ) if parameter == Parameter::Stiffness => wall.stiffness = value,
        (
            Parameter::Damping,
            Environment::DamperWall(wall) | Environment::FreeModeWall { wall, .. },
        ) => wall.damping = value,
        _ => return None,
    }
    Some(scene)
}

fn passes(scene: &Scene, remedy: &Remedy, value: f64) -> bool {
    let changed = with(scene, remedy.parameter, value)
        .unwrap_or_else(|| panic!("{remedy} names a number that {scene:?} does not have"));
    assess(&changed).outcome.is_ok()
}

#[test]
fn remedies_help() {
    let (mut rejected, mut advised) = (0, 0);
    for seed in 0..1_000 {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let scene = if seed % 2 == 0 { scenes::wall(rng) } else { scenes::free(rng) }.scene;
        let Err(rejection) = certify(&scene) else { continue };
        rejected += 1;
        for remedy in rejection.remedies().iter() {
            advised += 1;
            assert!(passes(&scene, remedy, remedy.value), "seed {seed}: {remedy} does not help");
            let beyond = match remedy.relation {
                Relation::AtMost => remedy.value * 1.03,
                Relation::AtLeast => remedy.value / 1.03,
                Relation::Exactly => continue,
            };
            let first = remedy.parameter == Parameter::Residual;
            assert!(
                first || !passes(&scene, remedy, beyond),
                "seed {seed}: {remedy} asks too much"
            );
        }
    }
    println!("rejected={rejected} remedies={advised}");
    assert!(rejected > 200 && advised > rejected, "{advised} remedies for {rejected} rejections");
}
