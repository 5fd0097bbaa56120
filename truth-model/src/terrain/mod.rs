//! The ground: height, nearest surface and rocks, from the scenario's terrain (T.40 to T.47).
//!
//! The relief is a plane through the world origin, plus craters, plus a map's elevations: one
//! height over each place, with a continuous gradient. Rocks lie on it.

mod craters;
mod cylinder;
mod field;
mod grid;
mod index;
mod rocks;

use std::fmt;
use std::sync::Arc;

use lander_models::math::square;
use lander_models::scenario::Terrain;
use nalgebra::{Matrix2, Vector2, Vector3};

pub use craters::Crater;
use craters::CraterField;
pub use cylinder::Cylinder;
use grid::Grid;
use rocks::RockField;
pub use rocks::{ROCK_REACH_M, Rock};

/// Farther above or below the relief than this, the tangent plane under a point stands for the
/// nearest one, m: nothing depends on more there, and far from a bowl nothing nearest is unique.
pub const NEAREST_REACH_M: f64 = 2.0;
/// Newton steps to the nearest point; three are enough within the relief's radius of curvature.
const NEWTON_STEPS: usize = 8;
/// A step shorter than this ends the search, m.
const NEWTON_DONE_M: f64 = 1e-9;

/// The surface nearest to a point: its tangent plane.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Distance of the point along the normal, m; negative below ground.
    pub clearance_m: f64,
    pub normal_w: Vector3<f64>,
}

/// Height at a place with its derivatives by x and y.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Local {
    height_m: f64,
    gradient: Vector2<f64>,
    hessian_per_m: Matrix2<f64>,
}

impl Local {
    fn add(&mut self, other: Self) {
        self.height_m += other.height_m;
        self.gradient += other.gradient;
        self.hessian_per_m += other.hessian_per_m;
    }

    fn normal_w(&self) -> Vector3<f64> {
        Vector3::new(-self.gradient.x, -self.gradient.y, 1.0).normalize()
    }
}

/// The terrain made ready for queries. Cheap to clone.
#[derive(Clone)]
pub struct Ground {
    normal_w: Vector3<f64>,
    craters: Option<Arc<CraterField>>,
    grid: Option<Arc<Grid>>,
    rocks: Option<Arc<RockField>>,
}

impl Ground {
    pub fn new(terrain: &Terrain) -> Self {
        let mut ground = Self {
            normal_w: terrain.normal_w(),
            craters: terrain.craters.as_ref().map(|c| Arc::new(CraterField::new(c, terrain.seed))),
            grid: terrain.heightmap.as_ref().map(|map| Arc::new(Grid::new(map))),
            rocks: None,
        };
        let rocks = terrain.rocks.as_ref();
        ground.rocks = rocks.map(|rocks| Arc::new(RockField::new(rocks, terrain.seed, &ground)));
        ground
    }

    /// The relief is the plane alone. Rocks may lie on it.
    pub fn is_plane(&self) -> bool {
        self.craters.is_none() && self.grid.is_none()
    }

    /// Height of the relief at a place, world z, m (T.40).
    pub fn height_m(&self, x_m: f64, y_m: f64) -> f64 {
        if self.is_plane() { self.plane_m(x_m, y_m) } else { self.local(x_m, y_m).height_m }
    }

    fn plane_m(&self, x_m: f64, y_m: f64) -> f64 {
        // The normal of a plane that is no wall has a positive z: slopes end at 45 degrees.
        -(self.normal_w.x * x_m + self.normal_w.y * y_m) / self.normal_w.z
    }

    fn local(&self, x_m: f64, y_m: f64) -> Local {
        let mut local = Local {
            height_m: self.plane_m(x_m, y_m),
            gradient: -self.normal_w.xy() / self.normal_w.z,
            hessian_per_m: Matrix2::zeros(),
        };
        if let Some(craters) = &self.craters {
            craters.add_to(&mut local, x_m, y_m);
        }
        if let Some(grid) = &self.grid {
            local.add(grid.local(x_m, y_m));
        }
        local
    }

