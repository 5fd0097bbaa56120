//! The watches on a vehicle held still in space, its engine doing a given share of what is asked.

use lander_models::Scenario;
use lander_models::signals::{ATTITUDE_WB, GUIDANCE};
use lander_models::vehicle::G0_M_S2;
use nalgebra::Vector2;

use super::*;

const STEP: Ticks = Ticks(10);
const COMMAND_N: f64 = 2000.0;

struct Rig {
    scenario: Scenario,
    vehicle: Vehicle,
    faults: Faults,
    engine: EngineEstimate,
    mass_kg: f64,
}

impl Rig {
    fn new() -> Self {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/landing.toml");
        let (scenario, vehicle) = Scenario::load(file.as_ref()).unwrap();
        let (faults, engine) = (Faults::default(), EngineEstimate::default());
        Self { scenario, vehicle, faults, engine, mass_kg: 250.0 }
    }

    /// Burns for so long with this share of the thrust and so much flow beside it; the thrust line
    /// goes through the centre of mass.
    fn burn(&mut self, seconds: f64, share: f64, loss_kg_s: f64) {
        for _ in 0..(seconds / STEP.seconds()).round() as usize {
            let mut inputs = vec![0.0; GUIDANCE.input_len()];
            inputs[GUIDANCE.input_offset(ATTITUDE_WB.name).unwrap()] = 1.0;
            let mut nav = Navigation::read(&self.vehicle, &inputs).unwrap();
            nav.mass = self.vehicle.mass.at(self.mass_kg - self.vehicle.mass.dry.mass_kg);
            let arm_b = nav.mass.com_b - self.vehicle.engine.pivot_b;
            let trim_rad = crate::disturbance::line_rad(&arm_b);
            self.engine.expect(&self.vehicle.engine, COMMAND_N, &trim_rad, STEP);
            let force_n = share * self.engine.burning_n(0.0).unwrap_or(0.0);
            nav.specific_force_b = Some(arm_b.normalize() * (force_n / nav.mass.mass_kg));
            let flow_kg_s = loss_kg_s + force_n / (self.vehicle.engine.isp_s * G0_M_S2);
            self.mass_kg -= flow_kg_s * STEP.seconds();
            let evidence = Evidence {
                vehicle: &self.vehicle,
                nav: &nav,
                rcs_torque_b: Vector3::zeros(),
                samples: PerSensor::default(),
                perfect: true,
                duration: STEP,
            };
            self.faults.observe(&evidence, &mut self.engine);
        }
    }

    fn capability(&self) -> Capability {
        self.faults.capability(&self.scenario.guidance, &self.vehicle, &self.engine)
    }
}

#[test]
fn a_sound_engine_is_left_alone() {
    let mut rig = Rig::new();
    // Three deviations of the paper's thrust bias.
    rig.burn(5.0, 0.91, 0.0);
    assert_eq!(rig.faults.declared(), [false; FAULT_SLOTS]);
    let (task, vehicle) = (&rig.scenario.guidance, &rig.vehicle);
    assert_eq!(rig.capability(), Capability::nominal(task, vehicle));
}

#[test]
fn no_thrust_is_an_outage_until_it_comes_back() {
    let mut rig = Rig::new();
    rig.burn(1.0, 1.0, 0.0);
    rig.burn(0.09, 0.0, 0.0);
    assert!(!rig.faults.engine.out(), "not yet 0.1 s");
    rig.burn(0.03, 0.0, 0.0);
    assert!(rig.faults.engine.out() && rig.engine.thrust_n() == 0.0);
    // Valves are shut for 0.2 s, then open for 0.3 s and the ignition.
    assert!(!rig.faults.engine.tries_restart(0.3));
    rig.burn(0.2, 0.0, 0.0);
    assert!(rig.faults.engine.tries_restart(0.3));
}

