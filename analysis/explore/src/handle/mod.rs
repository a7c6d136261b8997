//! The handle of the page: a scene's servo with a simulated device, in a hand that a person moves.
//!
//! Tick by tick it does what `haptic run` does: the device's angle becomes a count, the servo that is built
//! from the certified scene, in `f32` as on a board, makes a code of it, and the code's torque moves the
//! device ([`HeldDevice`](haptic_model::simulation::held_device::HeldDevice)), exactly over each tick, with
//! the scene's output delay and lags. A board that latches its codes computes each of them a tick before, from
//! the same counts; motor and device see no difference.

mod device_in_hand;
mod oscillation;
mod push;
mod record;
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

/// The most ticks of one call: a page that waited for long goes on from there.
const MOST_TICKS: u32 = 50_000;

thread_local! {
    static HANDLE: RefCell<Option<Simulated>> = const { RefCell::new(None) };
}

/// Takes a scene into the hand, by its `Settings`. Another scene goes on with the device as it moves: its
/// servo settles at the device's angle, while time stands still, and takes over with the next tick. What
/// cannot be read, or has no motion, changes nothing.
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

/// The next ticks, with the hand as `Motion` says. Numbers of each: count, angle in rad by the encoder,
/// coupling torque in N m, code, number of the limit's reason, and set-point and angle of the device in rad
/// at the tick's end. The motor applies the coupling torque's negative.
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

/// Begins the push that shows an environment, in the hand that there is.
pub fn push(_: &str, _: &mut Vec<f64>) -> PageResult {
    with_handle(|handle| {
        handle.push();
        Ok(String::new())
    })
}

/// What the servo did since it was built: the scene's text, and in the numbers a count and a code for each
/// tick, from the first one on.
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

/// The codes that a certified scene's servo makes of counts, as `haptic run --replay` prints them.
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
