//! A landing with a filter beside it that sees the raw sensors alone.

use std::path::Path;

use guidance_fmu::Guidance;
use guidance_fmu::navigation::nominal::{
    ACCELEROMETER_BIAS, ATTITUDE, GYRO_BIAS, POSITION, VELOCITY,
};
use guidance_fmu::navigation::{Actuation, Estimator, Inputs, Navigator, Update};
use lander_models::random::{normal, normal3};
use lander_models::scenario::{Navigation, PerSensor};
use lander_models::signals::{GUIDANCE, TRUTH, connections};
use lander_models::{Component, Scenario, Ticks, Vehicle};
use nalgebra::{SMatrix, SVector, Vector3};
use truth_model::{State, TruthModel};

pub const STEP: Ticks = Ticks(10);
/// Position, velocity, attitude and the IMU's biases.
pub const CORE: usize = 15;

pub type Core = SVector<f64, CORE>;

/// The default landing on sensors.
pub fn landing() -> (Scenario, Vehicle) {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/scenarios/landing-sensors.toml");
    Scenario::load(&file).unwrap()
}

/// The same with ground as the filter assumes it: a plane whose slopes are drawn.
pub fn drawn(seed: u64) -> (Scenario, Vehicle) {
    let (mut scenario, vehicle) = landing();
    scenario.seed = seed;
    scenario.prior.ground_roughness_m = 0.0;
    let slope = scenario.prior.ground_slope;
    let [x, y] = [0, 1].map(|axis| slope * normal(seed, "ground slope", axis));
    scenario.terrain.slope_rad = x.hypot(y).atan();
    scenario.terrain.downhill_rad = (-y).atan2(-x);
    let gravity = scenario.prior.gravity * normal(seed, "gravity of the site", 0);
    scenario.disturbances.offset.gravity = gravity;
    (scenario, vehicle)
}

pub struct Flight {
    pub truth: TruthModel,
    pub state: State,
    pub navigator: Navigator,
    pub estimator: Estimator,
    guidance: Guidance,
    guidance_state: guidance_fmu::State,
    inputs: Vec<f64>,
    commands: Vec<f64>,
}

impl Flight {
    /// By perfect guidance.
    pub fn new((scenario, vehicle): (Scenario, Vehicle)) -> Self {
        let mut seeing = scenario.clone();
        seeing.sensing.navigation = Navigation::Perfect;
        Self::guided_by(&seeing, scenario, vehicle)
    }

    /// By guidance that flies on a filter of its own, whose twin is the one beside it.
    pub fn closed((scenario, vehicle): (Scenario, Vehicle)) -> Self {
        Self::guided_by(&scenario.clone(), scenario, vehicle)
    }

    fn guided_by(seen: &Scenario, scenario: Scenario, vehicle: Vehicle) -> Self {
        let navigator = Navigator::new(&scenario, &vehicle).unwrap();
        let guidance = Guidance::new(seen, vehicle.clone());
        let truth = TruthModel::new(scenario, vehicle);
        Self {
            state: truth.initial_state(),
            truth,
            estimator: navigator.start(),
            navigator,
            guidance_state: guidance.initial_state(),
            guidance,
            inputs: vec![0.0; GUIDANCE.input_len()],
            commands: vec![0.0; TRUTH.input_len()],
        }
    }

    fn told(&self) -> Vec<f64> {
        let mut told = vec![0.0; TRUTH.output_len()];
        self.truth.outputs(&self.state, &mut told);
        told
    }

    /// A scalar output of the truth.
    pub fn output(&self, name: &str) -> f64 {
        self.told()[TRUTH.output_offset(name).unwrap()]
    }

    /// What guidance is told now.
    pub fn inputs(&mut self) -> &mut [f64] {
        let told = self.told();
        for (from, to, size) in connections(&TRUTH, &GUIDANCE) {
            self.inputs[to..to + size].copy_from_slice(&told[from..from + size]);
        }
        &mut self.inputs
    }

    /// Lets the filter see the present readings.
    pub fn observe(&mut self) -> PerSensor<Option<Update>> {
        self.inputs();
        self.observe_as_told()
    }

    /// As `observe`, with inputs that a test may have changed.
    pub fn observe_as_told(&mut self) -> PerSensor<Option<Update>> {
        let inputs = Inputs::read(&self.inputs);
        let actuation = Actuation::default();
        self.navigator.step(&mut self.estimator, self.state.now, &inputs, &actuation).unwrap()
    }

    /// Flies one communication step.
    pub fn fly(&mut self) {
        self.inputs();
        self.guidance.step(&mut self.guidance_state, &self.inputs, STEP).unwrap();
        let mut told = vec![0.0; GUIDANCE.output_len()];
        self.guidance.outputs(&self.guidance_state, &mut told);
        for (from, to, size) in connections(&GUIDANCE, &TRUTH) {
            self.commands[to..to + size].copy_from_slice(&told[from..from + size]);
        }
        self.truth.step(&mut self.state, &self.commands, STEP).unwrap();
    }

    pub fn airborne(&self) -> bool {
        self.state.touchdown.first.is_none()
    }

    /// Truth less estimate, in the order of the filter's errors. The biases' drift since the start
    /// is left out: 0.13 of a deviation that is itself an eighth of the bias's, or less.
    pub fn error(&self) -> Core {
        let sensors = self.truth.vehicle().sensors.as_ref().unwrap();
        let (motion, seed) = (&self.state.motion, self.truth.scenario().seed);
        let nominal = &self.estimator.filter.nominal;
        let drawn = |stream: &str, sigma: f64| normal3(seed, stream, 0) * sigma;
        let imu = &sensors.imu;
        let gyro_bias_b =
            drawn("imu.gyro.bias", imu.gyro.bias) + drawn("imu.gyro.drift", imu.gyro.drift);
        let accelerometer_bias_b = drawn("imu.accelerometer.bias", imu.accelerometer.bias)
            + drawn("imu.accelerometer.drift", imu.accelerometer.drift);
        let mut error = Core::zeros();
        let mut set = |place, value: Vector3<f64>| {
            error.fixed_rows_mut::<3>(place).copy_from(&value);
        };
        set(POSITION, motion.point_position_w(&imu.mount_b) - nominal.position_w);
        set(VELOCITY, motion.point_velocity_w(&imu.mount_b) - nominal.velocity_w);
        let turn = nominal.attitude_wb.inverse() * motion.attitude_wb;
        set(ATTITUDE, turn.scaled_axis());
        set(GYRO_BIAS, gyro_bias_b - nominal.parameters3(GYRO_BIAS));
        set(ACCELEROMETER_BIAS, accelerometer_bias_b - nominal.parameters3(ACCELEROMETER_BIAS));
        error
    }

    pub fn covariance(&self) -> SMatrix<f64, CORE, CORE> {
        self.estimator.filter.covariance.fixed_view::<CORE, CORE>(0, 0).into()
    }

    /// Normalised estimation error squared.
    pub fn nees(&self) -> f64 {
        let error = self.error();
        error.dot(&self.covariance().cholesky().unwrap().solve(&error))
    }
}
