//! Where a plane changes its class: a grid of cells, then smaller cells wherever the boundary may be.
//!
//! A cell is split if its corners, or those of its neighbours, are not all of one class, or if a
//! corner is close to another class by its own margin, the closer the smaller the cell. A search along
//! lines, as by bisection, crosses a strip of another class without seeing it. Here none is lost if the margin
//! falls below its bound within half a cell's diagonal of the strip.

use std::collections::{BTreeMap, BTreeSet};

/// A point of the finest grid: column, row.
pub type Point = (u32, u32);

/// A square cell: its lower left point and its side, in steps of the finest grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    pub at: Point,
    pub side: u32,
}

impl Cell {
    pub fn corners(self) -> [Point; 4] {
        let ((x, y), s) = (self.at, self.side);
        [(x, y), (x + s, y), (x, y + s), (x + s, y + s)]
    }

    fn quarters(self) -> [Self; 4] {
        let side = self.side / 2;
        Self { side, ..self }.corners().map(|at| Self { at, side })
    }
}

/// What the refinement looks at.
pub trait Sample {
    /// Points of different classes have a boundary between them.
    fn class(&self) -> u8;
    /// By its own margin another class is close, for a cell whose side is this share of the first ones'.
    fn is_close(&self, side: f64) -> bool;
}

/// Cells that cover the plane, and all points that were evaluated.
pub struct Refined<S> {
    pub cells: Vec<Cell>,
    pub points: BTreeMap<Point, S>,
}

/// Starts from `columns` × `rows` cells and splits them up to `depth` times. `evaluate` gets all new
/// points of a round, in order.
pub fn refine<S: Sample, E>(
    [columns, rows]: [u32; 2],
    depth: u32,
    mut evaluate: impl FnMut(&[Point]) -> Result<Vec<S>, E>,
) -> Result<Refined<S>, E> {
    let side = 1 << depth;
    let first = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let mut open: Vec<Cell> = first.map(|(x, y)| Cell { at: (x * side, y * side), side }).collect();
    let mut points: BTreeMap<Point, S> = BTreeMap::new();
    let mut cells = Vec::new();
    for round in 0..=depth {
        let corners = open.iter().flat_map(|cell| cell.corners());
        let new: BTreeSet<Point> = corners.filter(|point| !points.contains_key(point)).collect();
        let new: Vec<Point> = new.into_iter().collect();
        points.extend(new.iter().copied().zip(evaluate(&new)?));
        let (split, whole): (Vec<Cell>, Vec<Cell>) =
            open.into_iter().partition(|cell| round < depth && is_open(*cell, depth, &points));
        cells.extend(whole);
        open = split.into_iter().flat_map(Cell::quarters).collect();
    }
    cells.sort();
    Ok(Refined { cells, points })
}

/// Whether a boundary may pass through a cell, as far as its corners and those of its neighbours of the
/// same size tell.
fn is_open<S: Sample>(cell: Cell, depth: u32, points: &BTreeMap<Point, S>) -> bool {
    let ((x, y), s) = (cell.at, cell.side);
    let around =
        |centre: u32| [centre.checked_sub(s), Some(centre), Some(centre + s), Some(centre + 2 * s)];
    let near = around(y).into_iter().flatten().flat_map(|row| {
        around(x).into_iter().flatten().filter_map(move |column| points.get(&(column, row)))
    });
    let classes: BTreeSet<u8> = near.map(Sample::class).collect();
    let mut own = cell.corners().into_iter().filter_map(|corner| points.get(&corner));
    let side = f64::from(s) / f64::from(1_u32 << depth);
    classes.len() > 1 || own.any(|sample| sample.is_close(side))
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    struct Test {
        inside: bool,
        distance: f64,
        bound: f64,
    }

    impl Sample for Test {
        fn class(&self) -> u8 {
            u8::from(self.inside)
        }

        fn is_close(&self, side: f64) -> bool {
            self.distance < self.bound * side
        }
    }

    const GRID: [u32; 2] = [8, 8];
    const DEPTH: u32 = 3;

    /// A slanted strip of some width on a plane of 64 × 64 steps, with the distance from it known.
    fn strip(width: f64, bound: f64) -> (Refined<Test>, usize) {
        let mut count = 0;
        let evaluate = |points: &[Point]| {
            count += points.len();
            let sample = |(x, y): &Point| {
                let from_middle =
                    (f64::from(*x) - 0.7 * f64::from(*y) - 11.0).abs() / 1.49_f64.sqrt();
                Test {
                    inside: from_middle < width / 2.0,
                    distance: (from_middle - width / 2.0).abs(),
                    bound,
                }
            };
            Ok::<_, Infallible>(points.iter().map(sample).collect())
        };
        let Ok(refined) = refine(GRID, DEPTH, evaluate);
        (refined, count)
    }

    /// Finest points inside the strip that the cells around them do not know of.
    fn lost(refined: &Refined<Test>, width: f64) -> usize {
        let far = |cell: &&Cell| cell.side > 1;
        let inside = |x: u32, y: u32| {
            let d = (f64::from(x) - 0.7 * f64::from(y) - 11.0).abs() / 1.49_f64.sqrt();
            d < width / 2.0
        };
        let wrong = |cell: &Cell| {
            let class = refined.points[&cell.at].inside;
            let points = (0..=cell.side).flat_map(|dx| (0..=cell.side).map(move |dy| (dx, dy)));
            points.filter(|(dx, dy)| inside(cell.at.0 + dx, cell.at.1 + dy) != class).count()
        };
        refined.cells.iter().filter(far).map(wrong).sum()
    }

    #[test]
    fn cells_cover_the_plane_once_and_no_strip_is_lost() {
        // Far narrower than the first cells, of 8 steps: seen by the margins alone.
        for width in [1.5, 4.0, 12.0] {
            // Half the diagonal of a first cell is 5.7 steps.
            let (refined, count) = strip(width, 6.0);
            let area: u32 = refined.cells.iter().map(|cell| cell.side * cell.side).sum();
            assert_eq!(area, 64 * 64);
            assert_eq!(lost(&refined, width), 0, "{width}");
            assert!(refined.points.values().any(|sample| sample.inside));
            assert!(count == refined.points.len() && count < 65 * 65 / 2, "{count}");
        }
    }

    #[test]
    fn a_wide_region_needs_no_margin() {
        let (refined, _) = strip(24.0, 0.0);
        assert_eq!(lost(&refined, 24.0), 0);
    }
}
