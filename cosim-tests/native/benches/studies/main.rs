//! `cargo bench -p cosim --bench studies [-- --runs N --touchdowns N --json]`: what closed-loop landings and touchdowns
//! from given contact states take, by threads and by part, and what memory they hold.

mod parts;
mod table;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use cosim::study::Study;
use cosim::study::campaign::Campaign;
use cosim::study::row::Columns;

use table::{Report, Speed};

struct Options {
    runs: u64,
    touchdowns: u64,
    json: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::read(std::env::args().skip(1))?;
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").canonicalize()?;
    let cores = std::thread::available_parallelism()?.get();
    let parts = parts::measure(&models.join("scenarios/monte-carlo.toml"))?;
    let Options { runs, touchdowns, .. } = options;
    let campaigns = models.join("campaigns");
    let contacts = fs::read_to_string(campaigns.join("touchdowns.toml"))?;
    // A quarter of the runs first: what memory the rest adds is what a run leaves behind.
    let speeds = vec![
        fly("touchdowns, strut", &campaigns, &contacts, touchdowns / 4, cores)?,
        fly("touchdowns, strut", &campaigns, &contacts, touchdowns, cores)?,
        fly("landings, strut", &campaigns, &landings("strut"), runs / 4, 1)?,
        fly("landings, strut", &campaigns, &landings("strut"), runs, cores)?,
        fly("landings, Rapier", &campaigns, &landings("rapier"), runs, cores)?,
    ];
    let report = Report { speeds, parts };
    if options.json {
        println!("{}", serde_json::to_string_pretty(&report)?);
    } else {
        report.print();
    }
    Ok(())
}

/// The study of closed-loop landings under the paper's perturbations, contact to rest included.
fn landings(engine: &str) -> String {
    format!(
        "name = \"landings-{engine}\"\nkind = \"landing\"\nscenario = \"../scenarios/monte-carlo.toml\"\n\
         runs = {{ value = 2000, unit = \"1\" }}\nseed = {{ value = 1, unit = \"1\" }}\n\n\
         [[design]]\nkey = \"scenario.contact.engine\"\ndistribution = \"constant\"\nvalue = \"{engine}\"\n"
    )
}

/// A study's runs, its files included.
fn fly(
    what: &'static str,
    campaigns: &Path,
    study: &str,
    runs: u64,
    threads: usize,
) -> Result<Speed, Box<dyn Error>> {
    let asked = study.replace("runs = { value = 2000,", &format!("runs = {{ value = {runs},"));
    let study = Study::parse(&campaigns.join("bench.toml"), &asked)?;
    let columns = Columns::new(&study)?;
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("studies");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let start = Instant::now();
    Campaign::new(&study, &columns, &folder).run(None, threads, &AtomicBool::new(false))?;
    Speed::new(what, runs, threads, start.elapsed())
}

impl Options {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut options = Self { runs: 200, touchdowns: 4000, json: false };
        while let Some(word) = words.next() {
            let mut count = || -> Result<u64, Box<dyn Error>> {
                let value = words.next().ok_or(format!("{word} needs a value"))?.parse()?;
                if value < 4 {
                    Err(format!("{word} {value}: at least 4").into())
                } else {
                    Ok(value)
                }
            };
            match word.as_str() {
                "--runs" => options.runs = count()?,
                "--touchdowns" => options.touchdowns = count()?,
                "--json" => options.json = true,
                // Cargo's own.
                "--bench" => {}
                _ => return Err(format!("{word} is no option").into()),
            }
        }
        Ok(options)
    }
}
