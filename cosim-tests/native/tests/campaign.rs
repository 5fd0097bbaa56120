//! `lander campaign`: the same rows however it is run, nothing lost to a kill, wrong input named.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use cosim::study::row::Columns;
use cosim::study::shard::BUILD;
use cosim::study::{Kind, Study};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

#[path = "../build_fingerprint.rs"]
mod fingerprint;

const RUNS: u64 = 24;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("campaign").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Short touchdowns on the quick contact engine.
fn text() -> String {
    let scenario = root().join("models/scenarios/tip-over.toml");
    format!(
        r#"name = "drops"
kind = "touchdown"
scenario = "{}"
runs = {{ value = {RUNS}, unit = "1" }}
seed = {{ value = 7, unit = "1" }}
shard_runs = {{ value = 4, unit = "1" }}

[case]
slope_deg = {{ value = 0.0, unit = "deg" }}

[[design]]
key = "scenario.contact.engine"
distribution = "constant"
value = "strut"

[[design]]
key = "scenario.run.stop_time"
distribution = "constant"
value = {{ value = 1.0, unit = "s" }}

[[dispersion]]
key = "case.down_m_s"
distribution = "uniform"
low = {{ value = 0.5, unit = "m/s" }}
high = {{ value = 1.5, unit = "m/s" }}

[[dispersion]]
key = "vehicle.gear.crush_load_1"
as = "factor"
distribution = "normal"
mean = {{ value = 1.0, unit = "1" }}
deviation = {{ value = 0.05, unit = "1" }}

[[dispersion]]
key = "scenario.terrain.pads"
distribution = "choice"
values = ["sliding", "captured"]
"#,
        scenario.display()
    )
}

fn command(folder: &Path, text: &str, arguments: &[&str]) -> Command {
    fs::write(folder.join("study.toml"), text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lander"));
    command.args(["campaign", "study.toml", "--out", "out"]).args(arguments).current_dir(folder);
    command
}

fn lander(folder: &Path, text: &str, arguments: &[&str]) -> Output {
    command(folder, text, arguments).output().unwrap()
}

/// The table of a campaign that must succeed.
fn table(folder: &Path, text: &str, arguments: &[&str]) -> String {
    let output = lander(folder, text, arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    fs::read_to_string(folder.join("out/drops/results.csv")).unwrap()
}

/// The error of a campaign that must fail: one line.
fn refusal(folder: &Path, text: &str) -> String {
    let output = lander(folder, text, &[]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), error.lines().count()), (Some(2), 1), "{error}");
    error
}

fn shards(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder.join("out/drops/shards")) else { return Vec::new() };
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name.ends_with(".csv")).collect()
}

