//! `lander paper`: the paper's tables and figures.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use cosim::landing::{Error, write_whole};
use cosim::paper::chapter::Chapter;
use cosim::paper::{self, Order};

use super::{INTERRUPTED, OK, interruption, kit_folder, print, threads};

#[derive(Args)]
pub struct Paper {
    /// Folder for the report, its figures and tables
    #[arg(long, default_value = "results/paper")]
    out: PathBuf,
    /// Flights of each Monte Carlo
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    runs: u64,
    /// Number of threads; 0 takes all cores. The results don't depend on it
    #[arg(long, default_value_t = 0, value_parser = threads)]
    threads: usize,
    /// Print the tables as one JSON object
    #[arg(long)]
    json: bool,
}

impl Paper {
    pub fn execute(self) -> Result<u8, Error> {
        let interrupted = interruption()?;
        let (out, json) = (self.out.clone(), self.json);
        let order = Order {
            models: kit_folder("models"),
            out: self.out,
            runs: self.runs,
            threads: self.threads,
        };
        let Some(chapters) = order.execute(&interrupted)? else {
            // Nobody has to listen.
            let _ = writeln!(
                std::io::stderr(),
                "interrupted: flights are kept, the same command goes on from them"
            );
            return Ok(INTERRUPTED);
        };
        let all: Vec<_> = chapters.iter().map(Chapter::to_json).collect();
        let text = serde_json::to_string_pretty(&serde_json::json!({ "chapters": all }))? + "\n";
        paper::page(chapters).write(&out, "report")?;
        write_whole(&out.join("paper.json"), &text)?;
        print(&if json { text } else { format!("{}\n", out.join("report.html").display()) })?;
        Ok(OK)
    }
}
