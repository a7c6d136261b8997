//! The method of integration and its steps, by name and number.

use haptic_model::simulation::Integration;
use haptic_model::simulation::method::Method;

use crate::refusal::Refusal;

/// Largest number of steps per tick.
const MOST: i64 = 1_000_000;

/// The names of all methods.
pub fn names() -> Vec<&'static str> {
    Method::ALL.map(Method::as_str).to_vec()
}

/// The method and the steps of two arguments.
pub fn integration(method: &str, substeps: i64) -> Result<Integration, Refusal> {
    let found = Method::ALL.into_iter().find(|one| one.as_str() == method);
    let method = found.ok_or_else(|| {
        let bound = format!("it must be one of {}", names().join(", "));
        Refusal::argument("method", &format!("{method:?}"), &bound)
    })?;
    match u32::try_from(substeps) {
        Ok(steps @ 1..) if substeps <= MOST => Ok(Integration { method, substeps: steps }),
        _ => {
            let bound = format!("it must be a whole number from 1 to {MOST}");
            Err(Refusal::argument("substeps", &substeps.to_string(), &bound))
        }
    }
}
