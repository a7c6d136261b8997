//! Tests of a B-G431B-ESC1's bridge before a motor is connected: without a supply, and with a resistor and a coil
//! between two outputs. They are steps of the first power-on in `boards.md`, which has the instructions; those of a
//! brushless motor switch the third output, too. Each begins with a reset, refuses a supply other than that of its
//! step, ends with the gates low, and drives for less than 200 ms.
//!
//! First adapt the numbers below to the load and its supply.
#![no_std]
#![no_main]

use haptic_servo::board::input_filter::InputFilter;
use haptic_servo::board::stm32::output::bridge::load::Load;
use haptic_servo::board::stm32::wiring::{CHIP, ENCODER, TIMER_CLOCK};
use haptic_servo::board::stm32::{init_chip, width};
use haptic_servo::current::{
    B_G431B_ESC1, CurrentLoop, Drive, Duties, Motor, Sample, Supply, TripCodes, Winding,
};
use haptic_servo::servo::Transducers;

/// The load of steps 7 to 9, as the winding of a motor with almost no torque, and its supply in V. Resistor, coil and
/// wires in series: 1 ohm and 0.1 mH.
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

/// The same load with three outputs switched, between any two of them. Resistance and inductance of a phase are half
/// of those between two outputs.
const BETWEEN_ANY: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushless { pole_pairs: 1 },
        resistance: LOAD.motor.resistance / 2.0,
        inductance: LOAD.motor.inductance / 2.0,
        ..LOAD.motor
    },
    ..LOAD
};

/// The load of step 10 and its supply: half of the resistance, between any two outputs.
const TRIPPED: Drive = Drive {
    motor: Motor { resistance: 0.28, inductance: LOAD.motor.inductance, ..BETWEEN_ANY.motor },
    supply: Supply::sinking(14.2, 15.8),
    ..LOAD
};

/// Relative tolerance of resistance and inductance.
const TOLERANCE: f64 = 0.1;

/// The part of the supply between the outputs in step 8, and those of the sweep in step 9 in per cent.
const DUTY: f64 = 0.10;
const SWEEP: core::ops::RangeInclusive<u8> = 10..=40;
const SWEEP_STEP: u8 = 5;

/// The largest duty in step 10, 0.7, in steps of half a per cent.
const TRIP_STEPS: u8 = 140;
const TRIP_STEP: f64 = 0.005;

/// The part of a comparator's current that the last sample before its trip may have: its ripple and the duty's step
/// are below that, an error of the gain on both sides.
const TRIP_PART: core::ops::RangeInclusive<f32> = 0.8..=1.1;

/// Pulses of a gate in step 4, and instants from one to the next.
const PULSES: u32 = 20;
const PAUSE: u32 = 40;

/// The largest count of a supply that is off: 2 V.
const NO_BUS: u16 = (2.0 / B_G431B_ESC1.volts_per_count) as u16;

/// Full scale is 2 A, so that the comparators trip at the least that they can, 9 A. No encoder is read.
const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 4096.0,
    counter: width(ENCODER),
    full_scale_torque: 2.0,
    largest_speed: 1.0,
};

/// Period in s of the servo, which does not run here; as that of the scenes, 40 instants of 25 us.
const PERIOD: f64 = 0.001;
const INSTANT: f64 = PERIOD / 40.0;

/// The modulation, the limits and the scales of the current loops with two and with three outputs. The loops
/// themselves do not run.
static TWO: CurrentLoop = CurrentLoop::checked(&LOAD, &B_G431B_ESC1, &TRANSDUCERS, PERIOD);
static THREE: CurrentLoop = CurrentLoop::checked(&BETWEEN_ANY, &B_G431B_ESC1, &TRANSDUCERS, PERIOD);
static THREE_TRIPPED: CurrentLoop =
    CurrentLoop::checked(&TRIPPED, &B_G431B_ESC1, &TRANSDUCERS, PERIOD);

/// The least and the largest current in A at a duty. In each period of the modulation the dead time takes away
/// twice its part of the supply, up to half more or less.
const fn bounds(duty: f64) -> [f32; 2] {
    let dead = 2.0 * B_G431B_ESC1.dead_time / INSTANT;
    let Drive { motor: Motor { resistance, .. }, supply, .. } = LOAD;
    let least = supply.lowest * (duty - 1.5 * dead) / (resistance * (1.0 + TOLERANCE));
    let most = supply.highest * (duty - 0.5 * dead) / (resistance * (1.0 - TOLERANCE));
    [least as f32, most as f32]
}

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

