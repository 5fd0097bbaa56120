//! `lander rare`: the probability of a rare tip-over.

use std::path::PathBuf;

use clap::Args;
use cosim::landing::{Error, write_whole};
use cosim::report;
use cosim::study::row::Columns;
use cosim::study::{Study, StudyError, campaign, rare};

use super::{OK, interruption, kit_file, print, threads};
use crate::cli::campaign::CAMPAIGNS;

#[derive(Args)]
pub struct Rare {
    /// Study file of touchdowns, or the name of one in models/campaigns
    study: PathBuf,
    /// Folder for a folder of the study's name; plain runs found there are compared with
    #[arg(long, default_value = "results/campaigns")]
    out: PathBuf,
    /// Number of threads; 0 takes all cores. The results don't depend on it
    #[arg(long, default_value_t = 0, value_parser = threads)]
    threads: usize,
    /// Print the estimate as one JSON object
    #[arg(long)]
    json: bool,
}

impl Rare {
    pub fn execute(&self) -> Result<u8, Error> {
        let study = Study::load(&kit_file(self.study.clone(), CAMPAIGNS))?;
        let columns = Columns::new(&study)?;
        let campaign = campaign::Campaign::new(&study, &columns, &self.out);
        std::fs::create_dir_all(&campaign.folder)
            .map_err(|source| StudyError::File { file: campaign.folder.clone(), source })?;
        let interrupted = interruption()?;
        let found = rare::estimate(&campaign, self.threads, &interrupted)?;
        let json = serde_json::to_string_pretty(&found)? + "\n";
        write_whole(&campaign.folder.join("rare-event.json"), &json)?;
        report::rare::page(&study, &found).write(&campaign.folder, "rare-event")?;
        print(&if self.json { json } else { found.to_string() })?;
        Ok(OK)
    }
}
