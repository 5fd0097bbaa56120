//! The master executes whatever the schedule says, here on two components small enough to
//! follow by hand: truth adds its input to x, guidance commands x + 1.

use std::ops::ControlFlow;

use cosim::layout::Layout;
use cosim::master::Master;
use cosim::schedule::{Pair, Schedule};
use lander_models::signals::{Interface, Signal};
use lander_models::{Component, ModelError, Settings, StepReport, Ticks};

const fn signal(name: &'static str, start: f64) -> Signal {
    Signal { name, size: 1, unit: "1", start, description: "" }
}

static TRUTH: Interface = Interface {
    model: "adder",
    description: "",
    inputs: &[signal("u", 0.0)],
    outputs: &[signal("x", 1.0)],
    outputs_depend_on_inputs: false,
};
static GUIDANCE: Interface = Interface {
    model: "commander",
    description: "",
    inputs: &[signal("x", 1.0)],
    outputs: &[signal("u", 0.0)],
    outputs_depend_on_inputs: false,
};
static INTERFACES: Pair<&Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };

#[derive(Debug)]
struct Adder;
#[derive(Debug)]
struct Commander;

impl Component for Adder {
    const INTERFACE: &'static Interface = &TRUTH;
    type State = f64;

    fn create(_: &Settings) -> Result<(Self, f64), ModelError> {
        Ok((Self, 1.0))
    }

    fn step(&self, x: &mut f64, u: &[f64], _: Ticks) -> Result<StepReport, ModelError> {
        *x += u[0];
        Ok(StepReport { event: false, terminate: *x > 10.0 })
    }

    fn outputs(&self, x: &f64, outputs: &mut [f64]) {
        outputs[0] = *x;
    }
}

impl Component for Commander {
    const INTERFACE: &'static Interface = &GUIDANCE;
    type State = f64;

    fn create(_: &Settings) -> Result<(Self, f64), ModelError> {
        Ok((Self, 0.0))
    }

    fn step(&self, u: &mut f64, x: &[f64], _: Ticks) -> Result<StepReport, ModelError> {
        if x[0] > 50.0 {
            return Err(ModelError::Diverged { time_s: 0.0, what: "x" });
        }
        *u = x[0] + 1.0;
        Ok(StepReport::default())
    }

    fn outputs(&self, u: &f64, outputs: &mut [f64]) {
        outputs[0] = *u;
    }
}

#[derive(Debug)]
enum Failure {
    Model,
    Row,
}

impl From<ModelError> for Failure {
    fn from(_: ModelError) -> Self {
        Self::Model
    }
}

fn schedule(actions: &[&str]) -> Schedule {
    let text = format!(
        "communication_step = {{ value = 0.01, unit = \"s\" }}\n\
         actions = [{}]\n\
         rows = [\"truth\", \"guidance\"]\nresults = [\"x\"]\n\
         [components]\ntruth = \"adder\"\nguidance = \"commander\"\n[codes]\n",
        actions.join(", ")
    );
    Schedule::parse(&text, &INTERFACES).unwrap()
}

const TO_GUIDANCE: &str = "{ do = \"transfer\", from = \"truth\", to = \"guidance\" }";
const TO_TRUTH: &str = "{ do = \"transfer\", from = \"guidance\", to = \"truth\" }";
const GUIDE: &str = "{ do = \"step\", component = \"guidance\" }";
const MOVE: &str = "{ do = \"step\", component = \"truth\" }";
const RECORD: &str = "{ do = \"record\" }";

fn rows(schedule: &Schedule, stop_time: Ticks) -> Vec<Vec<f64>> {
    let settings = Settings { scenario_file: "unused.toml".into() };
    let mut rows = Vec::new();
    let mut master = Master::new::<Adder, Commander>(schedule, &settings).unwrap();
    master
        .run(stop_time, |row| {
            rows.push(row.to_vec());
            Ok::<_, Failure>(ControlFlow::Continue(()))
        })
        .unwrap();
    rows
}

