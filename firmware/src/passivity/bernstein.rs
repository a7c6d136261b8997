//! Enclosure of the minimum of a rational function of `c = cos(theta)` over `[-1, 1]`.
//!
//! Numerator `p` and denominator `r` are brought to Bernstein form on a box. Where all coefficients `r_i` are
//! positive, `p / r` is a convex mean of the `p_i / r_i`, so the smallest of these is a lower bound; the
//! values at the box's ends are upper bounds of the minimum. Boxes are halved until both meet. The bounds
//! converge quadratically, and rounding is always outward, so the result encloses the minimum even if the
//! halving ends early. To decide on which side of a border the minimum is, a few boxes are enough.

use super::chebyshev::Series;
use super::interval::Interval;
use super::polynomial::MAX_DEGREE;
use super::rounding::{div_down, div_up};

pub(super) const SIZE: usize = MAX_DEGREE + 2;
/// The pool of waiting boxes: five of the largest degree, more of smaller degrees. Few boxes wait, because a
/// half that cannot contain the minimum is settled at once, and the working memory must fit a small target's
/// stack.
const POOL: usize = 2 * SIZE * 5;
const MAX_WAITING: usize = 16;
const MAX_BOXES: u32 = 600;
const MAX_LEVEL: u32 = 30;
/// Smallest requested width of an enclosure, relative to its magnitude.
const TOLERANCE: f64 = 1e-13;
/// Distance of a bound from a border, relative to the border, at which the side of the minimum is decided:
/// far larger than rounding errors, so a finer search would not change the decision.
const CLEARANCE: f64 = 1e-9;

/// The required precision of a minimum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// The enclosure is as tight as possible near this border, and only as tight as necessary if the minimum
    /// is clearly on one side: with [`Interval::ENTIRE`] it is tight everywhere, with a limit it decides on
    /// which side of the limit the minimum is.
    pub border: Interval,
    /// Relative width of the enclosure at which the search may end.
    pub tolerance: f64,
}

impl Precision {
    /// As tight as possible.
    pub const TIGHT: Self = Self { border: Interval::ENTIRE, tolerance: TOLERANCE };

    /// Sufficient to decide on which side of a border the minimum is.
    pub const fn around(border: Interval) -> Self {
        Self { border, ..Self::TIGHT }
    }

    /// The same for a function that is smaller by this factor.
    pub const fn scaled(&self, factor: Interval) -> Self {
        if !self.border.is_finite() {
            return *self;
        }
        Self { border: self.border.mul(factor), ..*self }
    }

    /// A width relative to the minimum's magnitude.
    pub const fn within(tolerance: f64) -> Self {
        Self { tolerance: tolerance.max(TOLERANCE), ..Self::TIGHT }
    }
}

/// The minimum of `p / r`, and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// Encloses the minimum; the lower end is infinite if `r` could not be proved positive.
    pub value: Interval,
    /// An enclosure, the size of a box, of the `c` with the smallest value found; all of `[-1, 1]` if both
    /// ends have it, for instance for a constant `p / r`.
    pub at: Interval,
}

/// Bernstein coefficients of `p` and `r` on one box, of the same degree.
#[derive(Clone, Copy)]
pub(super) struct Bernstein {
    pub p: [Interval; SIZE],
    pub r: [Interval; SIZE],
    pub degree: usize,
}

impl Minimum {
    /// Whether no other computation of `p` and `r` would tell more: it is as tight as requested, or clearly
    /// on one side of the border.
    pub(super) const fn is_precise(&self, closeness: &Precision) -> bool {
        let Precision { border, .. } = *closeness;
        let is_clear = self.value.hi() < border.lo() - CLEARANCE * border.lo().abs()
            || self.value.lo() > border.hi() + CLEARANCE * border.hi().abs();
        let width = self.value.hi() - self.value.lo();
        is_clear || width.is_finite() && width <= CLEARANCE * self.value.magnitude()
    }
}

