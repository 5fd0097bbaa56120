//! Vectors and rotations to Rapier's types and back.

use lander_models::frames::Attitude;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rapier3d_f64::glamx::{DQuat, DVec3};
use rapier3d_f64::math::Pose;

pub fn pose(position: &Vector3<f64>, rotation: &Attitude) -> Pose {
    Pose::from_parts(to_glam(position), rotation_to_glam(rotation))
}

pub fn rotation_to_glam(rotation: &Attitude) -> DQuat {
    let q = rotation.quaternion();
    DQuat::from_xyzw(q.i, q.j, q.k, q.w)
}

pub fn to_glam(v: &Vector3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

pub fn from_glam(v: DVec3) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

pub fn from_glam_rotation(q: DQuat) -> Attitude {
    UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.x, q.y, q.z))
}
