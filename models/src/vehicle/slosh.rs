//! Sloshing propellant: `[slosh]` of a vehicle.

use nalgebra::Vector3;

use crate::frames::steiner;
use crate::mass::{MassModel, MassProperties, unphysical};
use crate::quantity::{ConfigError, Limit, Section};

use super::G0_M_S2;

/// Tanks that a motion has room for.
pub const MAX_TANKS: usize = 3;

/// Alike tanks, each with a spherical pendulum for the propellant that swings in it.
#[derive(Clone, Debug)]
pub struct Slosh {
    /// Hinge of each pendulum from O: the centre of a spherical tank.
    pub hinges_b: Vec<Vector3<f64>>,
    /// Hinge to bob.
    pub length_m: f64,
    /// Share of the propellant left that swings, of all tanks together.
    pub share: f64,
    /// Of the swing under Earth's gravity, where tanks are tested.
    pub damping_ratio: f64,
}

impl Slosh {
    /// Mass of one bob with `propellant_kg` left.
    pub fn bob_kg(&self, propellant_kg: f64) -> f64 {
        self.share * propellant_kg / self.hinges_b.len() as f64
    }

    /// Drag on a bob per mass and speed against the tank, 1/s: 2 ζ √(g0/L).
    pub fn drag_1_s(&self) -> f64 {
        2.0 * self.damping_ratio * (G0_M_S2 / self.length_m).sqrt()
    }

    /// The vehicle less its bobs: together with bobs that hang straight down the body's axis
    /// it has the vehicle's mass, centre and inertia (T.52).
    pub fn rest(&self, vehicle: &MassProperties, propellant_kg: f64) -> MassProperties {
        let bob_kg = self.bob_kg(propellant_kg);
        let mass_kg = vehicle.mass_kg - bob_kg * self.hinges_b.len() as f64;
        let hanging = || self.hinges_b.iter().map(|hinge_b| hinge_b - Vector3::z() * self.length_m);
        let moment_b = vehicle.com_b * vehicle.mass_kg - hanging().sum::<Vector3<f64>>() * bob_kg;
        let com_b = moment_b / mass_kg;
        let bobs_b = hanging().fold(nalgebra::Matrix3::zeros(), |sum, bob_b| {
            sum + steiner(&(bob_b - vehicle.com_b)) * bob_kg
        });
        let inertia_b = vehicle.inertia_b - bobs_b - steiner(&(com_b - vehicle.com_b)) * mass_kg;
        MassProperties { mass_kg, com_b, inertia_b }
    }
}

pub(super) fn read(root: &Section, mass: &MassModel) -> Result<Option<Slosh>, ConfigError> {
    if !root.has("slosh") {
        return Ok(None);
    }
    let s = root.section("slosh")?;
    let hinges_b: Vec<Vector3<f64>> =
        s.points::<3>("hinges_b", "m")?.into_iter().map(Vector3::from).collect();
    if !(1..=MAX_TANKS).contains(&hinges_b.len()) {
        let reason = format!("has {} points, must have 1 to {MAX_TANKS}", hinges_b.len());
        return Err(s.error("hinges_b", reason));
    }
    let slosh = Slosh {
        hinges_b,
        length_m: s.number("length", "m", Limit::Positive)?,
        share: s.number("share", "1", Limit::Within(0.0, 1.0))?,
        damping_ratio: s.number("damping_ratio", "1", Limit::Within(0.0, 1.0))?,
    };
    // At every quarter: what swings takes its inertia along.
    for fill in [0.25, 0.5, 0.75, 1.0] {
        let propellant_kg = fill * mass.propellant.capacity_kg;
        let rest = slosh.rest(&mass.at(propellant_kg), propellant_kg);
        if let Some(reason) = unphysical(&rest.inertia_b) {
            let what = format!("leaves the rest of the vehicle an inertia that {reason}");
            return Err(s.error("share", format!("is {}, {what}", slosh.share)));
        }
    }
    s.finish()?;
    Ok(Some(slosh))
}
