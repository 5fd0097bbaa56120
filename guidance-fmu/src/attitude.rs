//! Attitude control by gimbal and thrusters (G.35 to G.37).

use lander_models::math::square;
use lander_models::vehicle::Vehicle;
use nalgebra::{Rotation3, UnitQuaternion, Vector2, Vector3};

use crate::disturbance::{self, EngineEstimate};
use crate::faults::{Faults, StuckPair};
use crate::navigation::Navigation;

/// Loop gains: attitude error to rate and rate error to acceleration, 1/s.
struct Gains {
    error_to_rate_1_s: f64,
    rate_to_acceleration_1_s: f64,
    /// Slews are held to this rate.
    rate_max_rad_s: f64,
    /// With which a slew can be counted on to stop.
    deceleration_rad_s2: f64,
}

/// On the gimbal: poles at 3 ± 2.4i rad/s, a fifth of the gimbal's lag (20 rad/s). At 1 kN gimbal and thrusters give
/// 1 rad/s², but the gimbal takes 0.7 s to swing from one end to the other; from 0.25 to 0.4 rad/s² 109 hard
/// starts on the filter end alike (tried by hand).
const ON_GIMBAL: Gains = Gains {
    error_to_rate_1_s: 2.5,
    rate_to_acceleration_1_s: 6.0,
    rate_max_rad_s: 0.5,
    deceleration_rad_s2: 0.4,
};
/// On the thrusters: poles at 1.5 ± 1.2i rad/s; their 0.36 rad/s² stops a slew within 0.7 s.
const ON_THRUSTERS: Gains = Gains {
    error_to_rate_1_s: 1.2,
    rate_to_acceleration_1_s: 3.0,
    rate_max_rad_s: 0.26,
    deceleration_rad_s2: 0.36,
};

/// Time by which the thrust is behind its order for the laws that steer by it (G.99), s: the loop on the gimbal lags by
/// 6/15 = 0.4 s. With 0.3 s the poles of path and attitude together lie where the path's gains have them, at
/// a damping of 0.9; from 0.2 to 0.4 s a thousand landings on perfect navigation
/// end alike (tried by hand).
pub const LAG_S: f64 = 0.3;

impl Gains {
    /// Rate at which an error is taken back, over the error (G.98): in proportion where it is small, and not faster than
    /// can be stopped where it is large.
    fn rate_share_1_s(&self, error_rad: f64) -> f64 {
        let knee_rad = self.deceleration_rad_s2 / square(self.error_to_rate_1_s);
        if error_rad <= knee_rad {
            return self.error_to_rate_1_s;
        }
        (2.0 * self.deceleration_rad_s2 * (error_rad - 0.5 * knee_rad)).sqrt() / error_rad
    }
}

/// Below this thrust the gimbal's torque is not relied on.
pub const GIMBAL_THRUST_MIN_N: f64 = 400.0;

/// The gimbal's angle so far ahead decides what is left for the thrusters, s: one control step.
const LOOK_AHEAD_S: f64 = 0.01;

/// Commands of one step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Torquers {
    pub gimbal_rad: Vector2<f64>,
    pub rcs_torque_b: Vector3<f64>,
}

/// Turns the vehicle so that a thrust through the centre of mass points along `up_w` and body x
/// keeps its heading towards world x.
///
/// `up_rate_w` is the angular velocity of `up_w` itself, rad/s: a turn that is planned needs no
/// error to follow.
pub fn control(
    vehicle: &Vehicle,
    nav: &Navigation,
    engine: &EngineEstimate,
    faults: &Faults,
    up_w: &Vector3<f64>,
    up_rate_w: &Vector3<f64>,
) -> Torquers {
    let thrust_n = engine.thrust_n();
    let steers = thrust_n > GIMBAL_THRUST_MIN_N && faults.gimbal.seized().is_none();
    let gains = if steers { ON_GIMBAL } else { ON_THRUSTERS };
    let free_heading = faults.thrusters.stuck.is_some_and(|pair| pair.axis == 2);
    let heading_w = if free_heading { nav.attitude_wb * Vector3::x() } else { Vector3::x() };
    let trim_b = trim_line_b(vehicle, nav, faults, thrust_n);
    let wanted_wb = attitude_for(up_w, &heading_w, &trim_b);
    let error_b = (wanted_wb.inverse() * nav.attitude_wb).scaled_axis();
    let turn_b = nav.attitude_wb.inverse() * up_rate_w;
    let back_b = error_b * gains.rate_share_1_s(error_b.norm());
    let rate_b = (turn_b - back_b).cap_magnitude(gains.rate_max_rad_s);
    let acceleration_b = (rate_b - nav.rate_b) * gains.rate_to_acceleration_1_s;
    // (G.36)
    let spin_b = nav.mass.inertia_b * nav.rate_b;
    let torque_b = nav.mass.inertia_b * acceleration_b + nav.rate_b.cross(&spin_b);
    allocate(vehicle, nav, engine, faults, &torque_b)
}

