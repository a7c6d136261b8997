//! A rigid device in a passive hand, exactly: the code is constant over a period or a part of one, and
//! the motion and the energies over that time are matrices, with the lags of amplifier and sensor.
//!
//! Units are those of the loop: time in periods, angles in rad, damping in units of the declared
//! passivity `delta`. A torque is then in `delta / T`, an inertia in `delta T`.

use std::ops::Range;

use tests::hands::Hand;

/// Places in a state: position and velocity of the device and of up to two masses of the hand, the
/// torque, and the amplifier's current; eight are what a processor likes. A mass's position is that
/// against the mass before it, so that nothing cancels where a hand is far from zero.
pub const N: usize = 8;

/// Where the torque of the code is in a state. With an amplifier that is updated some times a period: the
/// rate of its torque.
pub const TORQUE: usize = 6;

/// Where the torque of an amplifier that lags is in a state.
pub const AMPLIFIED: usize = 7;

/// Where the filtered position is in a state, if the sensor lags: in the place of the second mass, so that
/// the hand has one at most.
pub const SENSED: usize = 4;

/// Masses of a hand besides the device.
pub const SEGMENTS: usize = 2;

/// A state of device and hand; see [`N`].
pub type State = [f64; N];

type Matrix = [[f64; N]; N];

const ZERO: Matrix = [[0.0; N]; N];

/// Largest norm of a matrix whose series is summed.
const SMALL: f64 = 0.25;

/// Terms of a series: `0.5^17 / 17!` is below the last place.
const TERMS: u32 = 17;

/// The lags of amplifier and sensor in periods; zero without one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lags {
    /// Time constant of the amplifier.
    pub amplifier: f64,
    /// Updates of the amplifier in a period; 0 if its lag is continuous.
    pub updates: u16,
    /// Time constant of the filter between encoder and servo.
    pub sensor: f64,
}

impl Lags {
    /// Masses that a hand may have besides the device.
    pub const fn segments(&self) -> usize {
        if self.sensor > 0.0 { SEGMENTS - 1 } else { SEGMENTS }
    }
}

/// Device and hand, as rates and energies.
#[derive(Clone, Copy, Debug)]
pub struct HeldDevice {
    rates: Matrix,
    /// Kinetic and potential energy is `x' energy x`.
    energy: Matrix,
    /// The power that the dampers of the hand take is `x' hand x`.
    hand: Matrix,
    /// Damping of the device.
    pub damping: f64,
    /// Where the torque on the device is in a state.
    force: usize,
}

/// What happens in some part of a period.
#[derive(Clone, Debug)]
pub struct Step {
    /// Its part of a period.
    pub part: f64,
    /// By columns, which are added up.
    transition: Matrix,
    /// Integral of the device's velocity squared.
    motion: Matrix,
    /// The work of a torque that changes in this time.
    work: Option<Box<Matrix>>,
    /// What the dampers of the hand take, where that is wanted.
    hand: Option<Box<Matrix>>,
}

impl HeldDevice {
    /// A device of this damping in a hand, whose inertia is that of both. Amplifier and sensor may lag.
    pub fn new(hand: &Hand, damping: f64, lags: &Lags) -> Self {
        let most = lags.segments();
        let mut mass = [hand.inertia, 1.0, 1.0];
        let (mut link, mut ground) = ([(0.0, 0.0); 3], [(hand.stiffness, hand.damping); 3]);
        for (i, segment) in hand.segments.iter().take(most).enumerate() {
            mass[i + 1] = segment.inertia;
            link[i + 1] = (segment.link_stiffness, segment.link_damping);
            ground[i + 1] = (segment.stiffness, segment.damping);
        }
        let used = 1 + hand.segments.len().min(most);
        let force = if lags.amplifier > 0.0 { AMPLIFIED } else { TORQUE };
        let mut held = Self { rates: ZERO, energy: ZERO, hand: ZERO, damping, force };
        for i in 0..used {
            held.energy[2 * i + 1][2 * i + 1] = 0.5 * mass[i];
            held.rates[2 * i][2 * i + 1] = 1.0;
            // What stretches this mass's ground, and its link to the mass before.
            held.connect(&mass, ground[i], i..i + 1, |j| f64::from(u8::from(j <= i)));
            if i > 0 {
                held.rates[2 * i][2 * i - 1] = -1.0;
                held.connect(&mass, link[i], i - 1..i + 1, |j| f64::from(u8::from(j == i)));
            }
        }
        held.rates[1][1] -= damping / mass[0];
        held.rates[1][force] = 1.0 / mass[0];
        held.lag(lags);
        held
    }

    fn lag(&mut self, lags: &Lags) {
        if lags.amplifier > 0.0 {
            if lags.updates > 0 {
                self.rates[AMPLIFIED][TORQUE] = 1.0;
            } else {
                self.rates[AMPLIFIED][TORQUE] = 1.0 / lags.amplifier;
                self.rates[AMPLIFIED][AMPLIFIED] = -1.0 / lags.amplifier;
            }
        }
        if lags.sensor > 0.0 {
            self.rates[SENSED][0] = 1.0 / lags.sensor;
            self.rates[SENSED][SENSED] = -1.0 / lags.sensor;
        }
    }

