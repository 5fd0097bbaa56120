//! THE signal table. Value references, modelDescription.xml, the log schema and the wiring
//! between the two components all come from here.
//!
//! Wiring rule: an output of one component feeds the input of the same name in the other.

/// Feet that the table has room for; a vehicle with fewer leaves the last slots at their start.
pub const FOOT_SLOTS: usize = 6;

/// Sensors in `sensor_valid` and `sensor_samples` (`scenario::PerSensor` has their order).
pub const SENSOR_SLOTS: usize = 6;

/// Failures in `fault_declared`.
pub const FAULT_SLOTS: usize = 7;

/// One named signal of `size` scalars.
#[derive(Clone, Copy, Debug)]
pub struct Signal {
    /// Scalars carry their unit in the name, vectors their frame (docs/CONVENTIONS.md).
    pub name: &'static str,
    pub size: usize,
    /// Unit in FMI spelling: `m`, `m/s`, `rad`, `1`, …
    pub unit: &'static str,
    /// Start value of each scalar (first scalar for a quaternion: see `start_of`).
    pub start: f64,
    pub description: &'static str,
}

impl Signal {
    /// Start value of scalar `index`; an attitude starts as the identity quaternion.
    pub fn start_of(&self, index: usize) -> f64 {
        let attitude = self.name.ends_with(ATTITUDE_WB.name);
        if attitude && index > 0 { 0.0 } else { self.start }
    }

    /// `name` for a scalar, `name[1]` … `name[size]` for an array.
    pub fn scalar_name(&self, index: usize) -> String {
        if self.size == 1 { self.name.to_owned() } else { format!("{}[{}]", self.name, index + 1) }
    }
}

/// Everything the outside can see of one component.
#[derive(Debug)]
pub struct Interface {
    /// FMI model name and identifier stem.
    pub model: &'static str,
    pub description: &'static str,
    pub inputs: &'static [Signal],
    pub outputs: &'static [Signal],
    /// `true` where outputs respond to inputs only through a step. Both components are so:
    /// a master sees no algebraic loop.
    pub outputs_depend_on_inputs: bool,
}

impl Interface {
    pub fn input_len(&self) -> usize {
        len(self.inputs)
    }

    pub fn output_len(&self) -> usize {
        len(self.outputs)
    }

    /// Position of an output in the flat output slice.
    pub fn output_offset(&self, name: &str) -> Option<usize> {
        offset(self.outputs, name)
    }

    /// Position of an input in the flat input slice.
    pub fn input_offset(&self, name: &str) -> Option<usize> {
        offset(self.inputs, name)
    }
}

/// Number of scalars in a list of signals.
pub fn len(signals: &[Signal]) -> usize {
    signals.iter().map(|signal| signal.size).sum()
}

fn offset(signals: &[Signal], name: &str) -> Option<usize> {
    let position = signals.iter().position(|signal| signal.name == name)?;
    Some(len(&signals[..position]))
}

/// (from output offset, to input offset, scalars) for every name the two have in common.
pub fn connections(from: &Interface, to: &Interface) -> Vec<(usize, usize, usize)> {
    from.outputs
        .iter()
        .filter_map(|signal| {
            Some((offset(from.outputs, signal.name)?, offset(to.inputs, signal.name)?, signal.size))
        })
        .collect()
}

const fn vector(
    name: &'static str,
    size: usize,
    unit: &'static str,
    description: &'static str,
) -> Signal {
    Signal { name, size, unit, start: 0.0, description }
}

const fn scalar(name: &'static str, unit: &'static str, description: &'static str) -> Signal {
    vector(name, 1, unit, description)
}

/// A result: NaN until the thing it measures has happened.
const fn result(name: &'static str, unit: &'static str, description: &'static str) -> Signal {
    Signal { start: f64::NAN, ..scalar(name, unit, description) }
}

/// A result for each foot: NaN until it has happened there, and for slots without a foot.
const fn foot_result(name: &'static str, unit: &'static str, description: &'static str) -> Signal {
    Signal { start: f64::NAN, ..vector(name, FOOT_SLOTS, unit, description) }
}

// Truth to guidance: the navigation solution where navigation is perfect, and leg probes.
pub const POSITION_W: Signal =
    vector("position_w", 3, "m", "Position of the structural origin O, world frame");
pub const VELOCITY_W: Signal =
    vector("velocity_w", 3, "m/s", "Velocity of the structural origin O, world frame");
