//! The hand that the proof of necessity constructs (theory, section 13.6).
//!
//! At one angle of the circle (equation 43) a rigid device in a hand answers a sampled torque with
//! `p = sum q_k Y_k` over the aliases `w_k`, where `q_k = h_k s_k / T` and `Y_k = 1 / (b + j X_k)` in
//! a lossless hand with the reactance `X_k`, the device's inertia included. Each `Y_k` is anywhere on the
//! circle through 0 and `1/b`, so that `p` is anywhere in a disk. A loop has a root at that angle where
//! `p = -1/H`: with that point inside of the disk, a `p` beyond it makes the loop grow. It prescribes the
//! reactances, and a mass, a spring and absorbers have any reactances at finitely many frequencies.

use std::f64::consts::{PI, TAU};

use haptic_servo::scene::Scene;
use nalgebra::{Complex, DMatrix, DVector};

use super::HEAVIEST;
use super::impedance::{Absorber, HandImpedance};
use super::nnls::nnls;
use crate::chain::Chain;
use crate::line_search::minimizing_angle;
use crate::response::Response;
use crate::sampled_actuator::SampledActuator;
use crate::simulation::closed_loop::transfers;

/// Aliases to either side whose reactances are met, in the order in which these numbers are tried.
const REACHES: [i32; 5] = [1, 3, 8, 16, 24];
/// Where in the gap between two frequencies absorbers may resonate, in the order in which these are tried:
/// the farther from a frequency, the less does the hand's response vary around it.
const PLACES: [&[f64]; 3] = [&[0.5], &[0.2, 0.5, 0.8], &[0.03, 0.1, 0.25, 0.5, 0.75, 0.9, 0.97]];
/// Largest reactance that is prescribed, over the damping.
const OPEN: f64 = 1e3;
/// Number of angles at which the disk is examined.
const ANGLES: usize = 400;

/// A loop whose torque passes through a delay and lags, around a rigid device.
pub(super) struct LaggingLoop {
    period: f64,
    damping: f64,
    inertia: f64,
    delay: f64,
    lags: [f64; 3],
    sampled: Option<SampledActuator>,
    controller: Response,
}

/// The disk of `2 b p` at one angle, from the aliases that are met.
struct Disk {
    /// Angular frequency in rad/s of each alias, and its `q`.
    aliases: Vec<(f64, Complex<f64>)>,
    controller: Complex<f64>,
    /// `sum q` and `sum |q|`.
    centre: Complex<f64>,
    radius: f64,
}

impl LaggingLoop {
    /// For a scene on its device; `None` where the device is not a single mass with damping, or the loop has
    /// no transfer function.
    pub(super) fn new(scene: &Scene, device: &Chain) -> Option<Self> {
        let controller = Response::new(transfers(scene).ok()?.controller);
        let latency = &scene.latency;
        let sampled = SampledActuator::of(latency, scene.timing.period);
        let amplifier = if sampled.is_none() { latency.actuator_lag.middle() } else { 0.0 };
        let lags = [amplifier, latency.sensor_lag.middle(), device.actuator_lag()];
        let (inertia, damping) = (device.inertia(), device.damping());
        let is_rigid = device.masses().len() == 1 && damping > 0.0;
        is_rigid.then_some(Self {
            period: scene.timing.period,
            damping,
            inertia,
            delay: latency.torque_delay().middle(),
            lags,
            sampled,
            controller,
        })
    }

    fn disk(&self, theta: f64, reach: i32) -> Disk {
        let held = Complex::new(1.0, 0.0) - Complex::from_polar(1.0, -theta);
        let alias = |k: i32| {
            let rate = (theta + TAU * f64::from(k)) / self.period;
            let late = Complex::from_polar(1.0, -rate * self.delay);
            let lags = self.lags.iter().map(|lag| Complex::new(1.0, rate * lag));
            let lagging: Complex<f64> = lags.product();
            let sampled = self.sampled.map_or(Complex::new(1.0, 0.0), |it| it.response(rate));
            (rate, -held * late * sampled / (lagging * (rate * rate * self.period)))
        };
        let aliases: Vec<_> = (-reach..=reach).map(alias).collect();
        Disk {
            controller: self.controller.at_angle(theta),
            centre: aliases.iter().map(|alias| alias.1).sum(),
            radius: aliases.iter().map(|alias| alias.1.norm()).sum(),
            aliases,
        }
    }

