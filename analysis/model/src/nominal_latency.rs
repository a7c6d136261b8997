//! The nominal latency of simulations, responses and curves, for a latency that is known in part: the middle
//! of each time's range, and no jitter. The certificate covers the whole range.

use haptic_servo::scene::{Latency, Scene};

/// The parts of a latency that the model leaves out, as short text; `None` if it is complete.
pub fn left_out(latency: &Latency) -> Option<&'static str> {
    let Latency {
        output_delay,
        output_jitter: _,
        count_jitter: _,
        actuator_lag,
        sensor_lag,
        actuator_response,
        actuator_updates: _,
        encoder: _,
    } = latency;
    let times = [output_delay, actuator_lag, sensor_lag, actuator_response];
    let exact = times.into_iter().all(|time| time.is_exact());
    match (exact, latency.total_jitter() == 0.0) {
        (true, true) => None,
        (true, false) => Some("without jitter"),
        (false, true) => Some("middle of each range of latency"),
        (false, false) => Some("middle of each range of latency, without jitter"),
    }
}

/// The part of a scene that a linear loop of its environment leaves out: the certificate counts on the slopes of the
/// map, and its passivity is then not that of the device. `None` if nothing is left out.
pub fn left_out_of_loop(scene: &Scene) -> Option<&'static str> {
    scene.environment.parts().anticogging.map(|_| "without [anticogging]")
}

/// A title of such a loop, with the part that it leaves out.
pub fn titled_loop(title: &str, scene: &Scene) -> String {
    let words = left_out_of_loop(scene).map_or_else(String::new, |words| format!(" ({words})"));
    titled(title, [&scene.latency]) + &words
}

/// A title that names the parts left out of the latency of one of the scenes.
pub fn titled<'l>(title: &str, latencies: impl IntoIterator<Item = &'l Latency>) -> String {
    // The longest text names the most parts.
    let words = latencies.into_iter().filter_map(left_out).max_by_key(|words| words.len());
    words.map_or_else(|| title.to_owned(), |words| format!("{title} ({words})"))
}

#[cfg(test)]
mod tests {
    use haptic_servo::latency::TimeRange;

    use super::*;

    #[test]
    fn a_title_says_what_is_left_out() {
        let delayed = Latency::delayed(1e-5).with_actuator_lag(5e-5);
        let jitters = Latency { output_jitter: 1e-6, ..delayed };
        let known_in_part = Latency { sensor_lag: TimeRange::between(0.0, 1e-5), ..delayed };
        assert_eq!(titled("wall", [&Latency::NONE, &delayed]), "wall");
        assert_eq!(titled("wall", [&delayed, &jitters]), "wall (without jitter)");
        let middle = "wall (middle of each range of latency)";
        assert_eq!(titled("wall", [&known_in_part]), middle);
        let both = Latency { output_jitter: 1e-6, ..known_in_part };
        assert_eq!(left_out(&both), Some("middle of each range of latency, without jitter"));
    }
}
