//! Clearance of a solid cylinder from relief and rocks (T.47).

use nalgebra::Vector3;

use super::{Ground, ROCK_REACH_M};

/// A solid cylinder between the centres of its two discs, world frame.
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    pub bottom_w: Vector3<f64>,
    pub top_w: Vector3<f64>,
    pub radius_m: f64,
}

impl Ground {
    /// Least clearance of a cylinder, m. The relief counts at the discs' rims and centres, exactly
    /// so for a plane; rocks count exactly, as far as `ROCK_REACH_M`.
    pub fn cylinder_clearance_m(&self, cylinder: &Cylinder) -> f64 {
        let along_w = cylinder.top_w - cylinder.bottom_w;
        let length_m = along_w.norm();
        let axis_w = along_w / length_m;
        let discs = [cylinder.bottom_w, cylinder.top_w];
        let relief_m = discs.map(|c| self.disc_clearance_m(&c, &axis_w, cylinder.radius_m));
        let middle_w = cylinder.bottom_w + 0.5 * along_w;
        let reach_m = ROCK_REACH_M + libm::hypot(cylinder.radius_m, 0.5 * length_m);
        let rocks = self.rocks_near(&middle_w, reach_m);
        let rocks_m = rocks.map(|rock| cylinder.distance_m(&rock.centre_w) - rock.radius_m);
        rocks_m.fold(relief_m[0].min(relief_m[1]), f64::min)
    }

    fn disc_clearance_m(
        &self,
        centre_w: &Vector3<f64>,
        axis_w: &Vector3<f64>,
        radius_m: f64,
    ) -> f64 {
        let across = |normal_w: &Vector3<f64>| normal_w - axis_w * normal_w.dot(axis_w);
        let under = self.nearest(centre_w);
        let down_w = across(&under.normal_w);
        let lowest_m = under.clearance_m - radius_m * down_w.norm();
        if self.is_plane() || lowest_m > super::NEAREST_REACH_M {
            return lowest_m;
        }
        // Once more about the rim point that the first tangent plane names.
        let rim_w = down_w.try_normalize(0.0).map_or_else(Vector3::zeros, |w| w * -radius_m);
        let there = self.nearest(&(centre_w + rim_w));
        let normal_w = there.normal_w;
        let centre_m = there.clearance_m - normal_w.dot(&rim_w);
        under.clearance_m.min(centre_m - radius_m * across(&normal_w).norm())
    }
}

impl Cylinder {
    /// Distance of a point from the solid, m; negative inside.
    pub fn distance_m(&self, point_w: &Vector3<f64>) -> f64 {
        let along_w = self.top_w - self.bottom_w;
        let length_m = along_w.norm();
        let from_w = point_w - self.bottom_w;
        let at_m = from_w.dot(&along_w) / length_m;
        let beyond_m = (-at_m).max(at_m - length_m);
        let aside_m = (from_w - along_w * (at_m / length_m)).norm() - self.radius_m;
        if beyond_m < 0.0 && aside_m < 0.0 {
            beyond_m.max(aside_m)
        } else {
            libm::hypot(beyond_m.max(0.0), aside_m.max(0.0))
        }
    }
}
