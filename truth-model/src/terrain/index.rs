//! Which items lie about a place: a uniform grid of cells over a square.

use std::ops::RangeInclusive;

/// Cells to a side, at most: a million cells, 4 MB.
const SIDE_MAX: f64 = 1024.0;

/// An axis-parallel rectangle, m.
#[derive(Clone, Copy)]
pub(super) struct Rectangle {
    pub x_m: f64,
    pub y_m: f64,
    /// Half the side.
    pub half_m: f64,
}

/// Items by cell, in compressed rows. What reaches beyond the square counts to its outer cells.
pub(super) struct Index {
    extent_m: f64,
    cell_m: f64,
    side: usize,
    /// Where each cell's items start in `items`; one more than there are cells.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Index {
    /// `extent_m` is half the side of the square about the origin. Item numbers are positions in
    /// `items`.
    pub fn new(extent_m: f64, cell_m: f64, items: &[Rectangle]) -> Self {
        let side = (2.0 * extent_m / cell_m).ceil().clamp(1.0, SIDE_MAX);
        let mut index = Self {
            extent_m,
            cell_m: 2.0 * extent_m / side,
            side: side as usize,
            starts: Vec::new(),
            items: Vec::new(),
        };
        let cells = |index: &Self, item: &Rectangle| {
            let (columns, side) = (index.cells(item.x_m, item.half_m), index.side);
            let rows = index.cells(item.y_m, item.half_m);
            rows.flat_map(move |row| columns.clone().map(move |column| row * side + column))
        };
        let mut ends = vec![0_u32; index.side * index.side + 1];
        for cell in items.iter().flat_map(|item| cells(&index, item)) {
            ends[cell + 1] += 1;
        }
        for cell in 1..ends.len() {
            ends[cell] += ends[cell - 1];
        }
        index.items = vec![0; ends[ends.len() - 1] as usize];
        index.starts = ends.clone();
        for (number, item) in items.iter().enumerate() {
            for cell in cells(&index, item) {
                index.items[ends[cell] as usize] = number as u32;
                ends[cell] += 1;
            }
        }
        index
    }

    /// Items of the cells that a rectangle touches, row by row.
    pub fn within(&self, of: Rectangle) -> impl Iterator<Item = usize> {
        let (columns, rows) = (self.cells(of.x_m, of.half_m), self.cells(of.y_m, of.half_m));
        rows.flat_map(move |row| {
            let first = self.starts[row * self.side + columns.start()] as usize;
            let end = self.starts[row * self.side + columns.end() + 1] as usize;
            self.items[first..end].iter().map(|item| *item as usize)
        })
    }

    fn cells(&self, centre_m: f64, half_m: f64) -> RangeInclusive<usize> {
        let last = (self.side - 1) as f64;
        let cell = |at_m: f64| ((at_m + self.extent_m) / self.cell_m).clamp(0.0, last) as usize;
        cell(centre_m - half_m)..=cell(centre_m + half_m)
    }
}