#[test]
fn the_table_does_not_depend_on_threads_shards_or_jobs() {
    let folder = empty_folder("threads");
    let expected = table(&folder, &text(), &["--threads", "1"]);
    assert_eq!(expected.lines().count() as u64, RUNS + 1);
    let other = empty_folder("shards");
    let larger = text().replace("value = 4, unit", "value = 5, unit");
    assert_eq!(table(&other, &larger, &["--threads", "3"]), expected);
    let jobs = empty_folder("jobs");
    for part in ["1/3", "2/3", "3/3"] {
        let output = lander(&jobs, &text(), &["--shard", part]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert!(!jobs.join("out/drops/results.csv").exists());
    }
    assert_eq!(shards(&jobs).len(), 6);
    assert_eq!(table(&jobs, &text(), &[]), expected);
    let bytes = |folder: &Path| fs::read(folder.join("out/drops/results.parquet")).unwrap();
    assert_eq!(bytes(&jobs), bytes(&folder));
}

#[test]
fn the_batch_file_runs_an_array_s_parts_and_the_merge() {
    let (folder, whole) = (empty_folder("batch"), empty_folder("batch-whole"));
    fs::write(folder.join("study.toml"), text()).unwrap();
    let batch = |task: Option<&str>| {
        let mut command = Command::new("bash");
        command
            .arg(root().join("cosim-tests/slurm/campaign.sbatch"))
            .args(["study.toml", "out"])
            .env("LANDER", env!("CARGO_BIN_EXE_lander"))
            .env_remove("SLURM_ARRAY_TASK_ID")
            .current_dir(&folder);
        if let Some(task) = task {
            command.envs([("SLURM_ARRAY_TASK_ID", task), ("SLURM_ARRAY_TASK_COUNT", "2")]);
        }
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        shards(&folder).len()
    };
    assert_eq!([batch(Some("2")), batch(Some("1"))], [3, 6]);
    assert!(!folder.join("out/drops/results.csv").exists());
    batch(None);
    let merged = fs::read_to_string(folder.join("out/drops/results.csv")).unwrap();
    assert_eq!(merged, table(&whole, &text(), &[]));
}

#[test]
fn a_landing_alone_leaves_a_log_too() {
    let folder = empty_folder("landing");
    let scenario = root().join("models/scenarios/monte-carlo.toml");
    let text = format!(
        "name = \"fall\"\nkind = \"landing\"\nscenario = \"{}\"\n\
         runs = {{ value = 2, unit = \"1\" }}\n[[design]]\nkey = \"scenario.run.stop_time\"\n\
         distribution = \"constant\"\nvalue = {{ value = 2.0, unit = \"s\" }}\n",
        scenario.display()
    );
    let output = lander(&folder, &text, &["--run", "1", "--log", "run.mcap", "--json"]);
    let row: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&row["outcome"], &row["end_time_s"]), (&"no_contact".into(), &2.0.into()));
    assert!(row["plans_accepted"].as_f64().unwrap() > 0.0);
    let log = fs::read(folder.join("run.mcap")).unwrap();
    assert!(log.ends_with(b"\x89MCAP0\r\n") && log.len() > 10_000);
}

