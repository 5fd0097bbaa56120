//! The table, and what a campaign holds in memory.

use std::error::Error;
use std::fs;
use std::time::Duration;

use serde::Serialize;

use crate::parts::Part;

#[derive(Serialize)]
pub struct Report {
    pub speeds: Vec<Speed>,
    pub parts: Vec<Part>,
}

/// One campaign.
#[derive(Serialize)]
pub struct Speed {
    what: &'static str,
    runs: u64,
    threads: usize,
    wall_s: f64,
    /// Largest resident memory of the process up to its end, MB.
    peak_mb: f64,
}

impl Speed {
    pub fn new(
        what: &'static str,
        runs: u64,
        threads: usize,
        wall: Duration,
    ) -> Result<Self, Box<dyn Error>> {
        Ok(Self { what, runs, threads, wall_s: wall.as_secs_f64(), peak_mb: peak_mb()? })
    }
}

impl Report {
    pub fn print(&self) {
        println!(
            "{:22} {:>7} {:>7} {:>8} {:>11} {:>10} {:>8}",
            "campaign", "runs", "threads", "wall, s", "1,000 in, s", "an hour", "peak, MB"
        );
        for Speed { what, runs, threads, wall_s, peak_mb } in &self.speeds {
            let each_s = wall_s / *runs as f64;
            println!(
                "{what:22} {runs:7} {threads:7} {wall_s:8.1} {:11.1} {:10.0} {peak_mb:8.1}",
                1e3 * each_s,
                3600.0 / each_s
            );
        }
        println!(
            "\n{:40} {:>8} {:>9} {:>7} {:>6}",
            "part of one landing", "steps", "us a step", "ms", "%"
        );
        let whole_s: f64 = self.parts.iter().map(|part| part.cpu_s).sum();
        for Part { name, steps, cpu_s } in &self.parts {
            println!(
                "{name:40} {steps:8} {:9.1} {:7.1} {:6.1}",
                1e6 * cpu_s / (*steps).max(1) as f64,
                1e3 * cpu_s,
                100.0 * cpu_s / whole_s
            );
        }
        println!("{:40} {:8} {:9} {:7.1}", "together, CPU", "", "", 1e3 * whole_s);
    }
}

/// Peak of the resident set as Linux counts it (proc(5), VmHWM).
fn peak_mb() -> Result<f64, Box<dyn Error>> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()).ok_or("no VmHWM")?;
    Ok(kilobytes.parse::<f64>()? / 1024.0)
}
