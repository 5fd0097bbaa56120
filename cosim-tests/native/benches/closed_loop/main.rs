//! `cargo bench -p cosim --bench closed_loop [-- --runs N --threads N --scheme NAME --json]`: how this
//! guidance lands under the paper's perturbations, beside the paper's scheme and an open loop. One
//! table in one run; every run that ended badly is left as a scenario file.

mod table;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use cosim::descents::{CLOSED_LOOP, FILTER, OPEN_LOOP, PAPER, SLOW, Scheme};
use lander_models::Vehicle;
use nix::time::{ClockId, clock_gettime};

use table::Campaign;

const SCHEMES: [Scheme; 5] = [CLOSED_LOOP, FILTER, SLOW, PAPER, OPEN_LOOP];
const RUNS: u64 = 200;

struct Options {
    runs: u64,
    threads: usize,
    scheme: Option<String>,
    json: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::read(std::env::args().skip(1))?;
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").canonicalize()?;
    let vehicle_file = models.join("vehicles/bug.toml");
    let vehicle = Vehicle::load(&vehicle_file)?;
    let seeds: Vec<u64> = (1..=options.runs).collect();
    let mut campaigns = Vec::new();
    let wanted =
        |scheme: &&Scheme| options.scheme.as_deref().is_none_or(|name| name == scheme.name);
    for scheme in SCHEMES.iter().filter(wanted) {
        let start_s = cpu_s()?;
        let descents = scheme.fly(&vehicle, &seeds, options.threads)?;
        let cpu_s = (cpu_s()? - start_s) / seeds.len() as f64;
        campaigns.push(Campaign::new(scheme, descents, cpu_s));
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("closed_loop");
    let vehicle_file = vehicle_file.display().to_string();
    for campaign in &campaigns {
        write_bad_runs(campaign, &folder, &vehicle_file)?;
    }
    if options.json {
        println!("{}", serde_json::to_string_pretty(&campaigns)?);
    } else {
        table::print(&campaigns, &folder);
    }
    Ok(())
}

impl Options {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut options = Self { runs: RUNS, threads: 0, scheme: None, json: false };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value"));
            match word.as_str() {
                "--runs" => options.runs = value()?.parse()?,
                "--threads" => options.threads = value()?.parse()?,
                "--scheme" => options.scheme = Some(value()?),
                "--json" => options.json = true,
                // Cargo's own.
                "--bench" => {}
                _ => return Err(format!("{word} is no option").into()),
            }
        }
        Ok(options)
    }
}

/// CPU time of all threads of this process so far, s.
fn cpu_s() -> Result<f64, nix::Error> {
    let now = clock_gettime(ClockId::CLOCK_PROCESS_CPUTIME_ID)?;
    Ok(now.tv_sec() as f64 + 1e-9 * now.tv_nsec() as f64)
}

/// Leaves every run that did not land as a scenario file, to be flown again.
fn write_bad_runs(campaign: &Campaign, folder: &Path, vehicle: &str) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    for descent in campaign.bad() {
        let file = folder.join(format!("{}-{}.toml", campaign.scheme.name, descent.seed));
        fs::write(file, campaign.scheme.scenario_text(vehicle, descent.seed))?;
    }
    Ok(())
}
