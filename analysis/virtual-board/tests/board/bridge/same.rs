//! The current controller on the board against the same on the host, bit for bit, with the samples that the board's
//! interrupt has read.

use haptic_servo::current::{CurrentController, Sample};
use haptic_servo::encoder::RawCount;
use virtual_board::board::BusAccess;
use virtual_board::chip::TICK_INTERRUPT;

use super::bench::{armed, boot, code, take_accesses};
use super::bridge_wall::CURRENT_LOOP;
use super::paddle::paddle;
use crate::bench::MID_SCALE;

/// Registers of the current interrupt.
const COUNT: u32 = 0x4000_0840;
const BREAK_CONTROL: u32 = 0x4001_2C44;
const MAIN_OUTPUT: u32 = 1 << 15;
const COMPARE: [u32; 3] = [0x4001_2C34, 0x4001_2C38, 0x4001_2C3C];
const CURRENTS: [u32; 2] = [0x5000_0080, 0x5000_0180];
const SUPPLY: u32 = 0x5000_0140;
const TEMPERATURE: u32 = 0x5000_0040;
/// Where interrupts are asked for, and the servo's there.
const PEND: u32 = 0xE000_E204;
const SERVO: u32 = 1 << (TICK_INTERRUPT % 32);

/// An instant of the current loop, as the bus has seen it.
#[derive(Clone, Copy, Debug, Default)]
struct Instant {
    count: u16,
    currents: [u16; 2],
    bus: u16,
    temperature: u16,
    compare: [Option<u32>; 3],
    /// What the gates were switched to.
    switched: Option<bool>,
    /// It begins a period of the servo.
    begins: bool,
}

impl Instant {
    fn sample(&self) -> Sample {
        let Self { currents, bus, temperature, .. } = *self;
        Sample { currents, bus, temperature, position: RawCount::from(self.count) }
    }

    fn take(&mut self, access: &BusAccess) {
        let value = access.value;
        match (access.address, access.writes) {
            (SUPPLY, false) => self.bus = value as u16,
            (TEMPERATURE, false) => self.temperature = value as u16,
            (BREAK_CONTROL, true) => self.switched = Some(value & MAIN_OUTPUT != 0),
            (PEND, true) => self.begins |= value & SERVO != 0,
            (address, writes) => {
                let place = |places: &[u32]| places.iter().position(|&place| place == address);
                if let (Some(phase), false) = (place(&CURRENTS), writes) {
                    self.currents[phase] = value as u16;
                } else if let (Some(phase), true) = (place(&COMPARE), writes) {
                    self.compare[phase] = Some(value);
                }
            }
        }
    }
}

/// The instants in what the bus has seen, each from its count on.
fn instants(accesses: &[BusAccess]) -> Vec<Instant> {
    let mut instants: Vec<Instant> = Vec::new();
    for access in accesses {
        if (access.address, access.writes) == (COUNT, false) {
            instants.push(Instant { count: access.value as u16, ..Instant::default() });
        } else if let Some(instant) = instants.last_mut() {
            instant.take(access);
        }
    }
    instants
}

/// A hand that swings the paddle into the wall and out of it.
fn swings(time: f64) -> f64 {
    0.1 + 0.25 * (40.0 * time).cos()
}

#[test]
fn the_current_interrupt_computes_what_the_host_computes() {
    const PERIODS: usize = 600;
    let mut bench = boot(paddle(swings, 0.0));
    bench.board_mut().accesses = Some(Vec::new());
    let armed = armed(&mut bench);
    // Behind a servo's request, the code at the instant of that is that of the tick before.
    let mut codes = Vec::new();
    let first = bench.pins().samples.len();
    for _ in 0..PERIODS {
        codes.push(code(&mut bench));
        bench.run(1);
    }
    let instants = instants(&take_accesses(&mut bench));
    let mut host = CurrentController::new(&CURRENT_LOOP);
    let (mut is_on, mut begun, mut compared, mut moved) = (false, 0_usize, 0_usize, 0_usize);
    let (mut reference, mut charging) = (0, None::<u32>);
    for instant in &instants[..instants.len() - 1] {
        if instant.begins {
            // The first request is the first sample's.
            begun += 1;
            let waiting = begun.checked_sub(first).and_then(|past| codes.get(past));
            reference = waiting.map_or(0, |&code| code.cast_signed() - MID_SCALE.cast_signed());
        }
        let sample = instant.sample();
        if is_on {
            let duties = host.step(&sample, reference).unwrap();
            let expected = duties.0.map(|duty| u32::from(CURRENT_LOOP.timer_counts() - duty));
            let pairs = instant.compare.into_iter().zip(expected.map(Some));
            for (written, expected) in pairs.take(CURRENT_LOOP.phases()) {
                assert_eq!(written, expected, "{compared}: {instant:?}");
            }
            compared += 1;
            moved += usize::from(reference != 0);
        } else if let Some(left) = &mut charging {
            host.charge(&sample).unwrap();
            if *left == 0 {
                host.start().unwrap();
                is_on = true;
            }
            *left = left.saturating_sub(1);
        } else {
            host.measure_offset(&sample);
            if instant.switched == Some(true) {
                host.start().unwrap();
                charging = Some(CURRENT_LOOP.charging_instants());
            }
        }
    }
    println!("{compared} instants are the same, {moved} of them with a torque; armed at {armed}");
    assert!(compared > PERIODS * 39 && moved > PERIODS * 10);
}
