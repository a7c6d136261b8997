//! Whether a board renders a certified scene: with its limits on the torque, the time at which it reads a count
//! and puts a torque out, and the number format of its programs.

use haptic_servo::certificate::{Assessment, Resolution, TimingError, assess_in};
use haptic_servo::number::Format;
use haptic_servo::scene::Scene;
use haptic_servo::servo::{BuildError, OutputTiming};

/// The reason why no board renders a certified scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The reason as a sentence.
    pub sentence: String,
    /// Whether a board has the times of the scene, and rejects it with its limits and reading time.
    pub is_rejection: bool,
}

/// Checks that a board renders an assessed and certified scene. A scene that was judged as it was written is
/// checked in the number format of a board's programs, f32.
///
/// # Errors
/// The reason why none does.
pub fn check(
    scene: &Scene,
    assessment: &Assessment,
    resolution: &Resolution,
) -> Result<(), Refusal> {
    if let (Some(limit), Some(full_scale)) = (scene.torque_limit, resolution.full_scale)
        && limit > full_scale
    {
        let sentence = BuildError::TorqueLimit { limit, full_scale }.to_string();
        return Err(Refusal { sentence, is_rejection: true });
    }
    let format = match assessment.format {
        Format::F64 => Format::F32,
        format => format,
    };
    renders(scene, &Assessment { format, ..*assessment })
}

/// Checks an assessed scene in its assessment's number format, with the output timing of a board for it.
///
/// # Errors
/// The reason why no board renders it.
pub fn renders(scene: &Scene, assessment: &Assessment) -> Result<(), Refusal> {
    let timing = OutputTiming::of_delay(scene.latency.code_delay(scene.timing.period));
    assessment.renders_at(scene, timing).map_err(|error| Refusal {
        sentence: error.to_string(),
        is_rejection: !matches!(
            error,
            TimingError::NotLate
                | TimingError::Phase { .. }
                | TimingError::DelayRange { .. }
                | TimingError::PhaseRange { .. }
        ),
    })
}

/// The sentence for a certified scene that has to pass on a board.
pub fn rejected(reason: &str) -> String {
    format!("rejected on a board: {reason}")
}

/// Whether a scene is certified in a number format, and no board rejects it: one may not have its times.
pub fn passes(scene: &Scene, format: Format, resolution: &Resolution) -> bool {
    let assessment = assess_in(scene, format);
    let refusal = || check(scene, &assessment, resolution).err();
    assessment.outcome.is_ok() && refusal().is_none_or(|refusal| !refusal.is_rejection)
}
