//! The torque that the hand applies over time, besides its impedance.

use std::f64::consts::TAU;
use std::path::Path;

use super::error::SimulationError;
use crate::file::simulation::HandTorque;

/// Torque of the hand in N m, positive in the direction of the angle.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum TorqueSignal {
    /// None.
    #[default]
    Free,
    /// One value a sample, held over it; none after the last.
    Held(Vec<f64>),
    /// `amplitude * sin(omega t + phase)`, continuous in time.
    Sine {
        /// Amplitude in N m.
        amplitude: f64,
        /// Angular frequency in rad/s.
        omega: f64,
        /// Phase in rad at sample 0.
        phase: f64,
    },
}

impl TorqueSignal {
    /// The torque of a scene file over `samples` samples of `period` (s); a torque file is read from
    /// `folder`.
    ///
    /// # Errors
    /// If the torque file cannot be read, or contains a value that is not a finite number.
    pub fn load(
        torque: &HandTorque,
        folder: &Path,
        samples: usize,
        period: f64,
    ) -> Result<Self, SimulationError> {
        Ok(match torque {
            HandTorque::Free => Self::Free,
            HandTorque::Held(torque) => Self::Held(torque.clone()),
            HandTorque::File(name) => Self::Held(read(&folder.join(name))?),
            &HandTorque::Sine { amplitude, omega, phase, held } => {
                let sine = Self::Sine { amplitude, omega, phase };
                let sampled = || (0..samples).map(|k| sine.sine(k, period)[0]).collect();
                if held { Self::Held(sampled()) } else { sine }
            }
            &HandTorque::Pulses { amplitude, every, length } => {
                let pulse = |k: usize| if k % every < length { amplitude } else { 0.0 };
                Self::Held((0..samples).map(pulse).collect())
            }
        })
    }

    /// Angular frequency in rad/s; zero where there is no sine.
    pub fn omega(&self) -> f64 {
        if let Self::Sine { omega, .. } = self { *omega } else { 0.0 }
    }

    /// The torque in N m that is held over sample `k`.
    #[inline]
    pub fn held(&self, k: usize) -> f64 {
        match self {
            Self::Held(torque) => torque.get(k).copied().unwrap_or(0.0),
            _ => 0.0,
        }
    }

    /// Sine torque in N m at sample `k`, and the cosine of the same amplitude.
    ///
    /// The angle is summed in two parts: after a thousand samples the rounding of one would be
    /// the largest error of the whole simulation.
    pub fn sine(&self, k: usize, period: f64) -> [f64; 2] {
        let &Self::Sine { amplitude, omega, phase } = self else { return [0.0; 2] };
        let advance = omega * period;
        let lost = omega.mul_add(period, -advance);
        let k = k as f64;
        let angle = k * advance;
        let rest = k.mul_add(advance, -angle) + k * lost;
        let (s, c) = (angle % TAU).sin_cos();
        // Remainder with the digits of 2 pi that f64 leaves out.
        let turns = (angle / TAU).trunc();
        let small = rest - turns * TAU_REST + phase;
        let (ds, dc) = small.sin_cos();
        [amplitude * (s * dc + c * ds), amplitude * (c * dc - s * ds)]
    }
}

/// The difference between 2 pi and `TAU`.
const TAU_REST: f64 = 2.449_293_598_294_706_4e-16;

/// Numbers separated by commas, semicolons, spaces or lines; `#` begins a comment.
fn read(path: &Path) -> Result<Vec<f64>, SimulationError> {
    let file = path.display().to_string();
    let unreadable = |error| format!("cannot read the torque file {file}: {error}");
    let bytes =
        std::fs::read(path).map_err(|error| SimulationError::TorqueFile(unreadable(error)))?;
    let text = crate::file::text_of(&file, 1, &bytes)
        .map_err(|error| SimulationError::TorqueFile(error.to_string()))?;
    // Spreadsheets begin their files with a byte order mark.
    let text = text.trim_start_matches('\u{feff}');
    let mut torque = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let data = line.split('#').next().unwrap_or_default();
        let apart = |c: char| c == ',' || c == ';' || c.is_whitespace();
        for word in data.split(apart).filter(|word| !word.is_empty()) {
            match word.parse::<f64>() {
                Ok(value) if value.is_finite() => torque.push(value),
                _ => {
                    let (line, value) = (index + 1, crate::file::excerpt(word));
                    return Err(SimulationError::TorqueFile(format!(
                        "{file}:{line}: `{value}` is out of bounds; it must be a finite number in N m"
                    )));
                }
            }
        }
    }
    Ok(torque)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_keeps_its_phase() {
        let hand_torque = TorqueSignal::Sine { amplitude: 2.0, omega: 1024.0, phase: 0.25 };
        // 1024 / 1024 rad a sample: sample k is at the angle k + 1/4 exactly.
        for k in [0, 1, 7, 1000, 123_456] {
            let [s, c] = hand_torque.sine(k, 1.0 / 1024.0);
            let (es, ec) = (k as f64 + 0.25).sin_cos();
            assert!((s - 2.0 * es).abs() < 1e-15 && (c - 2.0 * ec).abs() < 1e-15, "{k}");
        }
    }

    #[test]
    fn held_sines_and_pulses_are_values_a_sample() {
        let load = |torque| TorqueSignal::load(&torque, Path::new(""), 6, 0.001).unwrap();
        let pulses = load(HandTorque::Pulses { amplitude: 0.5, every: 3, length: 2 });
        assert_eq!(pulses, TorqueSignal::Held(vec![0.5, 0.5, 0.0, 0.5, 0.5, 0.0]));
        let sine = |held| HandTorque::Sine { amplitude: 2.0, omega: 100.0, phase: 0.25, held };
        for k in 0..6 {
            let wanted = 2.0 * (0.1 * k as f64 + 0.25).sin();
            assert!((load(sine(true)).held(k) - wanted).abs() < 1e-14);
            assert_eq!(load(sine(false)).held(k), 0.0);
        }
    }

    #[test]
    fn torque_files_name_what_is_no_number() {
        let folder = tempfile::tempdir().unwrap();
        let good = folder.path().join("push.csv");
        std::fs::write(&good, "# N m\n0.1, -0.2\n\n3e-1\n").unwrap();
        assert_eq!(read(&good).unwrap(), [0.1, -0.2, 0.3]);
        let bad = folder.path().join("bad.csv");
        std::fs::write(&bad, "0.1\nten\n").unwrap();
        let message = read(&bad).unwrap_err().to_string();
        assert!(message.contains("bad.csv:2") && message.contains("ten"), "{message}");
        std::fs::write(&bad, b"\xef\xbb\xbf0.1\r\n0.2").unwrap();
        assert_eq!(read(&bad).unwrap(), [0.1, 0.2]);
        std::fs::write(&bad, b"0.1\n\xff\n").unwrap();
        let message = read(&bad).unwrap_err().to_string();
        assert!(message.contains("bad.csv:2:1") && message.contains("UTF-8"), "{message}");
    }
}
