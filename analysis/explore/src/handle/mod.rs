//! The handle of the page: a scene's servo with a simulated device, in a hand that the user moves.
//!
//! Each tick is as in `haptic run`: the device's angle becomes a count, the servo of the certified scene, in
//! `f32` as on a board, computes a code, and the code's torque moves the device
//! ([`HeldDevice`](haptic_model::simulation::held_device::HeldDevice)), exactly over each tick, with the
//! scene's output delay and lags. A board with latched codes computes each code one tick earlier, from the
//! same counts, without a difference for motor and device.

mod hosted;
mod oscillation;
mod push;
mod rim;
mod servo;
mod settings;
mod simulated;
mod unchecked;

#[cfg(test)]
mod tests;

use std::cell::RefCell;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::PageResult;
use crate::judge::json;
use crate::scene_text::read;
use settings::Settings;
use simulated::{Motion, Simulated};

pub use rim::rim;

/// Largest number of ticks of one call; a page that was paused continues from there.
const MOST_TICKS: u32 = 50_000;

thread_local! {
    static HANDLE: RefCell<Option<Simulated>> = const { RefCell::new(None) };
}

/// Holds a scene with its `Settings`. A new scene continues with the moving device: its servo settles at the
/// device's angle, without time passing, and takes over in the next tick. An invalid scene, or one without a
/// motion, changes nothing.
pub fn hold(question: &str, _: &mut Vec<f64>) -> PageResult {
    let settings: Settings = parsed(question)?;
    HANDLE.with_borrow_mut(|handle| {
        match handle.as_mut().filter(|handle| handle.renders(&settings)) {
            Some(handle) => handle.change_hand(settings)?,
            None => *handle = Some(Simulated::new(settings, handle.as_ref())?),
        }
        handle.as_ref().map_or_else(nothing_held, |handle| json(&handle.held()))
    })
}

/// The next ticks, with the hand's `Motion`. Numbers of each: count, angle in rad by the encoder, coupling
/// torque in N m, code, number of the limit's reason, and set-point and angle of the device in rad at the
/// tick's end. The motor applies the coupling torque's negative.
pub fn motion(question: &str, numbers: &mut Vec<f64>) -> PageResult {
    let motion: Motion = parsed(question)?;
    if motion.ticks > MOST_TICKS {
        return Err(format!(
            "{} ticks are too many at once; the most is {MOST_TICKS}",
            motion.ticks
        ));
    }
    if !motion.setpoint.is_finite() {
        return Err("the hand's set-point must be a finite angle in rad".to_owned());
    }
    with_handle(|handle| json(&handle.run(&motion, numbers)))
}

/// Begins the push that demonstrates an environment, in the present hand.
pub fn push(_: &str, _: &mut Vec<f64>) -> PageResult {
    with_handle(|handle| {
        handle.push();
        Ok(String::new())
    })
}

/// The record of the servo since it was built: the scene's text, and in the numbers a count and a code for
/// each tick.
pub fn recorded(_: &str, numbers: &mut Vec<f64>) -> PageResult {
    with_handle(|handle| {
        handle.recorded(numbers);
        Ok(handle.scene_text().to_owned())
    })
}

/// Counts for the servo of a scene.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Recording {
    /// Text of the scene.
    scene: String,
    counts_per_turn: Option<f64>,
    counts: Vec<i32>,
}

/// The codes of a certified scene's servo for counts, as printed by `haptic run --replay`.
pub fn replay(question: &str, numbers: &mut Vec<f64>) -> PageResult {
    let recording: Recording = parsed(question)?;
    let file = read(&recording.scene).map_err(|error| error.to_string())?;
    let mut servo = servo::certified(&file, &file.transducers(recording.counts_per_turn, None))?;
    numbers.extend(recording.counts.iter().map(|&count| f64::from(servo.tick(count).code)));
    Ok(String::new())
}

fn parsed<T: DeserializeOwned>(question: &str) -> Result<T, String> {
    serde_json::from_str(question).map_err(|error| error.to_string())
}

fn with_handle(answer: impl FnOnce(&mut Simulated) -> PageResult) -> PageResult {
    HANDLE.with_borrow_mut(|handle| handle.as_mut().map_or_else(nothing_held, answer))
}

fn nothing_held() -> PageResult {
    Err("no scene is in the hand".to_owned())
}
