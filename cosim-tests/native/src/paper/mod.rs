//! The paper's tables and figures, as printed beside what this kit finds: a chapter each, one report.
//!
//! The printed numbers are those of models/paper/printed.toml. Every chapter is a function of the vehicle and
//! those, so that equal inputs make equal bytes.

mod cadence;
pub mod chapter;
mod closed_loop;
mod comparison;
mod convexification;
mod critical_tilt;
mod delta_v;
mod drawing;
mod dynamic_tip;
mod feasible_band;
mod flights;
mod hop;
mod index;
mod mass;
mod parameters;
mod printed;
mod problems;
mod three_dof;
mod tilt_sweep;
mod tip_angle;
mod tip_over;
mod trajectories;

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use guidance_fmu::scvx::PlanError;
use lander_models::{ConfigError, ModelError, Vehicle};

use crate::landing;
use crate::progress::Count;
use crate::report::Page;
use crate::schedule::ScheduleError;
use crate::study::StudyError;
use chapter::Chapter;
use flights::Flights;
use printed::Printed;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error("no plan for the {what}: {source}")]
    Plan { what: &'static str, source: PlanError },
}

/// What every chapter may take.
pub struct Inputs {
    pub printed: Printed,
    pub bug: Vehicle,
    /// The kit's folder of models.
    pub models: PathBuf,
    /// Of each Monte Carlo.
    pub runs: u64,
    pub flights: Flights,
}

/// What is asked for.
pub struct Order {
    /// The kit's folder of models.
    pub models: PathBuf,
    /// Of the report.
    pub out: PathBuf,
    /// Of each Monte Carlo.
    pub runs: u64,
    /// 0 takes all cores.
    pub threads: usize,
}

impl Order {
    /// Makes the report. `None` if interrupted: flights that were flown are kept.
    ///
    /// # Errors
    /// A file that is missing or wrong, a folder that can't be written.
    pub fn execute(
        &self,
        interrupted: &AtomicBool,
    ) -> Result<Option<Vec<Chapter>>, landing::Error> {
        let folder = self.out.join("flights");
        let flown = Flights::fly(&self.models, &folder, self.runs, self.threads, interrupted)?;
        let Some(flights) = flown else { return Ok(None) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build()?;
        Ok(pool.install(|| self.chapters(flights, interrupted))?)
    }

    fn chapters(
        &self,
        flights: Flights,
        interrupted: &AtomicBool,
    ) -> Result<Option<Vec<Chapter>>, Error> {
        let printed = Printed::load()?;
        let bug = Vehicle::load(&self.models.join("vehicles/bug.toml"))?;
        let models = self.models.clone();
        let inputs = Inputs { printed, bug, models, runs: self.runs, flights };
        let progress = Count::new("chapters", CHAPTERS.len());
        let mut chapters = Vec::new();
        for chapter in CHAPTERS {
            if interrupted.load(Ordering::Relaxed) {
                return Ok(None);
            }
            chapters.push(chapter(&inputs)?);
            progress.one_more();
        }
        progress.finish();
        Ok(Some(chapters))
    }
}

type Make = fn(&Inputs) -> Result<Chapter, Error>;

/// In the order of the paper.
const CHAPTERS: [Make; 15] = [
    tip_over::chapter,
    dynamic_tip::chapter,
    parameters::vehicle,
    mass::chapter,
    comparison::chapter,
    parameters::engine,
    delta_v::chapter,
    convexification::chapter,
    critical_tilt::chapter,
    feasible_band::chapter,
    tilt_sweep::chapter,
    hop::chapter,
    parameters::perturbations,
    closed_loop::chapter,
    cadence::chapter,
];

/// The report of these chapters.
pub fn page(chapters: Vec<Chapter>) -> Page {
    let mut page = Page::new("The paper's results, as printed and as found");
    page.paragraph(
        "Every table and figure of \"Integrated Lander-Propulsion-GNC Framework for Autonomous \
         Lunar Powered Descent\": what it prints, what its own formula gives, what the models \
         of this kit give, and what differs and why.",
    );
    page.filed_table(index::table());
    for chapter in chapters {
        chapter.print(&mut page);
    }
    page
}
