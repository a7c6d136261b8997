//! Tests of a B-G431B-ESC1's bridge with a resistor and a coil between the outputs 1 and 2, before a motor is
//! connected; `boards.md` has the instructions. Each begins with a reset, ends with the gates low, and drives
//! for less than 50 ms.
//!
//! First adapt the numbers below to the load and its supply.
#![no_std]
#![no_main]

use haptic_servo::board::input_filter::InputFilter;
use haptic_servo::board::stm32::output::bridge::load::Load;
use haptic_servo::board::stm32::wiring::{CHIP, ENCODER, TIMER_CLOCK};
use haptic_servo::board::stm32::{init_chip, width};
use haptic_servo::current::{
    B_G431B_ESC1, CurrentLoop, Drive, DutyCurrent, Motor, Sample, Supply, Winding,
};
use haptic_servo::servo::Transducers;

/// The load, as the winding of a motor with almost no torque, and its supply in V. Resistor, coil and wires
/// in series: 1 ohm and 0.1 mH.
const LOAD: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushed,
        resistance: 1.05,
        inductance: 0.1e-3,
        torque_constant: 1.0,
    },
    supply: Supply::sinking(11.4, 12.6),
    bandwidth: 500.0,
    largest_temperature: 60.0,
};

/// Relative tolerance of resistance and inductance.
const TOLERANCE: f64 = 0.1;

/// The part of the supply between the outputs, in both directions.
const DUTY: f64 = 0.15;

/// Full scale is 2 A, so that the comparators trip at the least that they can, 9 A. No encoder is read.
const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 4096.0,
    counter: width(ENCODER),
    full_scale_torque: 2.0,
    largest_speed: 1.0,
};

/// Period in s of the servo, which does not run here; as that of the scenes, 40 instants of 25 us.
const PERIOD: f64 = 0.001;

/// The modulation, the limits and the scales of the current loop with that load. The loop itself does not run.
static CURRENT_LOOP: CurrentLoop = CurrentLoop::checked(&LOAD, &B_G431B_ESC1, &TRANSDUCERS, PERIOD);

/// The expected reading at that duty.
const EXPECTED: DutyCurrent =
    LOAD.checked_current_at_duty(&B_G431B_ESC1, PERIOD / 40.0, DUTY, TOLERANCE);

/// The filter of the encoder's inputs.
const FILTER: InputFilter = InputFilter::of_encoder(&TRANSDUCERS, TIMER_CLOCK);

/// The chip of these tests, in the place where probe-rs looks for it.
#[used]
#[unsafe(no_mangle)]
#[unsafe(link_section = ".probe-rs.chip")]
static PROBE_RS_CHIP: [u8; CHIP.len()] = *CHIP;

/// The reason of a failure.
type Failure = &'static str;

/// Number of instants in a mean.
const MEASURED: u32 = 256;

/// Instants for settling of converters and amplifiers: samples between two instants belong to the previous
/// instant.
const SETTLING: u32 = 40;

/// The current in A that counts as zero: a count of noise, and a count of offset error.
const NONE: f32 = 0.06;

/// A board with its gates low, and the means of the phases without a current.
struct Bench {
    load: Load,
    offsets: [f32; 2],
}

impl Bench {
    /// Checks that the gates are low, the amplifiers' offsets valid, and the supply as stated.
    fn new() -> Result<Self, Failure> {
        let _ = init_chip(FILTER);
        let mut load = Load::new(&CURRENT_LOOP);
        if load.is_on() || !load.are_gates_low() {
            return Err("a gate is high after the reset: switch the supply off");
        }
        skip(&mut load, SETTLING)?;
        let (offsets, last) = means(&mut load)?;
        defmt::info!(
            "counts without a current: {} and {}, supply: {}",
            offsets[0],
            offsets[1],
            last.bus
        );
        let (lowest, highest) = B_G431B_ESC1.offset_counts;
        let is_offset = |mean: &f32| *mean >= f32::from(lowest) && *mean <= f32::from(highest);
        if !offsets.iter().all(is_offset) {
            return Err("the counts without a current are not those of a working amplifier");
        }
        let (lowest, highest) = CURRENT_LOOP.bus_counts();
        if last.bus < lowest {
            return Err(
                "the supply is below the stated voltage: is it on, and is its limit of current too low?",
            );
        }
        if last.bus > highest {
            return Err("the supply is above the stated voltage");
        }
        Ok(Self { load, offsets })
    }

    /// Switches the gates on, with no voltage.
    fn on(&mut self) -> Result<(), Failure> {
        match self.load.on() {
            Some(Ok(())) => Ok(()),
            Some(Err(_)) => Err(
                "an over-current comparator does not trip as a working one does without a current",
            ),
            None => Err("an instant is missed while the gates are switched on"),
        }
    }

