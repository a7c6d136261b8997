//! Regions of a grid as polygons: exact to the cell, and small enough for a file of lines.

/// A closed polygon in cells, from 0 to the number of columns and rows.
pub type Polygon = Vec<(usize, usize)>;

/// A run of cells in one column: from a row up to another.
type Run = (usize, usize);

/// Polygons that together cover the cells for which `inside(column, row)` holds. A region is divided where it
/// branches or joins.
pub fn polygons(
    columns: usize,
    rows: usize,
    inside: impl Fn(usize, usize) -> bool,
) -> Vec<Polygon> {
    let mut open: Vec<(usize, Vec<Run>)> = Vec::new();
    let mut done = Vec::new();
    for column in 0..columns {
        let found = runs(rows, |row| inside(column, row));
        let (mut goes_on, mut taken) = (Vec::new(), vec![false; found.len()]);
        for (first, mut strip) in open {
            let last = strip.last().copied().unwrap_or_default();
            let mut next = (0..found.len()).filter(|&i| !taken[i] && touch(last, found[i]));
            match (next.next(), next.next()) {
                (Some(only), None) => {
                    taken[only] = true;
                    strip.push(found[only]);
                    goes_on.push((first, strip));
                }
                _ => done.push(outline(first, &strip)),
            }
        }
        let begun = found.iter().zip(&taken).filter(|(_, taken)| !**taken);
        goes_on.extend(begun.map(|(&run, _)| (column, vec![run])));
        open = goes_on;
    }
    done.extend(open.iter().map(|(first, strip)| outline(*first, strip)));
    done
}

fn touch(a: Run, b: Run) -> bool {
    a.0 < b.1 && b.0 < a.1
}

fn runs(rows: usize, inside: impl Fn(usize) -> bool) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for row in (0..rows).filter(|&row| inside(row)) {
        match runs.last_mut() {
            Some(run) if run.1 == row => run.1 = row + 1,
            _ => runs.push((row, row + 1)),
        }
    }
    runs
}

/// Along the lower ends, and back along the upper ones.
fn outline(first: usize, strip: &[Run]) -> Polygon {
    let lower = side(first, strip.iter().map(|run| run.0));
    let upper = side(first, strip.iter().map(|run| run.1));
    lower.into_iter().chain(upper.into_iter().rev()).collect()
}

/// A line of steps, without the points between others on the same line.
fn side(first: usize, ends: impl Iterator<Item = usize>) -> Polygon {
    let mut line: Polygon = Vec::new();
    for (offset, end) in ends.enumerate() {
        let column = first + offset;
        match line.last_mut() {
            Some(last) if last.1 == end => last.0 = column + 1,
            _ => line.extend([(column, end), (column + 1, end)]),
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the area by the shoelace rule.
    fn area(polygon: &Polygon) -> i64 {
        let at = |i: usize| {
            let (x, y) = polygon[i % polygon.len()];
            (x as i64, y as i64)
        };
        let cross = |i: usize| at(i).0 * at(i + 1).1 - at(i + 1).0 * at(i).1;
        (0..polygon.len()).map(cross).sum::<i64>().abs()
    }

    #[test]
    fn every_shape_keeps_its_area() {
        type Shape = fn(usize, usize) -> bool;
        let ring: Shape = |x, y| {
            let r = (x as i64 - 20).pow(2) + (y as i64 - 20).pow(2);
            (50..300).contains(&r)
        };
        let fork: Shape = |x, y| x < 10 || y % 7 < 3;
        let speckles: Shape = |x, y| (x * 31 + y * 17) % 5 == 0;
        for shape in [ring, fork, speckles, |_, _| true, |_, _| false] {
            let cells = (0..40).flat_map(|x| (0..40).map(move |y| (x, y)));
            let count = cells.filter(|&(x, y)| shape(x, y)).count() as i64;
            assert_eq!(polygons(40, 40, shape).iter().map(area).sum::<i64>(), 2 * count);
        }
        assert_eq!(polygons(40, 40, |_, _| true), [[(0, 0), (40, 0), (40, 40), (0, 40)]]);
    }
}
