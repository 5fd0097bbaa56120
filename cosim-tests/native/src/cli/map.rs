//! `lander map`: a study's stability map.

use std::path::PathBuf;

use clap::Args;
use cosim::landing::{Error, write_whole};
use cosim::map::Atlas;
use cosim::map::table::{CaseSummary, points_csv};
use cosim::report;
use cosim::study::{Study, StudyError};

use super::campaign::CAMPAIGNS;
use super::{OK, interruption, kit_file, print, threads};

#[derive(Args)]
pub struct Map {
    /// Study file with a map, or the name of one in models/campaigns
    study: PathBuf,
    /// Folder for a folder of the study's name
    #[arg(long, default_value = "results/maps")]
    out: PathBuf,
    /// Number of threads; 0 takes all cores. The results don't depend on it
    #[arg(long, default_value_t = 0, value_parser = threads)]
    threads: usize,
    /// Print the summary as one JSON object
    #[arg(long)]
    json: bool,
}

impl Map {
    pub fn execute(&self) -> Result<u8, Error> {
        let study = Study::load(&kit_file(self.study.clone(), CAMPAIGNS))?;
        let atlas = Atlas::new(&study)?;
        let folder = self.out.join(&study.name);
        std::fs::create_dir_all(&folder)
            .map_err(|source| StudyError::File { file: folder.clone(), source })?;
        let interrupted = interruption()?;
        let mapped = atlas.draw(self.threads, &interrupted)?;
        let summaries: Vec<CaseSummary> = mapped.iter().map(|case| case.summary()).collect();
        let json = serde_json::json!({
            "study": study.name, "study_sha256": study.hash, "cases": summaries,
        });
        let json = serde_json::to_string_pretty(&json)? + "\n";
        write_whole(&folder.join("points.csv"), &points_csv(&mapped))?;
        report::map::page(&atlas, &mapped, &summaries).write(&folder, "report")?;
        write_whole(&folder.join("map.json"), &json)?;
        print(&if self.json { json } else { words(&summaries) })?;
        Ok(OK)
    }
}

fn words(summaries: &[CaseSummary]) -> String {
    let mut text = format!(
        "{:<24} {:>10}  {:>10} {:>10}  outcomes, % of the plane\n",
        "case", "touchdowns", "static %", "T.24 %"
    );
    for s in summaries {
        let outcomes: Vec<String> =
            s.outcomes.iter().map(|(name, share)| format!("{:.1} {name}", 100.0 * share)).collect();
        text += &format!(
            "{:<24} {:>10}  {:>10.1} {:>10.1}  {}\n",
            s.case,
            s.touchdowns,
            100.0 * s.static_criterion.misclassified,
            100.0 * s.captured_criterion.misclassified,
            outcomes.join(", ")
        );
    }
    text + "static, T.24: share of the plane that the static tip angle and the tip speed of captured pads misjudge\n"
}
