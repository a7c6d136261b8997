//! The simplest sufficient model, and the errors of the others.

use std::path::Path;

use serde::Serialize;

use super::{Deviation, Model, ModelResult, percent};
use crate::file::SceneFile;
use crate::simulation::Experiment;
use crate::studies::error::StudyError;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    /// The name of the scene in the file.
    pub scene: String,
    /// Largest relative error of a number, compared with the fullest model.
    pub bound: f64,
    pub enough: String,
    pub left_out: Vec<String>,
    /// All models, the cheapest first; the last is the fullest.
    pub models: Vec<JudgedModel>,
    /// The reason if there is no certificate to compare.
    pub no_certificate: Option<String>,
    pub message: String,
}

/// A model compared with the fullest model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JudgedModel {
    pub model: String,
    /// Parts of the fullest model that this model omits.
    pub lacks: Vec<String>,
    #[serde(flatten)]
    pub result: ModelResult,
    pub deviation: Deviation,
    /// The deviations beyond the bound; empty if the model is sufficient.
    pub beyond: Vec<String>,
}

/// Compares the models of a file's machine by the file's simulation; `folder` is the folder of its torque
/// file, `bound` the largest relative error of a number, compared with the fullest model.
pub fn advise(file: &SceneFile, folder: &Path, bound: f64) -> Result<Advice, StudyError> {
    let run = Experiment::of(file, folder)?;
    let fullest = Model::fullest(file);
    let full = ModelResult::of(fullest, file, &run)?;
    if full.motion.position.iter().chain(&full.motion.torque).all(|&value| value == 0.0) {
        return Err(StudyError::Rest { scene: file.name.clone() });
    }
    let mut models = Vec::new();
    for model in fullest.up_to() {
        let result =
            if model == fullest { full.clone() } else { ModelResult::of(model, file, &run)? };
        models.push(JudgedModel::of(model, result, (fullest, &full), bound));
    }
    let enough = models.iter().find(|judged| judged.beyond.is_empty());
    let (enough, left_out) = enough.map_or_else(
        || (fullest.to_string(), Vec::new()),
        |it| (it.model.clone(), it.lacks.clone()),
    );
    let message = message(&models, bound);
    let no_certificate = file.chain.as_rigid().err().map(|reason| reason.to_string());
    let scene = file.name.clone();
    Ok(Advice { scene, bound, enough, left_out, models, no_certificate, message })
}

impl JudgedModel {
    fn of(
        model: Model,
        result: ModelResult,
        (fullest, full): (Model, &ModelResult),
        bound: f64,
    ) -> Self {
        let deviation = Deviation::of(&result, full);
        let mut beyond = Vec::new();
        if let (Some(full), Some(found)) = (full.certificate, result.certificate)
            && full != found
        {
            beyond.push(format!("{found} and not {full}"));
        }
        if result.stability != full.stability {
            beyond.push(format!("{} and not {}", result.stability, full.stability));
        }
        let far = deviation.parts().filter(|(_, part)| part.is_nan() || *part > bound);
        beyond.extend(far.map(|(name, part)| match part.is_finite() {
            true => format!("{name} {} off", percent(part)),
            false => format!("{name} not to be compared"),
        }));
        let (model, lacks) = (model.to_string(), model.lacks(fullest));
        Self { model, lacks, result, deviation, beyond }
    }

    /// The text on the errors and the savings of its omissions.
    fn costs(&self, full: &ModelResult) -> String {
        let of = |(name, part)| format!("{} of the {name}", percent(part));
        let off: Vec<String> = self.deviation.parts().map(of).collect();
        let (states, all) = (self.result.states, full.states);
        format!("which costs {}, and leaves {states} states of {all}", off.join(", "))
    }
}

fn message(models: &[JudgedModel], bound: f64) -> String {
    let within = format!("within {}", percent(bound));
    match (models, models.iter().find(|judged| judged.beyond.is_empty())) {
        ([only], _) => format!("{} is all that the file describes", only.model),
        ([.., full], Some(enough)) if !enough.lacks.is_empty() => {
            let (lacks, costs) = (enough.lacks.join(" and "), enough.costs(&full.result));
            format!("{} is enough {within}: it leaves out {lacks}, {costs}", enough.model)
        }
        _ => {
            let without = models.iter().filter(|judged| judged.lacks.len() == 1);
            let without: Vec<_> = without
                .map(|it| format!("without {}: {}", it.lacks.join(""), it.beyond.join(", ")))
                .collect();
            format!("nothing may be left out {within}; {}", without.join("; "))
        }
    }
}
