//! The paper's tables and figures, as printed beside what this kit finds: a chapter each, one report.
//!
//! The printed numbers are those of models/paper/printed.toml. Every chapter is a function of the vehicle and
//! those, so that equal inputs make equal bytes.

pub mod chapter;
mod critical_tilt;
mod delta_v;
mod drawing;
mod mass;
mod parameters;
mod printed;
mod problems;
mod tip_angle;
mod tip_over;

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use guidance_fmu::scvx::PlanError;
use lander_models::{ConfigError, Vehicle};

use crate::landing;
use crate::progress::Count;
use crate::report::Page;
use chapter::Chapter;
use printed::Printed;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error("no plan for the {what}: {source}")]
    Plan { what: &'static str, source: PlanError },
}

/// What every chapter may take.
pub struct Inputs {
    pub printed: Printed,
    pub bug: Vehicle,
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
        let inputs = Inputs {
            printed: Printed::load()?,
            bug: Vehicle::load(&self.models.join("vehicles/bug.toml"))?,
        };
        type Make = fn(&Inputs) -> Result<Chapter, Error>;
        let makers: [Make; 7] = [
            |i| Ok(tip_over::chapter(&i.printed, &i.bug)?),
            |i| Ok(parameters::vehicle(&i.printed, &i.bug)?),
            |i| Ok(mass::chapter(&i.printed, &i.bug)?),
            |i| Ok(parameters::engine(&i.printed, &i.bug)?),
            delta_v::chapter,
            critical_tilt::chapter,
            |i| Ok(parameters::perturbations(&i.printed)?),
        ];
        let progress = Count::new("chapters", makers.len());
        let mut chapters = Vec::new();
        for make in makers {
            if interrupted.load(Ordering::Relaxed) {
                return Ok(None);
            }
            chapters.push(make(&inputs)?);
            progress.one_more();
        }
        progress.finish();
        Ok(Some(chapters))
    }
}

/// The report of these chapters.
pub fn page(chapters: Vec<Chapter>) -> Page {
    let mut page = Page::new("The paper's results, as printed and as found");
    page.paragraph(
        "Every table and figure of \"Integrated Lander-Propulsion-GNC Framework for Autonomous Lunar Powered Descent\": what it prints, \
         what its own formula gives, what the models of this kit give, and what differs and why.",
    );
    for chapter in chapters {
        chapter.print(&mut page);
    }
    page
}
