//! What each sensor should read, and how that depends on the errors (G.57 to G.59).

use lander_models::frames::Attitude;
use lander_models::math::square;
use lander_models::vehicle::{AltimeterSpec, LandmarkSpec, StarTrackerSpec, VelocimeterSpec};
use nalgebra::{Matrix1, Matrix3, SMatrix, Vector1, Vector3};

use super::filter::Innovation;
use super::nominal::*;

/// A plane near the target, by its estimated slope and height.
#[derive(Clone, Copy, Debug)]
pub struct Ground {
    pub target_w: Vector3<f64>,
    pub roughness_m: f64,
}

impl Ground {
    /// Upward, of height 1: its product with a displacement is the height gained over the plane.
    fn normal_w(nominal: &Nominal) -> Vector3<f64> {
        Vector3::new(-nominal.parameter(SLOPE), -nominal.parameter(SLOPE + 1), 1.0)
    }

    /// Height of a point of the body over the plane vertically below, and its derivatives (G.57).
    pub fn height_m(
        &self,
        nominal: &Nominal,
        arm_b: &Vector3<f64>,
    ) -> (f64, SMatrix<f64, 1, ERRORS>) {
        let normal_w = Self::normal_w(nominal);
        let from_w = nominal.position_w + nominal.attitude_wb * arm_b - self.target_w;
        // On a slope the height depends on the horizontal place too. That is left out: as the
        // estimated slope changes, a filter takes it for knowledge of the place that no sensor
        // gave (Huang, Mourikis and Roumeliotis, IJRR 29(5), 2010). GROUND carries the product.
        let mut sensitivity = Vector3::z().transpose() * point_sensitivity(nominal, arm_b);
        sensitivity[SLOPE] = -from_w.x;
        sensitivity[SLOPE + 1] = -from_w.y;
        sensitivity[GROUND] = -1.0;
        (normal_w.dot(&from_w) - nominal.parameter(GROUND), sensitivity)
    }
}

/// Position of a point of the body at `arm_b` from the IMU, by the errors.
pub fn point_sensitivity(nominal: &Nominal, arm_b: &Vector3<f64>) -> SMatrix<f64, 3, ERRORS> {
    let attitude = nominal.attitude_wb.to_rotation_matrix().into_inner();
    let mut sensitivity = SMatrix::<f64, 3, ERRORS>::zeros();
    sensitivity.fixed_view_mut::<3, 3>(0, POSITION).fill_with_identity();
    let turned = -attitude * arm_b.cross_matrix();
    sensitivity.fixed_view_mut::<3, 3>(0, ATTITUDE).copy_from(&turned);
    sensitivity
}

/// Slant range to the plane (G.57). None while the beam doesn't point at it.
pub fn altimeter(
    nominal: &Nominal,
    spec: &AltimeterSpec,
    arm_b: &Vector3<f64>,
    ground: &Ground,
    measured_m: f64,
) -> Option<Innovation<1>> {
    let attitude = nominal.attitude_wb.to_rotation_matrix().into_inner();
    let normal_w = Ground::normal_w(nominal);
    let beam_w = attitude * -Vector3::z();
    let closing = -normal_w.dot(&beam_w);
    let (height_m, by_errors) = ground.height_m(nominal, arm_b);
    let range_m = height_m / closing;
    if closing <= 0.0 || range_m <= 0.0 {
        return None;
    }
    // A turn or a slope also moves the spot along the ground.
    let turned_b = attitude * Vector3::z().cross_matrix() * range_m;
    let mut sensitivity = by_errors;
    let mut at_spot = sensitivity.fixed_view_mut::<1, 3>(0, ATTITUDE);
    at_spot += normal_w.transpose() * turned_b;
    sensitivity[SLOPE] -= beam_w.x * range_m;
    sensitivity[SLOPE + 1] -= beam_w.y * range_m;
    let gain = (1.0 + nominal.parameter(ALTIMETER_SCALE)) / closing;
    sensitivity *= gain;
    sensitivity[ALTIMETER_BIAS] = 1.0;
    sensitivity[ALTIMETER_SCALE] = range_m;
    let variance = square(spec.noise_m)
        + square(spec.noise_relative * range_m)
        + square(ground.roughness_m * gain);
    let predicted_m =
        range_m * (1.0 + nominal.parameter(ALTIMETER_SCALE)) + nominal.parameter(ALTIMETER_BIAS);
    Some(Innovation {
        value: Vector1::new(measured_m - predicted_m),
        sensitivity,
        noise: Matrix1::new(variance),
    })
}