/// Unit vector along which the vehicle thrusts, or would.
pub fn thrust_axis_w(
    vehicle: &Vehicle,
    nav: &Navigation,
    engine: &EngineEstimate,
    faults: &Faults,
) -> Vector3<f64> {
    nav.attitude_wb * trim_line_b(vehicle, nav, faults, engine.thrust_n())
}

/// Thrust line that the attitude is to put along the wanted thrust: through the centre of mass, or
/// where a seized gimbal has left it; the body's axis without thrust.
fn trim_line_b(
    vehicle: &Vehicle,
    nav: &Navigation,
    faults: &Faults,
    thrust_n: f64,
) -> Vector3<f64> {
    match faults.gimbal.seized() {
        _ if thrust_n <= GIMBAL_THRUST_MIN_N => Vector3::z(),
        Some(line_rad) => disturbance::line_b(&line_rad),
        None => (nav.mass.com_b - vehicle.engine.pivot_b).normalize(),
    }
}

/// Attitude whose thrust line `trim_b` is `up_w`, with body x near `heading_w` (G.35).
fn attitude_for(
    up_w: &Vector3<f64>,
    heading_w: &Vector3<f64>,
    trim_b: &Vector3<f64>,
) -> UnitQuaternion<f64> {
    // Body y from up × x: defined for every tilt below 90°, which the planner's limit ensures.
    let y_w = up_w.cross(heading_w);
    let y_w = y_w.try_normalize(1e-9).unwrap_or(Vector3::y());
    let x_w = y_w.cross(up_w);
    let frame = Rotation3::from_basis_unchecked(&[x_w, y_w, *up_w]);
    let trim = UnitQuaternion::rotation_between(trim_b, &Vector3::z()).unwrap_or_default();
    UnitQuaternion::from_rotation_matrix(&frame) * trim
}

/// Gimbal first; thrusters for what it can't give, or not in time (G.37).
fn allocate(
    vehicle: &Vehicle,
    nav: &Navigation,
    engine: &EngineEstimate,
    faults: &Faults,
    torque_b: &Vector3<f64>,
) -> Torquers {
    let thrust_n = engine.thrust_n();
    let limit_rad = vehicle.engine.gimbal_limit_rad;
    let arm_b = vehicle.engine.pivot_b - nav.mass.com_b;
    let mut left_b = *torque_b;
    let mut gimbal_rad = Vector2::zeros();
    let seized_rad = faults.gimbal.seized();
    if let (Some(line_rad), Some(asked_rad)) =
        (seized_rad, faults.gimbal.asked_rad(&disturbance::line_rad(&-arm_b)))
    {
        gimbal_rad = asked_rad - engine.pointing_rad;
        left_b -= arm_b.cross(&(disturbance::line_b(&line_rad) * thrust_n));
    } else if thrust_n > GIMBAL_THRUST_MIN_N {
        let lever_nm = arm_b.z * thrust_n;
        let wanted_rad = Vector2::new(
            (torque_b.x - arm_b.y * thrust_n) / lever_nm,
            (torque_b.y + arm_b.x * thrust_n) / lever_nm,
        );
        let command_rad = wanted_rad - engine.pointing_rad;
        gimbal_rad = command_rad.map(|angle| angle.clamp(-limit_rad, limit_rad));
        let line_rad = engine.gimbal_after_rad(&vehicle.engine, &gimbal_rad, LOOK_AHEAD_S)
            + engine.pointing_rad;
        left_b.x -= lever_nm * line_rad.x + arm_b.y * thrust_n;
        left_b.y -= lever_nm * line_rad.y - arm_b.x * thrust_n;
        // A centre of mass off the axis lets the gimbal roll the vehicle a little.
        left_b.z += thrust_n * (arm_b.x * line_rad.x + arm_b.y * line_rad.y);
    }
    let most_b = vehicle.rcs.torque_max_b;
    let mut rcs_torque_b = left_b.zip_map(&most_b, |torque, max| torque.clamp(-max, max));
    if let Some(StuckPair { axis, sign }) = faults.thrusters.stuck {
        rcs_torque_b[axis] = against(sign, left_b[axis], most_b[axis], nav.rate_b[axis]);
    }
    Torquers { gimbal_rad, rcs_torque_b }
}

