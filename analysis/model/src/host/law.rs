//! Hosts whose torques nobody can certify, as laws from the motion that they read to the torque that they send.

use std::f64::consts::TAU;
use std::fmt;
use std::str::FromStr;

use haptic_servo::servo::Transducers;
use haptic_servo::words;

words! {
    /// What a hostile host sends; its name on the command line and on the page.
    HostLaw {
    /// Pushes along the velocity.
    Pump "pump",
    /// Random torques.
    Noise "noise",
    /// A stiff spring towards zero, at the position of the reading before.
    LateSpring "late-spring",
    /// A square wave.
    Square "square",
    }
}

impl fmt::Display for HostLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl FromStr for HostLaw {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|law| law.as_str() == name).ok_or_else(|| {
            let names = Self::ALL.map(Self::as_str).join(", ");
            format!("there is no host {name}; there are {names}")
        })
    }
}

/// The motion that a host reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Angle in rad.
    pub position: f64,
    /// Velocity in rad/s.
    pub velocity: f64,
    /// Time in s since the host began.
    pub time: f64,
}

/// A host that follows a law.
#[derive(Clone, Debug, PartialEq)]
pub struct HostileHost {
    /// The law.
    pub law: HostLaw,
    /// Its torque in N m: of the spring at [`Self::DEFLECTION`], of the others the largest.
    pub torque: f64,
    /// Half the period of the square wave in s.
    pub half_period: f64,
    /// The position in rad of the reading before.
    before: f64,
}

impl HostileHost {
    /// Angle in rad at which the late spring has its torque.
    pub const DEFLECTION: f64 = 0.01;
    /// Half the usual period of the square wave in s.
    pub const HALF_PERIOD: f64 = 0.02;

    /// A host with this torque in N m.
    pub const fn new(law: HostLaw, torque: f64) -> Self {
        Self { law, torque, half_period: Self::HALF_PERIOD, before: 0.0 }
    }

    /// The torque in N m that it sends for a reading, positive in the direction of the angle.
    pub fn torque(&mut self, reading: &Reading) -> f64 {
        let before = std::mem::replace(&mut self.before, reading.position);
        let up = |is_up: bool| if is_up { self.torque } else { -self.torque };
        match self.law {
            HostLaw::Pump => up(reading.velocity >= 0.0),
            HostLaw::Noise => self.torque * noise(reading.time),
            HostLaw::LateSpring => -self.torque / Self::DEFLECTION * before,
            HostLaw::Square => up((reading.time / self.half_period).rem_euclid(2.0) < 1.0),
        }
    }
}

/// A host that reads a servo's counts, and sends a command from time to time.
#[derive(Clone, Debug, PartialEq)]
pub struct HostSender {
    host: HostileHost,
    /// Ticks from a command to the next.
    interval: u32,
    period: f64,
    radians_per_count: f64,
    read: i32,
    tick: u32,
}

impl HostSender {
    /// Time in s from a command to the next; a period, if that is longer. A serial line carries each command and
    /// its report.
    const INTERVAL: f64 = 2e-3;

    /// A host beside a servo with this period in s, which stands at this count.
    pub fn new(host: HostileHost, period: f64, transducers: &Transducers, count: i32) -> Self {
        let interval = (Self::INTERVAL / period).round().max(1.0) as u32;
        let radians_per_count = TAU / transducers.counts_per_turn;
        Self { host, interval, period, radians_per_count, read: count, tick: 0 }
    }

    /// The torque in N m that it sends at the end of a tick with this count, if it sends one.
    pub fn after(&mut self, count: i32) -> Option<f32> {
        let tick = self.tick;
        self.tick = tick.wrapping_add(1);
        if !tick.is_multiple_of(self.interval) {
            return None;
        }
        let moved = count.wrapping_sub(std::mem::replace(&mut self.read, count));
        let turned = f64::from(moved) * self.radians_per_count;
        let torque = self.host.torque(&Reading {
            position: f64::from(count) * self.radians_per_count,
            velocity: turned / (f64::from(self.interval) * self.period),
            time: f64::from(tick) * self.period,
        });
        Some(torque as f32)
    }
}

/// A number from -1 to below 1 that looks random (SplitMix64 of the bits of the time).
fn noise(time: f64) -> f64 {
    let mut bits = time.to_bits().wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