    /// The relief nearest to a point; rocks apart (T.46). Exact for a plane.
    pub fn nearest(&self, point_w: &Vector3<f64>) -> Surface {
        if self.is_plane() {
            return Surface { clearance_m: self.normal_w.dot(point_w), normal_w: self.normal_w };
        }
        let (place, local) = self.nearest_place(point_w);
        let normal_w = local.normal_w();
        let foot_w = Vector3::new(place.x, place.y, local.height_m);
        Surface { clearance_m: normal_w.dot(&(point_w - foot_w)), normal_w }
    }

    /// Newton's method on half the squared distance to the surface over (x, y), from the place
    /// under the point.
    fn nearest_place(&self, point_w: &Vector3<f64>) -> (Vector2<f64>, Local) {
        let under = point_w.xy();
        let mut place = under;
        let mut local = self.local(place.x, place.y);
        let reach_m = (point_w.z - local.height_m).abs();
        let mut best = (place, local);
        if reach_m > NEAREST_REACH_M {
            return best;
        }
        let mut least_m2 = reach_m * reach_m;
        for _ in 0..NEWTON_STEPS {
            let rise_m = local.height_m - point_w.z;
            let slope = (place - under) + local.gradient * rise_m;
            let tangent = Matrix2::identity() + local.gradient * local.gradient.transpose();
            // Without the curvature term the matrix always is positive definite.
            let curved = (tangent + local.hessian_per_m * rise_m).cholesky();
            let Some(solver) = curved.or_else(|| tangent.cholesky()) else { break };
            let target = place - solver.solve(&slope);
            // The nearest point is no farther than the one under the point.
            let aside = target - under;
            let next = under + aside * (reach_m / aside.norm().max(reach_m)).min(1.0);
            let step_m = (next - place).norm();
            place = next;
            local = self.local(place.x, place.y);
            let distance_m2 = (place - under).norm_squared() + square(local.height_m - point_w.z);
            if distance_m2 < least_m2 {
                (least_m2, best) = (distance_m2, (place, local));
            }
            if step_m < NEWTON_DONE_M {
                break;
            }
        }
        best
    }

    /// All craters, widest first.
    pub fn craters(&self) -> &[Crater] {
        self.craters.as_ref().map_or(&[], |field| field.craters())
    }

    /// All rocks, widest first.
    pub fn rocks(&self) -> &[Rock] {
        self.rocks.as_ref().map_or(&[], |field| field.rocks())
    }

    /// Rocks whose surface is within `reach_m` of a point, in an order that only the field decides.
    pub fn rocks_near(&self, point_w: &Vector3<f64>, reach_m: f64) -> impl Iterator<Item = &Rock> {
        let point_w = *point_w;
        self.rocks.iter().flat_map(move |field| field.near(point_w, reach_m))
    }

    /// The rock surface nearest to a point, if it is within `ROCK_REACH_M`.
    pub fn nearest_rock(&self, point_w: &Vector3<f64>) -> Option<Surface> {
        let surfaces = self.rocks_near(point_w, ROCK_REACH_M).map(|rock| rock.surface(point_w));
        surfaces.min_by(|a, b| a.clearance_m.total_cmp(&b.clearance_m))
    }

    /// Whether a ball is known without a search to be more than `gap_m` above everything. Never so over craters or a map.
    pub fn surely_clear(&self, centre_w: &Vector3<f64>, radius_m: f64, gap_m: f64) -> bool {
        let lowest_m = self.normal_w.dot(centre_w) - radius_m;
        let rocks_m = self.rocks.as_ref().map_or(f64::NEG_INFINITY, |rocks| rocks.top_m());
        self.is_plane() && lowest_m > gap_m && centre_w.z - radius_m > rocks_m + gap_m
    }

    /// Clearance of a ball from relief and rocks, m.
    pub fn ball_clearance_m(&self, centre_w: &Vector3<f64>, radius_m: f64) -> f64 {
        let relief_m = self.nearest(centre_w).clearance_m;
        let rock_m = self.nearest_rock(centre_w).map_or(f64::INFINITY, |rock| rock.clearance_m);
        relief_m.min(rock_m) - radius_m
    }
}

/// Short: fields and grids follow from the scenario, which prints its own.
impl fmt::Debug for Ground {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Ground")
            .field("normal_w", &self.normal_w)
            .field("craters", &self.craters().len())
            .field("rocks", &self.rocks().len())
            .field("grid", &self.grid)
            .finish()
    }
}
