//! Sensitivities against differences, at a state where nothing is zero.

use lander_models::Vehicle;
use lander_models::frames::Attitude;
use lander_models::vehicle::Sensors;
use nalgebra::{SVector, Vector3};

use super::filter::Innovation;
use super::nominal::*;
use super::sensors::*;

fn fit() -> Sensors {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
    Vehicle::load(file.as_ref()).unwrap().sensors.unwrap()
}

/// Every error of its own size: metres, tenths of a radian, hundredths of a scale.
fn somewhere() -> Nominal {
    let attitude_wb = Attitude::from_euler_angles(0.2, -0.3, 0.5);
    let nominal =
        Nominal::new(Vector3::new(40.0, -25.0, 180.0), Vector3::new(-6.0, 3.0, -20.0), attitude_wb);
    let mut parameters = Errors::zeros();
    // Level ground: on a slope the derivative by the horizontal place is left out on purpose.
    for place in (GYRO_BIAS..ERRORS).filter(|place| !(SLOPE..GROUND).contains(place)) {
        parameters[place] = 0.01 * (place as f64).sin();
    }
    nominal.plus(&parameters)
}

/// A measurement's prediction grows by what its innovation shrinks.
fn assert_slopes<const M: usize>(innovate: impl Fn(&Nominal) -> Innovation<M>, what: &str) {
    let nominal = somewhere();
    let sensitivity = innovate(&nominal).sensitivity;
    for place in 0..ERRORS {
        let step = 1e-5;
        let at = |by: f64| {
            let mut error = Errors::zeros();
            error[place] = by;
            innovate(&nominal.plus(&error)).value
        };
        let slope: SVector<f64, M> = (at(-step) - at(step)) / (2.0 * step);
        let found: SVector<f64, M> = sensitivity.column(place).into();
        // Central differences: curvature 1e-10 of values up to some 200, rounding 1e-13/1e-5.
        assert!((slope - found).norm() < 1e-6, "{what}, error {place}: {found} against {slope}");
    }
}

#[test]
fn every_sensitivity_is_the_slope_of_its_prediction() {
    let Sensors {
        altimeter: range, velocimeter: doppler, star_tracker: star, landmark: map, ..
    } = fit();
    let arm_b = Vector3::new(0.2, -0.4, -0.3);
    let ground = Ground { target_w: Vector3::new(3.0, -2.0, 1.0), roughness_m: 0.1 };
    assert_slopes(|n| altimeter(n, &range, &arm_b, &ground, 190.0).unwrap(), "altimeter");
    let (rate_b, velocity_b) = (Vector3::new(0.1, -0.2, 0.05), Vector3::new(1.0, 2.0, -20.0));
    assert_slopes(|n| velocimeter(n, &doppler, &arm_b, &rate_b, &velocity_b), "velocimeter");
    let map = map.unwrap();
    assert_slopes(|n| landmark(n, &map, &arm_b, &Vector3::zeros()), "landmark");
    // Only where estimate and measurement agree is the turn's slope the identity.
    let measured_wb = somewhere().attitude_wb;
    assert_slopes(|n| star_tracker(n, &star, &measured_wb), "star tracker");
}
