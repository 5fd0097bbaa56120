//! `lander touchdowns`: rows as asked, the same on any number of threads, wrong files named.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use cosim::touchdowns::{self, COLUMNS, Cases, Engine, Touchdown};
use lander_models::{Outcome, Ticks, Vehicle};

const STOP_TIME: Ticks = Ticks(8000);

/// propellant, gravity, down, across, travel, roll, pitch, yaw, rates, slope, downhill, friction,
/// captured.
const UPRIGHT: &str = "5,1.625,1,0.2,0,0,0,0,0,0,0,0,0,0.6,0";
const TIPS: &str = "5,1.625,1,2.5,0,0,12,0,0,0,0,12,0,0.5,1";
const SLIDES: &str = "5,1.625,0.5,2,90,0,0,22.5,0,0,0,0,0,0.2,0";
const CRASHES: &str = "5,1.625,6,0,0,0,0,0,0,0,0,0,0,0.6,0";
/// In the air for 2 v/g = 9.8 s.
const RISES: &str = "5,1.625,-8,0,0,0,0,0,0,0,0,0,0,0.6,0";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn bug() -> Vehicle {
    Vehicle::load(&root().join("models/vehicles/bug.toml")).unwrap()
}

fn header() -> String {
    COLUMNS.map(|(name, _)| name).join(",")
}

fn run(rows: &[&str], threads: usize) -> Vec<Touchdown> {
    let text = format!("{}\n{}\n", header(), rows.join("\n"));
    let cases = Cases::parse("cases.csv".as_ref(), &text, &bug()).unwrap();
    cases.run(&bug(), Engine::Rapier, STOP_TIME, threads).unwrap()
}

#[test]
fn each_row_gets_its_outcome_in_order() {
    let rows = run(&[UPRIGHT, TIPS, SLIDES, CRASHES, RISES], 2);
    let outcomes: Vec<_> = rows.iter().map(|row| row.outcome).collect();
    let expected =
        [Outcome::Landed, Outcome::Tipped, Outcome::Slid, Outcome::Crashed, Outcome::NoContact];
    assert_eq!(outcomes, expected);
    assert_eq!(rows[4].end_time_s, STOP_TIME.seconds());
    assert_eq!(rows[0].case[..4], [5.0, 1.625, 1.0, 0.2]);
    let [contact_s, _, margin_j, tip_s, stroke_m, load_n, slide_m] = rows[0].results;
    // 2 mm at 1 m/s, in ticks.
    assert!((0.001..=0.002).contains(&contact_s), "{contact_s}");
    assert!(margin_j > 0.0 && tip_s.is_nan() && stroke_m > 0.0 && load_n > 0.0 && slide_m > 0.0);
    // Friction takes mu times the normal impulse: of the impact, whose speed grew over the 2 mm,
    // then of the weight until 2 m/s are gone.
    let impact_m_s = (0.5_f64.powi(2) + 2.0 * 1.625 * 2e-3).sqrt();
    let expected_m = (2.0 - 0.2 * impact_m_s).powi(2) / (2.0 * 0.2 * 1.625);
    // 0.5 %: the acceptance of slides.
    assert!((rows[2].results[6] / expected_m - 1.0).abs() < 5e-3, "{}", rows[2].results[6]);
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let rows = [UPRIGHT, TIPS, CRASHES, RISES, UPRIGHT];
    assert_eq!(touchdowns::to_csv(&run(&rows, 1)), touchdowns::to_csv(&run(&rows, 3)));
}

#[test]
fn the_velocity_is_that_of_the_centre_of_mass() {
    // Crashed means faster than 5 m/s. With O at 4.9 m/s the centre of mass, 1.38 m above it, would
    // have 1.44 m/s across as well: 5.1 m/s.
    let turning = "0,1.625,4.9,0,0,0,0,0,0,60,0,0,0,0.6,0";
    let faster = "0,1.625,4.9,1.44,0,0,0,0,0,60,0,0,0,0.6,0";
    let rows = run(&[turning, faster], 1);
    assert_ne!(rows[0].outcome, Outcome::Crashed);
    assert_eq!(rows[1].outcome, Outcome::Crashed);
}

#[test]
fn wrong_files_are_named_with_line_column_and_value() {
    let header = header();
    let wrong = [
        (String::new(), vec!["line 1", "column 1 is ``"]),
        (header.replace("yaw_deg", "yaw") + "\n", vec!["line 1", "column 8 is `yaw`"]),
        (header.replace(",captured", "") + "\n", vec!["column 15 `captured` is missing"]),
        (header.clone() + ",mass_kg\n", vec!["column 16 is `mass_kg`"]),
        (header.clone() + "\n\n", vec!["has no cases"]),
        (format!("{header}\n{UPRIGHT}\n1,2,3\n"), vec!["line 3", "has 3 values, must have 15"]),
        (
            format!("{header}\n{}\n", UPRIGHT.replace("0.6", "fast")),
            vec!["line 2", "column `friction`", "`fast`", "must be a number"],
        ),
        (
            format!("{header}\n\n{}\n", UPRIGHT.replace("0.6", "nan")),
            vec!["line 3", "column `friction`", "`nan`", "must be finite"],
        ),
        (
            format!("{header}\n{}\n", UPRIGHT.replace("1.625", "-1")),
            vec!["column `gravity_m_s2`", "`-1`", "must be greater than 0"],
        ),
        (
            format!("{header}\n{}\n", UPRIGHT.replacen('5', "85.6", 1)),
            vec!["column `propellant_kg`", "`85.6`", "must not exceed the vehicle's 85.5"],
        ),
        (
            format!("{header}\n{}\n", UPRIGHT.replace("0.6,0", "0.6,0.5")),
            vec!["column `captured`", "`0.5`", "must be 0 or 1"],
        ),
    ];
    for (text, words) in wrong {
        let error = Cases::parse("cases.csv".as_ref(), &text, &bug()).unwrap_err().to_string();
        assert!(error.starts_with("cases.csv: ") && error.lines().count() == 1, "{error}");
        for word in words {
            assert!(error.contains(word), "{error}: no {word}");
        }
    }
}

fn lander(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lander"))
        .args(["touchdowns", "--cases", "cases.csv", "--stop-time", "2"])
        .arg("--vehicle")
        .arg(root().join("models/vehicles/bug.toml"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

#[test]
fn the_command_writes_whole_files_and_says_counts() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("touchdowns");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("cases.csv"), format!("{}\n{CRASHES}\n{RISES}\n", header())).unwrap();

    let output = lander(&folder, &["--out", "rows.csv"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(said, "2 touchdowns: 1 crashed, 1 no_contact\n");
    let rows = fs::read_to_string(folder.join("rows.csv")).unwrap();
    assert_eq!(rows.lines().count(), 3);
    assert!(rows.lines().nth(2).unwrap().ends_with("no_contact,2,,,,,,,"), "{rows}");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2, "a temporary file is left");

    assert_eq!(String::from_utf8(lander(&folder, &[]).stdout).unwrap(), rows);
    let json = lander(&folder, &["--json"]).stdout;
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["outcomes"]["crashed"], 1);
    assert_eq!(json["rows"][0]["down_m_s"], 6.0);
    assert!(json["rows"][1]["contact_time_s"].is_null());

    fs::write(folder.join("cases.csv"), "propellant\n").unwrap();
    let output = lander(&folder, &["--out", "none.csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().starts_with("error: cases.csv: line 1"));
    assert!(!folder.join("none.csv").exists());
}
