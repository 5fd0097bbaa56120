//! Structure and propellant: `[mass]` of a vehicle.

use nalgebra::Vector3;

use crate::frames::symmetric;
use crate::mass::{DryMass, MassLaw, MassModel, MassRow, Propellant, unphysical};
use crate::quantity::{ConfigError, Limit, Section};

/// Rows of `table`: propellant, centre of mass, then the tensor's xx, yy, zz, xy, xz, yz.
const TABLE_UNIT: &str = "kg, m, kg.m2";

pub(super) fn read(root: &Section) -> Result<MassModel, ConfigError> {
    let s = root.section("mass")?;
    let dry = DryMass {
        mass_kg: s.number("dry_mass", "kg", Limit::Positive)?,
        com_b: s.vector("dry_com_b", "m", Limit::Any)?.into(),
        inertia_kg_m2: s.vector("dry_inertia_b", "kg.m2", Limit::Positive)?.into(),
        products_kg_m2: if s.has("dry_products_b") {
            s.vector("dry_products_b", "kg.m2", Limit::Any)?.into()
        } else {
            Vector3::zeros()
        },
    };
    if let Some(reason) = unphysical(&dry.inertia_b()) {
        return Err(s.error("dry_inertia_b", reason));
    }
    let propellant = Propellant {
        capacity_kg: s.number("propellant_mass", "kg", Limit::Positive)?,
        com_b: s.vector("propellant_com_b", "m", Limit::Any)?.into(),
        gyration_radius_b: s.vector("propellant_gyration_radius_b", "m", Limit::Positive)?.into(),
    };
    let chosen = s.choice("model", &["two-body", "table"])?;
    let rows = if s.has("table") || chosen == "table" {
        read_table(&s, propellant.capacity_kg)?
    } else {
        Vec::new()
    };
    let law = if chosen == "table" { MassLaw::Table(rows) } else { MassLaw::TwoBody };
    s.finish()?;
    Ok(MassModel { law, dry, propellant })
}

fn read_table(s: &Section, capacity_kg: f64) -> Result<Vec<MassRow>, ConfigError> {
    let rows: Vec<MassRow> = s
        .points::<10>("table", TABLE_UNIT)?
        .into_iter()
        .map(|[propellant_kg, cx, cy, cz, xx, yy, zz, xy, xz, yz]| MassRow {
            propellant_kg,
            com_b: Vector3::new(cx, cy, cz),
            inertia_b: symmetric(&Vector3::new(xx, yy, zz), &Vector3::new(xy, xz, yz)),
        })
        .collect();
    for (n, row) in rows.iter().enumerate() {
        if let Some(reason) = unphysical(&row.inertia_b) {
            return Err(s.error("table", format!("row {} {reason}", n + 1)));
        }
    }
    let fills: Vec<f64> = rows.iter().map(|row| row.propellant_kg).collect();
    let rising = fills.len() >= 2 && fills.windows(2).all(|pair| pair[0] < pair[1]);
    if !rising || fills.first() != Some(&0.0) || fills.last() != Some(&capacity_kg) {
        let need = format!("must rise from 0 to the propellant_mass, {capacity_kg} kg");
        return Err(
            s.error("table", format!("has rows at {fills:?} kg of propellant: they {need}"))
        );
    }
    Ok(rows)
}
