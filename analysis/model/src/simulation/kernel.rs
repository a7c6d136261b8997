//! A fast form of the linear loop: a few states, one matrix, nothing else.

use nalgebra::DVector;

use super::closed_loop::ClosedLoop;
use super::discrete_plant::DiscretePlant;
use super::plant::{POSITION, VELOCITY};
use super::torque_signal::TorqueSignal;
use super::trajectory::Columns;

/// Samples between two checks whether the motion has died away.
pub(super) const LOOK: usize = 256;

/// A motion below this in every state counts as zero. It would decay into subnormal numbers, which
/// cost processors a hundred times the time of others.
pub(super) const DEAD: f64 = 1e-200;

/// A linear loop in motion.
pub trait Linear: std::fmt::Debug {
    /// Computes the next samples.
    fn fill(&mut self, hand_torque: &TorqueSignal, columns: Columns<'_>);
}

/// The loop with the number of states that it needs; `None` where it has too many.
pub fn kernel(
    closed: &ClosedLoop,
    tick: &DiscretePlant,
    period: f64,
    start: &DVector<f64>,
) -> Option<Box<dyn Linear>> {
    macro_rules! with_states {
        ($($n:literal),*) => {
            match closed.matrix.nrows() {
                $($n => Some(Box::new(Kernel::<$n>::new(closed, tick, period, start))),)*
                _ => None,
            }
        };
    }
    with_states!(2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12)
}

/// `z(k+1) = M z(k) + h w(k) + [s0 s1] (s, c)(k)`, with the columns of `M` in a row.
#[derive(Clone, Debug)]
struct Kernel<const N: usize> {
    columns: [[f64; N]; N],
    torque: [f64; N],
    hand: [f64; N],
    sine: [[f64; N]; 2],
    state: [f64; N],
    period: f64,
    k: usize,
}

impl<const N: usize> Kernel<N> {
    fn new(closed: &ClosedLoop, tick: &DiscretePlant, period: f64, start: &DVector<f64>) -> Self {
        let states = |plant: &DVector<f64>| -> [f64; N] {
            let all = closed.extended(plant);
            std::array::from_fn(|i| all[i])
        };
        Self {
            columns: std::array::from_fn(|j| std::array::from_fn(|i| closed.matrix[(i, j)])),
            torque: std::array::from_fn(|i| closed.torque[i]),
            hand: states(&tick.hand),
            sine: [states(&tick.sine[0]), states(&tick.sine[1])],
            state: states(start),
            period,
            k: 0,
        }
    }

    /// Runs the loop; `inputs` gives the addition to the next state in tick `k`.
    fn run(&mut self, columns: Columns<'_>, inputs: impl Fn(&Self, usize) -> Option<[f64; N]>) {
        let Columns { position, velocity, torque } = columns;
        let chunks = position.chunks_mut(LOOK).zip(velocity.chunks_mut(LOOK));
        for ((position, velocity), torque) in chunks.zip(torque.chunks_mut(LOOK)) {
            let count = position.len();
            self.look(Columns { position, velocity, torque }, &inputs);
            self.k += count;
            if self.state.iter().all(|state| state.abs() < DEAD) {
                self.state = [0.0; N];
            }
        }
    }

    #[inline(always)]
    fn look(&mut self, columns: Columns<'_>, inputs: impl Fn(&Self, usize) -> Option<[f64; N]>) {
        let mut state = self.state;
        let Columns { position, velocity, torque } = columns;
        let samples = position.iter_mut().zip(velocity).zip(torque);
        for (offset, ((position, velocity), torque)) in samples.enumerate() {
            *position = state[POSITION];
            *velocity = state[VELOCITY];
            *torque = dot(&self.torque, &state);
            state = times(&self.columns, &state);
            if let Some(added) = inputs(self, self.k + offset) {
                state = sum(&state, &added, 1.0);
            }
        }
        self.state = state;
    }
}

impl<const N: usize> Linear for Kernel<N> {
    fn fill(&mut self, hand_torque: &TorqueSignal, columns: Columns<'_>) {
        match hand_torque {
            TorqueSignal::Free => self.run(columns, |_, _| None),
            TorqueSignal::Held(_) => self
                .run(columns, |kernel, k| Some(sum(&[0.0; N], &kernel.hand, hand_torque.held(k)))),
            TorqueSignal::Sine { .. } => self.run(columns, |kernel, k| {
                let [s, c] = hand_torque.sine(k, kernel.period);
                let from_sine = sum(&[0.0; N], &kernel.sine[0], s);
                Some(sum(&from_sine, &kernel.sine[1], c))
            }),
        }
    }
}

#[inline(always)]
fn sum<const N: usize>(a: &[f64; N], b: &[f64; N], factor: f64) -> [f64; N] {
    std::array::from_fn(|i| a[i] + b[i] * factor)
}

#[inline(always)]
fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Column by column, so that all rows are computed side by side; even and odd columns have sums of their own,
/// because each addition waits for the one before.
#[inline(always)]
fn times<const N: usize>(columns: &[[f64; N]; N], state: &[f64; N]) -> [f64; N] {
    let mut sums = [[0.0; N]; 2];
    for (j, column) in columns.iter().enumerate() {
        sums[j % 2] = sum(&sums[j % 2], column, state[j]);
    }
    sum(&sums[0], &sums[1], 1.0)
}