    /// Hands, the simplest first.
    pub(super) fn hands(&self) -> impl Iterator<Item = HandImpedance> {
        let disks = REACHES.into_iter().flat_map(move |reach| {
            self.angles(reach).into_iter().map(move |theta| self.disk(theta, reach))
        });
        disks.flat_map(move |disk| {
            let targets = disk.targets(self.damping);
            let each = PLACES.into_iter().flat_map(|places| targets.map(|target| (places, target)));
            let hand = |(places, target): (&[f64], Option<f64>)| {
                self.hand(&Wanted::of(&disk, target?), places)
            };
            each.filter_map(hand).collect::<Vec<_>>()
        })
    }

    /// The damping below which `-1/H` is inside of the disk of nearly all aliases, at some angle.
    pub(super) fn needed(&self) -> f64 {
        const NEARLY_ALL: i32 = 2000;
        let needed = |theta: f64| self.disk(theta, NEARLY_ALL).needed();
        let worst = minimizing_angle(|theta| -needed(theta), 0.0, PI).unwrap_or(0.5 * PI);
        needed(worst.max(1e-3))
    }

    /// The angle at which the most damping is needed, and the farthest on both sides at which more than half
    /// of the missing damping is.
    fn angles(&self, reach: i32) -> Vec<f64> {
        let needed = |theta: f64| self.disk(theta, reach).needed();
        let worst = minimizing_angle(|theta| -needed(theta), 0.0, PI).unwrap_or(0.5 * PI);
        let worst = worst.max(1e-3);
        let lacking = needed(worst) - self.damping;
        if lacking.is_nan() || lacking <= 0.0 {
            return Vec::new();
        }
        let enough = |theta: &f64| needed(*theta) > self.damping + 0.5 * lacking;
        let step = PI / ANGLES as f64;
        let below =
            (1..ANGLES).map(|n| worst - step * n as f64).take_while(|t| *t > 0.0 && enough(t));
        let above =
            (1..ANGLES).map(|n| worst + step * n as f64).take_while(|t| *t < PI && enough(t));
        let mut angles = vec![worst];
        angles.extend(below.last());
        angles.extend(above.last());
        angles
    }

    /// The lossless hand whose reactances with the device's mass are nearest to the wanted ones.
    fn hand(&self, wanted: &[Wanted], places: &[f64]) -> Option<HandImpedance> {
        let rates: Vec<f64> = wanted.iter().map(|wanted| wanted.rate).collect();
        let parts = parts(&rates, places);
        let sizes: Vec<f64> = parts.iter().map(|part| part.size(&rates)).collect();
        let a = DMatrix::from_fn(rates.len(), parts.len(), |row, column| {
            wanted[row].weight * sizes[column] * parts[column].reactance(rates[row])
        });
        let b = DVector::from_fn(rates.len(), |row, _| {
            let mass = self.inertia / self.damping * rates[row];
            wanted[row].weight * (wanted[row].reactance - mass)
        });
        let found = nnls(&a, &b);
        let mut hand = HandImpedance::default();
        for ((part, size), value) in parts.iter().zip(&sizes).zip(&found) {
            if *value > 0.0 {
                part.add_to(&mut hand, value * size * self.damping);
            }
        }
        let masses = hand.absorbers.iter().map(|absorber| absorber.inertia);
        (masses.fold(hand.inertia, f64::max) <= HEAVIEST * self.inertia).then_some(hand)
    }
}

