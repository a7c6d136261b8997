//! Scenes that have no certificate, each for another reason.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::{
    DelayedSpring, FreeMode, ModeTable, ProfileMode, ProfileModes, Shape,
};
use haptic_servo::scene::Scene;
use refusals::scene;

/// Rejected: a spring of twice what a delay of one sample allows, alpha = K T / 2.
const _: Certified<Scene<DelayedSpring<1>>> = scene(DelayedSpring { stiffness: 88.0 }).certified();

/// Ill-posed: an undelayed spring as negative as the coupling is stiff.
const _: Certified<Scene<DelayedSpring<0>>> = scene(DelayedSpring { stiffness: -44.0 }).certified();

/// Undecided: it cancels all of the device's damping.
const _: Certified<Scene<FreeMode<0>>> = scene(FreeMode { residual: 0.0 }).certified();

static LIGHT: ModeTable<16> = ModeTable::of(&[Shape::detents(24, 0.01)]);
static STEEP: ModeTable<16> = ModeTable::of(&[Shape::detents(24, 5.0)]);
static MODES: [ProfileMode; 2] = [LIGHT.named("light"), STEEP.named("steep")];

/// A knob with a mode that is not selected and that is rejected.
const _: Certified<Scene<ProfileModes<1>>> = scene(ProfileModes::of(&MODES)).certified();

fn main() {}
