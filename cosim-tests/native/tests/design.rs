//! `lander design`: the same draws at every design, the same bytes however it is run, and what a design changes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use claims::{Bound, Claim};
use cosim::study::Study;
use cosim::study::distribution::Value as Drawn;
use cosim::study::row::Columns;
use nalgebra::Vector3;
use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("design").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Short touchdowns on held pads, at six designs.
fn text() -> String {
    let scenario = root().join("models/scenarios/tip-over.toml");
    format!(
        r#"name = "drops"
kind = "touchdown"
scenario = "{}"
runs = {{ value = 8, unit = "1" }}
seed = {{ value = 3, unit = "1" }}
shard_runs = {{ value = 6, unit = "1" }}

[case]
slope_deg = {{ value = 0.0, unit = "deg" }}
down_m_s = {{ value = 0.5, unit = "m/s" }}

[[axis]]
name = "footprint"
key = "vehicle.gear.feet_b"
as = "factor"
values = {{ value = [0.6, 1.0, 1.4], unit = "1" }}

[[axis]]
name = "raised"
key = "vehicle.mass.dry_com_b[3]"
as = "added"
low = {{ value = 0.0, unit = "m" }}
high = {{ value = 0.4, unit = "m" }}
count = {{ value = 2, unit = "1" }}

[[axis.with]]
key = "vehicle.mass.propellant_com_b[3]"
as = "added"
times = {{ value = 0.5, unit = "1" }}

[[design]]
key = "scenario.contact.engine"
distribution = "constant"
value = "strut"

[[design]]
key = "scenario.run.stop_time"
distribution = "constant"
value = {{ value = 2.5, unit = "s" }}

[[dispersion]]
key = "case.across_m_s"
distribution = "uniform"
low = {{ value = 1.0, unit = "m/s" }}
high = {{ value = 3.0, unit = "m/s" }}

[[dispersion]]
key = "vehicle.gear.crush_load_1"
as = "factor"
distribution = "normal"
mean = {{ value = 1.0, unit = "1" }}
deviation = {{ value = 0.05, unit = "1" }}
"#,
        scenario.display()
    )
}