#[test]
fn rows_hold_time_then_truth_then_guidance_until_a_component_terminates() {
    let schedule = schedule(&[TO_GUIDANCE, GUIDE, TO_TRUTH, MOVE, RECORD]);
    let names: Vec<String> = Layout::new(&schedule, &INTERFACES).column_names().collect();
    assert_eq!(names, ["time_s", "x", "u"]);
    let expected = [[0.0, 1.0, 0.0], [0.01, 3.0, 2.0], [0.02, 7.0, 4.0], [0.03, 15.0, 8.0]];
    assert_eq!(rows(&schedule, Ticks(1000)), expected);
}

#[test]
fn another_order_of_the_same_actions_gives_another_run() {
    let late = schedule(&[MOVE, TO_GUIDANCE, GUIDE, RECORD, TO_TRUTH]);
    let expected = [[0.0, 1.0, 0.0], [0.01, 1.0, 2.0], [0.02, 3.0, 4.0]];
    assert_eq!(rows(&late, Ticks(20)), expected);
}

#[test]
fn the_stop_time_ends_a_run() {
    let idle = schedule(&[RECORD]);
    assert_eq!(rows(&idle, Ticks(50)).len(), 6, "initial row and five steps");
}

#[test]
fn a_break_ends_the_run_at_that_row_and_an_error_ends_it_at_once() {
    let settings = Settings { scenario_file: "unused.toml".into() };
    let schedule = schedule(&[TO_GUIDANCE, GUIDE, TO_TRUTH, MOVE, RECORD]);
    let master = || Master::new::<Adder, Commander>(&schedule, &settings).unwrap();
    let mut seen = 0;
    let broken = master().run(Ticks(1000), |row| {
        seen += 1;
        let flow = if row[0] < 0.01 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
        Ok::<_, Failure>(flow)
    });
    assert!(broken.is_ok());
    assert_eq!(seen, 2);
    let failed = master().run(Ticks(1000), |_| Err(Failure::Row));
    assert!(matches!(failed, Err(Failure::Row)));
}

#[test]
fn a_value_that_is_not_finite_is_refused_as_an_fmu_refuses_it() {
    #[derive(Debug)]
    struct Broken;
    impl Component for Broken {
        const INTERFACE: &'static Interface = &TRUTH;
        type State = ();

        fn create(_: &Settings) -> Result<(Self, ()), ModelError> {
            Ok((Self, ()))
        }

        fn step(&self, (): &mut (), _: &[f64], _: Ticks) -> Result<StepReport, ModelError> {
            Ok(StepReport::default())
        }

        fn outputs(&self, (): &(), outputs: &mut [f64]) {
            outputs[0] = f64::NAN;
        }
    }
    let settings = Settings { scenario_file: "unused.toml".into() };
    let schedule = schedule(&[TO_GUIDANCE, RECORD]);
    let mut master = Master::new::<Broken, Commander>(&schedule, &settings).unwrap();
    let result =
        master.run(Ticks(1000), |_| Ok::<_, ModelError>(ControlFlow::Continue(()))).unwrap_err();
    assert_eq!(result.to_string(), "input x is NaN: inputs must be finite");
}

#[test]
fn a_component_that_fails_ends_the_run() {
    let settings = Settings { scenario_file: "unused.toml".into() };
    // Six rounds in one communication step carry x past 50: 1, 3, 7, 15, 31, 63.
    let round = [TO_GUIDANCE, GUIDE, TO_TRUTH, MOVE];
    let schedule = schedule(&round.repeat(6));
    let mut master = Master::new::<Adder, Commander>(&schedule, &settings).unwrap();
    let result = master.run(Ticks(1000), |_| Ok::<_, Failure>(ControlFlow::Continue(())));
    assert!(matches!(result, Err(Failure::Model)));
}
