//! `lander campaign`: a study to its tables, or one of its runs alone.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use cosim::landing::Error;
use cosim::report;
use cosim::study::campaign::{End, Part};
use cosim::study::data::Data;
use cosim::study::designs::DesignSummary;
use cosim::study::row::Columns;
use cosim::study::summary::Summary;
use cosim::study::{Study, campaign, data, table};

use super::{INTERRUPTED, OK, interruption, kit_file, print, threads};

pub const CAMPAIGNS: &str = "models/campaigns";

#[derive(Args)]
pub struct Campaign {
    /// Study file, or the name of one in models/campaigns
    study: PathBuf,
    /// Folder for a folder of the study's name
    #[arg(long, default_value = "results/campaigns")]
    out: PathBuf,
    /// Number of threads; 0 takes all cores. The results don't depend on it
    #[arg(long, default_value_t = 0, value_parser = threads)]
    threads: usize,
    /// Run part i of n alone, for as many jobs; a last campaign without it merges all
    #[arg(long, value_name = "I/N")]
    shard: Option<Part>,
    /// Run this one alone and print its row; no table is touched
    #[arg(long, value_name = "NUMBER", conflicts_with = "shard")]
    run: Option<u64>,
    /// MCAP log of that run
    #[arg(long, value_name = "FILE", requires = "run")]
    log: Option<PathBuf>,
    /// Print the summary, or the row, as one JSON object
    #[arg(long)]
    json: bool,
}

impl Campaign {
    pub fn execute(&self) -> Result<u8, Error> {
        let study = Study::load(&kit_file(self.study.clone(), CAMPAIGNS))?;
        study.need_no_map()?;
        self.of(&study)
    }

    /// As `execute`, of a study that must have designs.
    pub fn execute_designs(&self) -> Result<u8, Error> {
        let study = Study::load(&kit_file(self.study.clone(), CAMPAIGNS))?;
        study.need_axes()?;
        self.of(&study)
    }

    fn of(&self, study: &Study) -> Result<u8, Error> {
        let columns = Columns::new(study)?;
        match self.run {
            Some(number) => self.one(study, &columns, number),
            None => self.all(study, &columns),
        }
    }

    fn one(&self, study: &Study, columns: &Columns, number: u64) -> Result<u8, Error> {
        let run = study.run(number)?;
        let row = run.finish(study.kind, columns);
        if let Some(file) = &self.log {
            run.log(study.kind, columns, file)?;
        }
        if self.json {
            print(&(serde_json::to_string_pretty(&row.to_json(columns))? + "\n"))?;
        } else {
            print(&format!("{}\n{}\n", columns.header(), row.to_csv()))?;
        }
        Ok(OK)
    }

    fn all(&self, study: &Study, columns: &Columns) -> Result<u8, Error> {
        let campaign = campaign::Campaign::new(study, columns, &self.out);
        let interrupted = interruption()?;
        match campaign.run(self.shard, self.threads, &interrupted)? {
            End::Interrupted => {
                // Nobody has to listen.
                let _ = writeln!(
                    std::io::stderr(),
                    "interrupted: finished shards are kept, the same command goes on from them"
                );
                Ok(INTERRUPTED)
            }
            End::Part => Ok(OK),
            End::Whole => {
                table::merge(&campaign)?;
                self.conclude(&campaign)
            }
        }
    }

    fn conclude(&self, campaign: &campaign::Campaign) -> Result<u8, Error> {
        let (study, folder) = (campaign.study, &campaign.folder);
        let reader = data::open(campaign)?;
        let data = Data::new(&reader)?;
        let (words, json) = if study.axes.is_empty() {
            let summary = Summary::new(study, &data)?;
            report::campaign::page(study, &data, &summary)?.write(folder, "report")?;
            (summary.to_string(), serde_json::to_string_pretty(&summary)?)
        } else {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build()?;
            let summary = pool.install(|| DesignSummary::new(study, &data))?;
            report::design::page(study, &summary).write(folder, "report")?;
            (summary.to_string(), serde_json::to_string_pretty(&summary)?)
        };
        let json = json + "\n";
        cosim::landing::write_whole(&folder.join("summary.json"), &json)?;
        if self.json {
            print(&json)?;
        } else {
            print(&format!("{words}  report and tables in {}\n", folder.display()))?;
        }
        Ok(OK)
    }
}
