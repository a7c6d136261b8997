//! The motor that the host wires to the board's bridge, as the words of the command line.

use virtual_board::motor::{Motor, Winding};
use virtual_board::power_stage::Supply;

/// The word for a brushed motor, in place of a brushless one's pole pairs.
const BRUSHED: &str = "brushed";

/// The word for a supply that takes energy back, in place of a capacitance.
const SINKS: &str = "sinks";

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

/// The motor and its supply, of its winding, resistance, inductance, torque constant, voltage and capacitance.
pub fn parse(
    [winding, numbers @ .., capacitance]: &[String; 6],
) -> Result<(Motor, Supply), NoMotor> {
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
        let refused = || NoMotor { name, word: word.clone(), wanted: "a positive number" };
        *value = positive(word).ok_or_else(refused)?;
    }
    let [resistance, inductance, torque_constant, volts] = values;
    let motor = Motor::new(winding, resistance, inductance, torque_constant);
    let supply = match (capacitance.as_str(), positive(capacitance)) {
        (SINKS, _) => Supply::stiff(volts),
        (_, Some(farads)) => Supply::that_stores(volts, farads),
        _ => {
            let (name, wanted) = ("capacitance", "a positive number of farads, or `sinks`");
            return Err(NoMotor { name, word: capacitance.clone(), wanted });
        }
    };
    Ok((motor, supply))
}

fn positive(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> [String; 6] {
        let words: Vec<String> = line.split(' ').map(str::to_owned).collect();
        words.try_into().unwrap()
    }

    #[test]
    fn a_motor_is_what_its_words_say() {
        let (motor, supply) = parse(&words("brushed 0.6 1.2e-4 0.29 24 sinks")).unwrap();
        assert_eq!(motor, Motor::new(Winding::Brushed, 0.6, 1.2e-4, 0.29));
        assert_eq!(supply, Supply::stiff(24.0));
        let (motor, supply) = parse(&words("7 0.3 6e-5 0.05 22.6 0.001")).unwrap();
        assert_eq!(supply, Supply { volts: 22.6, capacitance: Some(0.001), source: 22.6 });
        assert_eq!(motor.winding, Winding::Brushless { pole_pairs: 7, offset: OFFSET });
    }

    #[test]
    fn words_that_are_no_motor_are_named() {
        for (line, parts) in [
            ("0 0.3 6e-5 0.05 24 sinks", ["winding is 0", "pole pairs"]),
            ("stepper 0.3 6e-5 0.05 24 sinks", ["winding is stepper", "brushed"]),
            ("7 -0.3 6e-5 0.05 24 sinks", ["resistance is -0.3", "positive"]),
            ("7 0.3 none 0.05 24 sinks", ["inductance is none", "positive"]),
            ("7 0.3 6e-5 NaN 24 sinks", ["torque constant is NaN", "positive"]),
            ("7 0.3 6e-5 0.05 inf sinks", ["supply is inf", "positive"]),
            ("7 0.3 6e-5 0.05 24 0", ["capacitance is 0", "sinks"]),
            ("7 0.3 6e-5 0.05 24 -0.001", ["capacitance is -0.001", "positive"]),
            ("7 0.3 6e-5 0.05 24 NaN", ["capacitance is NaN", "farads"]),
            ("7 0.3 6e-5 0.05 24 stiff", ["capacitance is stiff", "sinks"]),
        ] {
            let said = parse(&words(line)).unwrap_err().to_string();
            assert!(parts.iter().all(|part| said.contains(part)), "{said}");
        }
    }
}
