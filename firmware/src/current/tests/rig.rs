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
            offsets: [2050.0, 2041.0],
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

    /// A period of the modulation, from the middle of the low sides to the next one.
    fn switch(&mut self) {
        let counts = f64::from(BRUSHED.timer_counts());
        let [u, v, w] = self.loaded.0.map(f64::from);
        assert!(w == (counts / 2.0).floor() && u <= counts && v <= counts, "{:?}", self.loaded);
        let mut edges = [0.0, counts - u, counts - v, counts + u, counts + v, 2.0 * counts];
        edges.sort_by(f64::total_cmp);
        self.extremes = (self.current, self.current);
        for edge in edges.windows(2) {
            let middle = (edge[0] + edge[1]) / 2.0;
            let is_high = |compare: f64| f64::from((middle - counts).abs() < compare);
            let volts = self.bus * (is_high(u) - is_high(v));
            self.pass((edge[1] - edge[0]) / (2.0 * counts) * INSTANT, volts);
        }
        self.angle += self.speed * INSTANT;
    }

    fn pass(&mut self, time: f64, volts: f64) {
        let Motor { resistance, inductance, torque_constant, .. } = self.motor;
        let end = (volts - torque_constant * self.speed) / resistance;
        self.current -= (self.current - end) * -(-resistance * time / inductance).exp_m1();
        let (least, most) = self.extremes;
        self.extremes = (least.min(self.current), most.max(self.current));
    }
}