    /// A spring and a damper between two masses, or between one and the ground. `stretch`: what
    /// each of the positions up to the last of them adds to the spring's.
    fn connect(
        &mut self,
        mass: &[f64; 3],
        (stiffness, damping): (f64, f64),
        masses: Range<usize>,
        stretch: impl Fn(usize) -> f64,
    ) {
        let last = masses.end - 1;
        let sign = |i: usize| if i == last { 1.0 } else { -1.0 };
        for j in 0..=last {
            for i in masses.clone() {
                self.rates[2 * i + 1][2 * j] -= sign(i) * stiffness * stretch(j) / mass[i];
            }
            for i in 0..=last {
                self.energy[2 * i][2 * j] += 0.5 * stiffness * stretch(i) * stretch(j);
            }
        }
        for i in masses.clone() {
            for j in masses.clone() {
                let (row, column) = (2 * i + 1, 2 * j + 1);
                self.rates[row][column] -= sign(i) * sign(j) * damping / mass[i];
                self.hand[row][column] += sign(i) * sign(j) * damping;
            }
        }
    }

    /// Kinetic and potential energy.
    pub fn energy(&self, x: &State) -> f64 {
        form(&self.energy, x)
    }

    /// A part of a period, exactly.
    pub fn step(&self, part: f64) -> Step {
        if self.force == TORQUE {
            let (transition, [motion]) = integrate(&self.rates, [Self::device()], part);
            let transition = transposed(&transition);
            return Step { part, transition, motion, work: None, hand: None };
        }
        let both = [Self::device(), self.power()];
        let (transition, [motion, work]) = integrate(&self.rates, both, part);
        let work = Some(Box::new(work));
        Step { part, transition: transposed(&transition), motion, work, hand: None }
    }

    /// A part of a period with what the hand takes.
    pub fn audited(&self, part: f64) -> Step {
        let (_, [hand]) = integrate(&self.rates, [self.hand], part);
        Step { hand: Some(Box::new(hand)), ..self.step(part) }
    }

    /// The power of the torque on the device.
    fn power(&self) -> Matrix {
        let mut power = ZERO;
        power[1][self.force] = 0.5;
        power[self.force][1] = 0.5;
        power
    }

    /// The device's velocity squared.
    fn device() -> Matrix {
        let mut squared = ZERO;
        squared[1][1] = 1.0;
        squared
    }
}

impl Step {
    /// Moves the state on; returns the integral of the device's velocity squared, and the work of the torque.
    #[inline]
    pub fn advance(&self, x: &mut State) -> (f64, f64) {
        let motion = form(&self.motion, x);
        if let Some(work) = &self.work {
            let work = form(work, x);
            *x = times(&self.transition, x);
            return (motion, work);
        }
        let start = x[0];
        *x = times(&self.transition, x);
        (motion, x[TORQUE] * (x[0] - start))
    }

    /// What the dampers of the hand take from this state on, where that was wanted.
    #[inline]
    pub fn taken(&self, x: &State) -> f64 {
        self.hand.as_ref().map_or(0.0, |hand| form(hand, x))
    }
}

/// `x' m x` of a symmetric matrix.
#[inline]
fn form(m: &Matrix, x: &State) -> f64 {
    let y = times(m, x);
    let mut sum = 0.0;
    for i in 0..N {
        sum += y[i] * x[i];
    }
    sum
}

/// The matrix, given by its columns, times `x`.
#[inline]
fn times(columns: &Matrix, x: &State) -> State {
    let mut y = [0.0; N];
    for j in 0..N {
        for i in 0..N {
            y[i] += columns[j][i] * x[j];
        }
    }
    y
}

fn transposed(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut c = ZERO;
    for i in 0..N {
        for k in 0..N {
            let factor = a[i][k];
            for j in 0..N {
                c[i][j] += factor * b[k][j];
            }
        }
    }
    c
}

fn added(a: &Matrix, b: &Matrix, factor: f64) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + factor * b[i][j]))
}

/// `m' q + q m`.
fn both_sides(m: &Matrix, q: &Matrix) -> Matrix {
    let half = product(q, m);
    added(&half, &transposed(&half), 1.0)
}

/// `exp(m h)`, and for each `q` the integral of `exp(m t)' q exp(m t)` from 0 to `h`. The series of
/// a part so short that it converges at once, and then doubled.
fn integrate<const Q: usize>(m: &Matrix, q: [Matrix; Q], h: f64) -> (Matrix, [Matrix; Q]) {
    let norm = |m: &Matrix| {
        let rows = m.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>());
        rows.fold(0.0, f64::max)
    };
    let size = norm(m).max(norm(&transposed(m))) * h;
    let doublings = (size / SMALL).log2().ceil().max(0.0) as i32;
    let part = h * 0.5_f64.powi(doublings);
    let mut transition = ZERO;
    for (i, row) in transition.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    let mut term = transition;
    let mut integrals = [ZERO; Q];
    let mut derivatives = q;
    let mut factor = part;
    for k in 1..=TERMS {
        for (sum, derivative) in integrals.iter_mut().zip(&mut derivatives) {
            *sum = added(sum, derivative, factor);
            *derivative = both_sides(m, derivative);
        }
        factor *= part / f64::from(k + 1);
        let next = product(&term, m);
        term = added(&ZERO, &next, part / f64::from(k));
        transition = added(&transition, &term, 1.0);
    }
    for _ in 0..doublings {
        for sum in &mut integrals {
            let later = product(&transposed(&transition), &product(sum, &transition));
            *sum = added(sum, &later, 1.0);
        }
        transition = product(&transition, &transition);
    }
    (transition, integrals)
}