#[derive(Clone, Copy)]
struct Waiting {
    left: f64,
    level: u32,
    bound: Bound,
}

/// Lower bound of `p / r` on a box.
#[derive(Clone, Copy)]
struct Bound {
    lower: f64,
    /// The part due to rounding, which halving cannot improve.
    rounding: f64,
}

impl Waiting {
    const NONE: Self =
        Self { left: 0.0, level: 0, bound: Bound { lower: f64::INFINITY, rounding: 0.0 } };
}

/// Encloses the minimum of `p / r` over `c` in `[-1, 1]`; `r` must be positive there, which is proved as
/// well.
///
/// `ends` encloses `r` at -1 and at 1. As sums of the series the two lose all digits near a root, because
/// they are squares of small numbers. A caller with the roots of these squares has better enclosures, which
/// improve every box next to an end.
#[inline(never)]
pub const fn minimum(
    p: &Series,
    r: &Series,
    ends: [Interval; 2],
    closeness: &Precision,
) -> Minimum {
    let degree = if p.degree() > r.degree() { p.degree() } else { r.degree() };
    let mut root = Bernstein { p: from_chebyshev(p, degree), r: from_chebyshev(r, degree), degree };
    root.r[0] = root.r[0].and(ends[0]);
    root.r[degree] = root.r[degree].and(ends[1]);
    minimum_in(&mut root, false, closeness)
}

/// The same from Bernstein coefficients on `[-1, 1]`, whose memory the search uses.
pub(super) const fn minimum_of(function: &mut Bernstein, closeness: &Precision) -> Minimum {
    minimum_in(function, true, closeness)
}

#[inline(never)]
const fn minimum_in(root: &mut Bernstein, is_rounded: bool, closeness: &Precision) -> Minimum {
    let border = closeness.border;
    let mut search = Search {
        is_rounded,
        clearly_below: border.lo() - CLEARANCE * border.lo().abs(),
        clearly_above: border.hi() + CLEARANCE * border.hi().abs(),
        tolerance: closeness.tolerance,
        upper: f64::INFINITY,
        at: Interval::ZERO,
        lower: f64::INFINITY,
    };
    let left = upper_bound(root.p[0], root.r[0]);
    let right = upper_bound(root.p[root.degree], root.r[root.degree]);
    search.run(root);
    let lower = search.lower.min(search.upper);
    let flat = left.max(right) <= search.upper + 1e-12 * search.upper.abs();
    let at = if flat { Interval::new(-1.0, 1.0) } else { search.at };
    Minimum { value: Interval::new(lower, search.upper), at }
}

/// Upper bound of `p / r`; infinite if `r` is not proved positive.
const fn upper_bound(p: Interval, r: Interval) -> f64 {
    if r.is_positive() {
        div_up(p.hi(), if p.hi() >= 0.0 { r.lo() } else { r.hi() })
    } else {
        f64::INFINITY
    }
}

struct Search {
    /// Whether the coefficients of the first box are so inexact that halving makes up for rounding, other
    /// than at the ends, where coefficients are values.
    is_rounded: bool,
    /// The search ends at a value below this bound, or if all boxes are above the other bound.
    clearly_below: f64,
    clearly_above: f64,
    tolerance: f64,
    /// Smallest proved upper bound so far, and its `c`.
    upper: f64,
    at: Interval,
    /// Smallest lower bound of the settled boxes.
    lower: f64,
}

/// Waiting boxes.
struct Queue {
    pool: [Interval; POOL],
    waiting: [Waiting; MAX_WAITING],
    len: usize,
}

impl Search {
    /// Searches, beginning with the whole interval, in the memory of `pieces`.
    const fn run(&mut self, pieces: &mut Bernstein) {
        let whole = Waiting { left: -1.0, level: 0, bound: self.look(pieces, -1.0, 2.0) };
        if self.upper < self.clearly_below || self.is_settled(whole.bound) {
            // Most searches end here, and need no memory for boxes.
            self.lower = whole.bound.lower;
        } else {
            self.run_through_boxes(pieces, whole);
        }
    }

