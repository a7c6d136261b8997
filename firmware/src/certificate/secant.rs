//! Root search for a scene's shortage, between a failing and a passing value.

use super::digits::{Digits, Side};

/// The largest number of evaluations inside a bracket. A secant needs two or three; halving, if there is no
/// index for a secant, needs ten for the three reported digits.
const MAX_LOOKS: u32 = 14;
/// If two evaluations are this near, relative to the value, their secant needs no proof that the next digit
/// fails.
const NEAR: f64 = 0.03;

/// A value of the number in question, and the shortage with it.
#[derive(Clone, Copy)]
pub(super) struct Look {
    pub value: f64,
    /// [`super::PassivityProblem::shortage`]; `None` if the scene cannot be posed, or has no shortage.
    pub shortage: Option<f64>,
}

impl Look {
    pub const fn passes(&self) -> bool {
        matches!(self.shortage, Some(shortage) if shortage < 0.0)
    }

    /// Whether the shortage with another value is exactly equal: it does not depend on this number.
    pub const fn is_as_good_as(&self, other: &Self) -> bool {
        match (self.shortage, other.shortage) {
            (Some(own), Some(others)) => own == others,
            _ => false,
        }
    }
}

/// A failing and a passing value.
#[derive(Clone, Copy)]
pub(super) struct Bracket {
    pub fails: Look,
    pub passes: Look,
}

impl Bracket {
    const fn width(&self) -> f64 {
        (self.fails.value - self.passes.value).abs()
    }

    const fn middle(&self) -> f64 {
        // Each halved separately: the sum of the largest numbers is infinite.
        0.5 * self.fails.value + 0.5 * self.passes.value
    }

    /// The root of the straight line through two evaluations, if the shortage grows towards the failing
    /// value: close to values without an index, it may decrease.
    const fn zero_of_secant(&self, a: &Look, b: &Look) -> Option<f64> {
        let (Some(at_a), Some(at_b)) = (a.shortage, b.shortage) else { return None };
        let grows_upwards = (at_b > at_a) == (b.value > a.value);
        if at_a == at_b || grows_upwards != (self.fails.value > self.passes.value) {
            return None;
        }
        Some(b.value - at_b * (b.value - a.value) / (at_b - at_a))
    }

    /// Whether a value outside the bracket is on the passing side.
    const fn is_behind(&self, value: f64) -> bool {
        (value <= self.passes.value) == (self.passes.value < self.fails.value)
    }

    const fn contains(&self, value: f64) -> bool {
        let (a, b) = (self.fails.value, self.passes.value);
        (a < value && value < b) || (b < value && value < a)
    }
}

/// Narrows a bracket down to neighbours of three digits.
///
/// The shortage is nearly linear in most numbers, so the root of the secant through the last two evaluations
/// is close. If two evaluations have not halved the bracket, it is halved from then on.
pub(super) struct Search {
    side: Side,
    bracket: Bracket,
    last: Look,
    previous: Look,
    /// The best passing value, rounded to three digits.
    nearest: Digits,
    /// Whether the passing value was evaluated with these digits; false before the first evaluation passes.
    has_digits: bool,
    bisects: bool,
    /// The width of the bracket at most two evaluations ago.
    width: f64,
    looks: u32,
}

impl Search {
    pub const fn new(bracket: Bracket, side: Side) -> Self {
        Self {
            side,
            last: bracket.passes,
            previous: bracket.fails,
            nearest: Digits::of(bracket.passes.value, side),
            has_digits: false,
            bisects: false,
            width: bracket.width(),
            looks: 0,
            bracket,
        }
    }

    /// The passing value, to three digits.
    pub const fn nearest(&self) -> Digits {
        self.nearest
    }

    /// The next value to evaluate; `None` at the end.
    pub const fn next(&self) -> Option<Digits> {
        if self.looks == MAX_LOOKS {
            return None;
        }
        let guess = self.guess();
        let beside = guess.further(self.side);
        let inside = if self.bracket.contains(guess.value()) {
            guess
        } else if self.bracket.contains(beside.value()) {
            beside
        } else if self.has_digits && self.is_near() {
            return None;
        } else {
            self.nearest.nearer(self.side)
        };
        if self.bracket.contains(inside.value()) { Some(inside) } else { None }
    }

    /// The root of the secant, or the middle.
    const fn guess(&self) -> Digits {
        let zero = if self.bisects {
            None
        } else {
            self.bracket.zero_of_secant(&self.previous, &self.last)
        };
        match zero {
            Some(zero) if self.bracket.is_behind(zero) => self.nearest.nearer(self.side),
            Some(zero) if self.bracket.contains(zero) => Digits::of(zero, self.side),
            Some(_) => Digits::of(self.bracket.fails.value, self.side),
            None => Digits::of(self.bracket.middle(), self.side),
        }
    }

    const fn is_near(&self) -> bool {
        (self.last.value - self.previous.value).abs() <= NEAR * self.last.value
    }

    /// Takes the shortage at the value of [`Search::next`].
    pub const fn learn(&mut self, value: Digits, shortage: Option<f64>) {
        self.previous = self.last;
        self.last = Look { value: value.value(), shortage };
        if self.last.passes() {
            (self.nearest, self.has_digits) = (value, true);
            self.bracket.passes = self.last;
        } else {
            self.bracket.fails = self.last;
        }
        self.looks += 1;
        if self.looks.is_multiple_of(2) {
            self.bisects = self.bisects || self.bracket.width() > 0.5 * self.width;
            self.width = self.bracket.width();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The middle of the largest numbers is one, too: an infinite one has no digits.
    #[test]
    fn a_search_among_the_largest_numbers_ends() {
        let look = |value, shortage| Look { value, shortage };
        for side in [Side::Below, Side::Above] {
            let (fails, passes) = (look(f64::MAX, None), look(f64::MAX / 1.5, Some(-1.0)));
            let mut search = Search::new(Bracket { fails, passes }, side);
            let mut looks = 0;
            while let Some(value) = search.next() {
                assert!(search.bracket.contains(value.value()));
                search.learn(value, None);
                looks += 1;
            }
            assert!((1..=MAX_LOOKS).contains(&looks), "{looks}");
        }
    }
}
