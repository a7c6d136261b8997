//! Counts that are read late, or whose age varies, and a tank that debits the steps of the torque when they reach the
//! motor.

use super::*;

/// A board whose torques are latched, a host that sends anything, and a hand that knows the next torque and
/// when its counts are read.
struct Search {
    host: HostTorque,
    sampling: Sampling,
    /// Most parts of a period by which a count is read late.
    late: usize,
    /// Parts from the earliest instant of a count to that of the torques: with as many as `late`, the counts are
    /// old by up to that.
    delay: usize,
    response: HostResponse,
}

impl Search {
    fn new(late: usize, count: f64, debits_steps: bool) -> Self {
        // The reserve for steps of this torque is below the energy.
        let host = HostTorque { torque: 0.4, ..HOST };
        let reading = late as f64 / PARTS as f64 * PERIOD;
        let count = if count > 0.0 { count } else { COUNT };
        let sampling = Sampling { reading, count, ticks: 1, ..sampling() };
        let response = HostResponse::of(&host, &Latency::NONE, &sampling).unwrap();
        let mut response = response.without_memory(&host).unwrap();
        assert!(response.is_plain && response.step_price > 0.0, "{response:?}");
        if !debits_steps {
            response.step_price = 0.0;
        }
        Self { host, sampling, late, delay: 0, response }
    }

    /// Readings whose age is anything up to so many parts.
    fn with_age(late: usize, encoder: &'static EncoderReading) -> Self {
        let (host, sampling) =
            (HostTorque { torque: 0.4, ..HOST }, Sampling { ticks: 1, ..sampling() });
        let response = HostResponse::of(&host, &Latency::NONE.read_by(encoder), &sampling).unwrap();
        Self { host, sampling, late, delay: late, response }
    }

    /// The most energy that the hand has out at any time, over the budget until then.
    fn most<const LAGS: usize>(&self, run: usize) -> f64 {
        let HostTorque { energy, power, damping, torque, .. } = self.host;
        let count = self.sampling.count;
        let mut tank: Tank<FixedDelay<i64, 1>, LAGS> =
            Tank::new(&self.host, &self.response).unwrap();
        let share = 0.5 * self.response.speed * PERIOD;
        let mut motor = Motor::new(self.delay, 0.0, 0);
        motor.commands.push(0.0);
        let mut random = Random(run as u64);
        let size = 10_f64.powf(random.next());
        let (mut position, mut moved, mut read) = (0.37 * count, 0.0_f64, 0);
        let (mut taken, mut most) = (0.0_f64, 0.0_f64);
        for tick in 0..400 {
            let wanted = match run % 5 {
                0 if (tick / (1 + run / 5 % 4)).is_multiple_of(2) => torque,
                0 => -torque,
                1 => torque * size * random.next(),
                2 => torque * moved.signum(),
                3 => -torque * moved.signum(),
                _ => -size * 1e3 * position,
            };
            let command = tank.allowed(tank.in_range(wanted as f32));
            tank.give(command);
            motor.commands.push(f64::from(command) * CODE);
            // From this count to the next.
            let late = match run % 3 {
                0 => self.late,
                1 => tick % 2 * self.late,
                _ => ((0.5 + 0.5 * random.next()) * (self.late + 1) as f64) as usize,
            };
            let parts = PARTS * (tick + 1) + late.min(self.late) - read;
            read += parts;
            let (mut once, mut twice) = (0.0, 0.0);
            for _ in 0..parts {
                let (torque, square) = motor.part(0);
                once += torque / parts as f64;
                twice += square / parts as f64;
            }
            let time = parts as f64 / PARTS as f64 * PERIOD;
            // The step with the most that the tank does not book, and the step with the most for the hand.
            let unseen = 0.5 * (once - (tank.mean() * CODE)) / (damping / time - share / PERIOD);
            let largest = 0.5 * once * time / damping;
            let step = match run % 4 {
                // The hand moves within the tick, and is back.
                0 => 0.0,
                1 if tank.energy() < 0.8 * energy => unseen,
                1 => largest,
                2 => largest * (1.0 + size * random.next()),
                _ => [0.0, unseen, largest][(1.5 + 1.49 * random.next()) as usize],
            };
            taken += once * step - damping * step * step / time
                + 0.25 * time * (twice - once * once) / damping;
            most = most.max(taken / (energy + power * PERIOD * (tick + 1) as f64));
            let steps = (((position + step) / count).floor() - (position / count).floor()) as i32;
            moved = f64::from(steps) * count;
            position += step;
            tank.book(steps);
        }
        most
    }

    /// The most of many hosts, hands and late counts.
    fn most_of_many(late: usize, count: f64, debits_steps: bool) -> f64 {
        let search = Self::new(late, count, debits_steps);
        let any = |run| search.most::<0>(run);
        (0..600).map(any).fold(0.0, f64::max)
    }
}

#[test]
fn counts_that_are_read_late_give_no_more_than_the_budget() {
    for late in 1..=5 {
        for count in [0.0, 1e-4] {
            let most = Search::most_of_many(late, count, true);
            assert!((0.15..=1.0).contains(&most), "{late}, {count}: {most}");
        }
    }
}

#[test]
fn readings_of_a_varying_age_give_no_more_than_the_budget() {
    const fn up_to(parts: usize) -> EncoderReading {
        let most = parts as f64 / PARTS as f64 * PERIOD;
        EncoderReading { age: TimeRange::between(0.0, most), ..*EncoderReading::ideal() }
    }
    static ENCODERS: [(usize, EncoderReading); 3] = [(2, up_to(2)), (8, up_to(8)), (20, up_to(20))];
    for (late, encoder) in &ENCODERS {
        let search = Search::with_age(*late, encoder);
        let most = (0..600).map(|run| search.most::<1>(run)).fold(0.0, f64::max);
        assert!((0.15..=1.0).contains(&most), "{late}: {most}");
    }
}

#[test]
fn without_the_debit_of_steps_the_budget_is_exceeded() {
    for late in 1..=5 {
        let most = Search::most_of_many(late, 0.0, false);
        assert!(most > 1.5, "{late}: {most}");
    }
}