pub const ATTITUDE_WB: Signal = Signal {
    name: "attitude_wb",
    size: 4,
    unit: "1",
    start: 1.0,
    description: "Unit quaternion (w, x, y, z) that turns body coordinates into world coordinates",
};
pub const RATE_B: Signal =
    vector("rate_b", 3, "rad/s", "Angular velocity of body against world, body frame");
pub const SPECIFIC_FORCE_B: Signal = vector(
    "specific_force_b",
    3,
    "m/s2",
    "Non-gravitational acceleration of the centre of mass, mean of the last step, body frame",
);
pub const MASS_KG: Signal = scalar("mass_kg", "kg", "Total mass");
pub const ALTIMETER_M: Signal =
    scalar("altimeter_m", "m", "Height of the structural origin O above the ground below it");
pub const FOOT_CONTACT: Signal =
    vector("foot_contact", FOOT_SLOTS, "1", "Leg probe: 1 while the footpad touches the ground");

pub const COMPUTER_UP: Signal = Signal {
    start: 1.0,
    ..scalar("computer_up", "1", "1; 0 while the computer restarts and no command gets through")
};

// Raw readings, for a navigation filter.
pub const IMU_SPECIFIC_FORCE_B: Signal = vector(
    "imu_specific_force_b",
    3,
    "m/s2",
    "IMU: mean specific force of its mounting over its last period, mid-period body frame",
);
pub const IMU_RATE_B: Signal = vector(
    "imu_rate_b",
    3,
    "rad/s",
    "IMU: rotation vector of its last period over the period's length, body frame",
);
pub const ALTIMETER_RANGE_M: Signal =
    scalar("altimeter_range_m", "m", "Altimeter: slant range along body -z from its mounting");
pub const VELOCIMETER_VELOCITY_B: Signal = vector(
    "velocimeter_velocity_b",
    3,
    "m/s",
    "Velocimeter: velocity of its mounting point against the ground, body frame",
);
pub const STAR_TRACKER_ATTITUDE_WB: Signal = Signal {
    name: "star_tracker_attitude_wb",
    description: "Star tracker: unit quaternion (w, x, y, z), body to world",
    ..ATTITUDE_WB
};
pub const LANDMARK_POSITION_W: Signal =
    vector("landmark_position_w", 3, "m", "Landmark fix: position of O, world frame");
pub const SENSOR_VALID: Signal = vector(
    "sensor_valid",
    SENSOR_SLOTS,
    "1",
    "Last sample arrived: IMU, altimeter, velocimeter, star tracker, leg probes, landmark",
);
pub const SENSOR_SAMPLES: Signal = vector(
    "sensor_samples",
    SENSOR_SLOTS,
    "1",
    "Samples that arrived so far, in the order of sensor_valid: a change is a new reading",
);

// Guidance to truth: commands.
pub const THRUST_COMMAND_N: Signal =
    scalar("thrust_command_n", "N", "Main engine thrust command; 0 is off");
pub const GIMBAL_COMMAND_RAD: Signal = vector(
    "gimbal_command_rad",
    2,
    "rad",
    "Gimbal command: turns of the thrust line about body x, then about body y",
);
pub const RCS_TORQUE_COMMAND_B: Signal =
    vector("rcs_torque_command_b", 3, "N.m", "Torque asked of the attitude thrusters, body frame");

