//! Contact: what an engine that owns the motion on and near the ground must do, and the choice.

pub mod rapier;
pub mod strut;

use lander_models::Vehicle;
use lander_models::scenario::{ContactEngine as Choice, Terrain};
use lander_models::signals::FOOT_SLOTS;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::flight::Motion;
use crate::gear::LegState;
use crate::propulsion::Drive;
use crate::terrain::{Ground, Surface};
use rapier::RapierWorld;
use strut::StrutContact;

/// What a contact engine works on and never changes.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    pub vehicle: &'a Vehicle,
    pub terrain: &'a Terrain,
    pub ground: &'a Ground,
    pub gravity_w: Vector3<f64>,
    /// Steps within a tick for each of the engine's own: 1 in normal use, more for a reference.
    pub refinement: u32,
}

/// Friction of a captured pad: the lateral hold never gives way, the pad may still lift.
const CAPTURED_FRICTION: f64 = 1e3;

impl Site<'_> {
    /// Coulomb's coefficient of a pad on this ground.
    pub fn pad_friction(&self) -> f64 {
        if self.terrain.pads_captured { CAPTURED_FRICTION } else { self.terrain.friction }
    }

    /// What is nearest to a point: the ground's tangent plane or a rock's, and whether a rock's.
    pub fn pad_footing(&self, point_w: &Vector3<f64>) -> (Footing, bool) {
        let ground = self.footing(point_w);
        match self.ground.nearest_rock(point_w) {
            Some(rock) if rock.clearance_m < ground.clearance_m(point_w) => {
                (Footing::new(&rock, point_w), true)
            }
            _ => (ground, false),
        }
    }

    /// The ground's tangent plane nearest to a point.
    pub fn footing(&self, point_w: &Vector3<f64>) -> Footing {
        Footing::new(&self.ground.nearest(point_w), point_w)
    }
}

/// A plane: the points p with n · p = offset.
#[derive(Clone, Copy, Debug)]
pub struct Footing {
    pub normal_w: Vector3<f64>,
    pub offset_m: f64,
}

impl Footing {
    fn new(surface: &Surface, point_w: &Vector3<f64>) -> Self {
        let Surface { clearance_m, normal_w } = *surface;
        Self { normal_w, offset_m: normal_w.dot(point_w) - clearance_m }
    }

    pub fn clearance_m(&self, point_w: &Vector3<f64>) -> f64 {
        self.normal_w.dot(point_w) - self.offset_m
    }

    /// The plane's point nearest to a point.
    pub fn below(&self, point_w: &Vector3<f64>) -> Vector3<f64> {
        point_w - self.normal_w * self.clearance_m(point_w)
    }
}

/// Something of hull and nozzle each: the parts that must not touch the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Structure<T> {
    pub hull: T,
    pub nozzle: T,
}

impl Structure<bool> {
    pub fn any(&self) -> bool {
        self.hull || self.nozzle
    }
}

/// What one contact tick did to the ground.
#[derive(Clone, Copy, Debug, Default)]
pub struct Touch {
    /// Per leg: the pad carries load.
    pub feet: [bool; FOOT_SLOTS],
    /// What else carries load.
    pub structure: Structure<bool>,
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
    Strut(StrutContact),
}

impl Contact {
    pub fn take_over(choice: Choice, site: &Site, motion: &Motion, legs: &[LegState]) -> Self {
        match choice {
            Choice::Rapier => Self::Rapier(Box::new(RapierWorld::take_over(site, motion, legs))),
            Choice::Strut => Self::Strut(StrutContact::take_over(site, motion, legs)),
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
            Self::Strut(contact) => contact.step(site, motion, legs, drive),
        }
    }
}
