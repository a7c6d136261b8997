//! A knob of three modes; a mode that is not selected has steeper detents than the paddle allows.
use haptic_servo::certificate::Certified;
use haptic_servo::environment::{ModeTable, ProfileMode, ProfileModes, Shape};
use haptic_servo::scene::Scene;
use refusals::scene;

static LIGHT: ModeTable<16> = ModeTable::of(&[Shape::detents(24, 0.01)]);
static STEEP: ModeTable<16> = ModeTable::of(&[Shape::detents(24, 5.0)]);
static MODES: [ProfileMode; 3] =
    [LIGHT.named("light"), LIGHT.named("light, too"), STEEP.named("steep")];

const CERTIFIED: Certified<Scene<ProfileModes<1>>> = scene(ProfileModes::of(&MODES)).certified();

fn main() {
    let _ = CERTIFIED;
}
