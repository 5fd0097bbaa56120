//! One run of a study: what it draws, the world that makes, how it ends.

use std::ops::ControlFlow;
use std::path::Path;

use lander_models::component::Component;
use lander_models::signals::TRUTH;
use lander_models::{ConfigError, ModelError, Scenario, Ticks, Vehicle, random};
use truth_model::TruthModel;

use super::StudyError;
use super::distribution::Value;
use super::file::{Kind, Study};
use super::parameter::{Files, Parameter, Root};
use super::row::{Columns, Row};
use crate::flight;
use crate::landing::Error;
use crate::recorder::Recorder;
use crate::scene::Scene;
use crate::touchdowns::{self, Case};

/// Stream of the runs' own seeds.
const RUN_SEED: &str = "run seed";

/// A parameter's value in a run.
pub type Draw<'a> = (&'a Parameter, Value);

/// A world that draws have made.
#[derive(Clone, Debug)]
pub struct World {
    pub scenario: Scenario,
    pub vehicle: Vehicle,
    /// Of a touchdown.
    pub case: Case,
}

/// A draw that cannot be.
pub struct Refused {
    /// The key, and what was drawn for it if it was.
    what: String,
    reason: String,
}

impl Refused {
    pub fn at(self, study: &Study, place: impl Into<String>) -> StudyError {
        let Self { what, reason } = self;
        StudyError::Draw { file: study.file.clone(), place: place.into(), what, reason }
    }
}

/// One run, ready to start.
#[derive(Clone, Debug)]
pub struct Run {
    pub number: u64,
    /// Of the scenario's own draws: noise, biases, rocks, sensors.
    pub seed: u64,
    /// The axes', then in the order of `Study::drawn`; `None` for what belongs to a failure mode that it has not.
    pub values: Vec<Option<Value>>,
    /// Its failure modes.
    pub failures: Vec<String>,
    pub truth: World,
    /// What guidance takes for it.
    pub believed: World,
}

impl Study {
    /// Draws run `number`: a function of it and the study's seed alone.
    pub fn run(&self, number: u64) -> Result<Run, StudyError> {
        if number >= self.runs {
            let (file, runs) = (self.file.clone(), self.runs);
            return Err(StudyError::NoSuchRun { file, run: number, runs });
        }
        let Some(layout) = self.sobol_layout() else {
            // Every design has the same draws.
            let row = number / self.designs().count();
            return self.run_of(number, &|stream| random::uniform(self.seed, stream, row));
        };
        let matrices = layout.matrices as u64;
        let (row, matrix) = (number / matrices, number % matrices);
        let exchanged = matrix.checked_sub(2).and_then(|i| self.drawn().nth(i as usize));
        self.run_of(number, &|stream| {
            let of_b = matrix == 1 || exchanged.is_some_and(|parameter| parameter.key == stream);
            // The run's own seed stays with A: noise is part of the function, not an input.
            let sample = if of_b && stream != RUN_SEED { "B" } else { "A" };
            random::uniform(self.seed, &format!("{sample} {stream}"), row)
        })
    }

    /// As `run`, with draws given by stream: a parameter's stream is its key.
    pub fn run_of(&self, number: u64, uniform: &dyn Fn(&str) -> f64) -> Result<Run, StudyError> {
        let designs = self.designs();
        let (row, design) = (number / designs.count(), number % designs.count());
        let modes = self.failures.of_run(row, uniform);
        let of_modes = modes.iter().flat_map(|mode| &mode.parameters);
        let drawn = self.parameters.iter().chain(of_modes);
        let drawn: Vec<Draw> =
            drawn.map(|p| (p, p.distribution.quantile(uniform(&p.key)))).collect();
        // The design first: what is drawn as a factor or added scatters about it.
        let draws: Vec<Draw> = designs.draws(design).into_iter().chain(drawn.clone()).collect();
        let known: Vec<Draw> = draws.iter().filter(|(p, _)| p.known).cloned().collect();
        // A scenario's seed is a whole number that a file can hold.
        let seed = (uniform(RUN_SEED) * 9.007e15) as u64;
        let realise = |draws: &[Draw]| {
            let mut world = self.realise(draws).map_err(|r| r.at(self, format!("run {number}")))?;
            world.scenario.seed = seed;
            Ok::<_, StudyError>(world)
        };
        let value = |parameter: &Parameter| {
            let draw = drawn.iter().find(|(p, _)| p.key == parameter.key);
            draw.map(|(_, value)| value.clone())
        };
        let of_design = designs.values(design).into_iter().map(Some);
        Ok(Run {
            number,
            seed,
            values: of_design.chain(self.drawn().map(value)).collect(),
            failures: modes.iter().map(|mode| mode.name.clone()).collect(),
            truth: realise(&draws)?,
            believed: realise(&known)?,
        })
    }

