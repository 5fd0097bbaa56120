//! `lander map`: which velocities at contact a lander survives, for named cases of ground and attitude.

pub mod criterion;
pub mod file;
pub mod picture;
pub mod refine;
pub mod table;

use std::sync::atomic::{AtomicBool, Ordering};

use lander_models::quantity::ConfigError;
use lander_models::signals::TRUTH;
use lander_models::{ModelError, Outcome};
use rayon::prelude::*;

use crate::landing::Error;
use crate::progress::Count;
use crate::study::run::World;
use crate::study::{Study, StudyError};
use crate::touchdowns::{self, Case};
use criterion::Tips;
use file::{Map, MapCase, Near};
use refine::{Point, Refined, Sample, refine};

/// A touchdown on the map.
#[derive(Clone, Debug)]
pub struct Touchdown {
    pub across_m_s: f64,
    pub down_m_s: f64,
    pub outcome: Outcome,
    pub tip_energy_margin_j: f64,
    pub stability_distance_m: f64,
    pub peak_stroke_m: f64,
    /// Of hull and nozzle, the lesser.
    pub clearance_m: f64,
    /// From contact to the tip-over.
    pub tips_after_s: f64,
    pub criteria: Tips,
    /// How near another outcome is: with margins below so many times their bounds.
    nearness: f64,
}

impl Sample for Touchdown {
    fn class(&self) -> u8 {
        self.outcome as u8
    }

    fn is_close(&self, side: f64) -> bool {
        self.nearness < side
    }
}

/// A case, mapped.
pub struct Mapped<'a> {
    pub case: &'a MapCase,
    pub refined: Refined<Touchdown>,
}

/// Of a study that has a map.
pub struct Atlas<'a> {
    pub study: &'a Study,
    pub map: &'a Map,
    world: World,
}

impl<'a> Atlas<'a> {
    /// # Errors
    /// A study without a map, or with something drawn; a case that cannot be.
    pub fn new(study: &'a Study) -> Result<Self, StudyError> {
        let wrong = |key: &str, reason: String| {
            let (file, key) = (study.file.clone(), key.to_owned());
            StudyError::Config(ConfigError::Key { file, key, reason })
        };
        let map = study.map.as_ref().ok_or_else(|| wrong("map", "is missing".to_owned()))?;
        if let Some(drawn) = study.drawn().next() {
            let reason = "is drawn, but on a map only constants have a place".to_owned();
            return Err(wrong(&drawn.key, reason));
        }
        if !study.axes.is_empty() {
            return Err(wrong("axis", "is for designs: a map is of one".to_owned()));
        }
        let world = study.run(0)?.truth;
        for case in &map.cases {
            let state = case.at(&world.case, map.across_m_s[0], map.down_m_s[0]);
            touchdowns::check(&state, &world.vehicle).map_err(|(column, reason)| {
                wrong("map.cases", format!("{}: `{column}` {reason}", case.name))
            })?;
        }
        Ok(Self { study, map, world })
    }

    /// The contact state of a case at a velocity.
    pub fn state(&self, case: &MapCase, across_m_s: f64, down_m_s: f64) -> Case {
        case.at(&self.world.case, across_m_s, down_m_s)
    }

    /// Velocity at a point of the finest grid: across and down, m/s.
    pub fn velocity_m_s(&self, (x, y): Point) -> [f64; 2] {
        let map = self.map;
        let at = |[low, high]: [f64; 2], step: u32, cells: u32| {
            low + (high - low) * f64::from(step) / f64::from(cells << map.depth)
        };
        [at(map.across_m_s, x, map.cells[0]), at(map.down_m_s, y, map.cells[1])]
    }

    /// Maps every case on so many threads; 0 takes all cores.
    ///
    /// # Errors
    /// A touchdown that fails, `StudyError::Interrupted`.
    pub fn draw(&self, threads: usize, interrupted: &AtomicBool) -> Result<Vec<Mapped<'a>>, Error> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let map = self.map;
        let [columns, rows] = map.cells.map(|n| (n << map.depth) as usize + 1);
        let progress = Count::new("touchdowns at most", map.cases.len() * columns * rows);
        let one = |case: &'a MapCase| {
            let evaluate = |points: &[Point]| {
                let all = points.par_iter().map(|point| {
                    if interrupted.load(Ordering::Relaxed) {
                        return Err(StudyError::Interrupted.into());
                    }
                    let [across_m_s, down_m_s] = self.velocity_m_s(*point);
                    let touchdown = self.touch_down(case, across_m_s, down_m_s);
                    progress.one_more();
                    Ok(touchdown?)
                });
                let all: Vec<Result<Touchdown, Error>> = all.collect();
                all.into_iter().collect()
            };
            Ok(Mapped { case, refined: refine(map.cells, map.depth, evaluate)? })
        };
        let mapped: Result<_, Error> = pool.install(|| map.cases.iter().map(one).collect());
        progress.finish();
        mapped
    }

    fn touch_down(
        &self,
        case: &MapCase,
        across_m_s: f64,
        down_m_s: f64,
    ) -> Result<Touchdown, ModelError> {
        let World { scenario, vehicle, case: nominal } = &self.world;
        let state = case.at(nominal, across_m_s, down_m_s);
        let model = touchdowns::place(scenario.clone(), vehicle, &state);
        let (_, outputs) = touchdowns::settle(&model)?;
        let value = |name| TRUTH.output_offset(name).map_or(f64::NAN, |offset| outputs[offset]);
        let outcome = Outcome::from_code(value("outcome")).unwrap_or_default();
        let near = &self.map.near;
        let stroke_max_m = vehicle.gear.legs.iter().map(|leg| leg.strut_stroke_max_m());
        let stroke_max_m = stroke_max_m.fold(f64::INFINITY, f64::min);
        let mut touchdown = Touchdown {
            across_m_s,
            down_m_s,
            outcome,
            tip_energy_margin_j: value("tip_energy_margin_j"),
            stability_distance_m: value("stability_distance_m"),
            peak_stroke_m: value("peak_stroke_m"),
            clearance_m: value("least_hull_clearance_m").min(value("least_nozzle_clearance_m")),
            tips_after_s: value("tip_time_s") - value("contact_time_s"),
            criteria: criterion::tips(vehicle, &state),
            nearness: f64::INFINITY,
        };
        touchdown.nearness = nearness(&touchdown, near, stroke_max_m);
        Ok(touchdown)
    }
}

/// The least margin as a share of its bound.
fn nearness(t: &Touchdown, near: &Near, stroke_max_m: f64) -> f64 {
    match t.outcome {
        // The longer it took, the less it wanted for not tipping.
        Outcome::Tipped => near.slow_tip_s / t.tips_after_s,
        Outcome::Crashed => f64::INFINITY,
        _ => {
            // A margin that is gone has made its own outcome, and is near no other.
            let left = |margin: f64| if margin > 0.0 { margin } else { f64::INFINITY };
            let stroke_left_m = left(stroke_max_m - t.peak_stroke_m);
            (t.stability_distance_m / near.distance_m)
                .min(left(t.clearance_m) / near.clearance_m)
                .min(stroke_left_m / near.stroke_m)
        }
    }
}
