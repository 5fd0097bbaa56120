//! Truth outputs in the order of the signal table.

use lander_models::frames::{attitude_to_wxyz, heading_change_rad, tilt_rad};
use lander_models::signals::FOOT_SLOTS;
use nalgebra::Vector3;

use crate::model::{State, TruthModel};
use crate::verdict::FootImpact;

impl TruthModel {
    pub(crate) fn write_outputs(&self, state: &State, outputs: &mut [f64]) {
        let mut at = 0;
        self.visit_outputs(state, &mut |_, values| {
            outputs[at..at + values.len()].copy_from_slice(values);
            at += values.len();
        });
    }

    /// Hands every output to `put`, in table order.
    fn visit_outputs(&self, state: &State, put: &mut dyn FnMut(&'static str, &[f64])) {
        let motion = &state.motion;
        let readings = self.readings(state);
        let mass = self.vehicle().mass.at(motion.propellant_kg);
        let touchdown = &state.touchdown;
        let first = touchdown.first.as_ref();
        let flag = |on: bool| if on { 1.0 } else { 0.0 };
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let per_foot = |values: &mut dyn Iterator<Item = f64>| {
            let mut slots = [0.0; FOOT_SLOTS];
            for (slot, value) in slots.iter_mut().zip(values) {
                *slot = value;
            }
            slots
        };
        let error_w = motion.position_w - self.scenario().guidance.target_w;
        let tilt_deg = tilt_rad(&motion.attitude_wb).to_degrees();
        let tip = first.map(|_| self.tip_state(state, &mass));
        // What the run ended with, once it touched down.
        let rest = first.filter(|_| touchdown.decided());
        let clearance_m = rest.map(|_| self.structure_clearance_m(motion));
        let per_foot_impact = |value: fn(&FootImpact) -> f64| {
            touchdown.feet.map(|impact| or_nan(impact.as_ref().map(value)))
        };
        let flight_time = first.map_or(state.now, |contact| contact.time);
        // Dry tanks: whatever the lag and the command still say, nothing is delivered.
        let fed = if motion.propellant_kg > 0.0 { 1.0 } else { 0.0 };

        put("position_w", motion.position_w.as_slice());
        put("velocity_w", motion.velocity_w.as_slice());
        put("attitude_wb", &attitude_to_wxyz(&motion.attitude_wb));
        put("rate_b", motion.rate_b.as_slice());
        put("specific_force_b", state.specific_force_b.as_slice());
        put("mass_kg", &[mass.mass_kg]);
        put("altimeter_m", &[readings.altimeter.value.height_m]);
        put("foot_contact", &readings.leg_probes.value.map(flag));
        put("propellant_kg", &[motion.propellant_kg]);
        put("thrust_n", &[state.drive.thrust_n(motion)]);
        put("gimbal_rad", motion.gimbal_rad.as_slice());
        put("rcs_torque_b", (state.drive.rcs_torque_b * fed).as_slice());
        put("com_b", mass.com_b.as_slice());
        put("tilt_deg", &[tilt_deg]);
        put("foot_stroke_m", &per_foot(&mut self.struts(state).map(|strut| strut.0)));
        put("foot_load_n", &per_foot(&mut self.struts(state).map(|strut| strut.1)));
        put("foot_clearance_m", &per_foot(&mut self.foot_clearances_m(state)));
        put("contact_active", &[flag(state.contact.is_some())]);
        put("outcome", &[touchdown.outcome.code()]);
        put("position_error_m", &[error_w.xy().norm()]);
        put("contact_time_s", &[or_nan(first.map(|c| c.time.seconds()))]);
        put("contact_speed_down_m_s", &[or_nan(first.map(|c| -c.com_velocity_w.z))]);
        let across = first.map(|c| c.com_velocity_w.xy().norm());
        put("contact_speed_across_m_s", &[or_nan(across)]);
        put("contact_tilt_deg", &[or_nan(first.map(|c| tilt_rad(&c.attitude_wb).to_degrees()))]);
        put("contact_rate_deg_s", &[or_nan(first.map(|c| c.rate_rad_s.to_degrees()))]);
        put("foot_contact_time_s", &per_foot_impact(|foot| foot.time.seconds()));
        put("foot_contact_speed_normal_m_s", &per_foot_impact(|foot| foot.normal_m_s));
        put("foot_contact_speed_tangential_m_s", &per_foot_impact(|foot| foot.tangential_m_s));
        put("rest_tilt_deg", &[or_nan(rest.map(|_| tilt_deg))]);
        let off_ground_rad = rest.map(|_| {
            let (up_w, normal_w) =
                (motion.attitude_wb * Vector3::z(), self.footprint_normal_w(state));
            libm::atan2(up_w.cross(&normal_w).norm(), up_w.dot(&normal_w))
        });
        put("rest_tilt_to_ground_deg", &[or_nan(off_ground_rad.map(f64::to_degrees))]);
        let turn_rad = rest.map(|c| heading_change_rad(&c.attitude_wb, &motion.attitude_wb));
        put("rest_heading_change_deg", &[or_nan(turn_rad.map(f64::to_degrees))]);
        put("rest_hull_clearance_m", &[or_nan(clearance_m.map(|now| now.hull))]);
        put("rest_nozzle_clearance_m", &[or_nan(clearance_m.map(|now| now.nozzle))]);
        put("least_hull_clearance_m", &[or_nan(touchdown.clearance_m.map(|least| least.hull))]);
        put("least_nozzle_clearance_m", &[or_nan(touchdown.clearance_m.map(|least| least.nozzle))]);
        put("hull_struck", &[flag(touchdown.struck.hull)]);
        put("nozzle_struck", &[flag(touchdown.struck.nozzle)]);
        put("leg_bottomed", &[flag(touchdown.bottomed)]);
        put("peak_stroke_m", &[or_nan(first.map(|_| touchdown.peak_stroke_m))]);
        put("peak_leg_load_n", &[or_nan(first.map(|_| touchdown.peak_load_n))]);
        put("peak_acceleration_m_s2", &[or_nan(first.map(|_| touchdown.peak_acceleration_m_s2))]);
        let angular = first.map(|_| touchdown.peak_angular_acceleration_rad_s2);
        put("peak_angular_acceleration_rad_s2", &[or_nan(angular)]);
        put("tip_energy_margin_j", &[or_nan(touchdown.margin_j)]);
        put("tip_margin_now_j", &[or_nan(tip.map(|tip| tip.margin_j))]);
        put("stability_distance_m", &[or_nan(touchdown.distance_m)]);
        put("stability_distance_now_m", &[or_nan(tip.map(|tip| tip.distance_m))]);
        put("tip_time_s", &[or_nan(touchdown.tip_time().map(|time| time.seconds()))]);
        put("slide_distance_m", &[or_nan(first.map(|_| touchdown.slide_m))]);
        let used_kg = self.scenario().initial.propellant_kg - motion.propellant_kg;
        put("propellant_used_kg", &[used_kg]);
        put("flight_time_s", &[flight_time.seconds()]);
        put("dead_zone_time_s", &[state.dead_zone.seconds()]);
        put("slosh_angle_deg", &[motion.slosh.angle_rad().to_degrees()]);
        put("faults_active", &[self.scenario().faults.active(state.now) as f64]);
        put("imu_specific_force_b", readings.imu.value.specific_force_b.as_slice());
        put("imu_rate_b", readings.imu.value.rate_b.as_slice());
        put("altimeter_range_m", &[readings.altimeter.value.range_m]);
        put("velocimeter_velocity_b", readings.velocimeter.value.as_slice());
        let star_tracker_wb = attitude_to_wxyz(&readings.star_tracker.value);
        put("star_tracker_attitude_wb", &star_tracker_wb);
        put("landmark_position_w", readings.landmark.value.as_slice());
        put("sensor_valid", &readings.valid().to_array().map(flag));
        put("sensor_samples", &readings.samples().to_array().map(|count| count as f64));
        put("computer_up", &[flag(!self.scenario().faults.computer_resets(state.now))]);
    }
}

#[cfg(test)]
mod tests {
    use lander_models::component::{Component, Settings};
    use lander_models::signals::TRUTH;

    use crate::TruthModel;

    #[test]
    fn outputs_follow_the_signal_table() {
        let scenario_file =
            concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/landing.toml").into();
        let (model, state) = TruthModel::create(&Settings { scenario_file }).unwrap();
        let mut written = Vec::new();
        model.visit_outputs(&state, &mut |name, values| written.push((name, values.len())));
        let table: Vec<_> = TRUTH.outputs.iter().map(|s| (s.name, s.size)).collect();
        assert_eq!(written, table);
    }
}