fn command(folder: &Path, text: &str, arguments: &[&str]) -> Command {
    fs::write(folder.join("study.toml"), text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lander"));
    command.args(["design", "study.toml", "--out", "out"]).args(arguments).current_dir(folder);
    command
}

fn lander(folder: &Path, text: &str, arguments: &[&str]) -> Output {
    command(folder, text, arguments).output().unwrap()
}

/// All that a study that must succeed leaves for a reader.
fn files(folder: &Path, text: &str, arguments: &[&str]) -> Vec<String> {
    let output = lander(folder, text, arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    per_cent_is_per_cent(&folder.join("out/drops"));
    let names = ["results.csv", "summary.json", "report.html", "figures/tip-over.svg"];
    names.map(|name| fs::read_to_string(folder.join("out/drops").join(name)).unwrap()).to_vec()
}

/// The figure's shares are the table's, in the unit of both headings.
fn per_cent_is_per_cent(out: &Path) {
    let table = fs::read_to_string(out.join("tables/outcomes.csv")).unwrap();
    assert!(table.lines().next().unwrap().contains("\"share, %\""), "{table}");
    let figure = fs::read_to_string(out.join("figures/tip-over.csv")).unwrap();
    for line in table.lines().filter(|line| line.contains(",tipped,")) {
        let (design, cells) = line.split_once(",tipped,").unwrap();
        let share: f64 = cells.split(',').nth(1).unwrap().parse().unwrap();
        let start = format!("{design},\"tipped over, %\",");
        let drawn = figure.lines().find_map(|line| line.strip_prefix(&start)).unwrap();
        let drawn: f64 = drawn.split(',').next().unwrap().parse().unwrap();
        assert!((share - drawn).abs() <= 5.1e-3, "{line}: {drawn}");
    }
}

fn parse(text: &str) -> Study {
    Study::parse("study.toml".as_ref(), text).unwrap()
}

#[test]
fn every_design_has_the_same_draws() {
    let study = parse(&text());
    assert_eq!((study.runs, study.designs().count()), (48, 6));
    // The first value of each axis that changes nothing.
    assert_eq!(study.designs().name(study.designs().baseline()), "footprint 1, raised 0 m");
    for row in 0..8 {
        let runs: Vec<_> = (0..6).map(|design| study.run(6 * row + design).unwrap()).collect();
        for (design, run) in (0..).zip(&runs) {
            assert_eq!(run.seed, runs[0].seed);
            assert_eq!(run.values[2..], runs[0].values[2..]);
            assert_eq!(run.truth.case, runs[0].truth.case);
            let values: Vec<Option<Drawn>> =
                study.designs().values(design).into_iter().map(Some).collect();
            assert_eq!(run.values[..2], values);
            // Guidance knows the design, and not what is dispersed about it.
            for vehicle in [&run.truth.vehicle, &run.believed.vehicle] {
                let (factor, raised) =
                    ([0.6, 1.0, 1.4][design as usize % 3], [0.0, 0.4][design as usize / 3]);
                let foot_b = Vector3::new(1.3328963, 1.3328963, 0.0) * factor;
                assert!((vehicle.gear.feet_b().next().unwrap() - foot_b).norm() < 1e-12);
                let (dry, wet) = (vehicle.mass.at(0.0), vehicle.mass.propellant.com_b.z);
                assert!((dry.com_b.z - 1.38 - raised).abs() < 1e-12, "{}", dry.com_b.z);
                assert!((wet - 1.6532 - 0.5 * raised).abs() < 1e-12, "{wet}");
            }
            assert!(
                run.truth.vehicle.gear.legs[0].strut != run.believed.vehicle.gear.legs[0].strut
            );
        }
    }
    // More runs only add, and another draw is another row.
    let longer = parse(&text().replace("value = 8,", "value = 9,"));
    assert_eq!(longer.run(47).unwrap().values, study.run(47).unwrap().values);
    assert_ne!(study.run(6).unwrap().seed, study.run(0).unwrap().seed);
}

#[test]
fn results_do_not_depend_on_threads_or_a_kill() {
    let one = empty_folder("one");
    let expected = files(&one, &text(), &["--threads", "1"]);
    assert_eq!(files(&empty_folder("three"), &text(), &["--threads", "3"]), expected);
    let killed = empty_folder("killed");
    let mut child =
        command(&killed, &text(), &["--threads", "1"]).stderr(Stdio::null()).spawn().unwrap();
    let shards = killed.join("out/drops/shards");
    let done = || {
        let Ok(entries) = fs::read_dir(&shards) else { return 0 };
        let names = entries.map(|entry| entry.unwrap().path());
        names.filter(|path| path.extension().is_some_and(|end| end == "csv")).count()
    };
    let end = Instant::now() + Duration::from_secs(60);
    while done() < 2 {
        assert!(Instant::now() < end && child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!((2..8).contains(&done()) && !killed.join("out/drops/results.csv").exists());
    // A campaign, as job arrays and Dask run it, and a design study are the same thing.
    let whole = lander(&killed, &text(), &["--shard", "1/1"]);
    assert_eq!(whole.status.code(), Some(0), "{whole:?}");
    assert_eq!(files(&killed, &text(), &[]), expected);
}

#[test]
fn the_answer_is_of_pairs_and_as_many_rows_as_runs() {
    let folder = empty_folder("answer");
    let csv = files(&folder, &text(), &[]).remove(0);
    let json = lander(&folder, &text(), &["--json"]).stdout;
    let found: Value = serde_json::from_slice(&json).unwrap();
    let designs = found["designs"].as_array().unwrap();
    assert_eq!((&found["runs_each"], designs.len(), &found["baseline"]), (&8.into(), 6, &1.into()));
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(names[2..5], ["design_footprint", "design_raised_m", "across_m_s"]);
    let outcome = names.iter().position(|name| *name == "outcome").unwrap();
    let outcomes: Vec<&str> = lines.map(|line| line.split(',').nth(outcome).unwrap()).collect();
    assert_eq!(outcomes.len(), 48);
    for (design, of_design) in designs.iter().enumerate() {
        let tipped = of_design["outcomes"].as_array().unwrap().iter();
        let tipped = tipped.clone().find(|outcome| outcome["outcome"] == "tipped").unwrap();
        let over = |design: usize| outcomes.iter().skip(design).step_by(6).map(|o| *o == "tipped");
        assert_eq!(tipped["runs"].as_u64().unwrap() as usize, over(design).filter(|t| *t).count());
        if design == 1 {
            assert!(tipped["difference"].is_null());
            continue;
        }
        let pairs = &tipped["difference"]["pairs"];
        let lost = over(design).zip(over(1)).filter(|(here, there)| *here && !*there).count();
        let saved = over(design).zip(over(1)).filter(|(here, there)| !*here && *there).count();
        assert_eq!(
            (pairs["only_first"].as_u64(), pairs["only_second"].as_u64()),
            (Some(lost as u64), Some(saved as u64))
        );
        // A wider or lower lander is never worse on held pads.
        let wider_and_lower = [2, 5].contains(&design);
        assert!(!wider_and_lower || lost == 0, "{of_design}");
    }
}

#[test]
fn wrong_axes_are_refused_before_the_first_run() {
    let folder = empty_folder("wrong");
    let values = "values = { value = [0.6, 1.0, 1.4], unit = \"1\" }";
    for (from, to, words) in [
        (
            "vehicle.gear.feet_b",
            "vehicle.gear.toes_b",
            ["`vehicle.gear.toes_b`", "is not in the file"],
        ),
        ("case.across_m_s", "case.up_m_s", ["`case.up_m_s`", "is not known; known here"]),
        ("[0.6, 1.0, 1.4]", "[0.6, 1.0, 0.6]", ["axis[1].values`", "has 0.6 twice"]),
        ("[0.6, 1.0, 1.4]", "[]", ["axis[1].values`", "at least one value"]),
        ("[0.6, 1.0, 1.4]", "[1.0]", ["axis[1].values`", "must have two or more"]),
        ("[0.6, 1.0, 1.4]", "[0.6, 1.4]", ["axis[1].baseline`", "is 1, must be one of 0.6, 1.4"]),
        (
            "[0.6, 1.0, 1.4]",
            "[0.0, 1.0, 1.4]",
            ["design footprint 0, raised 0 m: `vehicle.gear.feet_b` drawn as 0", "must"],
        ),
        (
            values,
            "values = [\"wide\", \"narrow\"]",
            ["axis[1].as`", "is for numbers, but the distribution gives text"],
        ),
        (
            "unit = \"1\" }\n\n[[axis]]",
            "unit = \"m\" }\n\n[[axis]]",
            ["axis[1].as`", "must be in \"1\""],
        ),
        (
            "name = \"raised\"",
            "name = \"footprint\"\nbaseline = { value = 0.1, unit = \"m\" }",
            ["axis[2].baseline`", "is 0.1"],
        ),
        ("name = \"raised\"", "name = \"Raised!\"", ["axis[2].name`", "it names a column"]),
        ("count = { value = 2", "count = { value = 2.5", ["axis[2].count`", "whole number"]),
        (
            "as = \"factor\"\nvalues",
            "baseline = { value = 3, unit = \"1\" }\nas = \"factor\"\nvalues",
            ["axis[1].baseline`", "is 3, must be one of 0.6, 1, 1.4"],
        ),
        ("times = {", "time = {", ["axis[2].with[1].time`", "is not known"]),
        ("seed = {", "sampling = \"sobol\"\nseed = {", ["`sampling`", "no axes"]),
        (
            "key = \"vehicle.mass.dry_com_b[3]\"\nas = \"added\"",
            "key = \"case.across_m_s\"\nbaseline = { value = 0.0, unit = \"m\" }",
            ["`case.across_m_s`", "is an axis already"],
        ),
    ] {
        assert!(text().contains(from), "{from}");
        let output = lander(&folder, &text().replacen(from, to, 1), &[]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), error.lines().count()), (Some(2), 1), "{error}");
        assert!(error.starts_with("error: study.toml: "), "{error}");
        assert!(words.iter().all(|word| error.contains(word)), "{error}: {words:?}");
    }
    assert!(!folder.join("out").exists());
    let plain = root().join("models/campaigns/touchdowns.toml");
    let mut refused = Command::new(env!("CARGO_BIN_EXE_lander"));
    let output = refused.arg("design").arg(plain).current_dir(&folder).output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("`axis`: is missing: a design study has one or two"), "{error}");
    for other in ["rare", "map"] {
        let mut refused = Command::new(env!("CARGO_BIN_EXE_lander"));
        let text = if other == "map" { text() + MAP } else { text() };
        fs::write(folder.join("study.toml"), text).unwrap();
        let output = refused.args([other, "study.toml"]).current_dir(&folder).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(error.contains("`axis`: is for designs") || error.contains("is drawn"), "{error}");
    }
}

const MAP: &str = "[map]\nacross = { value = [0, 1], unit = \"m/s\" }\n\
                   down = { value = [0, 1], unit = \"m/s\" }\ncells = { value = [1, 1], unit = \"1\" }\n\
                   [[map.cases]]\nname = \"level\"\n";

/// Touchdowns of a rigid BUG, level, on held pads, towards an edge: what the energy criterion is about.
fn rigid() -> String {
    let constant = |key: &str, value: f64, unit: &str| {
        format!(
            "[[design]]\nkey = \"{key}\"\ndistribution = \"constant\"\n\
             value = {{ value = {value:e}, unit = \"{unit}\" }}\n"
        )
    };
    let case = "[case]\nslope_deg = { value = 0.0, unit = \"deg\" }\n\
                captured = { value = 1.0, unit = \"1\" }\n\
                propellant_kg = { value = 0.0, unit = \"kg\" }";
    let from = text().find("[case]").unwrap();
    let to = text().find("[[axis]]").unwrap();
    let mut text = text();
    text.replace_range(from..to, &format!("{case}\n\n"));
    text = text
        .replace("runs = { value = 8,", "runs = { value = 24,")
        .replace("[0.6, 1.0, 1.4]", "[0.8, 1.0, 1.2]")
        .replace("value = 2.5, unit = \"s\"", "value = 12.0, unit = \"s\"");
    let end = text.find("[[dispersion]]\nkey = \"vehicle.gear.crush_load_1\"").unwrap();
    text.truncate(end);
    text + &constant("vehicle.gear.crush_load_1", 1e9, "N")
        + &constant("vehicle.gear.crush_load_2", 1e9, "N")
        + &constant("vehicle.gear.stiffness", 1e6, "N/m")
        + &constant("vehicle.gear.damping", 4e4, "N.s/m")
}

#[test]
fn the_tip_over_speed_moves_with_footprint_and_height_as_the_energy_criterion_says() {
    let study = parse(&rigid());
    let columns = Columns::new(&study).unwrap();
    let mut wrong_at = Vec::new();
    let mut met = [0, 0];
    for number in 0..study.runs {
        let run = study.run(number).unwrap();
        let [
            Some(Drawn::Number(factor)),
            Some(Drawn::Number(raised_m)),
            Some(Drawn::Number(across_m_s)),
        ] = run.values.as_slice()
        else {
            panic!("{:?}", run.values)
        };
        // (T.17) by hand from BUG's file, dry: v = √(2 m g Δh I_e)/(m h), about the edge that it moves towards.
        let (mass_kg, gravity) = (174.0, 1.625);
        let (distance_m, height_m) = (1.3328963 * factor + 0.01, 1.38 + raised_m);
        let reach2 = distance_m * distance_m + height_m * height_m;
        let rise_m = reach2.sqrt() - height_m;
        let inertia = 126.1 + mass_kg * reach2;
        let limit_m_s = (2.0 * mass_kg * gravity * rise_m * inertia).sqrt() / (mass_kg * height_m);
        let over = run.finish(study.kind, &columns).outcome == "tipped";
        met[usize::from(over)] += 1;
        if over != (*across_m_s > limit_m_s) {
            wrong_at.push(across_m_s / limit_m_s - 1.0);
        }
    }
    // Both sides of every limit are drawn.
    assert!(met.iter().all(|count| *count > 30), "{met:?}");
    Claim {
        id: "design-tip-over-closed-form",
        section: "Contact: tip-over",
        claim: "greatest distance from the tip-over speed at which a draw of a design study is on the wrong side: \
                six footprints and heights, 24 speeds each",
        reference: "closed form (T.17) for captured pads",
        unit: "%",
        bound: Bound::AtMost(2.0),
        origin: "legs that give across their stroke and 0.1 m/s down at contact: 1 % of the energy of tip-over each",
        noise: 0.1,
    }
    .holds(100.0 * wrong_at.iter().fold(0.0_f64, |most, off| most.max(off.abs())));
}
