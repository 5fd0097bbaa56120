//! Mass, centre of mass and inertia as the propellant runs down.
//!
//! Two bodies by default: the dry structure, and propellant with a fixed centre of mass and fixed
//! radii of gyration. Smooth in the propellant mass, and it reproduces the paper's wet and dry
//! rows exactly and its mid row within 0.3 % (`tests/paper.rs`). Or a table of the whole vehicle,
//! linear between its rows.

use nalgebra::{Matrix3, Vector3};

use crate::frames::{steiner, symmetric};

#[derive(Clone, Debug)]
pub struct MassModel {
    pub law: MassLaw,
    pub dry: DryMass,
    pub propellant: Propellant,
}

/// How the whole vehicle's properties follow from the propellant left.
#[derive(Clone, Debug)]
pub enum MassLaw {
    /// Structure and propellant, each with its own centre and inertia (M.1, M.2).
    TwoBody,
    /// At least two rows, by rising propellant mass from 0 to the capacity (M.3).
    Table(Vec<MassRow>),
}

/// The whole vehicle at one fill.
#[derive(Clone, Copy, Debug)]
pub struct MassRow {
    pub propellant_kg: f64,
    /// Centre of mass from O.
    pub com_b: Vector3<f64>,
    /// About the centre of mass, body axes.
    pub inertia_b: Matrix3<f64>,
}

#[derive(Clone, Debug)]
pub struct DryMass {
    pub mass_kg: f64,
    /// Centre of mass from O.
    pub com_b: Vector3<f64>,
    /// Moments about its own centre of mass, body axes.
    pub inertia_kg_m2: Vector3<f64>,
    /// Off-diagonal elements xy, xz, yz of that tensor: J_xy = −∫ x y dm.
    pub products_kg_m2: Vector3<f64>,
}

#[derive(Clone, Debug)]
pub struct Propellant {
    pub capacity_kg: f64,
    /// Centre of mass from O, at any fill.
    pub com_b: Vector3<f64>,
    /// Radii of gyration about the propellant's own centre of mass.
    pub gyration_radius_b: Vector3<f64>,
}

/// The whole vehicle at one instant.
#[derive(Clone, Copy, Debug)]
pub struct MassProperties {
    pub mass_kg: f64,
    /// Centre of mass from O.
    pub com_b: Vector3<f64>,
    /// Inertia about the centre of mass, body axes.
    pub inertia_b: Matrix3<f64>,
}

/// What the vehicle gives up with the next kilogram of propellant.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    /// Where that kilogram comes from: d(m c)/dm_p, from O.
    pub centre_b: Vector3<f64>,
    /// dJ/dm_p of the inertia about the vehicle's centre of mass, m².
    pub inertia_b: Matrix3<f64>,
}

impl MassModel {
    pub fn wet_mass_kg(&self) -> f64 {
        self.dry.mass_kg + self.propellant.capacity_kg
    }

    /// Properties with `propellant_kg` left.
    #[inline]
    pub fn at(&self, propellant_kg: f64) -> MassProperties {
        let (dry, fuel) = (&self.dry, &self.propellant);
        let mass_kg = dry.mass_kg + propellant_kg;
        if let MassLaw::Table(rows) = &self.law {
            return between(rows, propellant_kg, mass_kg);
        }
        let share = propellant_kg / mass_kg;
        let apart_b = fuel.com_b - dry.com_b;
        let com_b = dry.com_b + apart_b * share;
        let mut inertia_b = dry.inertia_b() + steiner(&apart_b) * (dry.mass_kg * share);
        add_moments(&mut inertia_b, &(fuel.gyration_squared_b() * propellant_kg));
        MassProperties { mass_kg, com_b, inertia_b }
    }

    /// What the next kilogram takes along, with `propellant_kg` left (M.4).
    #[inline]
    pub fn draw(&self, propellant_kg: f64) -> Draw {
        let (dry, fuel) = (&self.dry, &self.propellant);
        if let MassLaw::Table(rows) = &self.law {
            return slope(rows, propellant_kg, dry.mass_kg + propellant_kg);
        }
        let from_com_b = (fuel.com_b - dry.com_b) * (dry.mass_kg / (dry.mass_kg + propellant_kg));
        let mut inertia_b = steiner(&from_com_b);
        add_moments(&mut inertia_b, &fuel.gyration_squared_b());
        Draw { centre_b: fuel.com_b, inertia_b }
    }
}

impl DryMass {
    /// About its own centre of mass, body axes.
    #[inline]
    pub fn inertia_b(&self) -> Matrix3<f64> {
        symmetric(&self.inertia_kg_m2, &self.products_kg_m2)
    }
}

impl Propellant {
    #[inline]
    fn gyration_squared_b(&self) -> Vector3<f64> {
        self.gyration_radius_b.component_mul(&self.gyration_radius_b)
    }
}

#[inline]
fn add_moments(inertia_b: &mut Matrix3<f64>, moments: &Vector3<f64>) {
    (0..3).for_each(|axis| inertia_b[(axis, axis)] += moments[axis]);
}

/// The two rows that enclose a fill; the first or last two beyond the table.
fn around(rows: &[MassRow], propellant_kg: f64) -> [&MassRow; 2] {
    let inner = &rows[1..rows.len() - 1];
    let low = inner.partition_point(|row| row.propellant_kg <= propellant_kg);
    [&rows[low], &rows[low + 1]]
}

