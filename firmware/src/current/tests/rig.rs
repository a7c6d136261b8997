//! A brushed motor on a power stage, in memory.

use super::*;
use crate::encoder::RawCount;

/// A motor, its supply and its encoder, with a controller.
pub struct Rig {
    pub controller: CurrentController,
    pub stage: PowerStage,
    pub motor: Motor,
    /// Supply in V.
    pub bus: f64,
    /// Speed in rad/s, and angle in rad.
    pub speed: f64,
    pub angle: f64,
    /// Current in A at the last instant.
    pub current: f64,
    /// Counts without a current, of U and V.
    pub offsets: [f64; 2],
    pub celsius: f64,
    /// Largest and smallest current in the last period.
    pub extremes: (f64, f64),
    loaded: Duties,
}

impl Rig {
    /// One whose gates have just been switched on.
    pub fn started(design: &CurrentLoop) -> Self {
        Self::off(design).restarted()
    }

    /// The same, whose offsets have been measured.
    pub fn restarted(mut self) -> Self {
        for _ in 0..300 {
            self.controller.measure_offset(&self.sample());
        }
        self.controller.start().unwrap();
        self
    }

    /// One whose gates are off, and whose offsets are unknown.
    pub fn off(design: &CurrentLoop) -> Self {
        Self {
            controller: CurrentController::new(design),
            stage: STAGE,
            motor: DRIVE.motor,
            bus: 24.0,
            speed: 0.0,
            angle: 0.0,
            current: 0.0,
            offsets: [2550.0, 2541.0],
            celsius: 30.0,
            extremes: (0.0, 0.0),
            loaded: design.no_voltage(),
        }
    }

    pub fn sample(&self) -> Sample {
        let count = |value: f64| value.round().clamp(0.0, 4095.0) as u16;
        let counts = self.current / self.stage.amps_per_count;
        let position = self.angle / std::f64::consts::TAU * TRANSDUCERS.counts_per_turn;
        Sample {
            currents: [count(self.offsets[0] - counts), count(self.offsets[1] + counts)],
            bus: count(self.bus / self.stage.volts_per_count),
            temperature: self.stage.thermistor.count(self.celsius),
            position: RawCount::from(position.floor() as i64 as u32),
        }
    }

    /// An instant, and the time until the next one; gives the current in A at the instant.
    pub fn instant(&mut self, code: i16) -> Result<f64, PowerFault> {
        let current = self.current;
        let duties = self.controller.step(&self.sample(), code)?;
        self.switch();
        self.loaded = duties;
        Ok(current)
    }

    /// The time until the next instant with these duties.
    pub fn hold(&mut self, duties: Duties) {
        self.loaded = duties;
        self.switch();
    }

    /// A period of the modulation, from the middle of the low sides to the next one.
    fn switch(&mut self) {
        let counts = f64::from(BRUSHED.timer_counts());
        let [u, v, w] = self.loaded.0.map(f64::from);
        assert!(w == (counts / 2.0).floor() && u <= counts && v <= counts, "{:?}", self.loaded);
        // A side switches on the dead time after the other has switched off.
        let dead = self.stage.dead_time / INSTANT * 2.0 * counts;
        let mut edges = vec![0.0, 2.0 * counts];
        edges.extend([u, v].iter().flat_map(|compare| {
            let (rise, fall) = (counts - compare, counts + compare);
            [rise, rise + dead, fall, fall + dead]
        }));
        edges.sort_by(f64::total_cmp);
        self.extremes = (self.current, self.current);
        for edge in edges.windows(2) {
            let middle = (edge[0] + edge[1]) / 2.0;
            let leg = |compare: f64| Leg::at(middle, counts - compare, counts + compare, dead);
            self.pass((edge[1] - edge[0]) / (2.0 * counts) * INSTANT, leg(u), leg(v));
        }
        self.angle += self.speed * INSTANT;
    }

    /// A time in which nothing switches. What flows into an open phase, or out of it, flows through a diode.
    fn pass(&mut self, time: f64, u: Leg, v: Leg) {
        let is_open = u == Leg::Open || v == Leg::Open;
        let back_emf = self.motor.torque_constant * self.speed;
        let volts = |sign: f64| self.bus * (u.part(sign) - v.part(-sign)) - back_emf;
        let sign = if self.current != 0.0 || !is_open {
            self.current.signum()
        } else {
            // Where neither direction has a voltage that drives it, no current begins.
            f64::from(volts(1.0) > 0.0) - f64::from(volts(-1.0) < 0.0)
        };
        if sign == 0.0 {
            return;
        }
        let Motor { resistance, inductance, .. } = self.motor;
        let end = volts(sign) / resistance;
        let next =
            self.current - (self.current - end) * -(-resistance * time / inductance).exp_m1();
        // A diode lets no current turn round.
        self.current = if is_open && next * sign < 0.0 { 0.0 } else { next };
        let (least, most) = self.extremes;
        self.extremes = (least.min(self.current), most.max(self.current));
    }
}

/// A phase of the bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Leg {
    Low,
    High,
    /// Both sides are off.
    Open,
}

impl Leg {
    /// At a time between the edges, in counts of the timer's clock.
    pub fn at(time: f64, rise: f64, fall: f64, dead: f64) -> Self {
        let is_open = |edge: f64| (edge..edge + dead).contains(&time);
        if rise < fall && (is_open(rise) || is_open(fall)) {
            Self::Open
        } else if (rise..fall).contains(&time) {
            Self::High
        } else {
            Self::Low
        }
    }

    /// Its voltage as a part of the supply, for a current out of it of this sign: through the low side's diode,
    /// or through the high side's.
    pub fn part(self, sign: f64) -> f64 {
        match self {
            Self::Low => 0.0,
            Self::High => 1.0,
            Self::Open => 0.5 - 0.5 * sign,
        }
    }
}
