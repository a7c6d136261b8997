//! Scenes to start from: those of the programs in `firmware/src/bin`, and a rejected scene.

/// A scene to start from.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Its name on the page.
    pub name: &'static str,
    /// The scene as a file.
    pub toml: &'static str,
}

macro_rules! scene {
    ($name:literal, $($part:expr),*) => {
        Preset { name: $name, toml: concat!("name = \"", $name, "\"\n", $($part),*) }
    };
}

/// The paddle of the paper's examples, at 1 kHz.
macro_rules! paddle {
    () => {
        "[device]\ninertia = 2.2e-5\ndamping = 0.022\n[servo]\nperiod = 0.001\n"
    };
}

/// The standard coupling of the paddle, `2 delta / T`.
macro_rules! spring {
    () => {
        "[coupling]\nstiffness = 44.0\n"
    };
}

/// The paddle's encoder of 61440 counts a turn, and its motor.
macro_rules! steps {
    () => {
        "encoder_step = 1.0226538585904274e-4\nfull_scale = 2.0\n"
    };
}

/// All values.
pub const ALL: &[Preset] = &[
    scene!(
        "delayed spring",
        paddle!(),
        spring!(),
        "[environment]\ntype = \"delayed-spring\"\nstiffness = 22.0\ndelay = 1\n[limits]\ntorque = 1.0\n",
        steps!()
    ),
    scene!(
        "damper wall",
        paddle!(),
        spring!(),
        "[environment]\ntype = \"damper-wall\"\nstiffness = 22.0\ndamping = 0.01\ndelay = 1\n\
         one_sided = true\n[limits]\ntorque = 1.0\n",
        steps!()
    ),
    scene!(
        "free mode",
        paddle!(),
        spring!(),
        "[environment]\ntype = \"free-mode\"\nresidual = 0.001\ndelay = 1\n[limits]\n\
         encoder_step = 1.0226538585904274e-4\nfull_scale = 0.25\n"
    ),
    scene!(
        "knob",
        paddle!(),
        spring!(),
        "[environment]\ntype = \"profile\"\ndelay = 1\n[[environment.shape]]\ntype = \"detents\"\n\
         count = 24\ntorque = 0.05\n[[environment.shape]]\ntype = \"end_stops\"\nfrom = -2.618\n\
         to = 2.618\nstiffness = 15.0\n[limits]\ntorque = 1.0\n",
        steps!()
    ),
    scene!(
        "undelayed wall behind a lag",
        "[device]\ninertia = 2.2e-5\ndamping = 0.022\nactuator_lag = 5.3e-5\n[servo]\nperiod = 0.001\n\
         output_delay = 1.0e-5\noutput_jitter = 1.0e-6\n[coupling]\ntype = \"matched\"\n[environment]\n\
         type = \"free-mode-wall\"\nresidual = 0.004\nstiffness = 22.0\ndamping = 0.01\ndelay = 0\n\
         one_sided = true\n[limits]\ntorque = 1.0\n",
        steps!()
    ),
    scene!(
        "beyond the limit",
        paddle!(),
        spring!(),
        "[environment]\ntype = \"damper-wall\"\nstiffness = 60.0\ndamping = 0.01\ndelay = 1\n\
         one_sided = true\n[limits]\ntorque = 1.0\n",
        steps!()
    ),
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
            assert_eq!(file.encoder_step, Some(TAU / 61_440.0));
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
