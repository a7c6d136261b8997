//! The sum of shapes as one table of knots.

use core::f64::consts::TAU;

use super::knots::{FULL_SCALE, Knots, Outline};
use super::layout::{Ends, Layout, SnapPoint, nearest};
use super::shape::Shape;
use super::shape_error::ShapeError;

impl<const KNOTS: usize> Knots<KNOTS> {
    /// The sum of shapes.
    ///
    /// The knots lie on the cells of the table: a corner elsewhere is cut off, which makes no slope steeper.
    ///
    /// # Errors
    /// If the shapes do not make a profile.
    pub const fn sampled(shapes: &[Shape]) -> Result<Self, ShapeError> {
        let mut units = [0; KNOTS];
        let (layout, wraps) = ok!(sampled(shapes, &mut units));
        Ok(Self::new(units, wraps, layout))
    }

    /// For constants: the same, or a compile error with the reason.
    ///
    /// # Panics
    /// If the shapes do not make a profile; in a constant this is a compile error.
    #[track_caller]
    pub const fn of(shapes: &[Shape]) -> Self {
        match Self::sampled(shapes) {
            Ok(knots) => knots,
            Err(error) => error.refuse(),
        }
    }
}

/// Writes the sum of shapes into the units of knots, whose number must be a power of two from 8 on. Returns
/// their layout, and whether the cell after the last knot is used.
///
/// # Errors
/// If the shapes do not make a profile.
pub const fn sampled(shapes: &[Shape], units: &mut [i16]) -> Result<(Layout, bool), ShapeError> {
    let frame = ok!(Frame::of(shapes, units.len()));
    let mut torque: f64 = match frame.snap {
        Some(Shape::SnapDetents { torque, .. }) => torque,
        _ => 0.0,
    };
    each!(i in 0..units.len() => {
        torque = torque.max(frame.torque_at(shapes, i).abs());
    });
    if torque == 0.0 {
        if frame.ends.is_none() {
            return Err(ShapeError::Flat);
        }
        // All units are zero for any torque.
        torque = 1.0;
    }
    each!(i in 0..units.len() => {
        let part = frame.torque_at(shapes, i) / torque;
        units[i] = nearest(part.abs() * FULL_SCALE as f64) as i16;
        if part < 0.0 {
            units[i] = -units[i];
        }
    });
    if frame.ends.is_none() {
        let mean = mean(shapes);
        // A smaller mean is less than a unit of a knot.
        if mean.abs() > 0.5 * torque / FULL_SCALE as f64 {
            return Err(ShapeError::Mean { mean });
        }
        if !make_odd(units) {
            balance(units);
        }
    }
    let Frame { count, centre, ends, wraps, .. } = frame;
    let mut layout = Layout { torque, count, centre, ends, snap: None };
    if let Some(Shape::SnapDetents { count, torque, centre, snap }) = frame.snap {
        layout.snap = Some(SnapPoint::new(&layout, count, torque, centre, snap));
    }
    Ok((layout, wraps))
}

/// Makes the knots exactly odd about the first if they are odd except for rounding; returns whether they are
/// odd.
const fn make_odd(units: &mut [i16]) -> bool {
    each!(i in 0..units.len() => {
        let mirrored = units[(units.len() - i) % units.len()] as i32;
        if (units[i] as i32 + mirrored).abs() > 1 {
            return false;
        }
    });
    let half = units.len() / 2;
    (units[0], units[half]) = (0, 0);
    each!(i in 1..half => {
        units[units.len() - i] = -units[i];
    });
    true
}

/// Makes the sum of the knots zero, one unit per knot: rounding and cut corners may leave a small sum.
const fn balance(units: &mut [i16]) {
    let mut sum = Outline::of(units, true).sum;
    let mut i = 0;
    while sum != 0 {
        let unit = units[i % units.len()] as i32 - sum.signum();
        // No knot exceeds full scale; another knot takes the unit.
        if unit.abs() <= FULL_SCALE as i32 {
            units[i % units.len()] = unit as i16;
            sum -= sum.signum();
        }
        i += 1;
    }
}

/// The mean torque in N m of periodic tables, by their own knots; the mean of other shapes is zero.
const fn mean(shapes: &[Shape]) -> f64 {
    let mut mean = 0.0;
    each!(i in 0..shapes.len() => {
        if let Shape::Periodic(knots) = shapes[i] {
            let mut area = 0.0;
            each!(k in 1..knots.len() => {
                let ((from, below), (to, above)) = (knots[k - 1], knots[k]);
                area += 0.5 * (below + above) * (to - from);
            });
            mean += area / (knots[knots.len() - 1].0 - knots[0].0);
        }
    });
    mean
}