    /// The current in A at a duty, once it has settled.
    fn current_at(&mut self, duty: f64) -> Result<f32, Failure> {
        self.load.set(CURRENT_LOOP.duties_at(duty));
        // One instant until the duty acts.
        skip(&mut self.load, 1 + EXPECTED.settling)?;
        self.current()
    }

    /// The mean of the current in A.
    fn current(&mut self) -> Result<f32, Failure> {
        let ([u, v], _) = means(&mut self.load)?;
        let current =
            CURRENT_LOOP.current_between_two((u - v) - (self.offsets[0] - self.offsets[1]));
        defmt::info!("{} mA", (current * 1e3) as i32);
        Ok(current)
    }

    /// With the gates off, each of them is low, and no current is left.
    fn check_off(&mut self) -> Result<(), Failure> {
        if self.load.is_on() || !self.load.are_gates_low() {
            return Err("the gates are not off: switch the supply off");
        }
        skip(&mut self.load, SETTLING)?;
        match self.current()?.abs() < NONE {
            true => Ok(()),
            false => Err("a current flows with the gates off: switch the supply off"),
        }
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.load.off();
    }
}

/// Lets instants pass.
fn skip(load: &mut Load, instants: u32) -> Result<(), Failure> {
    for _ in 0..instants {
        sample(load)?;
    }
    Ok(())
}

/// The means of the two phases' counts, and the last sample.
fn means(load: &mut Load) -> Result<([f32; 2], Sample), Failure> {
    let mut sums = [0; 2];
    for _ in 1..MEASURED {
        add(&mut sums, &sample(load)?);
    }
    let last = sample(load)?;
    add(&mut sums, &last);
    Ok((sums.map(|sum| sum as f32 / MEASURED as f32), last))
}

fn add(sums: &mut [u32; 2], sample: &Sample) {
    for (sum, count) in sums.iter_mut().zip(sample.currents) {
        *sum += u32::from(count);
    }
}

/// The next sample; fails if gates that were on have been turned off.
fn sample(load: &mut Load) -> Result<Sample, Failure> {
    let sample = load.next().ok_or("no sample has come: the modulation does not run")?;
    if load.broke() {
        return Err("a comparator has taken the gates away: is the load a short?");
    }
    Ok(sample)
}

/// Both outputs are switched at half, so that no current flows.
fn no_duty() -> Result<(), Failure> {
    let mut bench = Bench::new()?;
    bench.on()?;
    if bench.current_at(0.0)?.abs() > NONE {
        return Err("a current flows without a voltage: is something connected to output 3?");
    }
    bench.load.off();
    bench.check_off()
}

/// That part of the supply in both directions, and off again.
fn part_of_the_supply() -> Result<(), Failure> {
    let mut bench = Bench::new()?;
    defmt::info!(
        "{} to {} mA are expected",
        (EXPECTED.least * 1e3) as i32,
        (EXPECTED.most * 1e3) as i32
    );
    bench.on()?;
    for sign in [1.0_f32, -1.0] {
        let current = sign * bench.current_at(f64::from(sign) * DUTY)?;
        if current < -NONE {
            return Err("the current has the wrong sign: an amplifier reads another phase");
        }
        if current < EXPECTED.least as f32 - NONE {
            return Err(
                "the current is too small: is the load connected, and its resistance as stated?",
            );
        }
        if current > EXPECTED.most as f32 + NONE {
            return Err("the current is too large: is the resistance as stated?");
        }
    }
    bench.load.off();
    bench.check_off()
}

/// A break turns the gates off during a current in the load, and only switching them on again ends it.
fn software_break() -> Result<(), Failure> {
    let mut bench = Bench::new()?;
    bench.on()?;
    if bench.current_at(DUTY)? < EXPECTED.least as f32 - NONE {
        return Err("no current flows before the break");
    }
    bench.load.break_now();
    if bench.load.is_on() || !bench.load.are_gates_low() {
        return Err("a break does not take the gates away: switch the supply off");
    }
    if !bench.load.broke() {
        return Err("a break does not say that it was");
    }
    bench.load.set(CURRENT_LOOP.duties_at(DUTY));
    bench.load.next().ok_or("no sample has come: the modulation does not run")?;
    if bench.load.is_on() {
        return Err("the gates come back by themselves: switch the supply off");
    }
    bench.load.off();
    Ok(())
}

#[embedded_test::tests]
mod tests {
    use super::Failure;

    #[test]
    #[timeout(5)]
    fn outputs_at_half_give_no_current() -> Result<(), Failure> {
        super::no_duty()
    }

    #[test]
    #[timeout(5)]
    fn a_part_of_the_supply_gives_the_current_of_the_load() -> Result<(), Failure> {
        super::part_of_the_supply()
    }

    #[test]
    #[timeout(5)]
    fn a_break_takes_the_gates_away() -> Result<(), Failure> {
        super::software_break()
    }
}
