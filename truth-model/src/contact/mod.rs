//! Contact: what an engine that owns the motion on and near the ground must do, and the choice.

pub mod rapier;

use lander_models::Vehicle;
use lander_models::scenario::{ContactEngine as Choice, Terrain};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::flight::Motion;
use crate::gear::LegState;
use crate::propulsion::Drive;
use crate::terrain::Ground;
use rapier::RapierWorld;

/// What a contact engine works on and never changes.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    pub vehicle: &'a Vehicle,
    pub terrain: &'a Terrain,
    pub ground: &'a Ground,
    pub gravity_w: Vector3<f64>,
}

/// What one contact tick did to the ground.
#[derive(Clone, Debug, Default)]
pub struct Touch {
    /// Per leg: the pad carries load.
    pub feet: Vec<bool>,
    pub structure: bool,
}

/// Owns motion and legs while the vehicle is on or near the ground. Plain data.
pub trait ContactEngine: Sized {
    /// Takes over a flying vehicle. The struts start at their crushed length, unloaded.
    fn take_over(site: &Site, motion: &Motion, legs: &[LegState]) -> Self;

    /// One tick. `None` once a body has become non-finite.
    fn step(
        &mut self,
        site: &Site,
        motion: &mut Motion,
        legs: &mut [LegState],
        drive: &Drive,
    ) -> Option<Touch>;
}

/// The engine that the scenario chose, at one instant.
#[derive(Clone, Serialize, Deserialize)]
pub enum Contact {
    Rapier(Box<RapierWorld>),
}

impl Contact {
    pub fn take_over(choice: Choice, site: &Site, motion: &Motion, legs: &[LegState]) -> Self {
        match choice {
            Choice::Rapier | Choice::Strut => {
                Self::Rapier(Box::new(RapierWorld::take_over(site, motion, legs)))
            }
        }
    }

    pub fn step(
        &mut self,
        site: &Site,
        motion: &mut Motion,
        legs: &mut [LegState],
        drive: &Drive,
    ) -> Option<Touch> {
        match self {
            Self::Rapier(world) => world.step(site, motion, legs, drive),
        }
    }
}
