//! Structure and propellant: `[mass]` of a vehicle.

use crate::mass::{DryMass, MassModel, Propellant};
use crate::quantity::{ConfigError, Limit, Section};

pub(super) fn read(root: &Section) -> Result<MassModel, ConfigError> {
    let s = root.section("mass")?;
    let model = MassModel {
        dry: DryMass {
            mass_kg: s.number("dry_mass", "kg", Limit::Positive)?,
            com_b: s.vector("dry_com_b", "m", Limit::Any)?.into(),
            inertia_kg_m2: s.vector("dry_inertia_b", "kg.m2", Limit::Positive)?.into(),
        },
        propellant: Propellant {
            capacity_kg: s.number("propellant_mass", "kg", Limit::Positive)?,
            com_b: s.vector("propellant_com_b", "m", Limit::Any)?.into(),
            gyration_radius_b: s
                .vector("propellant_gyration_radius_b", "m", Limit::Positive)?
                .into(),
        },
    };
    s.finish()?;
    Ok(model)
}
