//! A map's elevations between its nodes: cubic convolution (Keys 1981), (T.45).

use std::fmt;
use std::sync::Arc;

use lander_models::heightmap::HeightGrid;
use lander_models::scenario::Heightmap;
use nalgebra::{Matrix2, Vector2};

use super::Local;

#[derive(Clone)]
pub(super) struct Grid {
    grid: Arc<HeightGrid>,
    /// Elevation of world z = 0.
    datum_m: f64,
}

impl Grid {
    pub fn new(map: &Heightmap) -> Self {
        let mut grid = Self { grid: map.grid.clone(), datum_m: 0.0 };
        grid.datum_m = map.datum_m.unwrap_or_else(|| grid.local(0.0, 0.0).height_m);
        grid
    }

    /// Beyond its edge the grid goes on with its outermost nodes.
    pub fn local(&self, x_m: f64, y_m: f64) -> Local {
        let HeightGrid { columns, rows, spacing_m, west_m, south_m, elevations_m } = &*self.grid;
        let (column, x) = Kernel::at((x_m - west_m) / spacing_m, *columns);
        let (row, y) = Kernel::at((y_m - south_m) / spacing_m, *rows);
        let node = |first: isize, offset: usize, count: usize| {
            (first + offset as isize).clamp(0, count as isize - 1) as usize
        };
        let mut sums = [0.0; 6];
        for j in 0..4 {
            let line = node(row, j, *rows) * columns;
            let mut along = [0.0; 3];
            for i in 0..4 {
                // Heights, not elevations: the datum would cost digits.
                let height_m = elevations_m[line + node(column, i, *columns)] - self.datum_m;
                along[0] += x.value[i] * height_m;
                along[1] += x.first[i] * height_m;
                along[2] += x.second[i] * height_m;
            }
            sums[0] += y.value[j] * along[0];
            sums[1] += y.value[j] * along[1];
            sums[2] += y.first[j] * along[0];
            sums[3] += y.value[j] * along[2];
            sums[4] += y.first[j] * along[1];
            sums[5] += y.second[j] * along[0];
        }
        let [height_m, x1, y1, xx, xy, yy] = sums;
        Local {
            height_m,
            gradient: Vector2::new(x1, y1) / *spacing_m,
            hessian_per_m: Matrix2::new(xx, xy, xy, yy) / (spacing_m * spacing_m),
        }
    }
}

impl fmt::Debug for Grid {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:?} about {} m", self.grid, self.datum_m)
    }
}

/// Weights of four neighbouring nodes, and their derivatives by the node distance.
struct Kernel {
    value: [f64; 4],
    first: [f64; 4],
    second: [f64; 4],
}

impl Kernel {
    /// The first of the four nodes, and their weights, at a position counted in nodes.
    fn at(position: f64, count: usize) -> (isize, Self) {
        // Two nodes beyond the edge all four are the outermost one.
        let position = position.clamp(-2.0, count as f64 + 1.0);
        let cell = position.floor();
        let t = position - cell;
        let (t2, t3) = (t * t, t * t * t);
        let kernel = Self {
            value: [
                0.5 * (-t + 2.0 * t2 - t3),
                0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
                0.5 * (t + 4.0 * t2 - 3.0 * t3),
                0.5 * (t3 - t2),
            ],
            first: [
                0.5 * (-1.0 + 4.0 * t - 3.0 * t2),
                0.5 * (-10.0 * t + 9.0 * t2),
                0.5 * (1.0 + 8.0 * t - 9.0 * t2),
                0.5 * (3.0 * t2 - 2.0 * t),
            ],
            second: [2.0 - 3.0 * t, 9.0 * t - 5.0, 4.0 - 9.0 * t, 3.0 * t - 1.0],
        };
        (cell as isize - 1, kernel)
    }
}
