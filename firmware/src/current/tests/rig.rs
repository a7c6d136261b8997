//! Motors on a power stage, in memory: a brushed one, and one of three phases.

use std::f64::consts::TAU;

use super::*;
use crate::encoder::RawCount;

/// A brushed motor, its supply and its encoder, with a controller.
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
        let rest = self.sample();
        (0..300).for_each(|_| self.controller.measure_offset(&rest));
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
        let counts = self.current / self.stage.amps_per_count;
        let currents = [self.offsets[0] - counts, self.offsets[1] + counts];
        sample(currents, self.bus, self.celsius, self.angle)
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
        // A side switches on the dead time after the other has switched off.
        let dead = self.stage.dead_time / INSTANT * 2.0 * counts;
        self.extremes = (self.current, self.current);
        for edge in edges(&[u, v], counts, dead).windows(2) {
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

/// The sample of currents in counts, of the supply in V, and of the encoder's angle in rad.
fn sample(currents: [f64; 2], bus: f64, celsius: f64, angle: f64) -> Sample {
    let count = |value: f64| value.round().clamp(0.0, 4095.0) as u16;
    let position = angle / TAU * TRANSDUCERS.counts_per_turn;
    Sample {
        currents: currents.map(count),
        bus: count(bus / STAGE.volts_per_count),
        temperature: STAGE.thermistor.count(celsius),
        position: RawCount::from(position.floor() as i64 as u32),
    }
}

/// The times of a period at which a side switches on or off, in order, in counts of the timer's clock.
fn edges(compare: &[f64], counts: f64, dead: f64) -> Vec<f64> {
    let mut edges = vec![0.0, 2.0 * counts];
    edges.extend(compare.iter().flat_map(|compare| {
        let (rise, fall) = (counts - compare, counts + compare);
        [rise, rise + dead, fall, fall + dead]
    }));
    edges.sort_by(f64::total_cmp);
    edges
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

/// A brushless motor with its handle, its supply and its encoder, and a controller.
#[derive(Clone)]
pub struct ThreePhases {
    pub controller: CurrentController,
    pub motor: Motor,
    pub pole_pairs: f64,
    /// The winding to which each of the bridge's phases is connected.
    pub wires: [usize; 3],
    /// 1, or -1 of an encoder that counts down where the handle turns up.
    pub encoder: f64,
    pub bus: f64,
    /// Electrical angle at the handle's angle 0, in rad.
    pub offset: f64,
    /// Angle in rad and speed in rad/s of the handle.
    pub angle: f64,
    pub speed: f64,
    /// What moves the handle; it turns with its speed where there is none.
    pub handle: Option<Handle>,
    /// Whether each edge of the switches is computed, or the mean of a period.
    pub edges: bool,
    /// Current in U's direction and across it, of the windings, in A.
    current: [f64; 2],
    loaded: Duties,
}

/// A handle that can turn.
#[derive(Clone, Copy, Debug)]
pub struct Handle {
    pub inertia: f64,
    pub damping: f64,
    /// Coulomb friction in N m.
    pub friction: f64,
    /// Amplitude in N m, and periods a turn.
    pub cogging: (f64, f64),
}

const ROOT_3: f64 = 1.732_050_807_568_877_2;

fn phases([along, across]: [f64; 2]) -> [f64; 3] {
    let part = across * ROOT_3 / 2.0;
    [along, -along / 2.0 + part, -along / 2.0 - part]
}

/// 0 where there is none.
fn sign(current: f64) -> f64 {
    if current == 0.0 { 0.0 } else { current.signum() }
}

impl ThreePhases {
    pub fn off(design: &CurrentLoop) -> Self {
        Self {
            controller: CurrentController::new(design),
            motor: BRUSHLESS_DRIVE.motor,
            pole_pairs: 7.0,
            wires: [0, 1, 2],
            encoder: 1.0,
            bus: 24.0,
            offset: 1.0,
            angle: 0.0,
            speed: 0.0,
            handle: None,
            edges: true,
            current: [0.0; 2],
            loaded: design.no_voltage(),
        }
    }

    /// Offsets are measured.
    pub fn measured(mut self) -> Self {
        let rest = self.sample();
        (0..300).for_each(|_| self.controller.measure_offset(&rest));
        self
    }

    /// The gates have just been switched on, and the phase is known.
    pub fn started(design: &CurrentLoop) -> Self {
        Self::off(design).measured().aligned()
    }

    /// The same after the offsets were measured.
    pub fn aligned(mut self) -> Self {
        let offset = (self.offset / TAU * 2_f64.powi(32)) as u32;
        let is_reversed = self.encoder < 0.0;
        self.controller.set_phase(PhaseAlignment { offset, is_reversed });
        self.controller.start().unwrap();
        self
    }

    fn electrical(&self) -> f64 {
        self.offset + self.pole_pairs * self.angle
    }

    /// Current along and across the magnets in A.
    pub fn currents(&self) -> [f64; 2] {
        let (sine, cosine) = self.electrical().sin_cos();
        let [along, across] = self.current;
        [along * cosine + across * sine, across * cosine - along * sine]
    }

    pub fn torque(&self) -> f64 {
        self.motor.torque_constant * self.currents()[1]
    }

    /// Largest current of a winding in A.
    pub fn largest(&self) -> f64 {
        phases(self.current).into_iter().fold(0.0, |most, current| most.max(current.abs()))
    }

    pub fn sample(&self) -> Sample {
        let currents = phases(self.current);
        let of = |phase: usize| 2553.0 - currents[self.wires[phase]] / STAGE.amps_per_count;
        sample([of(0), of(1)], self.bus, 30.0, self.encoder * self.angle)
    }

    /// An instant with this code, and the time until the next one.
    pub fn instant(&mut self, code: i16) -> Result<(), PowerFault> {
        let duties = self.controller.step(&self.sample(), code)?;
        self.pass_with(duties);
        Ok(())
    }

    /// The time until the next instant, for which these are loaded.
    pub fn pass_with(&mut self, duties: Duties) {
        let counts = f64::from(BRUSHLESS.timer_counts());
        let compare = self.loaded.0.map(f64::from);
        assert!(compare.iter().all(|&compare| compare <= counts), "{:?}", self.loaded);
        if self.edges {
            // A side switches on the dead time after the other has switched off.
            let dead = STAGE.dead_time / INSTANT * 2.0 * counts;
            for edge in edges(&compare, counts, dead).windows(2) {
                let middle = (edge[0] + edge[1]) / 2.0;
                let currents = phases(self.current);
                let legs = [0, 1, 2].map(|phase| {
                    let leg =
                        Leg::at(middle, counts - compare[phase], counts + compare[phase], dead);
                    leg.part(sign(currents[self.wires[phase]]))
                });
                self.pass((edge[1] - edge[0]) / (2.0 * counts) * INSTANT, legs);
            }
        } else {
            self.pass(INSTANT, compare.map(|compare| compare / counts));
        }
        self.turn();
        self.loaded = duties;
    }

    /// A time with the bridge's phases at these parts of the supply. The handle turns on with it.
    fn pass(&mut self, time: f64, legs: [f64; 3]) {
        let mut windings = [0.0; 3];
        for (leg, wire) in legs.into_iter().zip(self.wires) {
            windings[wire] = leg * self.bus;
        }
        let [a, b, c] = windings;
        let volts = [(2.0 * a - b - c) / 3.0, (b - c) / ROOT_3];
        self.angle += self.speed * time / 2.0;
        let induced = self.motor.torque_constant * 2.0 / 3.0 * self.speed;
        let (sine, cosine) = self.electrical().sin_cos();
        let emf = [-induced * sine, induced * cosine];
        let Motor { resistance, inductance, .. } = self.motor;
        let part = -(-resistance * time / inductance).exp_m1();
        for axis in 0..2 {
            let end = (volts[axis] - emf[axis]) / resistance;
            self.current[axis] += (end - self.current[axis]) * part;
        }
        self.angle += self.speed * time / 2.0;
    }

    fn turn(&mut self) {
        let Some(handle) = self.handle else { return };
        let (cogging, periods) = handle.cogging;
        let torque = self.torque() - cogging * (periods * self.angle).sin();
        // Friction holds, or takes at most all of the speed.
        let free = self.speed + (torque - handle.damping * self.speed) / handle.inertia * INSTANT;
        let most = handle.friction / handle.inertia * INSTANT;
        self.speed = free - free.clamp(-most, most);
    }
}
