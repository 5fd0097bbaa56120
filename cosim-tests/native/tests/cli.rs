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
    record_to(Stdio::piped(), out, arguments, rows)
}

fn record_to(stdout: Stdio, out: &Path, arguments: &[&str], rows: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_lander"))
        .args(["record", "--scenario", "models/scenarios/landing.toml", "--out"])
        .arg(out)
        .args(arguments)
        .current_dir(root())
        .stdin(Stdio::piped())
        .stdout(stdout)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A recorder that refuses a row reads no further.
    let _ = child.stdin.take().unwrap().write_all(rows);
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
    row[layout.columns("foot_contact_time_s")][4..].fill(f64::NAN);
    row[layout.columns("nozzle_struck")][0] = 1.0;
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
    let feet = serde_json::json!([0.0, 0.0, 0.0, 0.0, null, null]);
    assert_eq!(results["foot_contact_time_s"], feet);
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
    let bytes = rows(4, Outcome::InFlight, f64::NAN, f64::NAN);
    let output = record(&out, &["--json"], &bytes);
    assert_eq!(output.status.code(), Some(130));
    let results: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(results["outcome"], "in_flight");
    assert_eq!(results["interrupted"], true);
    assert_eq!(results["end_time_s"], 0.03);
    assert_eq!(files(&out), ["landing.json", "landing.mcap"]);
}

/// Whole rows, with other times in some (row, time in s).
fn retimed(count: u32, times_s: &[(usize, f64)]) -> Vec<u8> {
    let mut bytes = rows(count, Outcome::Landed, 1.0, 0.1);
    let width = bytes.len() / count as usize;
    for (row, time_s) in times_s {
        bytes[row * width..][..8].copy_from_slice(&time_s.to_le_bytes());
    }
    bytes
}

#[test]
fn rows_that_no_master_sends_are_refused_and_leave_no_results() {
    let whole = retimed(5, &[]);
    let cases = [
        ("partial", whole[..whole.len() - 3].to_vec(), "row 4 has "),
        ("late-start", retimed(5, &[(0, 0.01)]), "the first row must be at 0 s"),
        ("standstill", retimed(5, &[(3, 0.02)]), "must be after the last, at 0.02 s"),
        // landing.toml stops at 90 s, so no row is at 90.01 s.
        ("beyond", retimed(5, &[(4, 90.01)]), "must be before 90.01 s"),
        // 2^64 ns, which a log time can't hold, are 1.8e10 s.
        ("overflow", retimed(5, &[(4, 1e11)]), "must be before 90.01 s"),
        ("between-ticks", retimed(5, &[(4, 0.0401)]), "is not a whole"),
        ("infinite", retimed(5, &[(4, f64::INFINITY)]), "is not a whole"),
    ];
    for (name, bytes, reason) in cases {
        let out = empty_folder(name);
        let output = record(&out, &["--json"], &bytes);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{name}: {stderr}");
        assert!(output.stdout.is_empty(), "{name}");
        // The first row is progress.
        let error = stderr.lines().last().unwrap();
        assert!(error.starts_with("error: ") && error.contains(reason), "{name}: {stderr}");
        assert!(!out.join("landing.json").exists(), "{name}");
    }
}

/// The last bytes of every complete MCAP file.
const MCAP_MAGIC: &[u8] = b"\x89MCAP0\r\n";

#[test]
fn a_row_at_nan_says_that_the_master_failed() {
    let out = empty_folder("failed");
    fs::write(out.join("landing.json"), "{\"outcome\": \"landed\"}").unwrap();
    let output = record(&out, &["--json", "--gate"], &retimed(5, &[(4, f64::NAN)]));
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(!stderr.contains("error"), "the master says why: {stderr}");
    assert_eq!(files(&out), ["landing.mcap"], "no results, old ones neither");
    assert!(fs::read(out.join("landing.mcap")).unwrap().ends_with(MCAP_MAGIC));
}

