//! What `lander campaign` and `lander rare` say of a study's runs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// A folder with a study of short touchdowns on held pads; `head` has its runs and sampling.
fn study(name: &str, head: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("statistics").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let scenario = root().join("models/scenarios/tip-over.toml");
    let text = format!(
        r#"name = "drops"
kind = "touchdown"
scenario = "{}"
{head}
[case]
slope_deg = {{ value = 0.0, unit = "deg" }}
down_m_s = {{ value = 1.0, unit = "m/s" }}

[[design]]
key = "scenario.contact.engine"
distribution = "constant"
value = "strut"

[[design]]
key = "scenario.run.stop_time"
distribution = "constant"
value = {{ value = 1.5, unit = "s" }}

[[dispersion]]
key = "case.across_m_s"
distribution = "uniform"
low = {{ value = 0.5, unit = "m/s" }}
high = {{ value = 2.0, unit = "m/s" }}

[[dispersion]]
key = "case.gravity_m_s2"
distribution = "uniform"
low = {{ value = 1.62, unit = "m/s2" }}
high = {{ value = 1.63, unit = "m/s2" }}
"#,
        scenario.display()
    );
    fs::write(folder.join("study.toml"), text).unwrap();
    folder
}

fn lander(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lander"));
    command.args(arguments).current_dir(folder).output().unwrap()
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = lander(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Entries of a list of the summary that are about the stability distance, by parameter.
fn about_stability<'a>(summary: &'a Value, list: &str) -> Vec<(&'a str, &'a Value)> {
    let entries = summary[list].as_array().unwrap().iter();
    entries
        .filter(|entry| entry["result"] == "stability_distance_m")
        .map(|entry| (entry["parameter"].as_str().unwrap(), entry))
        .collect()
}

#[test]
fn the_parameter_that_matters_comes_out_on_top() {
    let folder = study("sensitivity", "runs = { value = 60, unit = \"1\" }");
    let summary = json(&folder, &["campaign", "study.toml", "--out", "out", "--json"]);
    let found = about_stability(&summary, "sensitivity");
    // The faster, the nearer to a tip-over; a per mille of gravity is nothing.
    assert_eq!(found[0].0, "across_m_s");
    assert!(found[0].1["value"].as_f64().unwrap() < -0.9, "{found:?}");
    let outcomes = summary["groups"][0]["outcomes"].as_array().unwrap();
    let runs: u64 = outcomes.iter().map(|share| share["runs"].as_u64().unwrap()).sum();
    assert_eq!((summary["groups"][0]["runs"].as_u64(), runs), (Some(60), 60));
    let stroke = summary["results"].as_array().unwrap();
    let stroke = stroke.iter().find(|result| result["result"] == "peak_stroke_m").unwrap();
    assert_eq!(stroke["measured"], 60);
    let shares = stroke["quantiles"].as_array().unwrap().iter();
    for quantile in shares {
        let [low, value, high] = ["low", "value", "high"].map(|key| quantile[key].as_f64());
        let value = value.unwrap();
        assert!(low.is_none_or(|low| low <= value) && high.is_none_or(|high| value <= high));
        // Of sixty runs none need lie beyond their 1 % and 99 % quantiles.
        let outer = [0.01, 0.99].contains(&quantile["share"].as_f64().unwrap());
        assert_eq!(low.is_none() || high.is_none(), outer, "{quantile}");
    }
}

#[test]
fn sobol_s_layout_gives_the_variance_to_its_cause() {
    let head = "runs = { value = 80, unit = \"1\" }\nsampling = \"sobol\"";
    let folder = study("sobol", head);
    let summary = json(&folder, &["campaign", "study.toml", "--out", "out", "--json"]);
    // Outcomes and bounds are of the independent runs, A and B of each row.
    assert_eq!((&summary["runs"], &summary["groups"][0]["runs"]), (&80.into(), &40.into()));
    let found = about_stability(&summary, "sobol");
    let total = |name: &str| {
        let entry = found.iter().find(|(parameter, _)| *parameter == name).unwrap().1;
        entry["total"]["value"].as_f64().unwrap()
    };
    // All of it and nothing, but for the sampling error of twenty rows.
    assert!(total("across_m_s") > 0.6 && total("gravity_m_s2") < 0.05, "{found:?}");
    let text = fs::read_to_string(folder.join("study.toml")).unwrap();
    fs::write(folder.join("study.toml"), text.replace("value = 80", "value = 81")).unwrap();
    let error = String::from_utf8(lander(&folder, &["campaign", "study.toml"]).stderr).unwrap();
    assert!(error.contains("`runs`: is 81, must be a multiple of 4"), "{error}");
}

#[test]
fn a_rare_event_is_found_in_steps_and_compared_with_plain_runs() {
    let rare = "[rare_event]\nsamples = { value = 500, unit = \"1\" }\n\
                levels_max = { value = 2, unit = \"1\" }";
    let head = format!("runs = {{ value = 100, unit = \"1\" }}\n{rare}");
    let folder = study("rare", &head);
    json(&folder, &["campaign", "study.toml", "--out", "out", "--json"]);
    let found = json(&folder, &["rare", "study.toml", "--out", "out", "--json"]);
    assert_eq!(found["runs"], 950);
    // Two levels do not reach it, and say nothing from below.
    assert!(found["reached"] == false && found["low"] == 0.0, "{found}");
    let first = &found["levels"][0];
    assert_eq!(first["probability"], 0.1);
    // Shares of a hundred and of five hundred: four standard errors of their difference.
    let met = found["plain"][0]["met"].as_f64().unwrap();
    assert!(
        (met / 100.0 - 0.1).abs() < 4.0 * (0.09 * (1.0 / 100.0 + 1.0 / 500.0_f64)).sqrt(),
        "{met}"
    );
    let one = lander(&folder, &["rare", "study.toml", "--out", "out", "--json", "--threads", "1"]);
    assert_eq!(serde_json::from_slice::<Value>(&one.stdout).unwrap(), found);
    let kit = root().join("models/campaigns/paper-monte-carlo.toml");
    let refused = lander(&folder, &["rare", kit.to_str().unwrap(), "--out", "out"]);
    let error = String::from_utf8(refused.stderr).unwrap();
    assert!(error.contains("key `kind`: is \"landing\""), "{error}");
}

/// A crash ends a run at contact, so it says nothing of what comes after.
#[test]
fn what_crashed_measures_no_touchdown() {
    let folder = study("crash", "runs = { value = 20, unit = \"1\" }");
    let text = fs::read_to_string(folder.join("study.toml")).unwrap();
    // tip-over.toml takes 5 m/s for a crash.
    let down = "[[dispersion]]\nkey = \"case.down_m_s\"\ndistribution = \"choice\"\n\
                values = { value = [1.0, 8.0], unit = \"m/s\" }\n";
    let text = text.replace("down_m_s = { value = 1.0, unit = \"m/s\" }\n", "") + down;
    fs::write(folder.join("study.toml"), text).unwrap();
    let summary = json(&folder, &["campaign", "study.toml", "--out", "out", "--json"]);
    let outcomes = summary["groups"][0]["outcomes"].as_array().unwrap();
    let crashed = outcomes.iter().find(|share| share["outcome"] == "crashed").unwrap();
    let crashed = crashed["runs"].as_u64().unwrap();
    assert!((2..19).contains(&crashed), "{summary}");
    let measured = |name: &str| {
        let results = summary["results"].as_array().unwrap();
        let found = results.iter().find(|result| result["result"] == name).unwrap();
        found["measured"].as_u64().unwrap()
    };
    assert_eq!(measured("contact_speed_down_m_s"), 20);
    assert_eq!(measured("peak_leg_load_n"), 20 - crashed);
    // The same in every run that was measured, and said all the same.
    assert_eq!(measured("rest_tilt_deg"), 20 - crashed);
}

#[test]
fn the_page_is_whole_and_says_how_to_repeat_it() {
    let folder = study("page", "runs = { value = 30, unit = \"1\" }");
    json(&folder, &["campaign", "study.toml", "--out", "out", "--json"]);
    let out = folder.join("out/drops");
    let html = fs::read_to_string(out.join("report.html")).unwrap();
    // Nothing is fetched: no link, script or picture from elsewhere but the names of XML spaces.
    let foreign = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for word in ["http:", "https:", "<script", "<link", "<img", "@import", "url("] {
        assert!(!foreign.contains(word), "{word}");
    }
    for word in [
        "30 touchdowns",
        "uniform, 0.5 to 2 m/s",
        "<td>case.slope_deg</td><td>is 0 deg</td>",
        "<td>scenario.contact.engine</td><td>is strut</td>",
        "95 % bounds",
        "lander campaign drops.toml --run",
        "SHA-256",
        "key = &quot;case.across_m_s&quot;",
    ] {
        assert!(html.contains(word), "{word}");
    }
    let mut figures = 0;
    for entry in fs::read_dir(out.join("figures")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "svg") {
            let svg = fs::read_to_string(&path).unwrap();
            roxmltree::Document::parse(&svg).unwrap();
            assert!(html.contains(svg.as_str()) && !svg.contains("NaN"), "{path:?}");
            let csv = fs::read_to_string(path.with_extension("csv")).unwrap();
            assert!(csv.lines().count() > 1, "{path:?}");
            figures += 1;
        }
    }
    assert!(figures >= 4, "{figures}");
}
