//! Tests on a real board through a debug probe; `boards.md` has the instructions. Each begins with a reset.
//!
//! First adapt the numbers below to your device.
#![no_std]
#![no_main]

use haptic_servo::board::ProgramMode;
use haptic_servo::board::input_filter::InputFilter;
use haptic_servo::board::stm32::output::Setup;
use haptic_servo::board::stm32::output::dac::present_code;
use haptic_servo::board::stm32::quadrature::Counter;
use haptic_servo::board::stm32::registers::Registers;
use haptic_servo::board::stm32::wiring::{CHIP, ENCODER, TIMER_CLOCK};
use haptic_servo::board::stm32::{init_chip, registers, width};
use haptic_servo::boot::Startup;
use haptic_servo::certificate::Certified;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::Position;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::{OutputMode, Transducers};
use haptic_servo::servo_loop::Hardware;

/// The encoder and the motor.
const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: width(ENCODER),
    full_scale_torque: 2.0,
    largest_speed: 100.0,
};

/// The filter of the encoder's inputs.
const FILTER: InputFilter = InputFilter::of_encoder(&TRANSDUCERS, TIMER_CLOCK);

/// The scene of these tests: that of the program `damper_wall`.
const CERTIFIED: Certified<Scene> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Wall::damped(22.0, 0.01, 1).behind(0.0).alone(),
    latency: Latency::NONE,
    torque_limit: Some(1.0),
}
.certified();

/// The reason of a failure.
type Failure = &'static str;

/// The chip of these tests, in the place where probe-rs looks for it.
#[used]
#[unsafe(no_mangle)]
#[unsafe(link_section = ".probe-rs.chip")]
static PROBE_RS_CHIP: [u8; CHIP.len()] = *CHIP;

/// The board with only its pacing timer running: amplifier off, mid-scale, no watchdog.
fn paced() -> Registers {
    let _ = init_chip(FILTER);
    let mut hardware =
        registers(Setup::DAC, CERTIFIED.scene().timing.period, <ProgramMode as OutputMode>::TIMING);
    hardware.zero_encoder();
    hardware.start(<ProgramMode as OutputMode>::TIMING);
    hardware
}

/// Waits until the next period has begun.
fn next(hardware: &mut Registers) {
    let counts = hardware.period();
    while hardware.time_in_period() < counts {}
    hardware.periods_since_last();
}

/// Waits for this many periods, which are milliseconds.
fn wait(hardware: &mut Registers, periods: u32) {
    for _ in 0..periods {
        next(hardware);
    }
}

/// Follows the encoder.
struct Follower(Position);

impl Follower {
    fn new() -> Self {
        Self(Position::new(TRANSDUCERS.counter))
    }

    fn count(&mut self) -> i64 {
        self.0.update(ENCODER.count());
        self.0.count()
    }
}

/// Codes from mid-scale to full torque.
const MOST: u16 = DacCode::CODES_TO_FULL_SCALE;

#[embedded_test::tests]
mod tests {
    use super::*;

    /// The user turns the handle by hand, once around in the positive direction.
    #[test]
    #[timeout(30)]
    fn a_turn_counts_up_by_the_counts_of_a_turn() -> Result<(), Failure> {
        let (mut hardware, mut encoder) = (paced(), Follower::new());
        let wanted = TRANSDUCERS.counts_per_turn as i64;
        defmt::info!("turn the handle once around, the positive way, within 20 s");
        for _ in 0..20_000 {
            next(&mut hardware);
            encoder.count();
        }
        let count = encoder.count();
        defmt::info!("{} counts, and {} were expected", count, wanted);
        match count {
            0 => Err("the encoder has not moved: is it supplied and connected?"),
            _ if count < 0 => Err("the encoder counts down: swap its channels A and B"),
            // The precision with which a hand returns to the starting point.
            _ if (count - wanted).abs() * 50 > wanted => Err("these are not the counts of a turn"),
            _ => Ok(()),
        }
    }

    /// A code written after an update appears at the next update, and not before.
    #[test]
    fn a_code_appears_at_the_next_update_and_not_before() -> Result<(), Failure> {
        let mut hardware = paced();
        for code in [2048 - MOST, 1024, 2047, 2048, 3072, 2048 + MOST, 2048] {
            next(&mut hardware);
            let before = present_code();
            hardware.write(DacCode::new(code).map_err(|_| "no code")?);
            cortex_m::asm::delay(1000);
            if present_code() != before {
                return Err("a code has appeared within its tick: the DAC is not latched");
            }
            next(&mut hardware);
            cortex_m::asm::delay(1000);
            if present_code() != code {
                return Err(
                    "a code has not appeared at the next update: is the trigger the timer's?",
                );
            }
        }
        Ok(())
    }

    /// Levels to be measured at the torque pin.
    #[test]
    fn levels_to_be_measured_at_the_torque_pin() -> Result<(), Failure> {
        let mut hardware = paced();
        for code in [2048, 2048 - MOST, 1024, 3072, 2048 + MOST] {
            let millivolts = u32::from(code) * 3300 / 4096;
            defmt::info!("for 4 s: code {}, about {} mV with a supply of 3.3 V", code, millivolts);
            hardware.write(DacCode::new(code).map_err(|_| "no code")?);
            wait(&mut hardware, 4000);
        }
        Ok(())
    }

    /// A small torque for at most a tenth of a second must turn the handle in its direction, first one way
    /// and then the other. Otherwise a spring would not push back.
    #[test]
    fn torque_turns_the_handle_its_own_way() -> Result<(), Failure> {
        /// A fiftieth of full scale.
        const LITTLE: u16 = MOST / 50;
        let (mut hardware, mut encoder) = (paced(), Follower::new());
        let enough = TRANSDUCERS.counts_per_turn as i64 / 500;
        for (sign, code) in [(1, 2048 + LITTLE), (-1, 2048 - LITTLE)] {
            let code = DacCode::new(code).map_err(|_| "no code")?;
            let start = encoder.count();
            hardware.write(code);
            hardware.amplifier(true);
            let mut moved = 0;
            for _ in 0..100 {
                next(&mut hardware);
                moved = (encoder.count() - start) * sign;
                if moved.abs() > enough {
                    break;
                }
            }
            hardware.write(DacCode::MID_SCALE);
            hardware.amplifier(false);
            defmt::info!("moved by {} counts the way of the torque", moved);
            if moved < -enough {
                return Err("the motor turns against its torque: swap its leads");
            }
            if moved <= enough {
                return Err("the motor has hardly moved: is the amplifier supplied and enabled?");
            }
            wait(&mut hardware, 500);
        }
        Ok(())
    }
}