#[test]
fn a_run_alone_is_its_row_and_leaves_a_log() {
    let folder = empty_folder("alone");
    let table = table(&folder, &text(), &[]);
    let output = lander(&folder, &text(), &["--run", "17", "--log", "run.mcap"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(said.lines().nth(1), table.lines().nth(18));
    let log = fs::read(folder.join("run.mcap")).unwrap();
    // MCAP's magic bytes stand at both ends of a whole file.
    let magic = b"\x89MCAP0\r\n";
    assert!(log.starts_with(magic) && log.ends_with(magic) && log.len() > 10_000);
    let json = lander(&folder, &text(), &["--run", "17", "--json"]).stdout;
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["run"], 17);
    assert!((0.5..1.5).contains(&json["down_m_s"].as_f64().unwrap()));
    assert!(json["position_error_m"].is_number() && json["tip_time_s"].is_null());
    let error = lander(&folder, &text(), &["--run", "24"]).stderr;
    assert!(String::from_utf8(error).unwrap().contains("there is no run 24"));
}

#[test]
fn parquet_holds_what_csv_holds() {
    let folder = empty_folder("parquet");
    let csv = table(&folder, &text(), &[]);
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let file = fs::File::open(folder.join("out/drops/results.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap().clone();
    let hash = metadata.iter().find(|entry| entry.key == "study_sha256").unwrap();
    assert_eq!(hash.value.as_ref().unwrap().len(), 64);
    let mut rows = 0;
    for (row, line) in reader.get_row_iter(None).unwrap().zip(lines) {
        for (((name, field), column), cell) in
            row.unwrap().get_column_iter().zip(&names).zip(line.split(','))
        {
            assert_eq!(name, column);
            match field {
                Field::Null => assert_eq!(cell, "", "{name}"),
                Field::Double(value) => assert_eq!(cell.parse(), Ok(*value), "{name}"),
                Field::Long(value) => assert_eq!(cell.parse(), Ok(*value), "{name}"),
                Field::Str(value) => assert_eq!(cell, value, "{name}"),
                other => panic!("{name} is {other:?}"),
            }
        }
        rows += 1;
    }
    assert_eq!(rows, RUNS);
}

/// Stops a campaign in the middle with a signal; its exit code.
fn stop(folder: &Path, text: &str, signal: &str) -> Option<i32> {
    let mut child =
        command(folder, text, &["--threads", "1"]).stderr(Stdio::null()).spawn().unwrap();
    let end = Instant::now() + Duration::from_secs(60);
    while shards(folder).len() < 2 {
        assert!(Instant::now() < end && child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(2));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
    child.wait().unwrap().code()
}

#[test]
fn a_campaign_that_is_killed_goes_on_to_the_same_bytes() {
    let whole = empty_folder("whole");
    // Long enough to be met in the middle.
    let text = text().replace(&format!("value = {RUNS}"), "value = 80");
    let expected = table(&whole, &text, &[]);
    for (signal, code) in [("-KILL", None), ("-INT", Some(130))] {
        let folder = empty_folder(signal);
        assert_eq!(stop(&folder, &text, signal), code);
        assert!(!folder.join("out/drops/results.csv").exists());
        let found = shards(&folder).len();
        assert!((2..20).contains(&found), "{found}");
        assert_eq!(table(&folder, &text, &[]), expected, "{signal}");
    }
}

#[test]
fn damaged_shards_are_run_again_and_more_runs_only_add() {
    let folder = empty_folder("damaged");
    let expected = table(&folder, &text(), &[]);
    let shard = folder.join("out/drops/shards/000000004-000000007.csv");
    let rows = fs::read_to_string(&shard).unwrap();
    fs::write(&shard, &rows[..rows.len() / 2]).unwrap();
    assert_eq!(table(&folder, &text(), &[]), expected);
    let more = text().replace(&format!("value = {RUNS}"), "value = 26");
    let longer = table(&folder, &more, &[]);
    assert!(longer.starts_with(&expected) && longer.lines().count() == 27);
}

#[test]
fn leftovers_of_a_kill_go_and_what_is_being_written_stays() {
    let folder = empty_folder("leftovers");
    let shards = folder.join("out/drops/shards");
    fs::create_dir_all(&shards).unwrap();
    let left = [
        shards.join("000000000-000000003.csv.0123456789abcdef.part"),
        folder.join("out/drops/results.csv.0123456789abcdef.part"),
    ];
    let written = shards.join("000000004-000000007.csv.0123456789abcdef.part");
    for file in left.iter().chain([&written]) {
        fs::write(file, "half a row").unwrap();
    }
    // As another job of the same study holds it.
    let open = fs::File::open(&written).unwrap();
    open.lock().unwrap();
    table(&folder, &text(), &[]);
    assert!(left.iter().all(|file| !file.exists()) && written.exists());
    drop(open);
    table(&folder, &text(), &[]);
    assert!(!written.exists());
}

#[test]
fn a_build_s_fingerprint_is_of_its_sources() {
    assert_eq!(fingerprint::fingerprint(&root()).unwrap(), BUILD);
    let copy = empty_folder("sources");
    for source in fingerprint::SOURCES {
        let to = copy.join(source);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        let copied = Command::new("cp").arg("-r").arg(root().join(source)).arg(to).status();
        assert!(copied.unwrap().success());
    }
    assert_eq!(fingerprint::fingerprint(&copy).unwrap(), BUILD);
    for source in ["truth-model/src/flight.rs", "guidance-fmu/src/lib.rs", "models/src/mass.rs"] {
        let file = copy.join(source);
        let text = fs::read_to_string(&file).unwrap();
        fs::write(&file, text.clone() + " ").unwrap();
        assert_ne!(fingerprint::fingerprint(&copy).unwrap(), BUILD, "{source}");
        fs::write(&file, text).unwrap();
    }
}

#[test]
fn shards_of_another_study_version_or_build_are_not_touched() {
    let folder = empty_folder("foreign");
    table(&folder, &text(), &[]);
    let file = folder.join("out/drops/shards/000000008-000000011.csv");
    let rows = fs::read_to_string(&file).unwrap();
    let error = refusal(&folder, &text().replace("value = 7,", "value = 8,"));
    assert!(error.contains("is of another study, version or build"), "{error}");
    let version = concat!(" version ", env!("CARGO_PKG_VERSION"));
    fs::write(&file, rows.replace(version, " version 0.0.9")).unwrap();
    let error = refusal(&folder, &text());
    assert!(error.contains("000000008-000000011.csv: ") && error.contains("0.0.9"), "{error}");
    assert!(fs::read_to_string(&file).unwrap().contains("0.0.9"));
    fs::write(&file, rows.replace(BUILD, "0123456789abcdef")).unwrap();
    let error = refusal(&folder, &text());
    assert!(error.contains("build 0123456789abcdef"), "{error}");
}

#[test]
fn wrong_studies_are_refused_before_the_first_run() {
    let folder = empty_folder("wrong");
    for (from, to, words) in [
        ("case.down_m_s", "case.up_m_s", ["`case.up_m_s`", "is not known; known here"]),
        (
            "vehicle.gear.crush_load_1",
            "vehicle.gear.crush_load_3",
            ["`vehicle.gear.crush_load_3`", "is not in the file"],
        ),
        ("scenario.terrain.pads", "scenario.terrain.pad", ["terrain.pad`", "is not known"]),
        ("\"captured\"]", "\"glued\"]", ["drawn as glued", "must be one of sliding, captured"]),
        ("low = { value = 0.5", "low = { value = 1.5", ["dispersion[1].high", "greater than low"]),
        (
            "deviation = { value = 0.05",
            "deviation = { value = 0.0",
            ["deviation", "greater than 0"],
        ),
        (
            "low = { value = 0.5, unit = \"m/s\"",
            "low = { value = 0.5, unit = \"km/s\"",
            ["high", "must be in"],
        ),
        ("kind = \"touchdown\"", "kind = \"landing\"", ["case", "is for kind"]),
        ("value = 7, unit", "value = 7.5, unit", ["seed", "must be a whole number"]),
        ("name = \"drops\"", "name = \"a/b\"", ["name", "must be fit for a folder"]),
        ("case.down_m_s", "case.friction", ["case.friction", "must be in \"1\""]),
        // What no run would notice.
        ("scenario.terrain.pads", "scenario.vehicle", ["scenario.vehicle", "before any draw"]),
        ("scenario.terrain.pads", "scenario.run.seed", ["scenario.run.seed", "each run's own"]),
        ("scenario.terrain.pads", "scenario.name", ["scenario.name", "changes no run"]),
        (
            "scenario.terrain.pads",
            "scenario.initial.velocity_w[1]",
            ["initial.velocity_w[1]", "no part of a touchdown"],
        ),
        ("scenario.terrain.pads", "scenario.guidance.mode", ["guidance", "no part of a touchdown"]),
        ("scenario.terrain.pads", "scenario.terrain.slope", ["slope", "by `case.slope_deg`"]),
        ("\"captured\"]", "\"a, b\"]", ["values", "no commas"]),
        (
            "high = { value = 1.5, unit = \"m/s\" }",
            "high = { value = 1.5, unit = \"m/s\" }\nstep = { value = 5.0, unit = \"m/s\" }",
            ["step", "at most half"],
        ),
    ] {
        assert!(text().contains(from), "{from}");
        let error = refusal(&folder, &text().replacen(from, to, 1));
        assert!(error.starts_with("error: study.toml: "), "{error}");
        assert!(words.iter().all(|word| error.contains(word)), "{error}: {words:?}");
    }
    assert!(!folder.join("out").exists());
}

#[test]
fn an_impossible_draw_names_its_run() {
    let folder = empty_folder("draw");
    // One draw in forty is negative: not that of the first run.
    let text = text().replace("deviation = { value = 0.05", "deviation = { value = 0.5");
    let error = refusal(&folder, &text);
    assert!(!error.contains("run 0:"), "{error}");
    // It is told before any run.
    assert_eq!(shards(&folder).len(), 0);
    assert!(error.contains("run ") && error.contains("`vehicle.gear.crush_load_1` drawn as -"));
    assert!(error.contains("must be greater than 0"), "{error}");
}

#[test]
fn a_folder_that_cannot_be_written_and_a_full_disk_lose_nothing() {
    let folder = empty_folder("unwritable");
    fs::write(folder.join("out"), "a file where the folder should be").unwrap();
    assert!(refusal(&folder, &text()).contains("out/drops/shards: "));

    let full = empty_folder("full");
    fs::write(full.join("study.toml"), text()).unwrap();
    // Files of half a kilobyte at most: the system refuses the rest as a full disk does.
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" campaign study.toml --out out";
    let output = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_lander")])
        .current_dir(&full)
        .output()
        .unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("shards/000000000-000000003.csv: "), "{error}");
    assert_eq!(fs::read_dir(full.join("out/drops/shards")).unwrap().count(), 0);

    let dev_full = lander(&full, &text(), &["--run", "0", "--log", "/dev/full"]);
    let error = String::from_utf8(dev_full.stderr).unwrap();
    assert_eq!(dev_full.status.code(), Some(2), "{error}");
    assert!(error.contains("/dev/full: the log cannot be written"), "{error}");
}

#[test]
fn guidance_learns_of_designs_and_not_of_dispersions() {
    let scenario = root().join("models/scenarios/landing.toml");
    let parameter = |list: &str, key: &str, value: f64, unit: &str| {
        format!(
            "[[{list}]]\nkey = \"scenario.{key}\"\ndistribution = \"constant\"\n\
             value = {{ value = {value:?}, unit = \"{unit}\" }}\n"
        )
    };
    let text = format!(
        "name = \"known\"\nkind = \"landing\"\nscenario = \"{}\"\n\
         runs = {{ value = 1, unit = \"1\" }}\n{}{}{}",
        scenario.display(),
        parameter("design", "guidance.cutoff_height", 0.6, "m"),
        parameter("dispersion", "site.gravity", 1.7, "m/s2"),
        parameter("dispersion", "initial.velocity_w[3]", -24.0, "m/s"),
    );
    let study = Study::parse("study.toml".as_ref(), &text).unwrap();
    let run = study.run(0).unwrap();
    let (truth, believed) = (&run.truth.scenario, &run.believed.scenario);
    assert_eq!((truth.gravity_m_s2, believed.gravity_m_s2), (1.7, 1.625));
    assert_eq!((truth.initial.velocity_w.z, believed.initial.velocity_w.z), (-24.0, -25.0));
    assert_eq!((truth.guidance.cutoff_height_m, believed.guidance.cutoff_height_m), (0.6, 0.6));
    assert_eq!(truth.seed, believed.seed);
}

#[test]
fn the_kit_s_studies_are_sound_and_fail_as_often_as_they_say() {
    let folder = root().join("models/campaigns");
    let files: Vec<PathBuf> =
        fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(files.len() >= 4);
    for file in &files {
        let study = Study::load(file).unwrap();
        assert_eq!(file.file_stem().unwrap().to_str(), Some(study.name.as_str()));
        Columns::new(&study).unwrap();
    }
    let study = Study::load(&folder.join("paper-monte-carlo.toml")).unwrap();
    assert_eq!((study.kind, study.runs, study.failures.modes.len()), (Kind::Landing, 1000, 10));
    let n = 20_000;
    let struck = (0..n).filter(|run| {
        let uniform = |stream: &str| lander_models::random::uniform(study.seed, stream, *run);
        !study.failures.of_run(*run, &uniform).is_empty()
    });
    // The paper's "some 2.5 %": ten independent modes at 0.25 %; five standard errors.
    let expected = 1.0 - 0.9975_f64.powi(10);
    let share = struck.count() as f64 / n as f64;
    assert!((share - expected).abs() < 5.0 * (expected / n as f64).sqrt(), "{share}");
    let forced = Study::load(&folder.join("failure-modes.toml")).unwrap();
    for run in [0, 3, 13] {
        let found = forced.run(run).unwrap();
        let mode = &forced.failures.modes[run as usize % 10].name;
        assert_eq!(found.failures, std::slice::from_ref(mode));
        assert_eq!(found.truth.scenario.faults.onsets().count(), 1);
        assert_eq!(found.believed.scenario.faults.onsets().count(), 0);
    }
}