    #[inline(never)]
    const fn run_through_boxes(&mut self, pieces: &mut Bernstein, whole: Waiting) {
        let mut queue = Queue::EMPTY;
        let mut current = self.split(&mut queue, pieces, whole);
        let mut boxes = 1;
        loop {
            boxes += 1;
            if self.upper < self.clearly_below {
                self.give_up(&queue, current.bound);
                return;
            }
            if boxes > MAX_BOXES || current.level >= MAX_LEVEL || self.is_settled(current.bound) {
                self.lower = self.lower.min(current.bound.lower);
            } else {
                current = self.split(&mut queue, pieces, current);
                continue;
            }
            match queue.take(pieces) {
                Some(next) => current = next,
                None => return,
            }
        }
    }

    /// Ends the search, with the remaining boxes as they are.
    const fn give_up(&mut self, queue: &Queue, current: Bound) {
        self.lower = self.lower.min(current.lower);
        each!(i in 0..queue.len => {
            self.lower = self.lower.min(queue.waiting[i].bound.lower);
        });
    }

    /// Bounds the minimum on a box: updates the upper bound, returns the lower one.
    const fn look(&mut self, pieces: &Bernstein, left: f64, width: f64) -> Bound {
        let n = pieces.degree;
        self.evaluate(upper_bound(pieces.p[0], pieces.r[0]), left, width);
        self.evaluate(upper_bound(pieces.p[n], pieces.r[n]), left + width, width);
        let mut bound = Bound { lower: f64::INFINITY, rounding: 0.0 };
        each!(i in 0..=n => {
            let (p, r) = (pieces.p[i], pieces.r[i]);
            if !r.is_positive() {
                return Bound { lower: f64::NEG_INFINITY, rounding: 0.0 };
            }
            let lower = div_down(p.lo(), if p.lo() >= 0.0 { r.hi() } else { r.lo() });
            if lower < bound.lower {
                let improves = self.is_rounded && i != 0 && i != n;
                let rounding = if improves { 0.0 } else { upper_bound(p, r) - lower };
                bound = Bound { lower, rounding };
            }
        });
        bound
    }

    const fn evaluate(&mut self, value: f64, at: f64, width: f64) {
        if value < self.upper {
            self.upper = value;
            self.at = if at.abs() == 1.0 {
                Interval::exact(at)
            } else {
                Interval::new((at - width).max(-1.0), (at + width).min(1.0))
            };
        }
    }

    /// Whether halving the box cannot change the result by more than the precision, or than rounding.
    const fn is_settled(&self, bound: Bound) -> bool {
        let slack = (self.tolerance * self.upper.abs()).max(2.0 * bound.rounding);
        bound.lower > self.clearly_above || bound.lower >= self.upper - slack
    }

    /// Halves the box. Returns the half with the smaller lower bound and queues the other half; a half that
    /// cannot contain a smaller value is settled at once.
    #[inline(never)]
    const fn split(
        &mut self,
        queue: &mut Queue,
        pieces: &mut Bernstein,
        parent: Waiting,
    ) -> Waiting {
        let n = pieces.degree;
        let width = box_width(parent.level + 1);
        let middle = parent.left + width;
        let mut right = *pieces;
        halve(&mut pieces.p, &mut right.p, n);
        halve(&mut pieces.r, &mut right.r, n);
        let level = parent.level + 1;
        let low = self.look(pieces, parent.left, width);
        let high = self.look(&right, middle, width);
        let a = Waiting { left: parent.left, level, bound: low };
        let b = Waiting { left: middle, level, bound: high };
        if low.lower <= high.lower {
            self.put_aside(queue, &right, b);
            a
        } else {
            self.put_aside(queue, pieces, a);
            *pieces = right;
            b
        }
    }