    /// The world of so many draws; whatever is not drawn is as in the files.
    pub fn realise(&self, draws: &[Draw]) -> Result<World, Refused> {
        let mut files = Files { scenario: self.scenario.clone(), vehicle: self.vehicle.clone() };
        let refused = |(parameter, value): &Draw, reason| Refused {
            what: format!("`{}` drawn as {value}", parameter.key),
            reason,
        };
        for draw in draws {
            if draw.0.root == Root::Case && self.kind == Kind::Landing {
                return Err(refused(draw, "is for kind \"touchdown\"".to_owned()));
            }
            draw.0.apply(&mut files, &draw.1).map_err(|reason| refused(draw, reason))?;
        }
        // The draw whose key the reader refuses; an error of the files themselves has none.
        let blame = |error: ConfigError| {
            let text = error.to_string();
            let guilty = draws.iter().find(|(p, _)| text.contains(&p.path_in_file()));
            match guilty.or(draws.last()) {
                Some(draw) => refused(draw, text),
                None => Refused { what: "the scenario".to_owned(), reason: text },
            }
        };
        let vehicle = Vehicle::of(&self.vehicle_file, files.vehicle).map_err(blame)?;
        let scenario =
            Scenario::of(&self.scenario_file, files.scenario, &vehicle).map_err(blame)?;
        let mut case = touchdowns::case_of(&scenario);
        if self.kind == Kind::Touchdown {
            for (index, value) in &self.case {
                case[*index] = *value;
            }
            for draw in draws {
                draw.0.apply_to_case(&mut case, &draw.1).map_err(|reason| refused(draw, reason))?;
            }
            touchdowns::check(&case, &vehicle).map_err(|(column, reason)| {
                let guilty = draws.iter().find(|(p, _)| p.key.ends_with(column));
                match guilty {
                    Some(draw) => refused(draw, reason),
                    None => Refused { what: format!("`case.{column}`"), reason },
                }
            })?;
        }
        Ok(World { scenario, vehicle, case })
    }
}

impl Run {
    /// Runs to the end. A run that a component breaks off has the outcome `failed` and no results.
    pub fn finish(&self, kind: Kind, columns: &Columns) -> Row {
        let outputs = match kind {
            Kind::Landing => self.land(columns),
            Kind::Touchdown => touchdowns::settle(&self.touchdown())
                .map(|(end, outputs)| [vec![end.seconds()], outputs].concat()),
        };
        let (outcome, results) = match outputs {
            Ok(row) => (columns.outcome(&row), columns.results(&row)),
            Err(_) => ("failed", columns.no_results()),
        };
        Row {
            number: self.number,
            seed: self.seed,
            values: self.values.clone(),
            failures: if self.failures.is_empty() {
                "none".into()
            } else {
                self.failures.join("+")
            },
            outcome,
            results,
        }
    }

    fn land(&self, columns: &Columns) -> Result<Vec<f64>, ModelError> {
        let truth = (&self.truth.scenario, &self.truth.vehicle);
        let believed = (&self.believed.scenario, &self.believed.vehicle);
        flight::last_row(&columns.schedule, truth, believed)
    }

    /// As `finish`, and leaves a log of it.
    pub fn log(&self, kind: Kind, columns: &Columns, file: &Path) -> Result<(), Error> {
        let model = self.touchdown();
        let scenario =
            if kind == Kind::Touchdown { model.scenario() } else { &self.truth.scenario };
        let scene = Scene::new(scenario, &self.truth.vehicle);
        let mut recorder = Recorder::create(file, &columns.layout, scene)?;
        let mut on_row = |row: &[f64]| {
            // A communication point is a whole number of ticks.
            let time = Ticks::from_seconds(row[0]).unwrap_or(Ticks::ZERO);
            recorder.row(time, row);
            Ok::<_, ModelError>(ControlFlow::Continue(()))
        };
        let flown = match kind {
            Kind::Landing => {
                let truth = (&self.truth.scenario, &self.truth.vehicle);
                let believed = (&self.believed.scenario, &self.believed.vehicle);
                flight::fly(&columns.schedule, truth, believed, &mut on_row)
            }
            Kind::Touchdown => watch(&model, columns.schedule.communication_step, &mut on_row),
        };
        // A log reads to its end, also that of a run that broke off.
        recorder.close()?;
        Ok(flown?)
    }

    fn touchdown(&self) -> TruthModel {
        let World { scenario, vehicle, case } = &self.truth;
        touchdowns::place(scenario.clone(), vehicle, case)
    }
}

/// A touchdown as `touchdowns::settle`, a row each communication step.
fn watch<E: From<ModelError>>(
    model: &TruthModel,
    step: Ticks,
    mut on_row: impl FnMut(&[f64]) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    let mut state = model.initial_state();
    let engine_off = vec![0.0; TRUTH.input_len()];
    let mut row = vec![0.0; 1 + TRUTH.output_len()];
    let mut over = false;
    loop {
        row[0] = state.now.seconds();
        model.outputs(&state, &mut row[1..]);
        if on_row(&row)?.is_break() || over || state.now >= model.scenario().stop_time {
            return Ok(());
        }
        over = model.step(&mut state, &engine_off, step)?.terminate;
    }
}
