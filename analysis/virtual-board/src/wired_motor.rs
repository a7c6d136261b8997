//! The motor that the host wires to the board's bridge, as the words of the command line.

use virtual_board::motor::{Motor, Winding};
use virtual_board::power_stage::Supply;

/// The word for a brushed motor, in place of a brushless one's pole pairs.
const BRUSHED: &str = "brushed";

/// Electrical angle in rad of a brushless motor's magnets at the encoder's zero: any, for an alignment to find.
const OFFSET: f64 = 1.0;

/// Error: the words are not a motor.
#[derive(Debug, thiserror::Error)]
#[error("{name} is {word}, not {wanted}")]
pub struct NoMotor {
    name: &'static str,
    word: String,
    wanted: &'static str,
}

/// The motor and its supply, of its winding, resistance, inductance, torque constant and voltage.
pub fn parse([winding, numbers @ ..]: &[String; 5]) -> Result<(Motor, Supply), NoMotor> {
    const NAMES: [&str; 4] = ["resistance", "inductance", "torque constant", "supply"];
    let winding = match (winding.as_str(), winding.parse()) {
        (BRUSHED, _) => Winding::Brushed,
        (_, Ok(pole_pairs @ 1..)) => Winding::Brushless { pole_pairs, offset: OFFSET },
        _ => {
            let (name, wanted) = ("winding", "`brushed` or a number of pole pairs");
            return Err(NoMotor { name, word: winding.clone(), wanted });
        }
    };
    let mut values = [0.0; 4];
    for ((value, word), name) in values.iter_mut().zip(numbers).zip(NAMES) {
        let positive = |number: &f64| *number > 0.0 && number.is_finite();
        let refused = || NoMotor { name, word: word.clone(), wanted: "a positive number" };
        *value = word.parse().ok().filter(positive).ok_or_else(refused)?;
    }
    let [resistance, inductance, torque_constant, volts] = values;
    let motor = Motor::new(winding, resistance, inductance, torque_constant);
    Ok((motor, Supply::stiff(volts)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> [String; 5] {
        let words: Vec<String> = line.split(' ').map(str::to_owned).collect();
        words.try_into().unwrap()
    }

    #[test]
    fn a_motor_is_what_its_words_say() {
        let (motor, supply) = parse(&words("brushed 0.6 1.2e-4 0.29 24")).unwrap();
        assert_eq!(motor, Motor::new(Winding::Brushed, 0.6, 1.2e-4, 0.29));
        assert_eq!(supply, Supply::stiff(24.0));
        let (motor, _) = parse(&words("7 0.3 6e-5 0.05 22.6")).unwrap();
        assert_eq!(motor.winding, Winding::Brushless { pole_pairs: 7, offset: OFFSET });
    }

    #[test]
    fn words_that_are_no_motor_are_named() {
        for (line, parts) in [
            ("0 0.3 6e-5 0.05 24", ["winding is 0", "pole pairs"]),
            ("stepper 0.3 6e-5 0.05 24", ["winding is stepper", "brushed"]),
            ("7 -0.3 6e-5 0.05 24", ["resistance is -0.3", "positive"]),
            ("7 0.3 none 0.05 24", ["inductance is none", "positive"]),
            ("7 0.3 6e-5 NaN 24", ["torque constant is NaN", "positive"]),
            ("7 0.3 6e-5 0.05 inf", ["supply is inf", "positive"]),
        ] {
            let said = parse(&words(line)).unwrap_err().to_string();
            assert!(parts.iter().all(|part| said.contains(part)), "{said}");
        }
    }
}