/// A reactance that the proof prescribes.
struct Wanted {
    /// Angular frequency in rad/s, positive.
    rate: f64,
    /// Over the device's damping.
    reactance: f64,
    /// Change of `p` for a deviation of 1, over the size of its disk.
    weight: f64,
}

impl Wanted {
    /// For the point of a disk's boundary in that direction (equation 44), in the order of the frequencies.
    fn of(disk: &Disk, direction: f64) -> Vec<Self> {
        let wanted = |&(rate, q): &(f64, Complex<f64>)| {
            let reactance = (0.5 * (q.arg() - direction)).tan().clamp(-OPEN, OPEN);
            let weight = q.norm() / (disk.radius * (1.0 + reactance * reactance));
            Self { rate: rate.abs(), reactance: reactance * rate.signum(), weight }
        };
        let mut all: Vec<Self> = disk.aliases.iter().map(wanted).collect();
        all.sort_by(|a, b| a.rate.total_cmp(&b.rate));
        all
    }
}

/// A part of a lossless hand, by Foster's form.
enum Part {
    Mass,
    Spring,
    /// By its resonance in rad/s.
    Absorber(f64),
}

impl Part {
    /// Reactance at a frequency of the part whose number is 1.
    fn reactance(&self, rate: f64) -> f64 {
        match self {
            Self::Mass => rate,
            Self::Spring => -1.0 / rate,
            Self::Absorber(resonance) => rate / (resonance * resonance - rate * rate),
        }
    }

    /// Its number for a largest reactance of 1 at the frequencies, so that all columns have about the same
    /// size.
    fn size(&self, rates: &[f64]) -> f64 {
        let largest = rates.iter().map(|&rate| self.reactance(rate).abs()).fold(0.0, f64::max);
        1.0 / largest
    }

    fn add_to(&self, hand: &mut HandImpedance, number: f64) {
        match self {
            Self::Mass => hand.inertia = number,
            Self::Spring => hand.stiffness = number,
            Self::Absorber(resonance) => hand
                .absorbers
                .push(Absorber { inertia: number / (resonance * resonance), stiffness: number }),
        }
    }
}

/// A mass, a spring, and absorbers that resonate between the frequencies, below and above them.
fn parts(rates: &[f64], places: &[f64]) -> Vec<Part> {
    /// Frequencies that are nearer to each other, relative to their size, count as one.
    const ONE: f64 = 1e-6;
    let (first, last) = (rates[0], rates[rates.len() - 1]);
    let gaps = rates.windows(2).map(|two| (two[0], two[1]));
    let gaps = std::iter::once((0.0, first)).chain(gaps).chain([(last, 1.5 * last)]);
    let wide = gaps.filter(|(from, to)| to - from > ONE * to);
    let absorbers = wide.flat_map(|(from, to)| {
        places.iter().map(move |place| Part::Absorber(from + place * (to - from)))
    });
    [Part::Mass, Part::Spring].into_iter().chain(absorbers).collect()
}

impl Disk {
    /// The damping below which `-1/H` is inside of the disk.
    fn needed(&self) -> f64 {
        let real = (self.controller * self.centre).re;
        let ripple = self.radius * self.radius - self.centre.norm_sqr();
        0.5 * ((real * real + ripple.max(0.0) * self.controller.norm_sqr()).sqrt() - real)
    }

    /// Directions from the centre to the boundary: across the point itself, and to where the ray from 0
    /// through the point leaves the disk.
    fn targets(&self, damping: f64) -> [Option<f64>; 2] {
        let point = -1.0 / self.controller;
        let (centre, radius) = (self.centre / (2.0 * damping), self.radius / (2.0 * damping));
        let across = point - centre;
        if !point.is_finite() || across.norm() >= radius {
            return [None; 2];
        }
        // |l point - centre| = radius
        let (a, b) = (point.norm_sqr(), (point * centre.conj()).re);
        let root = b * b - a * (centre.norm_sqr() - radius * radius);
        let beyond = point * ((b + root.max(0.0).sqrt()) / a) - centre;
        [Some(across.arg()), Some(beyond.arg())]
    }
}
