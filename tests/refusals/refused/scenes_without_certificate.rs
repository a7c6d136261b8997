//! Scenes that have no certificate, each for another reason.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::{Canceller, ModeTable, Profile, ProfileMode, Shape, Wall};
use haptic_servo::scene::Scene;
use refusals::{TRANSDUCERS, scene};

/// Rejected: a spring of twice what a delay of one sample allows, alpha = K T / 2.
const _: Certified<Scene> = scene(Wall::spring(88.0, 1).alone()).certified();

/// Ill-posed: an undelayed spring as negative as the coupling is stiff.
const _: Certified<Scene> = scene(Wall::spring(-44.0, 0).alone()).certified();

/// Undecided: it cancels all of the device's damping.
const _: Certified<Scene> = scene(Canceller::to(0.0).alone()).certified();

static LIGHT: ModeTable<16> = ModeTable::of(&[Shape::detents(24, 0.01)]);
static STEEP: ModeTable<16> = ModeTable::of(&[Shape::detents(24, 5.0)]);
static MODES: [ProfileMode; 2] = [LIGHT.named("light"), STEEP.named("steep")];

/// A knob with a mode that is not selected and that is rejected.
const SCENE: Scene = scene(Profile::of_modes(&MODES, 1).alone());
const CERTIFIED: Certified<Scene> = SCENE.certified();

// Its program adds nothing to the refusal.
haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
}
