//! A shape as a URDF of one link: for viewers that draw robots but no scene entities.

use std::fmt::Write as _;

use nalgebra::Vector3;

use crate::scene::{Color, Entity};

/// Cylinders for frustums, as wide as their wider end, and for lines.
pub fn of(entity: &Entity, link: &str) -> String {
    let mut visuals = String::new();
    for frustum in &entity.frustums {
        let radius_m = frustum.bottom_radius_m.max(frustum.top_radius_m);
        let axis = frustum.attitude * Vector3::z();
        let place = Place { center: frustum.center, axis };
        cylinder(&mut visuals, &place, frustum.length_m, radius_m, frustum.color);
    }
    for lines in &entity.lines {
        let (ends, _) = lines.points.as_chunks::<2>();
        for [from, to] in ends {
            let along = to - from;
            let place = Place { center: (from + to) * 0.5, axis: along.normalize() };
            cylinder(&mut visuals, &place, along.norm(), 0.5 * lines.thickness_m, lines.color);
        }
    }
    format!(
        "<?xml version=\"1.0\"?>\n<robot name=\"{link}\">\n <link name=\"{link}\">\n{visuals} </link>\n</robot>\n"
    )
}

struct Place {
    center: Vector3<f64>,
    /// Unit vector.
    axis: Vector3<f64>,
}

fn cylinder(visuals: &mut String, place: &Place, length_m: f64, radius_m: f64, color: Color) {
    let (Place { center, axis }, [r, g, b, a]) = (place, color);
    // URDF turns about x, y and z in this order; z goes to the axis by the last two.
    let (pitch, yaw) = (libm::acos(axis.z.clamp(-1.0, 1.0)), libm::atan2(axis.y, axis.x));
    // Writing to a String cannot fail.
    let _ = writeln!(
        visuals,
        "  <visual><origin xyz=\"{:.4} {:.4} {:.4}\" rpy=\"0 {pitch:.5} {yaw:.5}\"/>\
         <geometry><cylinder radius=\"{radius_m:.4}\" length=\"{length_m:.4}\"/></geometry>\
         <material name=\"{r}-{g}-{b}\"><color rgba=\"{r} {g} {b} {a}\"/></material></visual>",
        center.x, center.y, center.z
    );
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, UnitQuaternion};

    use super::*;
    use crate::scene::{Frustum, Lines};

    #[test]
    fn a_strut_points_from_end_to_end() {
        let (from, to) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.0, 2.5, 4.0));
        let color = [0.5, 0.5, 0.5, 1.0];
        let lines = vec![Lines { points: vec![from, to], thickness_m: 0.05, color }];
        let urdf = of(&Entity { lines, ..Entity::default() }, "lander");
        let number = |after: &str| -> Vec<f64> {
            let text = urdf.split(after).nth(1).unwrap().split('"').next().unwrap();
            text.split(' ').map(|word| word.parse().unwrap()).collect()
        };
        let (center, rpy) = (number("xyz=\""), number("rpy=\""));
        let axis = Rotation3::from_euler_angles(rpy[0], rpy[1], rpy[2]) * Vector3::z();
        let end = Vector3::from_vec(center) + axis * (0.5 * number("length=\"")[0]);
        // Printed to 0.1 mm and 10 µrad.
        assert!((end - to).norm() < 2e-4, "{end} is not {to}");
    }

    #[test]
    fn a_frustum_is_as_wide_as_its_wider_end() {
        let frustum = Frustum {
            center: Vector3::zeros(),
            attitude: UnitQuaternion::identity(),
            length_m: 1.0,
            bottom_radius_m: 0.4,
            top_radius_m: 0.2,
            color: [1.0; 4],
        };
        let urdf = of(&Entity { frustums: vec![frustum], ..Entity::default() }, "lander");
        assert!(urdf.contains("radius=\"0.4000\"") && urdf.contains("<link name=\"lander\">"));
    }
}
