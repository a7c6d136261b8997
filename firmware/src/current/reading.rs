//! Converts the counts of a power stage to the units of its [`PowerReading`].

use super::current_loop::CurrentLoop;
use crate::power_reading::PowerReading;

impl CurrentLoop {
    /// The reading, without an index, from a current in A, the servo's last code by
    /// [`DacCode::offset`](crate::dac::DacCode::offset), and the counts of supply and temperature. For the
    /// host; the current interrupt does not use it.
    pub fn power_reading(
        &self,
        current: f32,
        code_offset: i16,
        (bus, temperature): (u16, u16),
    ) -> PowerReading {
        let reference = self.law.amps_per_code * f32::from(code_offset);
        PowerReading {
            current: nearest_milliamps(current),
            reference: nearest_milliamps(reference),
            // The cast rounds a positive number down.
            voltage: (f32::from(bus) * self.limits.millivolts_per_count + 0.5) as u32,
            temperature: self.limits.thermistor.tenths(temperature),
            index: None,
        }
    }
}

/// The nearest whole number of mA; casts round towards zero.
fn nearest_milliamps(amps: f32) -> i32 {
    let milliamps = amps * 1e3;
    (milliamps + 0.5_f32.copysign(milliamps)) as i32
}

#[cfg(test)]
mod tests {
    use crate::current::tests::BRUSHED;
    use crate::power_reading::PowerReading;

    /// At 25 degrees the thermistor has 10 kΩ: the divider's 4.7/14.7 of 4095 counts are 1309.3.
    const AT_25: u16 = 1309;

    #[test]
    fn counts_become_units() {
        let reading = BRUSHED.power_reading(-0.4124, -1791, (2865, AT_25));
        let PowerReading { current, reference, voltage, temperature, .. } = reading;
        // 2865 counts of 8.4 mV.
        assert_eq!((current, reference, voltage), (-412, -4000, 24_066));
        // Straight lines ten degrees apart are half a degree off at most.
        assert!((temperature - 250).abs() <= 5, "{temperature}");
    }

    #[test]
    fn currents_are_rounded_to_the_nearest() {
        for (amps, milliamps) in [(0.0006, 1), (-0.0006, -1), (0.0004, 0), (-0.0004, 0)] {
            assert_eq!(BRUSHED.power_reading(amps, 0, (2865, AT_25)).current, milliamps);
        }
    }
}