/// The position of a table's cells.
struct Frame {
    /// Width of a cell in rad.
    cell: f64,
    count: f64,
    centre: f64,
    ends: Option<Ends>,
    /// The shape whose springs are the end stops.
    outermost: Option<usize>,
    /// The detents with a snap point, which are not in the table.
    snap: Option<Shape>,
    wraps: bool,
}

impl Frame {
    const fn of(shapes: &[Shape], knots: usize) -> Result<Self, ShapeError> {
        if shapes.is_empty() {
            return Err(ShapeError::Empty);
        }
        let mut repeats: u32 = 0;
        let mut centre = 0.0;
        let mut narrowest = f64::INFINITY;
        let mut ends: Option<Ends> = None;
        let mut outermost = None;
        let mut single = None;
        let mut snap = None;
        each!(i in 0..shapes.len() => {
            ok!(shapes[i].checked(i));
            if let Shape::SnapDetents { .. } = shapes[i] {
                if snap.is_some() {
                    return Err(ShapeError::SecondSnap { shape: i });
                }
                snap = Some(shapes[i]);
            }
            narrowest = narrowest.min(shapes[i].narrowest());
            if let Some(reach) = shapes[i].extent()
                && reach.stiffness > 0.0
            {
                let is_stops = matches!(shapes[i], Shape::EndStops { .. });
                match &mut ends {
                    Some(widest) => {
                        if is_stops && (reach.to - reach.from > widest.to - widest.from) {
                            outermost = Some(i);
                        }
                        widest.from = widest.from.min(reach.from);
                        widest.to = widest.to.max(reach.to);
                        widest.stiffness = widest.stiffness.max(reach.stiffness);
                    }
                    None => {
                        ends = Some(reach);
                        outermost = if is_stops { Some(i) } else { None };
                    }
                }
            }
            match (shapes[i].repeats(), &shapes[i]) {
                (_, Shape::EndStops { .. }) => {}
                (Some(count), shape) => {
                    if let (
                        Shape::Detents { centre: of_this, .. }
                        | Shape::SnapDetents { centre: of_this, .. },
                        0,
                    ) = (shape, repeats)
                    {
                        centre = *of_this;
                    }
                    repeats = common_divisor(repeats, count);
                }
                (None, _) => single = Some(i),
            }
        });
        let frame = match (single, ends) {
            (Some(shape), None) => return Err(ShapeError::Endless { shape }),
            (Some(_), Some(Ends { from, to, .. })) => {
                // A level cell at either end keeps the range clear of the cell from the last knot to the
                // first.
                let cell = (to - from) / (knots - 3) as f64;
                let (count, centre) = (TAU / (cell * knots as f64), from - cell);
                Self { cell, count, centre, ends, outermost, snap, wraps: false }
            }
            (None, None) if repeats == 0 => return Err(ShapeError::Flat),
            (None, ends) => {
                // A profile that is zero between its ends repeats any number of times.
                let count = if repeats == 0 { 1.0 } else { repeats as f64 };
                let cell = TAU / count / knots as f64;
                Self { cell, count, centre, ends, outermost, snap, wraps: true }
            }
        };
        // Narrower cells, so that each straight piece is represented.
        if frame.cell > narrowest {
            return Err(ShapeError::TooFewKnots {
                knots,
                needed: nearest(knots as f64 * frame.cell / narrowest + 0.5),
            });
        }
        Ok(frame)
    }

    /// The torque in N m of all shapes at a knot.
    const fn torque_at(&self, shapes: &[Shape], knot: usize) -> f64 {
        let mut angle = self.centre + knot as f64 * self.cell;
        if let (Some(Ends { from, to, .. }), false) = (self.ends, self.wraps) {
            angle = angle.max(from).min(to);
        }
        let mut sum = 0.0;
        each!(i in 0..shapes.len() => {
            // The outermost springs act beyond the table.
            let is_beyond = match self.outermost {
                Some(outermost) => outermost == i,
                None => false,
            };
            if !is_beyond && !matches!(shapes[i], Shape::SnapDetents { .. }) {
                sum += shapes[i].torque_at(angle);
            }
        });
        sum
    }
}

const fn common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}
