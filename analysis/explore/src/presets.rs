//! Scenes to start from: those of the programs in `firmware/src/bin`, a knob of bought parts, and a rejected scene.

/// A scene to start from.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Its name on the page.
    pub name: &'static str,
    /// The scene as a file.
    pub toml: &'static str,
}

macro_rules! presets {
    ($($name:literal in $file:literal),* $(,)?) => {
        &[$(Preset { name: $name, toml: include_str!(concat!("presets/", $file)) }),*]
    };
}

/// All values.
pub const ALL: &[Preset] = presets![
    "delayed spring" in "delayed_spring.toml",
    "gimbal knob with MT6701" in "gimbal_knob.toml",
    "damper wall" in "damper_wall.toml",
    "free mode" in "free_mode.toml",
    "knob" in "knob.toml",
    "torque of a host" in "host.toml",
    "undelayed wall behind a lag" in "undelayed_wall.toml",
    "beyond the limit" in "beyond_the_limit.toml",
];

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use haptic_model::file::{Format, parse};
    use haptic_model::verdict::{Verdict, judge_in};

    use super::*;

    #[test]
    fn all_but_the_last_are_certified_and_fit_on_a_board() {
        for (index, preset) in ALL.iter().enumerate() {
            let file = parse(preset.name, Format::Toml, preset.toml);
            let file = file.unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(file.name, preset.name);
            let counts = if preset.name.contains("MT6701") { 16_384.0 } else { 61_440.0 };
            assert_eq!(file.encoder_step, Some(TAU / counts));
            let format = haptic_servo::number::Format::F64;
            let report = judge_in(&file.name, &file.scene, format, &file.steps());
            let is_last = index + 1 == ALL.len();
            let expected = if is_last { Verdict::Rejected } else { Verdict::Certified };
            assert_eq!(report.verdict, expected, "{}: {}", preset.name, report.message);
            assert_eq!(report.remedies.is_empty(), !is_last, "{}", preset.name);
            assert_eq!(report.board, None, "{}", preset.name);
        }
    }
}