/// Velocity against the ground in body axes (G.58).
pub fn velocimeter(
    nominal: &Nominal,
    spec: &VelocimeterSpec,
    arm_b: &Vector3<f64>,
    rate_b: &Vector3<f64>,
    measured_b: &Vector3<f64>,
) -> Innovation<3> {
    let carried_b = nominal.attitude_wb.inverse() * nominal.velocity_w;
    let velocity_b = carried_b + rate_b.cross(arm_b);
    let gain = nominal.parameters3(VELOCIMETER_SCALE).add_scalar(1.0);
    let to_body = nominal.attitude_wb.inverse().to_rotation_matrix().into_inner();
    let scaled = Matrix3::from_diagonal(&gain);
    let mut sensitivity = SMatrix::<f64, 3, ERRORS>::zeros();
    let mut set = |place, block: Matrix3<f64>| {
        sensitivity.fixed_view_mut::<3, 3>(0, place).copy_from(&block);
    };
    set(VELOCITY, scaled * to_body);
    set(ATTITUDE, scaled * carried_b.cross_matrix());
    set(VELOCIMETER_BIAS, Matrix3::identity());
    set(VELOCIMETER_SCALE, Matrix3::from_diagonal(&velocity_b));
    let variance =
        velocity_b.map(|speed| square(spec.noise_m_s) + square(spec.noise_relative * speed));
    let predicted_b = velocity_b.component_mul(&gain) + nominal.parameters3(VELOCIMETER_BIAS);
    Innovation {
        value: measured_b - predicted_b,
        sensitivity,
        noise: Matrix3::from_diagonal(&variance),
    }
}

/// Turn from the estimated attitude to the measured one (G.59).
pub fn star_tracker(
    nominal: &Nominal,
    spec: &StarTrackerSpec,
    measured_wb: &Attitude,
) -> Innovation<3> {
    let turn_b = (nominal.attitude_wb.inverse() * measured_wb).scaled_axis();
    let mut sensitivity = SMatrix::<f64, 3, ERRORS>::zeros();
    sensitivity.fixed_view_mut::<3, 3>(0, ATTITUDE).fill_with_identity();
    sensitivity.fixed_view_mut::<3, 3>(0, MISALIGNMENT).fill_with_identity();
    let about = spec.boresight_b.into_inner() * spec.boresight_b.transpose();
    Innovation {
        value: turn_b - nominal.parameters3(MISALIGNMENT),
        sensitivity,
        noise: (Matrix3::identity() - about) * square(spec.noise_across_rad)
            + about * square(spec.noise_about_rad),
    }
}

/// Position of O on the map (G.59); `arm_b` is O from the IMU.
pub fn landmark(
    nominal: &Nominal,
    spec: &LandmarkSpec,
    arm_b: &Vector3<f64>,
    measured_w: &Vector3<f64>,
) -> Innovation<3> {
    let predicted_w =
        nominal.position_w + nominal.attitude_wb * arm_b + nominal.parameters3(LANDMARK_BIAS);
    let mut sensitivity = point_sensitivity(nominal, arm_b);
    sensitivity.fixed_view_mut::<3, 3>(0, LANDMARK_BIAS).fill_with_identity();
    let variance = spec.noise_w.component_mul(&spec.noise_w);
    Innovation {
        value: measured_w - predicted_w,
        sensitivity,
        noise: Matrix3::from_diagonal(&variance),
    }
}
