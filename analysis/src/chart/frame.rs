//! Clipping of lines to a frame.

/// A point in units of the drawing, from the upper left corner of a panel.
pub type Place = (f64, f64);

pub fn whole(place: &Place) -> (i32, i32) {
    (place.0.round() as i32, place.1.round() as i32)
}

/// A rectangle from the upper left corner on; down is positive, as in the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub right: f64,
    pub bottom: f64,
}

impl Frame {
    /// Whether a place is inside or on the border; never true of NaN.
    pub fn contains(&self, (x, y): Place) -> bool {
        (0.0..=self.right).contains(&x) && (0.0..=self.bottom).contains(&y)
    }

    /// The nearest place inside or on the border.
    pub fn nearest(&self, (x, y): Place) -> Place {
        (x.clamp(0.0, self.right), y.clamp(0.0, self.bottom))
    }

    /// The point in which the line from an inner to an outer place crosses the border.
    pub fn crossing(&self, inner: Place, outer: Place) -> Place {
        let part = |from: f64, to: f64, high: f64| {
            let bound = if to > from { high } else { 0.0 };
            if to == from { f64::INFINITY } else { (bound - from) / (to - from) }
        };
        let t = part(inner.0, outer.0, self.right)
            .min(part(inner.1, outer.1, self.bottom))
            .clamp(0.0, 1.0);
        let x = inner.0 + t * (outer.0 - inner.0);
        let y = inner.1 + t * (outer.1 - inner.1);
        self.nearest((x, y))
    }

    /// The parts of a line inside, up to the border.
    pub fn clip(&self, line: &[Place]) -> Vec<Vec<Place>> {
        let mut parts: Vec<Vec<Place>> = Vec::new();
        let mut open = false;
        for (i, &place) in line.iter().enumerate() {
            let inside = self.contains(place);
            let before = i.checked_sub(1).map(|j| line[j]).filter(|p| p.0.is_finite());
            match (open, inside) {
                (false, true) => {
                    let entry = before.map(|before| self.crossing(place, before));
                    parts.push(entry.into_iter().chain([place]).collect());
                }
                (true, _) => {
                    if let (Some(part), Some(before)) = (parts.last_mut(), before) {
                        let end = if inside { place } else { self.crossing(before, place) };
                        part.extend([end].into_iter().filter(|end| end.0.is_finite()));
                    }
                }
                (false, false) => {}
            }
            open = inside;
        }
        parts
    }
}
