//! The table of a motor's learnt cogging, which the servo opposes.

use haptic_servo::environment::{Anticogging, Environment};
use haptic_servo::scene::{EncoderReading, Scene};

use super::faults::Read;
use super::key;
use super::section::Section;

/// Reads `[anticogging]`.
pub fn anticogging(mut section: Section<'_>) -> Read<Anticogging> {
    let torques = section.list(&key::ANTICOGGING_TORQUE);
    let share = section.number(&key::ANTICOGGING_SHARE);
    section.finish();
    let torques = torques?.ok_or_else(|| section.missing(&key::ANTICOGGING_TORQUE))?;
    // A scene refers to it, as to the table of a torque profile.
    let units = Box::leak(vec![0; torques.len()].into_boxed_slice());
    let learnt = Anticogging::learnt(&torques, units);
    let learnt = learnt.map_err(|error| {
        section.conflict(&key::ANTICOGGING_TORQUE, format!("cannot be used: {error}"))
    })?;
    Ok(learnt.sharing(share?))
}

/// The scene beside it, with the friction of the device on which it relies; `full_scale` in N m is the motor's.
pub fn beside(
    top: &Section<'_>,
    scene: Scene,
    anticogging: Anticogging,
    friction: Option<f64>,
    full_scale: Option<f64>,
) -> Read<Scene> {
    if !matches!(scene.environment, Environment::Parts(_)) {
        let reason =
            format!("stands beside a rational `{}`, which no board renders", key::TYPE.path);
        return Err(top.conflict(&key::ANTICOGGING, reason));
    }
    let (torque, limit_key) = (anticogging.largest(), key::TORQUE_LIMIT.path);
    if let Some(full_scale) = full_scale {
        let full_key = key::FULL_SCALE.path;
        let reason = match scene.torque_limit {
            Some(limit) if torque + limit <= full_scale => None,
            Some(limit) => Some(format!(
                "of up to {torque} N m and `{limit_key}` = {limit} N m are together above `{full_key}` = \
                 {full_scale} N m, which would clip their sum"
            )),
            None => Some(format!("needs `{limit_key}`, or the scene takes all of `{full_key}`")),
        };
        if let Some(reason) = reason {
            return Err(top.conflict(&key::ANTICOGGING_TORQUE, reason));
        }
    }
    let friction = friction.unwrap_or(0.0);
    let mut latency = scene.latency;
    if friction != latency.encoder.friction {
        latency.encoder = Box::leak(Box::new(EncoderReading { friction, ..*latency.encoder }));
    }
    Ok(Scene { environment: scene.environment.beside(anticogging), latency, ..scene })
}
