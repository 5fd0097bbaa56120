//! One table of all schemes, and the seeds of what went badly.

use std::collections::BTreeMap;
use std::path::Path;

/// Bad runs of a scheme that are named; all are left as files.
const SEEDS_SHOWN: usize = 10;

use cosim::descents::{Descent, Scheme};
use cosim::statistics::binomial::lower_limit;
use cosim::statistics::spread::Spread;
use serde::Serialize;

/// All descents of a scheme.
#[derive(Serialize)]
pub struct Campaign {
    #[serde(skip)]
    pub scheme: Scheme,
    name: &'static str,
    replan_s: f64,
    compensation: bool,
    tracking: bool,
    terminal_law: bool,
    landed: usize,
    /// One-sided 95 % lower limit, Clopper and Pearson.
    landed_share_at_least: f64,
    outcomes: BTreeMap<&'static str, usize>,
    miss_m: Spread,
    down_m_s: Spread,
    across_m_s: Spread,
    tilt_deg: Spread,
    rate_deg_s: Spread,
    propellant_kg: Spread,
    /// Mean of a run; not in the JSON, whose bytes are the same in every run.
    #[serde(skip)]
    cpu_s: f64,
    descents: Vec<Descent>,
}

impl Campaign {
    pub fn new(scheme: &Scheme, descents: Vec<Descent>, cpu_s: f64) -> Self {
        let spread = |of: fn(&Descent) -> f64| Spread::of(descents.iter().map(of));
        let landed = descents.iter().filter(|descent| descent.landed).count();
        let mut outcomes = BTreeMap::new();
        for descent in &descents {
            *outcomes.entry(descent.outcome).or_default() += 1;
        }
        Self {
            scheme: *scheme,
            name: scheme.name,
            replan_s: scheme.replan_s,
            compensation: scheme.compensation,
            tracking: scheme.tracking,
            terminal_law: scheme.terminal_law,
            landed,
            landed_share_at_least: lower_limit(landed, descents.len()),
            outcomes,
            miss_m: spread(|d| d.miss_m),
            down_m_s: spread(|d| d.down_m_s),
            across_m_s: spread(|d| d.across_m_s),
            tilt_deg: spread(|d| d.tilt_deg),
            rate_deg_s: spread(|d| d.rate_deg_s),
            propellant_kg: spread(|d| d.propellant_kg),
            cpu_s,
            descents,
        }
    }

    /// Runs that did not end upright and undamaged.
    pub fn bad(&self) -> impl Iterator<Item = &Descent> {
        self.descents.iter().filter(|descent| !descent.landed)
    }

    /// Seed of the greatest value.
    fn worst(&self, of: fn(&Descent) -> f64) -> u64 {
        let measured = self.descents.iter().filter(|descent| !of(descent).is_nan());
        measured.max_by(|a, b| of(a).total_cmp(&of(b))).map_or(0, |descent| descent.seed)
    }
}

pub fn print(campaigns: &[Campaign], folder: &Path) {
    println!(
        "                 landed  at least   miss m             down m/s             across m/s          tilt °  rate °/s  propellant  CPU\n\
         scheme                %         %   mean    p99    max   p50    p99    max   p50   p99    max    p99       p99          kg  ms/run"
    );
    for c in campaigns {
        let n = c.descents.len() as f64;
        println!(
            "{:<14} {:>7.1} {:>9.2} {:>6.2} {:>6.2} {:>6.2} {:>5.2} {:>6.2} {:>6.2} {:>5.2} {:>5.2} {:>6.2} {:>6.2} {:>9.2} {:>11.2} {:>7.0}",
            c.name,
            100.0 * c.landed as f64 / n,
            100.0 * c.landed_share_at_least,
            c.miss_m.mean,
            c.miss_m.p99,
            c.miss_m.max,
            c.down_m_s.p50,
            c.down_m_s.p99,
            c.down_m_s.max,
            c.across_m_s.p50,
            c.across_m_s.p99,
            c.across_m_s.max,
            c.tilt_deg.p99,
            c.rate_deg_s.p99,
            c.propellant_kg.mean,
            1e3 * c.cpu_s,
        );
    }
    println!();
    for c in campaigns {
        let outcomes: Vec<_> = c.outcomes.iter().map(|(name, n)| format!("{n} {name}")).collect();
        println!(
            "{}: {} (worst miss: seed {}, down {}, across {}, tilt {}, rate {})",
            c.name,
            outcomes.join(", "),
            c.worst(|d| d.miss_m),
            c.worst(|d| d.down_m_s),
            c.worst(|d| d.across_m_s),
            c.worst(|d| d.tilt_deg),
            c.worst(|d| d.rate_deg_s),
        );
        let seeds: Vec<_> = c.bad().map(|d| format!("{} {}", d.seed, d.outcome)).collect();
        if !seeds.is_empty() {
            let shown = &seeds[..seeds.len().min(SEEDS_SHOWN)];
            let more = seeds.len() - shown.len();
            let rest = if more > 0 { format!(", and {more} more") } else { String::new() };
            println!("  bad by seed: {}{rest}", shown.join(", "));
            println!("  again: cargo lander run {}/{}-SEED.toml", folder.display(), c.name);
        }
    }
    println!(
        "\nLanded: at rest upright, undamaged, slid less than the scenario's limit; at least: one-sided 95 % limit of\n\
         Clopper and Pearson. Speeds of the centre of mass, tilt and rate: at first contact. Quantiles by rank, of\n\
         the runs that touched the ground. CPU: all threads, truth with contact and guidance."
    );
}