pub const TRUTH: Interface = Interface {
    model: "lander-truth",
    description: "Six-degree-of-freedom lander: powered flight, leg contact, touchdown verdict",
    outputs_depend_on_inputs: false,
    inputs: &[THRUST_COMMAND_N, GIMBAL_COMMAND_RAD, RCS_TORQUE_COMMAND_B],
    outputs: &[
        POSITION_W,
        VELOCITY_W,
        ATTITUDE_WB,
        RATE_B,
        SPECIFIC_FORCE_B,
        MASS_KG,
        ALTIMETER_M,
        FOOT_CONTACT,
        scalar("propellant_kg", "kg", "Propellant left"),
        scalar("thrust_n", "N", "Main engine thrust"),
        vector("gimbal_rad", 2, "rad", "Gimbal angles about body x and body y"),
        vector("rcs_torque_b", 3, "N.m", "Torque of the attitude thrusters, body frame"),
        vector("com_b", 3, "m", "Centre of mass from the structural origin O, body frame"),
        scalar("tilt_deg", "deg", "Angle between the body axis and the vertical"),
        vector("foot_stroke_m", FOOT_SLOTS, "m", "Strut compression"),
        vector("foot_load_n", FOOT_SLOTS, "N", "Axial strut load, compression positive"),
        vector("foot_clearance_m", FOOT_SLOTS, "m", "Height of the footpad above the ground"),
        scalar("contact_active", "1", "1 while the contact engine owns the motion"),
        scalar(
            "outcome",
            "1",
            "0 in_flight, 1 landed, 2 slid, 3 tipped, 4 struck, 5 crashed, 6 no_contact, 7 bottomed",
        ),
        result("position_error_m", "m", "Horizontal distance of O from the target"),
        result("contact_time_s", "s", "Time of first contact"),
        result(
            "contact_speed_down_m_s",
            "m/s",
            "Downward speed of the centre of mass at first contact",
        ),
        result(
            "contact_speed_across_m_s",
            "m/s",
            "Horizontal speed of the centre of mass at first contact",
        ),
        result("contact_tilt_deg", "deg", "Tilt from the vertical at first contact"),
        result("contact_rate_deg_s", "deg/s", "Magnitude of the angular rate at first contact"),
        foot_result("foot_contact_time_s", "s", "Time at which each footpad first touched"),
        foot_result(
            "foot_contact_speed_normal_m_s",
            "m/s",
            "Speed of each footpad into the ground when it first touched, along the local normal",
        ),
        foot_result(
            "foot_contact_speed_tangential_m_s",
            "m/s",
            "Speed of each footpad along the local ground when it first touched",
        ),
        result("rest_tilt_deg", "deg", "Tilt from the vertical when the run ended on the ground"),
        result(
            "rest_tilt_to_ground_deg",
            "deg",
            "Angle between the body axis and the normal of the ground below the footpads then",
        ),
        result(
            "rest_heading_change_deg",
            "deg",
            "Turn about the vertical from first contact until then",
        ),
        result("rest_hull_clearance_m", "m", "Clearance of the hull above the ground then"),
        result("rest_nozzle_clearance_m", "m", "Clearance of the nozzle above the ground then"),
        result("least_hull_clearance_m", "m", "Least clearance of the hull since first contact"),
        result(
            "least_nozzle_clearance_m",
            "m",
            "Least clearance of the nozzle since first contact",
        ),
        scalar("hull_struck", "1", "1 once the hull has touched the ground"),
        scalar("nozzle_struck", "1", "1 once the nozzle has touched the ground"),
        scalar("leg_bottomed", "1", "1 once a strut has used up its stroke"),
        result("peak_stroke_m", "m", "Largest strut compression"),
        result("peak_leg_load_n", "N", "Largest axial strut load"),
        result(
            "peak_acceleration_m_s2",
            "m/s2",
            "Largest non-gravitational acceleration of the centre of mass since first contact, \
             mean of a tick",
        ),
        result(
            "peak_angular_acceleration_rad_s2",
            "rad/s2",
            "Largest angular acceleration since first contact, mean of a tick",
        ),
        result(
            "tip_energy_margin_j",
            "J",
            "Least energy that was still lacking to tip over any edge since first contact",
        ),
        result(
            "tip_margin_now_j",
            "J",
            "Energy still lacking to tip over the worst edge now; negative beyond it",
        ),
        result(
            "stability_distance_m",
            "m",
            "Least distance of the centre of mass inside the vertical planes through adjacent \
             footpads since first contact",
        ),
        result("stability_distance_now_m", "m", "The same distance now; negative beyond an edge"),
        result(
            "tip_time_s",
            "s",
            "Time at which the centre of mass left the support polygon for good",
        ),
        result(
            "slide_distance_m",
            "m",
            "Horizontal distance of the footprint's centre from its place at first contact",
        ),
        scalar("propellant_used_kg", "kg", "Propellant used"),
        scalar("flight_time_s", "s", "Time from start to first contact, or so far"),
        scalar("dead_zone_time_s", "s", "Time for which thrust was commanded inside the dead zone"),
        scalar("slosh_angle_deg", "deg", "Largest angle of a slosh pendulum from the body axis"),
        scalar("faults_active", "1", "Failure modes past their onset"),
        IMU_SPECIFIC_FORCE_B,
        IMU_RATE_B,
        ALTIMETER_RANGE_M,
        VELOCIMETER_VELOCITY_B,
        STAR_TRACKER_ATTITUDE_WB,
        LANDMARK_POSITION_W,
        SENSOR_VALID,
        SENSOR_SAMPLES,
        COMPUTER_UP,
    ],
};

