//! `lander map`: cells that hide nothing, the same on any number of threads, closed forms beside them.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// A study of one case; `cells` and `depth` make its grid.
fn text(cells: u32, depth: u32, case: &str) -> String {
    let scenario = root().join("models/scenarios/tip-over.toml");
    format!(
        r#"name = "small"
kind = "touchdown"
scenario = "{}"
runs = {{ value = 1, unit = "1" }}

[case]
slope_deg = {{ value = 0.0, unit = "deg" }}

[[design]]
key = "scenario.contact.engine"
distribution = "constant"
value = "strut"

[map]
across = {{ value = [0.0, 4.0], unit = "m/s" }}
down = {{ value = [0.5, 4.0], unit = "m/s" }}
cells = {{ value = [{cells}, {cells}], unit = "1" }}
depth = {{ value = {depth}, unit = "1" }}

[[map.cases]]
name = "the case, alone"
{case}"#,
        scenario.display()
    )
}

const DOWNHILL: &str = "slope_deg = { value = 12.0, unit = \"deg\" }\n\
                        captured = { value = 1.0, unit = \"1\" }\n";
const LEVEL: &str = "captured = { value = 0.0, unit = \"1\" }\n\
                     friction = { value = 0.3, unit = \"1\" }\n";

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("map").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn lander(folder: &Path, text: &str, arguments: &[&str]) -> Output {
    fs::write(folder.join("study.toml"), text).unwrap();
    Command::new(env!("CARGO_BIN_EXE_lander"))
        .args(["map", "study.toml", "--out", "out", "--json"])
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// The summary of the case, and the rows of a table without their case.
fn map(folder: &Path, text: &str, table: &str) -> (Value, Vec<Vec<String>>) {
    let output = lander(folder, text, &[]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let csv = fs::read_to_string(folder.join("out/small").join(table)).unwrap();
    let row = |line: &str| {
        let cells = line.strip_prefix("\"the case, alone\",").unwrap().split(',');
        cells.map(str::to_owned).collect()
    };
    (summary["cases"][0].clone(), csv.lines().skip(1).map(row).collect())
}

#[test]
fn no_cell_hides_what_the_full_grid_shows() {
    let fine = folder("fine");
    let (_, points) = map(&fine, &text(8, 0, DOWNHILL), "points.csv");
    let points: Vec<(f64, f64, &str)> = points
        .iter()
        .map(|row| (row[0].parse().unwrap(), row[1].parse().unwrap(), row[2].as_str()))
        .collect();
    assert_eq!(points.len(), 81);
    let coarse = folder("coarse");
    let (summary, cells) = map(&coarse, &text(4, 1, DOWNHILL), "figures/map.csv");
    assert!(summary["touchdowns"].as_u64().unwrap() < 81);
    let mut area = 0.0;
    for cell in &cells {
        let [x0, x1, y0, y1]: [f64; 4] = std::array::from_fn(|i| cell[i].parse().unwrap());
        area += (x1 - x0) * (y1 - y0);
        let inside = |(x, y, _): &&(f64, f64, &str)| {
            (x0 - 1e-9..x1 + 1e-9).contains(x) && (y0 - 1e-9..y1 + 1e-9).contains(y)
        };
        let classes: Vec<&str> = points.iter().filter(inside).map(|(_, _, class)| *class).collect();
        let alike = classes.iter().all(|class| *class == cell[4]);
        assert!(alike || cell[4] == "mixed", "{cell:?}: {classes:?}");
    }
    // The plane, to rounding.
    assert!((area - 4.0 * 3.5).abs() < 1e-9, "{area}");
}

#[test]
fn the_map_does_not_depend_on_threads_and_the_page_is_whole() {
    let (one, three) = (folder("one"), folder("three"));
    let text = text(3, 1, LEVEL);
    let first = lander(&one, &text, &["--threads", "1"]);
    assert_eq!(first.stdout, lander(&three, &text, &["--threads", "3"]).stdout);
    for file in ["points.csv", "map.json", "report.html", "figures/map.svg", "figures/map.csv"] {
        let read = |folder: &Path| fs::read(folder.join("out/small").join(file)).unwrap();
        assert_eq!(read(&one), read(&three), "{file}");
    }
    let svg = fs::read_to_string(one.join("out/small/figures/map.svg")).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let cells = document.descendants().filter(|node| node.has_tag_name("rect")).count();
    assert!(cells > 9, "{cells}");
    let html = fs::read_to_string(one.join("out/small/report.html")).unwrap();
    assert!(html.contains(svg.as_str()) && html.contains("lander map small.toml"));
    // Of the case: slope, downhill azimuth, friction, pads.
    let case = "<td>the case, alone</td><td>0</td><td>0</td><td>0.3</td><td>sliding</td>";
    assert!(html.contains(case), "{html}");
}

#[test]
fn criteria_are_judged_by_the_touchdowns() {
    let folder = folder("criteria");
    let (summary, points) = map(&folder, &text(4, 0, LEVEL), "points.csv");
    // On level ground no static angle tips, and with so little friction nothing does.
    assert_eq!(summary["static_criterion"]["misclassified"], 0.0);
    assert!(summary["outcomes"]["tipped"].is_null());
    // Two legs lead: the closed form for level ground and pads of no size, (T.17), with BUG's figures of
    // 5 kg of propellant gives 2.03 m/s; the pads' radius of 20 mm shifts it by some per mille.
    for row in &points {
        let across: f64 = row[0].parse().unwrap();
        assert_eq!(row[9], if across > 2.04 { "1" } else { "0" }, "{row:?}");
    }
    let called = summary["captured_criterion"]["false_alarms"].as_f64().unwrap();
    // Columns at 3 and 4 m/s of five, as means of corners: half of the third cell and the fourth.
    assert!((called - 0.375).abs() < 1e-9, "{called}");
}

#[test]
fn wrong_maps_are_refused() {
    let folder = folder("wrong");
    let dispersion = "[[dispersion]]\nkey = \"case.friction\"\ndistribution = \"uniform\"\n\
                      low = { value = 0.1, unit = \"1\" }\nhigh = { value = 0.2, unit = \"1\" }\n";
    let good = text(2, 0, LEVEL);
    for (text, words) in [
        (good.replace("[0.0, 4.0]", "[4.0, 0.0]"), ["map.across", "must ascend"]),
        (good.replace("[2, 2]", "[2.5, 2]"), ["map.cells", "must be whole"]),
        (good.replace("friction", "grip"), ["map.cases[1].grip", "is not known"]),
        (
            good.replace("value = 0.3", "value = 3.0"),
            ["map.cases[1].friction", "must lie in [0, 2]"],
        ),
        (good.replace("[map]", &format!("{dispersion}[map]")), ["case.friction", "only constants"]),
        (good.split("[map]").next().unwrap().to_owned(), ["map", "is missing"]),
    ] {
        let output = lander(&folder, &text, &[]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), error.lines().count()), (Some(2), 1), "{error}");
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
    assert!(!folder.join("out").exists());
}

#[test]
fn what_is_no_map_and_what_is_one_alone() {
    let folder = folder("wrong");
    let twice = text(2, 0, LEVEL) + "\n[[map.cases]]\nname = \"the case, alone\"\n";
    let rising = text(2, 0, LEVEL).replace("[0.5, 4.0]", "[-0.5, 4.0]");
    for (text, words) in [
        (twice, ["map.cases", "has two of the name"]),
        (rising, ["map.down", "must not be negative"]),
        (text(2, 0, "lean = { value = 95.0, unit = \"deg\" }"), ["lean", "must lie in [-90, 90]"]),
    ] {
        let output = lander(&folder, &text, &[]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(words.iter().all(|word| error.contains(word)), "{error}: {words:?}");
    }
    fs::write(folder.join("study.toml"), text(2, 0, LEVEL)).unwrap();
    let mut campaign = Command::new(env!("CARGO_BIN_EXE_lander"));
    let campaign = campaign.args(["campaign", "study.toml"]).current_dir(&folder).output().unwrap();
    let error = String::from_utf8(campaign.stderr).unwrap();
    assert!(campaign.status.code() == Some(2) && error.contains("is for `lander map`"), "{error}");
}

#[test]
fn an_interruption_leaves_no_map() {
    let folder = folder("interrupted");
    fs::write(folder.join("study.toml"), text(40, 2, LEVEL)).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_lander"))
        .args(["map", "study.toml", "--out", "out"])
        .current_dir(&folder)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut progress = BufReader::new(child.stderr.take().unwrap());
    // It counts touchdowns, so it has begun.
    progress.read_until(b'/', &mut Vec::new()).unwrap();
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    let mut rest = String::new();
    progress.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest}");
    assert!(rest.contains("interrupted: nothing of it is kept"), "{rest}");
    assert_eq!(fs::read_dir(folder.join("out/small")).unwrap().count(), 0);
}
