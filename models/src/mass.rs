//! Mass, centre of mass and inertia as the propellant runs down.
//!
//! Two bodies: the dry structure, and propellant with a fixed centre of mass and fixed radii of
//! gyration. Smooth in the propellant mass, and it reproduces the paper's wet and dry rows
//! exactly and its mid row within 0.3 % (`tests/paper.rs`).

use nalgebra::{Matrix3, Vector3};

use crate::frames::steiner;

#[derive(Clone, Debug)]
pub struct MassModel {
    pub dry: DryMass,
    pub propellant: Propellant,
}

#[derive(Clone, Debug)]
pub struct DryMass {
    pub mass_kg: f64,
    /// Centre of mass from O.
    pub com_b: Vector3<f64>,
    /// Principal moments about its own centre of mass, body axes.
    pub inertia_kg_m2: Vector3<f64>,
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

impl MassModel {
    pub fn wet_mass_kg(&self) -> f64 {
        self.dry.mass_kg + self.propellant.capacity_kg
    }

    /// Properties with `propellant_kg` left.
    pub fn at(&self, propellant_kg: f64) -> MassProperties {
        let (dry, fuel) = (&self.dry, &self.propellant);
        let mass_kg = dry.mass_kg + propellant_kg;
        let com_b = (dry.com_b * dry.mass_kg + fuel.com_b * propellant_kg) / mass_kg;
        let own = dry.inertia_kg_m2
            + fuel.gyration_radius_b.component_mul(&fuel.gyration_radius_b) * propellant_kg;
        let reduced_mass_kg = dry.mass_kg * propellant_kg / mass_kg;
        let inertia_b =
            Matrix3::from_diagonal(&own) + steiner(&(fuel.com_b - dry.com_b)) * reduced_mass_kg;
        MassProperties { mass_kg, com_b, inertia_b }
    }
}