#[test]
fn old_results_go_before_the_first_row() {
    let out = empty_folder("stale");
    fs::write(out.join("landing.json"), "{\"outcome\": \"landed\"}").unwrap();
    assert_eq!(record(&out, &[], &[]).status.code(), Some(2));
    assert_eq!(files(&out), [""; 0]);
}

#[test]
fn a_closed_or_full_standard_output_does_not_panic() {
    let rows = rows(3, Outcome::Landed, 1.0, 0.1);
    let out = empty_folder("closed");
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let closed = record_to(writer.into(), &out, &["--json"], &rows);
    assert_eq!(closed.status.code(), Some(0), "{closed:?}");
    assert_eq!(files(&out), ["landing.json", "landing.mcap"]);
    let full = fs::File::create("/dev/full").unwrap();
    let full = record_to(full.into(), &out, &[], &rows);
    assert_eq!(full.status.code(), Some(2), "{full:?}");
    let stderr = String::from_utf8(full.stderr).unwrap();
    assert!(stderr.lines().last().unwrap().starts_with("error: standard output: "), "{stderr}");
}

#[test]
fn a_closed_standard_error_does_not_end_the_flight() {
    let out = empty_folder("closed-error");
    for (scenario, code) in [("models/scenarios/tip-over.toml", 0), ("nowhere.toml", 2)] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let status = Command::new(env!("CARGO_BIN_EXE_lander"))
            .args(["run", scenario, "--out"])
            .arg(&out)
            .current_dir(root())
            .stdout(Stdio::null())
            .stderr(writer)
            .status();
        assert_eq!(status.unwrap().code(), Some(code), "{scenario}");
    }
    assert_eq!(files(&out), ["tip-over.json", "tip-over.mcap"]);
}

#[test]
fn a_bare_name_is_a_file_here_or_else_a_scenario_of_the_workspace() {
    let run = |folder: &Path, out: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lander"));
        command.args(["run", "tip-over", "--out"]).arg(out).current_dir(folder);
        command.output().unwrap()
    };
    let out = empty_folder("bare-name");
    let below = run(&root().join("models/src"), &out);
    assert_eq!(below.status.code(), Some(0), "{below:?}");
    fs::write(out.join("tip-over"), "no scenario").unwrap();
    let here = run(&out, &out);
    assert_eq!(here.status.code(), Some(2), "{here:?}");
    let stderr = String::from_utf8(here.stderr).unwrap();
    assert!(stderr.starts_with("error: tip-over: not valid TOML"), "{stderr}");
}

#[test]
fn only_a_landing_is_said_to_be_at_rest() {
    let out = empty_folder("at-rest");
    for outcome in Outcome::ALL.into_iter().filter(|outcome| *outcome != Outcome::InFlight) {
        let printed = record(&out, &[], &rows(1, outcome, 1.0, 0.1)).stdout;
        let verdict = String::from_utf8(printed).unwrap();
        let at_rest = outcome == Outcome::Landed;
        assert_eq!(verdict.contains("  at rest "), at_rest, "{verdict}");
        assert_eq!(verdict.contains("  at the end "), !at_rest, "{verdict}");
    }
}

#[test]
fn a_strike_names_the_part() {
    let out = empty_folder("struck");
    let printed = record(&out, &[], &rows(1, Outcome::Struck, 1.0, 0.1)).stdout;
    let verdict = String::from_utf8(printed).unwrap();
    assert!(verdict.starts_with("STRUCK the ground with its nozzle ("), "{verdict}");
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
    let long = format!("name = \"{}\"", "n".repeat(201));
    for (from, to, key) in [
        ("name = \"landing\"", "name = \"../landing\"", "name"),
        ("name = \"landing\"", "name = 'land\\ing'", "name"),
        ("name = \"landing\"", "name = \"land\\ning\"", "name"),
        ("name = \"landing\"", "name = \"\\u001b[31m\"", "name"),
        ("name = \"landing\"", &long, "name"),
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