fn between(rows: &[MassRow], propellant_kg: f64, mass_kg: f64) -> MassProperties {
    let [low, high] = around(rows, propellant_kg);
    let share = (propellant_kg - low.propellant_kg) / (high.propellant_kg - low.propellant_kg);
    let com_b = low.com_b + (high.com_b - low.com_b) * share;
    let inertia_b = low.inertia_b + (high.inertia_b - low.inertia_b) * share;
    MassProperties { mass_kg, com_b, inertia_b }
}

fn slope(rows: &[MassRow], propellant_kg: f64, mass_kg: f64) -> Draw {
    let [low, high] = around(rows, propellant_kg);
    let span_kg = high.propellant_kg - low.propellant_kg;
    let com_b = between(rows, propellant_kg, mass_kg).com_b;
    Draw {
        centre_b: com_b + (high.com_b - low.com_b) * (mass_kg / span_kg),
        inertia_b: (high.inertia_b - low.inertia_b) / span_kg,
    }
}

/// Why a symmetric tensor can't be the inertia of a body, if it can't: its principal moments must
/// be positive, and none may exceed the sum of the other two.
pub fn unphysical(inertia_b: &Matrix3<f64>) -> Option<String> {
    let [mut a, mut b, mut c]: [f64; 3] = inertia_b.symmetric_eigenvalues().into();
    if a > b {
        std::mem::swap(&mut a, &mut b);
    }
    if b > c {
        std::mem::swap(&mut b, &mut c);
    }
    if a > b {
        std::mem::swap(&mut a, &mut b);
    }
    let shown = format!("has the principal moments {a:.4}, {b:.4} and {c:.4} kg.m2");
    // A thin plate has c = a + b exactly; rounding may not refuse it.
    let slack = 1e-9 * c.abs();
    if a <= 0.0 {
        Some(format!("{shown}: all must be greater than 0"))
    } else if c > a + b + slack {
        Some(format!("{shown}: the largest must not exceed the sum of the others"))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(law: MassLaw) -> MassModel {
        MassModel {
            law,
            dry: DryMass {
                mass_kg: 100.0,
                com_b: Vector3::new(0.02, -0.01, 1.2),
                inertia_kg_m2: Vector3::new(90.0, 80.0, 50.0),
                products_kg_m2: Vector3::new(1.0, -2.0, 0.5),
            },
            propellant: Propellant {
                capacity_kg: 60.0,
                com_b: Vector3::new(0.0, 0.05, 1.6),
                gyration_radius_b: Vector3::new(0.3, 0.32, 0.25),
            },
        }
    }

    fn table() -> MassModel {
        let row = |propellant_kg, z, scale| MassRow {
            propellant_kg,
            com_b: Vector3::new(0.01, 0.0, z),
            inertia_b: Matrix3::from_diagonal(&Vector3::new(90.0, 80.0, 50.0)) * scale,
        };
        model(MassLaw::Table(vec![row(0.0, 1.2, 1.0), row(20.0, 1.3, 1.05), row(60.0, 1.4, 1.2)]))
    }

    #[test]
    fn a_draw_is_the_slope_of_moment_and_inertia() {
        let h = 1e-4;
        for model in [model(MassLaw::TwoBody), table()] {
            for propellant_kg in [5.0, 31.0, 55.0] {
                let (low, high) = (model.at(propellant_kg - h), model.at(propellant_kg + h));
                let draw = model.draw(propellant_kg);
                let moment = |p: &MassProperties| p.com_b * p.mass_kg;
                let centre_b = (moment(&high) - moment(&low)) / (2.0 * h);
                let inertia_b = (high.inertia_b - low.inertia_b) / (2.0 * h);
                // Rounding of numbers near 100 (1e-14) over the difference of 2e-4.
                assert!((draw.centre_b - centre_b).norm() < 1e-8);
                assert!((draw.inertia_b - inertia_b).norm() < 1e-8);
            }
        }
    }

    #[test]
    fn a_table_is_met_at_its_rows_and_halved_between_them() {
        let model = table();
        let near = |propellant_kg: f64, z: f64, scale: f64| {
            let now = model.at(propellant_kg);
            assert!((now.com_b.z - z).abs() < 1e-14 && (now.inertia_b.m11 - 90.0 * scale) < 1e-12);
        };
        near(0.0, 1.2, 1.0);
        near(20.0, 1.3, 1.05);
        near(60.0, 1.4, 1.2);
        near(40.0, 1.35, 1.125);
    }

    #[test]
    fn a_tensor_that_no_body_has_is_told_apart() {
        let of = |x, y, z, p: [f64; 3]| unphysical(&symmetric(&Vector3::new(x, y, z), &p.into()));
        assert_eq!(of(126.0, 126.1, 86.5, [3.0, -4.0, 1.0]), None);
        assert_eq!(of(1.0, 1.0, 2.0, [0.0; 3]), None);
        assert!(of(1.0, 1.0, 2.1, [0.0; 3]).unwrap().contains("must not exceed"));
        assert!(of(1.0, 1.0, 1.0, [1.5, 0.0, 0.0]).unwrap().contains("greater than 0"));
    }
}