#[test]
fn a_weak_engine_bounds_what_plans_count_on() {
    let mut rig = Rig::new();
    rig.burn(1.0, 1.0, 0.0);
    rig.burn(1.0, 0.4, 0.0);
    assert!(rig.faults.engine.weak());
    let left = rig.capability();
    // 0.4 of 5200 N.
    assert!((left.thrust_max_n - 2080.0).abs() < 1e-6, "{left:?}");
    assert!((left.plan_thrust_max_n - 0.8 * left.thrust_max_n).abs() < 1e-9, "{left:?}");
    rig.burn(1.0, 1.0, 0.0);
    assert!(!rig.faults.engine.weak(), "it is itself again");
}

#[test]
fn a_leak_is_measured_while_the_engine_burns() {
    let mut rig = Rig::new();
    rig.burn(2.0, 1.0, 0.0);
    assert!(!rig.faults.propellant.leaking());
    rig.burn(3.0, 1.0, 1.5);
    // Six memories of 0.5 s leave 0.25 % of the way; the mass of a step is that of its end.
    assert!(rig.faults.propellant.leaking());
    assert!((rig.capability().loss_kg_s - 1.5).abs() < 0.01, "{:?}", rig.capability());
}

#[test]
fn a_torque_nobody_asked_for_is_a_stuck_pair_and_its_end_refutes_it() {
    let mut rig = Rig::new();
    let nav = {
        let mut inputs = vec![0.0; GUIDANCE.input_len()];
        inputs[GUIDANCE.input_offset(ATTITUDE_WB.name).unwrap()] = 1.0;
        Navigation::read(&rig.vehicle, &inputs).unwrap()
    };
    let mut turn = |torque_n_m: f64, steps: usize| {
        let mut rate_rad_s = 0.0;
        for _ in 0..steps {
            let mut nav = nav;
            rate_rad_s += torque_n_m * STEP.seconds() / nav.mass.inertia_b[(2, 2)];
            nav.rate_b.z = rate_rad_s;
            nav.specific_force_b = Some(Vector3::zeros());
            let rcs_torque_b = Vector3::zeros();
            let samples = PerSensor::default();
            let vehicle = &rig.vehicle;
            let evidence = Evidence {
                vehicle,
                nav: &nav,
                rcs_torque_b,
                samples,
                perfect: true,
                duration: STEP,
            };
            rig.faults.observe(&evidence, &mut rig.engine);
        }
        rig.faults.thrusters.stuck
    };
    assert_eq!(turn(0.0, 100), None);
    // 35 N·m less the half that is waited for: 2.5 pulses of 0.7 N·m·s take 0.1 s.
    assert_eq!(turn(-35.0, 8), None);
    assert_eq!(turn(-35.0, 20), Some(StuckPair { axis: 2, sign: -1.0 }));
    assert_eq!(turn(0.0, 20), None);
}

#[test]
fn a_line_that_stands_while_commands_move_is_a_seized_gimbal() {
    let seized = |follows: f64| {
        let mut rig = Rig::new();
        for step in 0..300 {
            let mut inputs = vec![0.0; GUIDANCE.input_len()];
            inputs[GUIDANCE.input_offset(ATTITUDE_WB.name).unwrap()] = 1.0;
            let mut nav = Navigation::read(&rig.vehicle, &inputs).unwrap();
            let angle_rad = if step < 150 { 0.0 } else { 0.1 };
            rig.engine.expect(&rig.vehicle.engine, COMMAND_N, &Vector2::new(angle_rad, 0.0), STEP);
            let line_rad = rig.engine.gimbal_mean_rad() * follows;
            let force_b = crate::disturbance::line_b(&line_rad) * COMMAND_N;
            nav.specific_force_b = Some(force_b / nav.mass.mass_kg);
            // Thrusters hold the vehicle against the line's torque.
            let arm_b = rig.vehicle.engine.pivot_b - nav.mass.com_b;
            let evidence = Evidence {
                vehicle: &rig.vehicle,
                nav: &nav,
                rcs_torque_b: -arm_b.cross(&force_b),
                samples: PerSensor::default(),
                perfect: true,
                duration: STEP,
            };
            rig.faults.observe(&evidence, &mut rig.engine);
        }
        rig.faults.gimbal.proven()
    };
    assert!(seized(0.0) && !seized(1.0));
}
