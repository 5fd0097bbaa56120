//! Ground as viewers draw it: heights over two square grids, the landing site and its
//! surroundings, and the rocks about the site.

use nalgebra::Vector3;
use serde::Serialize;
use truth_model::terrain::{Ground, Rock};

/// Half the edge of the site's patch, m, and the squares along an edge.
const SITE_M: f64 = 16.0;
const SITE_SQUARES: u32 = 32;
/// Least half edge of the surroundings, m: a horizon for a vehicle high up.
const AROUND_M: f64 = 800.0;
const AROUND_SQUARES: u32 = 24;
/// Rocks shown, those around the site.
const ROCK_REACH_M: f64 = 12.0;

/// World frame, m.
#[derive(Clone, Debug, Serialize)]
pub struct Relief {
    pub site: Patch,
    pub around: Patch,
    /// Centre and radius.
    pub rocks: Vec<[f64; 4]>,
}

/// Heights over a square grid, row by row from the least x and y.
#[derive(Clone, Debug, Serialize)]
pub struct Patch {
    pub least_x_m: f64,
    pub least_y_m: f64,
    pub spacing_m: f64,
    pub squares: u32,
    pub heights_m: Vec<f64>,
}

impl Relief {
    /// About a place where a vehicle lands, out to where it starts.
    pub fn about(ground: &Ground, place_w: &Vector3<f64>, start_w: &Vector3<f64>) -> Self {
        let reach_m = (start_w - place_w).xy().amax();
        let around_m = (1.5 * reach_m).max(AROUND_M);
        let place = [place_w.x, place_w.y];
        Self {
            site: Patch::about(ground, place, SITE_M, SITE_SQUARES),
            around: Patch::about(ground, place, around_m, AROUND_SQUARES),
            rocks: ground.rocks_near(place_w, ROCK_REACH_M).map(rock).collect(),
        }
    }
}

fn rock(rock: &Rock) -> [f64; 4] {
    [rock.centre_w.x, rock.centre_w.y, rock.centre_w.z, rock.radius_m]
}

impl Patch {
    fn about(ground: &Ground, [x_m, y_m]: [f64; 2], half_m: f64, squares: u32) -> Self {
        let spacing_m = 2.0 * half_m / f64::from(squares);
        // Whole spacings, so that lines stand on round numbers.
        let least = |middle_m: f64| ((middle_m - half_m) / spacing_m).round() * spacing_m;
        let mut patch = Self {
            least_x_m: least(x_m),
            least_y_m: least(y_m),
            spacing_m,
            squares,
            heights_m: Vec::new(),
        };
        let to_millimetre = |height_m: f64| (height_m * 1e3).round() / 1e3;
        let heights_m = patch.places().map(|[x_m, y_m]| to_millimetre(ground.height_m(x_m, y_m)));
        patch.heights_m = heights_m.collect();
        patch
    }

    fn places(&self) -> impl Iterator<Item = [f64; 2]> + use<> {
        let Self { least_x_m, least_y_m, spacing_m, squares, .. } = *self;
        let at = move |index: u32| f64::from(index) * spacing_m;
        (0..=squares).flat_map(move |row| {
            (0..=squares).map(move |column| [least_x_m + at(column), least_y_m + at(row)])
        })
    }

    /// Corners of the grid, row by row.
    pub fn points_w(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        self.places().zip(&self.heights_m).map(|([x_m, y_m], z_m)| Vector3::new(x_m, y_m, *z_m))
    }

    /// Edges of the squares, as pairs of points.
    pub fn lines(&self) -> impl Iterator<Item = Vector3<f64>> {
        let points_w: Vec<_> = self.points_w().collect();
        let (squares, row) = (self.squares as usize, self.squares as usize + 1);
        (0..row).flat_map(move |line| {
            let along: Vec<_> = (0..squares)
                .flat_map(|n| [line * row + n, line * row + n + 1])
                .chain((0..squares).flat_map(|n| [n * row + line, (n + 1) * row + line]))
                .map(|index| points_w[index])
                .collect();
            along
        })
    }

    /// Two triangles a square, as places in `points_w`.
    pub fn triangles(&self) -> impl Iterator<Item = u32> + use<> {
        let (squares, row) = (self.squares, self.squares + 1);
        (0..squares).flat_map(move |y| {
            (0..squares).flat_map(move |x| {
                let [a, b, c, d] =
                    [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(up, right)| (y + up) * row + x + right);
                [a, b, c, a, c, d]
            })
        })
    }
}