/// Instants for settling of converters and amplifiers, where samples between two instants belong to the previous
/// instant; and of a current: many time constants of the load.
const SETTLING: u32 = 80;

/// The current in A of a count.
const COUNT: f32 = B_G431B_ESC1.amps_per_count as f32;

/// The current in A that counts as zero: a count of noise, and a count of offset error.
const NONE: f32 = 0.06;

/// A missed instant.
const MISSED: Failure = "no sample has come: the modulation does not run";

const PHASES: [&str; 3] = ["U", "V", "W"];

/// The outputs that a load is between, and whose voltage and current are counted from the first to the second.
type Pair = [usize; 2];
const U_V: Pair = [0, 1];
const SIDES: [&str; 2] = ["high", "low"];

/// A board with its gates low, and the means of the phases without a current.
struct Bench {
    load: Load,
    current_loop: &'static CurrentLoop,
    pair: Pair,
    offsets: [f32; 2],
}

impl Bench {
    /// Checks that the gates are low, the amplifiers' offsets valid, and the supply as stated.
    fn new(current_loop: &'static CurrentLoop, pair: Pair) -> Result<Self, Failure> {
        let mut load = set_up(current_loop)?;
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
        let (lowest, highest) = current_loop.bus_counts();
        if last.bus < lowest {
            return Err(
                "the supply is below the stated voltage: is it on, and is its limit of current too low?",
            );
        }
        if last.bus > highest {
            return Err("the supply is above the stated voltage");
        }
        Ok(Self { load, current_loop, pair, offsets })
    }

    /// Switches the gates on, with no voltage; returns the codes at which the comparators trip.
    fn on(&mut self) -> Result<TripCodes, Failure> {
        let trips = trips(&mut self.load)?;
        self.load.on(trips).ok_or("an instant is missed while the gates are switched on")?;
        Ok(trips)
    }

    /// Sets the part of the supply that is between the outputs; the third output is at half.
    fn set(&mut self, duty: f64) {
        let Duties([high, low, half]) = self.current_loop.duties_at(duty);
        let mut duties = [half; 3];
        (duties[self.pair[0]], duties[self.pair[1]]) = (high, low);
        self.load.set(Duties(duties));
    }

    /// The current in A at a duty, once it has settled.
    fn current_at(&mut self, duty: f64) -> Result<f32, Failure> {
        self.set(duty);
        skip(&mut self.load, SETTLING)?;
        self.current()
    }

    /// The mean of the current in A.
    fn current(&mut self) -> Result<f32, Failure> {
        let (counts, _) = means(&mut self.load)?;
        Ok(self.current_of(counts))
    }

    /// The current in A from one output to the other: half the difference of their currents. W's makes the sum zero.
    fn current_of(&self, counts: [f32; 2]) -> f32 {
        let [u, v] = [counts[0] - self.offsets[0], counts[1] - self.offsets[1]];
        let currents = [u, v, -(u + v)];
        self.current_loop.current_between_two(currents[self.pair[0]] - currents[self.pair[1]])
    }

