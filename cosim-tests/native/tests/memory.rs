//! What a campaign's tables, statistics and report take of memory, over the number of runs.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use claims::{Bound, Claim};
use cosim::study::Study;
use cosim::study::campaign::Campaign;
use cosim::study::row::{Columns, Content};
use lander_models::random::uniforms;
use nix::sys::resource::{UsageWho, getrusage};

/// A study of touchdowns of which every shard is there: rows as long as those of a run.
fn campaign(folder: &Path, runs: u64) {
    let kit = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/campaigns/touchdowns.toml");
    let scenarios = kit.parent().unwrap().join("../scenarios").canonicalize().unwrap();
    let text = fs::read_to_string(&kit)
        .unwrap()
        .replace("../scenarios", scenarios.to_str().unwrap())
        .replace("runs = { value = 2000,", &format!("runs = {{ value = {runs},"));
    let file = folder.join("study.toml");
    fs::write(&file, &text).unwrap();
    let study = Study::parse(&file, &text).unwrap();
    let columns = Columns::new(&study).unwrap();
    let campaign = Campaign::new(&study, &columns, &folder.join("out"));
    fs::create_dir_all(folder.join("out/touchdowns/shards")).unwrap();
    for shard in campaign.shards() {
        let row = |run: u64| {
            let mut numbers = uniforms(run, "row");
            let cells = columns.all.iter().map(|(name, content)| match (content, name.as_str()) {
                (Content::Whole, _) => run.to_string(),
                (Content::Number, _) => numbers.next().unwrap().to_string(),
                (Content::Text, "outcome") => ["landed", "tipped"][run as usize % 2].to_owned(),
                (Content::Text, _) => "none".to_owned(),
            });
            cells.collect::<Vec<_>>().join(",")
        };
        shard.write(&shard.runs.clone().map(row).collect::<Vec<_>>()).unwrap();
    }
}

/// Most memory that any child so far had, after one that merges and judges so many runs, MB.
fn peak_mb(runs: u64) -> f64 {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("memory");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    campaign(&folder, runs);
    let status = Command::new(env!("CARGO_BIN_EXE_lander"))
        .args(["campaign", "study.toml", "--out", "out", "--threads", "1"])
        .stdout(Stdio::null())
        .current_dir(&folder)
        .status();
    assert!(status.unwrap().success());
    let report = fs::read_to_string(folder.join("out/touchdowns/report.html")).unwrap();
    assert!(report.contains(&format!("{runs} touchdowns")));
    fs::remove_dir_all(&folder).unwrap();
    // In kB on Linux.
    getrusage(UsageWho::RUSAGE_CHILDREN).unwrap().max_rss() as f64 / 1e3
}

#[test]
fn memory_does_not_grow_with_the_runs_by_more_than_a_few_columns() {
    let (few, many) = (10_000_u32, 50_000_u32);
    let start_mb = peak_mb(few.into());
    let grown_mb = peak_mb(many.into()) - start_mb;
    assert!(start_mb > 5.0 && start_mb < 100.0, "{start_mb} MB");
    Claim {
        id: "campaign-memory",
        section: "Studies",
        claim: "growth of a campaign's memory from 10,000 to 50,000 runs, tables and report included, for each 100,000 runs",
        reference: "whole rows in memory: 60 MB",
        unit: "MB",
        bound: Bound::AtMost(10.0),
        origin: "a rank correlation holds two columns, their pairs, order and ranks: ten of 0.8 MB, and two of codes",
        noise: 10.0,
    }
    .holds(grown_mb * 1e5 / f64::from(many - few));
}
