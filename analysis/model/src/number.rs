//! Number formats by name, and the numbers of a scene that do not fit them.

use haptic_servo::number::{Format, OutOfRange};
use haptic_servo::parameter::Parameter;
use haptic_servo::scene::Scene;
use thiserror::Error;

/// The format of a name such as `f32`, `f64`, `i8f24`, `i8f24-truncated` or `q8.24`.
///
/// # Errors
/// A sentence that describes the valid names.
pub fn format(name: &str) -> Result<Format, String> {
    let lower = name.to_ascii_lowercase();
    if let Some(rounded) = lower.strip_suffix("-truncated") {
        return match format(rounded)? {
            Format::Fixed { fraction_bits } => Ok(Format::Truncated { fraction_bits }),
            _ => {
                Err("only a fixed-point format can be truncated, such as i8f24-truncated"
                    .to_owned())
            }
        };
    }
    match lower.as_str() {
        "f32" => return Ok(Format::F32),
        "f64" => return Ok(Format::F64),
        _ => (),
    }
    let parts = match lower.strip_prefix('q') {
        Some(parts) => parts.split_once('.'),
        None => lower.strip_prefix('i').and_then(|parts| parts.split_once('f')),
    };
    let whole = |digits: &str| digits.parse::<u32>().ok().filter(|&bits| bits <= 32);
    match parts.map(|(before, behind)| (whole(before), whole(behind))) {
        Some((Some(before), Some(fraction_bits))) if before + fraction_bits == 32 => {
            Ok(Format::Fixed { fraction_bits })
        }
        _ => Err("it must be f32, f64, or 32-bit fixed point, such as i8f24 or i16f16".to_owned()),
    }
}

/// A number of a scene that a format does not hold.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("`{key}`: {reason}")]
pub struct DoesNotFit {
    /// Its key in a file.
    pub key: &'static str,
    /// Value, bound and format.
    pub reason: OutOfRange,
}

/// Whether a format holds a scene's angles and torques. Its coefficients are checked by their certificate:
/// where the format does not hold them, they stay as they were written.
///
/// # Errors
/// The first number that it does not hold.
pub fn fits(scene: &Scene, format: Format) -> Result<(), DoesNotFit> {
    let (Format::Fixed { fraction_bits } | Format::Truncated { fraction_bits }) = format else {
        return Ok(());
    };
    let bound = f64::from(i32::MAX) / (1_u64 << fraction_bits) as f64;
    for parameter in [Parameter::Face, Parameter::TorqueLimit] {
        let (key, value) = (parameter.key(), scene.get(parameter).unwrap_or(0.0));
        if value.abs() > bound {
            return Err(DoesNotFit { key, reason: OutOfRange { value, bound, format } });
        }
    }
    Ok(())
}