/// What to ask on the axis of a stuck pair: the pair against it balances it, and less of that
/// turns the vehicle its way (G.89). Nothing stops such a turn, so none is begun: a torque is only
/// let through to stop one the other way.
fn against(sign: f64, wanted_n_m: f64, most_n_m: f64, rate_rad_s: f64) -> f64 {
    let stops = sign * rate_rad_s < 0.0;
    let net_n_m = if stops { (sign * wanted_n_m).clamp(0.0, most_n_m) } else { 0.0 };
    sign * (net_n_m - most_n_m)
}

#[cfg(test)]
mod tests {
    use lander_models::Ticks;
    use lander_models::signals::{ATTITUDE_WB, GUIDANCE, MASS_KG};

    use super::*;

    fn bug() -> Vehicle {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
        Vehicle::load(file.as_ref()).unwrap()
    }

    /// Upright, at rest, with 70 kg of propellant.
    fn upright(vehicle: &Vehicle) -> Navigation {
        let mut inputs = vec![0.0; GUIDANCE.input_len()];
        inputs[GUIDANCE.input_offset(ATTITUDE_WB.name).unwrap()] = 1.0;
        inputs[GUIDANCE.input_offset(MASS_KG.name).unwrap()] = 244.0;
        Navigation::read(vehicle, &inputs).unwrap()
    }

    /// An engine that has settled at a thrust with its gimbal centred.
    fn running(vehicle: &Vehicle, thrust_n: f64) -> EngineEstimate {
        let mut engine = EngineEstimate::default();
        engine.expect(&vehicle.engine, thrust_n, &Vector2::zeros(), Ticks(10_000));
        engine
    }

    /// Torque of a thrust line at these angles, written down again: body z turned about x, then y.
    fn torque_b(nav: &Navigation, vehicle: &Vehicle, line_rad: Vector2<f64>) -> Vector3<f64> {
        let about_x = Rotation3::from_axis_angle(&Vector3::x_axis(), line_rad.x);
        let about_y = Rotation3::from_axis_angle(&Vector3::y_axis(), line_rad.y);
        let force_b = about_y * about_x * Vector3::z() * 2000.0;
        (vehicle.engine.pivot_b - nav.mass.com_b).cross(&force_b)
    }

    #[test]
    fn no_error_is_taken_back_faster_than_it_can_be_stopped() {
        for gains in [ON_GIMBAL, ON_THRUSTERS] {
            let rate_rad_s = |error_rad: f64| gains.rate_share_1_s(error_rad) * error_rad;
            assert_eq!(rate_rad_s(0.01), gains.error_to_rate_1_s * 0.01);
            for step in 1..200 {
                // Deceleration along the profile: rate times its slope.
                let error_rad = 0.01 * f64::from(step);
                let slope_1_s =
                    (rate_rad_s(error_rad + 1e-6) - rate_rad_s(error_rad - 1e-6)) / 2e-6;
                let most_rad_s2 = gains.deceleration_rad_s2;
                let deceleration_rad_s2 = rate_rad_s(error_rad) * slope_1_s;
                // The difference quotient is good to about 1e-9.
                assert!(deceleration_rad_s2 < most_rad_s2 + 1e-6, "{error_rad} rad");
                assert!(slope_1_s > 0.0, "{error_rad} rad");
            }
        }
    }

    #[test]
    fn gimbal_and_thrusters_give_the_torque_that_is_asked_for() {
        let vehicle = bug();
        let nav = upright(&vehicle);
        let asked_b = Vector3::new(20.0, -25.0, 5.0);
        let mut engine = running(&vehicle, 2000.0);
        // At once thrusters give what the gimbal has yet to turn to; in the end the gimbal does all.
        for steps in 0..100 {
            let given = allocate(&vehicle, &nav, &engine, &Faults::default(), &asked_b);
            let soon_rad =
                engine.gimbal_after_rad(&vehicle.engine, &given.gimbal_rad, LOOK_AHEAD_S);
            let torque_b = torque_b(&nav, &vehicle, soon_rad) + given.rcs_torque_b;
            // First order in the angle: what is left is δ²/2 of the torque, below 0.1 % at 2°.
            assert!((torque_b - asked_b).norm() < 1e-3 * asked_b.norm(), "{torque_b}");
            let by_thrusters = given.rcs_torque_b.xy().norm() / asked_b.xy().norm();
            assert!(steps > 0 || by_thrusters > 0.5, "{by_thrusters} at once");
            assert!(steps < 99 || by_thrusters < 1e-3, "{by_thrusters} in the end");
            engine.expect(&vehicle.engine, 2000.0, &given.gimbal_rad, Ticks(10));
        }
    }

