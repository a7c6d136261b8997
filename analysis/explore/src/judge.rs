//! The certificate, as in `haptic certify`.

use haptic_model::file::SceneFile;
use haptic_model::remedy_change::{RemedyChange, remedy_changes};
use haptic_model::verdict::{VerdictReport, judge_file, judge_file_without_remedies};
use haptic_model::verdict_text::{details, rows};
use haptic_servo::number::Format;
use serde::Serialize;

use crate::PageResult;
use crate::scene_text::{Wrong, read};

/// A file that cannot be judged.
#[derive(Serialize)]
struct Unreadable {
    error: String,
}

/// A judged scene for the page.
#[derive(Serialize)]
struct Judged {
    report: VerdictReport,
    rows: Vec<(&'static str, String)>,
    remedies: Vec<RemedyChange>,
}

/// The output of `haptic certify --json` for a scene as JSON; `{"error": ..}` if the scene is invalid.
pub fn certify(text: &str, _: &mut Vec<f64>) -> PageResult {
    match read(text) {
        Ok(file) => json(&report(&file)),
        Err(error) => json(&Unreadable { error: error.to_string() }),
    }
}

/// Verdict, numbers, rows of text and remedies of a scene, or its faults.
pub fn judge(text: &str, _: &mut Vec<f64>) -> PageResult {
    judged(text, report)
}

/// The same without remedies, which take long if times are ranges.
pub fn judge_without_remedies(text: &str, _: &mut Vec<f64>) -> PageResult {
    judged(text, judge_file_without_remedies)
}

fn judged(text: &str, report: impl FnOnce(&SceneFile) -> VerdictReport) -> PageResult {
    match read(text) {
        Ok(file) => {
            let report = report(&file);
            let rows = [rows(&report), details(&report)].concat();
            json(&Judged { rows, remedies: remedy_changes(&file, &report), report })
        }
        Err(error) => json(&Wrong::of(&error)),
    }
}

fn report(file: &SceneFile) -> VerdictReport {
    judge_file(file, Format::F64)
}

/// As JSON.
pub fn json(answer: &impl Serialize) -> PageResult {
    serde_json::to_string(answer).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    fn judged(text: &str) -> Value {
        serde_json::from_str(&judge(text, &mut Vec::new()).unwrap()).unwrap()
    }

    #[test]
    fn each_wrong_value_is_named_with_its_key() {
        let text = r#"{"name": "a", "device": {"inertia": "1,5", "damping": 0.02, "actuator_lag": [0, -1]},
            "servo": {}, "environment": {"type": "profile", "delay": 1, "shape": [
            {"type": "detents", "count": 24, "torque": -1}, {"type": "table", "knots": [[0, "a"], [1, 0]]}]},
            "limit": {}}"#;
        let judged = judged(text);
        let keys: Vec<_> =
            judged["errors"].as_array().unwrap().iter().map(|error| error["key"].clone()).collect();
        let expected = [
            "device.inertia",
            "device.actuator_lag[1]",
            "servo.period",
            "environment.shape[0].torque",
            "environment.shape[1].knots[0][1]",
            "limit",
        ];
        assert_eq!(keys, expected.map(Value::from), "{judged}");
        assert!(judged["report"].is_null());
    }

    #[test]
    fn a_rejected_preset_has_its_rows_and_its_remedies() {
        let preset = crate::presets::ALL.last().unwrap();
        let judged = judged(preset.toml);
        let remedies = judged["remedies"].as_array().unwrap();
        let words: Vec<_> = remedies.iter().map(|remedy| remedy["sentence"].clone()).collect();
        assert_eq!(Value::from(words), judged["report"]["remedies"]);
        assert_eq!(remedies[0]["changes"][0][0], "environment.stiffness");
        let rows = judged["rows"].as_array().unwrap();
        assert!(rows.iter().any(|row| row[1] == remedies[0]["sentence"]), "{judged}");
        let quick = judge_without_remedies(preset.toml, &mut Vec::new()).unwrap();
        let quick: Value = serde_json::from_str(&quick).unwrap();
        assert_eq!(quick["remedies"], Value::Array(vec![]));
        for same in
            ["verdict", "rules", "reason", "alpha", "bound", "delta", "theta", "assumptions"]
        {
            assert_eq!(quick["report"][same], judged["report"][same], "{same}");
        }
    }
}
