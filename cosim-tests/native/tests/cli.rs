//! `lander` as a user or another master meets it: exit codes, files, errors.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use cosim::layout::Layout;
use cosim::schedule::{Pair, Schedule};
use lander_models::Outcome;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};

static INTERFACES: Pair<&Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn record(out: &Path, arguments: &[&str], rows: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_lander"))
        .args(["record", "--scenario", "models/scenarios/landing.toml", "--out"])
        .arg(out)
        .args(arguments)
        .current_dir(root())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(rows).unwrap();
    child.wait_with_output().unwrap()
}

/// `count` rows of a landing with the given outcome and contact speeds.
fn rows(count: u32, outcome: Outcome, down_m_s: f64, across_m_s: f64) -> Vec<u8> {
    let schedule = Schedule::load(&INTERFACES).unwrap();
    let layout = Layout::new(&schedule, &INTERFACES);
    let mut row = vec![0.0; layout.width()];
    row[layout.columns("attitude_wb")][0] = 1.0;
    row[layout.columns("contact_speed_down_m_s")][0] = down_m_s;
    row[layout.columns("contact_speed_across_m_s")][0] = across_m_s;
    row[layout.columns("tip_time_s")][0] = f64::NAN;
    row[layout.columns("outcome")][0] = outcome.code();
    let mut bytes = Vec::new();
    for index in 0..count {
        row[0] = f64::from(index) / 100.0;
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

#[test]
fn rows_become_a_log_and_results() {
    let out = empty_folder("whole");
    let output = record(&out, &["--json"], &rows(5, Outcome::Landed, 1.0, 0.1));
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(files(&out), ["landing.json", "landing.mcap"]);
    let printed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(printed, fs::read_to_string(out.join("landing.json")).unwrap());
    let results: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(results["outcome"], "landed");
    assert_eq!(results["interrupted"], false);
    assert_eq!(results["end_time_s"], 0.04);
    assert!(results["tip_time_s"].is_null(), "NaN has no JSON number");
}

#[test]
fn the_digest_is_sha256_over_the_bytes_of_all_rows() {
    use sha2::Digest;
    let out = empty_folder("digest");
    let bytes = rows(3, Outcome::Landed, 1.0, 0.1);
    let printed = record(&out, &["--json"], &bytes).stdout;
    let results: serde_json::Value = serde_json::from_slice(&printed).unwrap();
    let expected: String =
        sha2::Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(results["digest"], expected);
}

#[test]
fn the_gate_passes_landed_and_nothing_else() {
    let out = empty_folder("gate");
    for outcome in Outcome::ALL.into_iter().filter(|outcome| *outcome != Outcome::InFlight) {
        let rows = rows(1, outcome, 1.9, 0.4);
        let output = record(&out, &["--gate"], &rows);
        let code = if outcome == Outcome::Landed { 0 } else { 1 };
        assert_eq!(output.status.code(), Some(code), "{outcome:?}");
        assert_eq!(record(&out, &[], &rows).status.code(), Some(0), "without the gate");
    }
}

#[test]
fn a_stream_that_ends_in_flight_counts_as_interrupted() {
    let out = empty_folder("interrupted");
    let mut bytes = rows(5, Outcome::InFlight, f64::NAN, f64::NAN);
    bytes.truncate(bytes.len() - 3);
    let output = record(&out, &["--json"], &bytes);
    assert_eq!(output.status.code(), Some(130));
    let results: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(results["outcome"], "in_flight");
    assert_eq!(results["interrupted"], true);
    assert_eq!(results["end_time_s"], 0.03, "the half row does not count");
    assert_eq!(files(&out), ["landing.json", "landing.mcap"]);
}

#[test]
fn without_a_row_there_is_no_file() {
    let out = empty_folder("nothing");
    let output = record(&out, &[], &[]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(files(&out), [""; 0]);
}

#[test]
fn a_bad_scenario_is_one_line_with_file_key_and_reason_and_leaves_no_file() {
    let folder = empty_folder("bad-scenario");
    let out = folder.join("out");
    let text = fs::read_to_string(root().join("models/scenarios/landing.toml")).unwrap();
    let vehicle = root().join("models/vehicles/bug.toml");
    let vehicle = vehicle.canonicalize().unwrap();
    let text = text.replace("../vehicles/bug.toml", vehicle.to_str().unwrap());
    let file = folder.join("bad.toml");
    for (from, to, key) in [
        ("name = \"landing\"", "name = \"../landing\"", "name"),
        ("unit = \"m/s2\"", "unit = \"g\"", "site.gravity"),
        ("[run]", "[run]\nwind = 3", "wind"),
    ] {
        let bad = text.replacen(from, to, 1);
        assert_ne!(bad, text);
        fs::write(&file, bad).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_lander"))
            .arg("run")
            .args([&file, Path::new("--out"), &out])
            .output()
            .unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        assert!(stderr.starts_with("error: ") && stderr.contains("bad.toml"), "{stderr}");
        assert!(stderr.contains(key), "{stderr}");
        assert!(output.stdout.is_empty());
        assert!(!out.exists());
    }
}