    /// The current at a duty in both directions, in A without its sign, checked against the load's.
    fn checked_at(&mut self, duty: f64) -> Result<[f32; 2], Failure> {
        let [least, most] = bounds(duty);
        let mut currents = [0.0; 2];
        for (sign, current) in [1.0_f32, -1.0].into_iter().zip(&mut currents) {
            *current = sign * self.current_at(f64::from(sign) * duty)?;
            defmt::info!(
                "at {} % of the supply: {} mA, {} to {} mA are expected",
                (f64::from(sign) * duty * 100.0) as i32,
                (sign * *current * 1e3) as i32,
                (least * 1e3) as i32,
                (most * 1e3) as i32
            );
            if *current < -NONE {
                return Err("the current has the wrong sign: an amplifier reads another phase");
            }
            if *current < least - NONE {
                return Err(
                    "the current is too small: is the load connected, and its resistance as stated?",
                );
            }
            if *current > most + NONE {
                return Err("the current is too large: is the resistance as stated?");
            }
        }
        Ok(currents)
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

/// The chip, with its gates low.
fn set_up(current_loop: &'static CurrentLoop) -> Result<Load, Failure> {
    let _ = init_chip(FILTER);
    let mut load = Load::new(current_loop);
    if load.is_on() || !load.are_gates_low() {
        return Err("a gate is high after the reset: switch the supply off");
    }
    skip(&mut load, SETTLING)?;
    Ok(load)
}

/// The same without a supply at the bridge.
fn without_bus() -> Result<Load, Failure> {
    let mut load = set_up(&THREE_TRIPPED)?;
    check_no_bus(&sample(&mut load)?)?;
    Ok(load)
}

fn check_no_bus(sample: &Sample) -> Result<(), Failure> {
    if sample.bus > NO_BUS {
        return Err("the bridge has a supply of more than 2 V: disconnect it for this step");
    }
    Ok(())
}

/// The codes at which the comparators trip without a current.
fn trips(load: &mut Load) -> Result<TripCodes, Failure> {
    match load.trips().ok_or(MISSED)? {
        Ok(trips) => {
            defmt::info!("without a current the comparators trip at the codes {}", trips);
            Ok(trips)
        }
        Err(fault) => {
            let (_, [phase, code]) = fault.encode();
            defmt::info!("the comparator of phase {}, code {}", PHASES[phase as usize], code);
            Err("an over-current comparator does not trip as a working one does without a current")
        }
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
    let sample = load.next().ok_or(MISSED)?;
    if load.broke() {
        return Err("a comparator has taken the gates away: is the load a short?");
    }
    Ok(sample)
}

fn check_low(load: &Load) -> Result<(), Failure> {
    match !load.is_on() && load.are_gates_low() {
        true => Ok(()),
        false => Err("the gates are not off: switch the supply off"),
    }
}

/// A sweep of the duty: each step adds the same current, by the supply that is measured.
fn sweep(current_loop: &'static CurrentLoop, pair: Pair) -> Result<(), Failure> {
    let mut bench = Bench::new(current_loop, pair)?;
    bench.on()?;
    let part = f64::from(SWEEP_STEP) / 100.0;
    let mut last: Option<[f32; 2]> = None;
    for percent in SWEEP.step_by(SWEEP_STEP.into()) {
        let currents = bench.checked_at(f64::from(percent) / 100.0)?;
        let volts = f64::from(sample(&mut bench.load)?.bus) * B_G431B_ESC1.volts_per_count;
        let step = (volts * part / LOAD.motor.resistance) as f32;
        let is_off = |(now, before): (f32, f32)| {
            (now - before - step).abs() > TOLERANCE as f32 * step + COUNT
        };
        if last.is_some_and(|last| currents.into_iter().zip(last).any(is_off)) {
            return Err(
                "a step of the duty adds another current: resistance or gain is not as stated",
            );
        }
        last = Some(currents);
    }
    bench.load.off();
    bench.check_off()
}

/// All switched outputs are at half, so that no current flows.
fn no_current_at_half(current_loop: &'static CurrentLoop) -> Result<(), Failure> {
    let mut bench = Bench::new(current_loop, U_V)?;
    bench.on()?;
    if bench.current_at(0.0)?.abs() > NONE {
        return Err("a current flows without a voltage: is something connected to an output?");
    }
    bench.load.off();
    bench.check_off()
}

/// A growing current out of one output into another, until the comparator of that one takes the gates away.
fn comparator_trips(from: usize, into: usize) -> Result<(), Failure> {
    let mut bench = Bench::new(&THREE_TRIPPED, [from, into])?;
    let [u, v, w] = bench.on()?;
    let (own, shared) = [(u, [u, u]), (v, [v, w]), (w, [v, w])][into];
    let above = THREE_TRIPPED.trip_threshold(shared) - own;
    let expected = f32::from(above) * THREE_TRIPPED.trip_range().amps_per_code as f32;
    let mut current = 0.0;
    for step in 0..=TRIP_STEPS {
        bench.set(f64::from(step) * TRIP_STEP);
        let sample = bench.load.next().ok_or(MISSED)?;
        if bench.load.broke() {
            check_low(&bench.load)?;
            defmt::info!(
                "phase {} has tripped behind {} mA, {} mA are expected",
                PHASES[into],
                (current * 1e3) as i32,
                (expected * 1e3) as i32
            );
            return match TRIP_PART.contains(&(current / expected)) {
                true => Ok(()),
                false => Err("the comparator trips at another current than its threshold's"),
            };
        }
        current = bench.current_of(sample.currents.map(f32::from));
    }
    Err("no comparator has taken the gates away: is the load between these outputs?")
}

#[embedded_test::tests]
mod tests {
    use super::*;

    /// The input of each gate driver is high in turn, and no other.
    #[test]
    #[timeout(5)]
    fn step_4_each_gate_in_turn_without_a_bus() -> Result<(), Failure> {
        let mut load = without_bus()?;
        for (gate, side, phase) in (0..6).map(|gate| (gate, gate / 3, gate % 3)) {
            defmt::info!("{} of 6: the {} side of {}", gate + 1, SIDES[side], PHASES[phase]);
            for _ in 0..PULSES {
                let (high, last) = load.pulse(phase, side).ok_or(MISSED)?;
                let mut expected = [[false; 2]; 3];
                expected[phase][side] = true;
                if high != expected {
                    return Err("another gate than the named one is high, or that one is low");
                }
                check_no_bus(&last)?;
                for _ in 1..PAUSE {
                    check_no_bus(&sample(&mut load)?)?;
                }
            }
        }
        check_low(&load)
    }

    /// The comparators' ramp.
    #[test]
    #[timeout(5)]
    fn step_5_the_comparators_trip_without_a_current() -> Result<(), Failure> {
        let mut load = without_bus()?;
        trips(&mut load)?;
        check_low(&load)
    }

    #[test]
    #[timeout(5)]
    fn step_7_outputs_at_half_give_no_current() -> Result<(), Failure> {
        no_current_at_half(&TWO)
    }

    #[test]
    #[timeout(5)]
    fn brushless_7_outputs_at_half_give_no_current() -> Result<(), Failure> {
        no_current_at_half(&THREE)
    }

    /// That part of the supply in both directions, and off again.
    #[test]
    #[timeout(5)]
    fn step_8_a_part_of_the_supply_gives_the_current_of_the_load() -> Result<(), Failure> {
        let mut bench = Bench::new(&TWO, U_V)?;
        bench.on()?;
        bench.checked_at(DUTY)?;
        bench.load.off();
        bench.check_off()
    }

    /// A break turns the gates off during a current in the load, and only switching them on again ends it.
    #[test]
    #[timeout(5)]
    fn step_8_a_break_takes_the_gates_away() -> Result<(), Failure> {
        let mut bench = Bench::new(&TWO, U_V)?;
        bench.on()?;
        if bench.current_at(DUTY)? < bounds(DUTY)[0] - NONE {
            return Err("no current flows before the break");
        }
        bench.load.break_now();
        if bench.load.is_on() || !bench.load.are_gates_low() {
            return Err("a break does not take the gates away: switch the supply off");
        }
        if !bench.load.broke() {
            return Err("a break does not say that it was");
        }
        bench.load.set(TWO.duties_at(DUTY));
        bench.load.next().ok_or(MISSED)?;
        if bench.load.is_on() {
            return Err("the gates come back by themselves: switch the supply off");
        }
        bench.load.off();
        Ok(())
    }

    #[test]
    #[timeout(5)]
    fn step_9_a_sweep_of_the_duty_gives_equal_steps() -> Result<(), Failure> {
        sweep(&TWO, U_V)
    }

    #[test]
    #[timeout(5)]
    fn brushless_9_a_sweep_from_v_into_w_gives_equal_steps() -> Result<(), Failure> {
        sweep(&THREE, [1, 2])
    }

    #[test]
    #[timeout(5)]
    fn brushless_9_a_sweep_from_w_into_u_gives_equal_steps() -> Result<(), Failure> {
        sweep(&THREE, [2, 0])
    }

    #[test]
    #[timeout(5)]
    fn step_10_a_current_from_v_into_u_trips() -> Result<(), Failure> {
        comparator_trips(1, 0)
    }

    #[test]
    #[timeout(5)]
    fn step_10_a_current_from_u_into_v_trips() -> Result<(), Failure> {
        comparator_trips(0, 1)
    }

    #[test]
    #[timeout(5)]
    fn step_10_a_current_from_v_into_w_trips() -> Result<(), Failure> {
        comparator_trips(1, 2)
    }
}