pub const GUIDANCE: Interface = Interface {
    model: "scvx-guidance",
    description: "Successive-convexification guidance, tracking and attitude control",
    outputs_depend_on_inputs: false,
    inputs: &[
        POSITION_W,
        VELOCITY_W,
        ATTITUDE_WB,
        RATE_B,
        SPECIFIC_FORCE_B,
        MASS_KG,
        ALTIMETER_M,
        FOOT_CONTACT,
        IMU_SPECIFIC_FORCE_B,
        IMU_RATE_B,
        ALTIMETER_RANGE_M,
        VELOCIMETER_VELOCITY_B,
        STAR_TRACKER_ATTITUDE_WB,
        LANDMARK_POSITION_W,
        SENSOR_VALID,
        SENSOR_SAMPLES,
        COMPUTER_UP,
    ],
    outputs: &[
        THRUST_COMMAND_N,
        GIMBAL_COMMAND_RAD,
        RCS_TORQUE_COMMAND_B,
        scalar(
            "phase",
            "1",
            "0 standby, 1 lift_off, 2 coast, 3 burn, 4 terminal, 5 cut_off, 6 fall_back",
        ),
        vector("plan_position_w", 3, "m", "Planned position of O now, world frame"),
        vector("plan_velocity_w", 3, "m/s", "Planned velocity of O now, world frame"),
        vector("up_command_w", 3, "1", "Commanded direction of the body axis, world frame"),
        scalar("plan_time_to_go_s", "s", "Time to the end of the plan"),
        scalar("plan_propellant_kg", "kg", "Propellant that the rest of the plan needs"),
        scalar("plans_accepted", "1", "Plans accepted so far"),
        scalar("plans_failed", "1", "Solves that failed so far"),
        scalar("goal", "1", "0 target, 1 anywhere, 2 softest_impact, 3 below, 4 upright"),
        vector(
            "fault_declared",
            FAULT_SLOTS,
            "1",
            "1 while declared: engine out, engine weak, gimbal seized, thruster pair stuck, \
             propellant lost, sensor silent, restarted without memory",
        ),
        // What guidance takes for true at the start of the last step: the filter's estimate, or
        // with perfect navigation the truth with no deviations.
        vector("nav_position_w", 3, "m", "Position of O taken for true, world frame"),
        vector("nav_velocity_w", 3, "m/s", "Velocity of O taken for true, world frame"),
        Signal {
            name: "nav_attitude_wb",
            description: "Attitude taken for true: unit quaternion (w, x, y, z), body to world",
            ..ATTITUDE_WB
        },
        vector("nav_rate_b", 3, "rad/s", "Angular velocity taken for true, body frame"),
        scalar("nav_height_m", "m", "Height of O above the ground taken for true"),
        scalar("nav_mass_kg", "kg", "Total mass taken for true"),
        vector("nav_gyro_bias_b", 3, "rad/s", "Gyro bias, estimate"),
        vector("nav_accelerometer_bias_b", 3, "m/s2", "Accelerometer bias, estimate"),
        vector("nav_sigma_position_w", 3, "m", "Position: standard deviation"),
        vector("nav_sigma_velocity_w", 3, "m/s", "Velocity: standard deviation"),
        vector("nav_sigma_attitude_b", 3, "rad", "Turn about each body axis: standard deviation"),
        vector("nav_sigma_gyro_bias_b", 3, "rad/s", "Gyro bias: standard deviation"),
        vector("nav_sigma_accelerometer_bias_b", 3, "m/s2", "Accelerometer bias: deviation"),
        scalar("nav_sigma_height_m", "m", "Height above the ground: standard deviation"),
        vector(
            "nav_rejected",
            SENSOR_SLOTS,
            "1",
            "Samples that the innovation gate refused so far, in the order of sensor_valid",
        ),
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_has_its_source() {
        for (from, to) in [(&TRUTH, &GUIDANCE), (&GUIDANCE, &TRUTH)] {
            let fed: usize = connections(from, to).iter().map(|c| c.2).sum();
            assert_eq!(fed, to.input_len(), "{} has an unconnected input", to.model);
        }
    }

    #[test]
    fn names_are_unique_and_units_match_across_a_wire() {
        for interface in [&TRUTH, &GUIDANCE] {
            let mut names: Vec<_> =
                interface.inputs.iter().chain(interface.outputs).map(|s| s.name).collect();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), interface.inputs.len() + interface.outputs.len());
        }
        for output in TRUTH.outputs.iter().chain(GUIDANCE.outputs) {
            for input in TRUTH.inputs.iter().chain(GUIDANCE.inputs) {
                if output.name == input.name {
                    assert_eq!((output.unit, output.size), (input.unit, input.size));
                }
            }
        }
    }
}