    const fn put_aside(&mut self, queue: &mut Queue, pieces: &Bernstein, waiting: Waiting) {
        if self.is_settled(waiting.bound) || !queue.put(pieces, waiting) {
            self.lower = self.lower.min(waiting.bound.lower);
        }
    }
}

impl Queue {
    const EMPTY: Self =
        Self { pool: [Interval::ZERO; POOL], waiting: [Waiting::NONE; MAX_WAITING], len: 0 };

    /// Queues a box; returns whether there was room.
    #[inline(never)]
    const fn put(&mut self, pieces: &Bernstein, waiting: Waiting) -> bool {
        let degree = pieces.degree;
        let stride = 2 * (degree + 1);
        let base = self.len * stride;
        if base + stride > POOL || self.len >= MAX_WAITING {
            return false;
        }
        each!(i in 0..=degree => {
            self.pool[base + i] = pieces.p[i];
            self.pool[base + degree + 1 + i] = pieces.r[i];
        });
        self.waiting[self.len] = waiting;
        self.len += 1;
        true
    }

    const fn take(&mut self, pieces: &mut Bernstein) -> Option<Waiting> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        let degree = pieces.degree;
        let base = self.len * 2 * (degree + 1);
        each!(i in 0..=degree => {
            pieces.p[i] = self.pool[base + i];
            pieces.r[i] = self.pool[base + degree + 1 + i];
        });
        Some(self.waiting[self.len])
    }
}

/// Width of a box after `level` halvings of `[-1, 1]`; a power of two, exact.
const fn box_width(level: u32) -> f64 {
    2.0 / (1u64 << level) as f64
}

/// De Casteljau at the middle: `left` becomes the left half, `right` (a copy) the right half.
const fn halve(left: &mut [Interval; SIZE], right: &mut [Interval; SIZE], n: usize) {
    // right[0..] is reduced in place: after step k, right[i] holds the mean of level k.
    each!(k in 0..=n => {
        left[k] = right[0];
        let mut i = 0;
        while i + k < n {
            right[i] = right[i].add(right[i + 1]).half();
            i += 1;
        }
    });
    // Level k left its last mean, the right half's coefficient n - k, at right[n - k].
}

/// Bernstein coefficients on `[-1, 1]`, `c` growing with the index, of a Chebyshev series.
///
/// Multiplied by the binomials, `T_k` has the whole coefficients `(-1)^(k-i) C(2k, 2i)` at degree `k`, and
/// raising the degree by one adds neighbours; so only the series' own coefficients and the final division by
/// the binomials are rounded.
#[inline(never)]
const fn from_chebyshev(series: &Series, degree: usize) -> [Interval; SIZE] {
    let mut scaled = [Interval::ZERO; SIZE];
    each!(k in 0..=degree => {
        // Raise from degree k - 1 to k: multiply by (1 - t) + t.
        let mut i = k;
        while i > 0 {
            scaled[i] = scaled[i].add(scaled[i - 1]);
            i -= 1;
        }
        let a = series.coefficient(k);
        if !a.is_zero() {
            each!(i in 0..=k => {
                let sign = if (k - i) % 2 == 0 { 1.0 } else { -1.0 };
                let weight = Interval::exact(sign * binomial(2 * k, 2 * i));
                scaled[i] = scaled[i].add(a.mul(weight));
            });
        }
    });
    each!(i in 0..=degree => {
        scaled[i] = scaled[i].div(Interval::exact(binomial(degree, i)));
    });
    scaled
}

/// `C(n, k)` for `n <= 34`: below 2^53, so exact.
pub(super) const fn binomial(n: usize, k: usize) -> f64 {
    let k = if k > n - k { n - k } else { k };
    let mut value: u64 = 1;
    each!(i in 0..k => {
        value = value * (n - i) as u64 / (i + 1) as u64;
    });
    value as f64
}