    #[test]
    fn a_thrust_line_known_to_be_off_is_trimmed_out() {
        let vehicle = bug();
        let nav = upright(&vehicle);
        let mut engine = running(&vehicle, 2000.0);
        engine.pointing_rad = Vector2::new(0.03, -0.02);
        let asked_b = Vector3::new(10.0, -20.0, 0.0);
        let given = allocate(&vehicle, &nav, &engine, &Faults::default(), &asked_b);
        let torque_b = torque_b(&nav, &vehicle, given.gimbal_rad + engine.pointing_rad);
        // First order in the angle, as above.
        assert!((torque_b - asked_b).xy().norm() < 1e-3 * asked_b.norm(), "{torque_b}");
    }

    #[test]
    fn thrusters_take_over_what_the_gimbal_cannot_give() {
        let vehicle = bug();
        let nav = upright(&vehicle);
        let asked_b = Vector3::new(200.0, 0.0, 0.0);
        let given =
            allocate(&vehicle, &nav, &running(&vehicle, 1000.0), &Faults::default(), &asked_b);
        assert_eq!(given.gimbal_rad.x.abs(), vehicle.engine.gimbal_limit_rad);
        assert_eq!(given.rcs_torque_b.x, vehicle.rcs.torque_max_b.x);
        let engine_off =
            allocate(&vehicle, &nav, &EngineEstimate::default(), &Faults::default(), &asked_b);
        assert_eq!(engine_off.gimbal_rad, Vector2::zeros());
    }

    #[test]
    fn the_wanted_attitude_puts_the_trimmed_thrust_line_where_it_was_asked() {
        let vehicle = bug();
        let nav = upright(&vehicle);
        let up_w = Vector3::new(0.3, -0.2, 0.9).normalize();
        let trim_b = trim_line_b(&vehicle, &nav, &Faults::default(), 2000.0);
        let wanted_wb = attitude_for(&up_w, &Vector3::x(), &trim_b);
        let line_b = (nav.mass.com_b - vehicle.engine.pivot_b).normalize();
        assert!((wanted_wb * line_b - up_w).norm() < 1e-12, "rounding only");
        // Heading: body x keeps to the plane of world x and up.
        assert!((wanted_wb * Vector3::x()).x > 0.8);
    }

    #[test]
    fn a_stuck_pair_is_balanced_and_only_let_through_to_stop_a_turn_against_it() {
        for sign in [1.0, -1.0] {
            for (wanted_n_m, rate_rad_s, net_n_m) in
                [(20.0, -0.1, 20.0), (80.0, -0.1, 50.0), (-20.0, -0.1, 0.0), (20.0, 0.1, 0.0)]
            {
                let asked_n_m = against(sign, sign * wanted_n_m, 50.0, sign * rate_rad_s);
                assert_eq!(asked_n_m + sign * 50.0, sign * net_n_m, "{wanted_n_m}, {rate_rad_s}");
            }
        }
    }

    #[test]
    fn a_tilted_vehicle_is_turned_back() {
        let vehicle = bug();
        for axis in [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()] {
            let mut nav = upright(&vehicle);
            nav.attitude_wb = UnitQuaternion::from_axis_angle(&axis, 0.1);
            let still = Vector3::zeros();
            let (engine, faults) = (EngineEstimate::default(), Faults::default());
            let given = control(&vehicle, &nav, &engine, &faults, &Vector3::z(), &still);
            assert!(given.rcs_torque_b.dot(&axis) < 0.0, "about {axis:?}");
        }
    }

    #[test]
    fn an_attitude_that_was_never_connected_is_refused_by_name() {
        let vehicle = bug();
        let error = Navigation::read(&vehicle, &vec![0.0; GUIDANCE.input_len()]).unwrap_err();
        assert!(error.to_string().contains("attitude_wb"), "{error}");
    }
}
