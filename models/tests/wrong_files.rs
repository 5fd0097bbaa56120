//! A wrong file is refused with its name, the key and the reason.

use std::path::Path;

use lander_models::scenario::Scenario;
use lander_models::vehicle::Vehicle;

const SCENARIO: &str = include_str!("../scenarios/landing.toml");
const BUG: &str = include_str!("../vehicles/bug.toml");

fn bug() -> Vehicle {
    Vehicle::parse(Path::new("bug.toml"), BUG).unwrap()
}

/// The error after `from` is replaced by `to` in the default scenario.
#[track_caller]
fn scenario_error(from: &str, to: &str) -> String {
    assert!(SCENARIO.contains(from), "the scenario no longer has {from}");
    let text = SCENARIO.replacen(from, to, 1);
    Scenario::parse(Path::new("landing.toml"), &text, &bug()).unwrap_err().to_string()
}

#[track_caller]
fn vehicle_error(from: &str, to: &str) -> String {
    assert!(BUG.contains(from), "the vehicle no longer has {from}");
    let text = BUG.replacen(from, to, 1);
    Vehicle::parse(Path::new("bug.toml"), &text).unwrap_err().to_string()
}

#[track_caller]
fn says(error: &str, parts: &[&str]) {
    for part in parts {
        assert!(error.contains(part), "`{error}` does not say `{part}`");
    }
}

#[test]
fn an_unknown_key_is_named_with_what_is_known() {
    let error = scenario_error("friction =", "frction = { value = 1.0, unit = \"1\" }\nfriction =");
    says(&error, &["landing.toml", "`terrain.frction`", "not known", "friction"]);
    let error = scenario_error("unit = \"1\" }", "unit = \"1\", sigma = 2 }");
    says(&error, &["`terrain.friction.sigma`", "not known"]);
}

#[test]
fn a_missing_or_wrong_unit_is_told_with_the_right_one() {
    let error = scenario_error("{ value = 1.625, unit = \"m/s2\" }", "1.625");
    says(&error, &["landing.toml", "`site.gravity`", "no unit", "m/s2"]);
    let error = scenario_error("{ value = 1.625, unit = \"m/s2\" }", "{ value = 1.625 }");
    says(&error, &["`site.gravity`", "no unit"]);
    let error = scenario_error("unit = \"m/s2\"", "unit = \"ft/s2\"");
    says(&error, &["`site.gravity`", "ft/s2", "m/s2"]);
}

#[test]
fn text_nan_and_a_wrong_length_are_refused() {
    says(&scenario_error("1.625", "\"lunar\""), &["`site.gravity`", "must be a number", "string"]);
    says(&scenario_error("1.625", "nan"), &["`site.gravity`", "NaN", "finite"]);
    says(&scenario_error("1.625", "inf"), &["`site.gravity`", "finite"]);
    says(
        &scenario_error("[300.0, 100.0, 500.0]", "[300.0, 100.0]"),
        &["`initial.position_w`", "3"],
    );
    says(&scenario_error("{ value = 1.625, unit = \"m/s2\" }", "\"1.6\""), &["`site.gravity`"]);
    says(&scenario_error("name = \"landing\"", "name = 3"), &["`name`", "text"]);
}

#[test]
fn values_beyond_their_limits_name_the_limit() {
    says(&scenario_error("value = 85.5", "value = 86.0"), &["`initial.propellant`", "86", "85.5"]);
    says(&scenario_error("1.625", "-1.0"), &["`site.gravity`", "-1", "greater than 0"]);
    says(&scenario_error("\"descent\"", "\"ascent\""), &["`guidance.mode`", "ascent", "hop"]);
    says(&scenario_error("value = 90.0", "value = 0.00015"), &["`run.stop_time`"]);
    let error = vehicle_error("value = 174.0", "value = -174.0");
    says(&error, &["bug.toml", "`mass.dry_mass`", "-174", "greater than 0"]);
}

#[test]
fn terrain_beyond_its_limits_is_refused() {
    let fields = |table: &str| scenario_error("[initial]", &format!("{table}\n[initial]"));
    let craters = "[terrain.craters]\nextent = { value = 500.0, unit = \"m\" }\n\
                   diameter_max = { value = 100.0, unit = \"m\" }\n";
    let error = fields(&format!("{craters}diameter_min = {{ value = 0.1, unit = \"m\" }}"));
    says(&error, &["`terrain.craters.diameter_min`", "bodies", "at most 200000"]);
    let error = fields(&format!("{craters}diameter_min = {{ value = 200.0, unit = \"m\" }}"));
    says(&error, &["`terrain.craters.diameter_max`", "is 100 m", "[200, 15000]"]);
    let rocks = "[terrain.rocks]\nextent = { value = 50.0, unit = \"m\" }\n\
                 diameter_min = { value = 0.2, unit = \"m\" }\n\
                 diameter_max = { value = 2.0, unit = \"m\" }\n";
    says(&fields(rocks), &["`terrain.rocks.abundance`", "missing"]);
    let rocks = format!("{rocks}abundance = {{ value = 0.02, unit = \"1\" }}\n");
    let error = fields(&format!("{rocks}burial = {{ value = 0.6, unit = \"1\" }}"));
    says(&error, &["`terrain.rocks.burial`", "0.6", "[0, 0.5]"]);
    // A key of the other law has no meaning here.
    let error = fields(&format!("{rocks}exponent = {{ value = 2.0, unit = \"1\" }}"));
    says(&error, &["`terrain.rocks.exponent`", "not known"]);
    let error = fields("[terrain.soil]\nexponent = { value = 3.0, unit = \"1\" }");
    says(&error, &["`terrain.soil.exponent`", "3", "[0.5, 1.8]"]);
    let error = fields("[terrain.soil]\ncohesive_modulus = { value = 1.4, unit = \"kN/m2\" }");
    says(&error, &["`terrain.soil.cohesive_modulus`", "kN/m2", "N/m^(n+1)"]);
    let error = fields("[terrain.lakes]");
    says(&error, &["`terrain.lakes`", "not known", "heightmap"]);
}

#[test]
fn gear_that_contact_cannot_hold_is_refused() {
    let error = vehicle_error("{ value = 2.0, unit = \"kg\"", "{ value = 7.0, unit = \"kg\"");
    says(&error, &["`gear.foot_mass`", "7", "[0.5, 4.56"]);
    // A leg's give across its stroke takes two numbers.
    let error = vehicle_error("lateral_damping =", "# lateral_damping =");
    says(&error, &["`gear.lateral_damping`"]);
    // The first two feet change places: the polygon crosses itself.
    let (first, second) = ("[1.3328963, 1.3328963, 0.0]", "[-1.3328963, 1.3328963, 0.0]");
    let swapped = format!("{second}, {first}");
    let error = vehicle_error(&format!("{first}, {second}"), &swapped);
    says(&error, &["`gear.feet_b`", "counter-clockwise"]);
}

#[test]
fn faults_and_disturbances_that_make_no_sense_are_refused() {
    let with = |text: &str| scenario_error("[run]", &format!("{text}\n[run]"));
    let onset = "onset = { value = 1.0, unit = \"s\" }";
    says(&with("[faults.engine_shutof]"), &["`faults.engine_shutof`", "engine_shutoff, "]);
    says(&with("[faults.engine_shutoff]"), &["`faults.engine_shutoff.onset`", "missing"]);
    let error = with(&format!("[faults.sensor_failure]\n{onset}"));
    says(&error, &["`faults.sensor_failure.sensor`", "missing"]);
    let error = with(&format!(
        "[faults.thrust_degradation]\n{onset}\nfraction = {{ value = 1.5, unit = \"1\" }}"
    ));
    says(&error, &["`faults.thrust_degradation.fraction`", "1.5", "[0, 1]"]);
    let error = with("[faults.gimbal_seizure]\nonset = { value = 0.0005, unit = \"s\" }");
    says(&error, &["`faults.gimbal_seizure.onset`", "whole"]);
    let error = with("[disturbances]\npreset = \"engine\"");
    says(&error, &["`disturbances.preset`", "engine-table"]);
    let error = with("[disturbances]\nmass = { value = 0.5, unit = \"1\" }");
    says(&error, &["`disturbances.mass`", "0.5", "must lie in"]);
}

#[test]
fn engine_and_thruster_data_that_make_no_sense_are_refused() {
    let error = vehicle_error("[0.1538, 210.0], ", "");
    says(&error, &["`engine.specific_impulse_table`", "two rows"]);
    let table = BUG.lines().find(|line| line.starts_with("specific_impulse_table")).unwrap();
    let text = BUG.replace(table, "").replace("_model = \"constant\"", "_model = \"throttle\"");
    let error = Vehicle::parse(Path::new("bug.toml"), &text).unwrap_err().to_string();
    says(&error, &["`engine.specific_impulse_model`", "specific_impulse_table"]);
    let error = vehicle_error("min_pulse = { value = 0.02", "min_pulse = { value = 0.0205");
    says(&error, &["`rcs.min_pulse`", "whole"]);
    let error = vehicle_error("min_pulse", "least_pulse");
    says(&error, &["`rcs.min_pulse`", "missing"]);
}

#[test]
fn inertia_that_no_body_has_is_refused() {
    let error = vehicle_error("[126.0, 126.1, 86.5]", "[126.0, 126.1, 286.5]");
    says(&error, &["bug.toml", "`mass.dry_inertia_b`", "286.5", "sum of the others"]);
    let products = "dry_products_b = { value = [200.0, 0.0, 0.0], unit = \"kg.m2\", source = \"x\", grade = \"assumed\" }";
    let error = vehicle_error("[mass]", &format!("[mass]\n{products}"));
    says(&error, &["`mass.dry_inertia_b`", "greater than 0"]);
    let error = vehicle_error("[63.43, 0.0, 0.0, 1.45, 136.5", "[63.43, 0.0, 0.0, 1.45, 336.5");
    says(&error, &["`mass.table`", "row 2", "sum of the others"]);
    let error = vehicle_error("[63.43, 0.0", "[93.43, 0.0");
    says(&error, &["`mass.table`", "93.43", "rise from 0", "85.5 kg"]);
}

#[test]
fn slosh_that_the_vehicle_cannot_have_is_refused() {
    let slosh = "[slosh]\nactive = \"on\"\n\n[guidance]";
    let (from, to) = (BUG.find("[slosh]").unwrap(), BUG.find("[engine]").unwrap());
    let without = Vehicle::parse(Path::new("bug.toml"), &(BUG[..from].to_owned() + &BUG[to..]));
    let vehicle = without.unwrap();
    let text = SCENARIO.replacen("[guidance]", slosh, 1);
    let error = Scenario::parse(Path::new("landing.toml"), &text, &vehicle).unwrap_err();
    says(&error.to_string(), &["landing.toml", "`slosh.active`", "BUG", "[slosh]"]);
    // Bobs so far out that no body could be the rest.
    let error = vehicle_error("[0.0507, 0.23, 1.6532]", "[0.0507, 3.23, 1.6532]");
    says(&error, &["`slosh.share`", "0.6", "sum of the others"]);
    let point = "[0.0507, 0.23, 1.6532], ";
    let error = vehicle_error(point, &point.repeat(3));
    says(&error, &["`slosh.hinges_b`", "4 points", "1 to 3"]);
}

#[test]
fn a_vehicle_s_number_needs_its_source_and_grade() {
    let error = vehicle_error("source = \"paper, Table III\", ", "");
    says(&error, &["`mass.dry_mass`", "no source"]);
    let error = vehicle_error("grade = \"documented\"", "grade = \"guessed\"");
    says(&error, &["`mass.dry_mass`", "grade", "assumed"]);
}

#[test]
fn broken_toml_and_a_missing_section_or_file_are_named() {
    says(&scenario_error("[site]", "[site"), &["landing.toml", "not valid TOML"]);
    says(&scenario_error("[site]\ngravity", "[sight]\ngravity"), &["`site`", "missing"]);
    let error = Scenario::load(Path::new("nowhere/x.toml")).unwrap_err().to_string();
    says(&error, &["nowhere/x.toml", "cannot be read"]);
}

#[test]
fn every_shipped_scenario_loads() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        Scenario::load(&entry.unwrap().path()).unwrap();
        count += 1;
    }
    assert!(count >= 5);
}

#[test]
fn every_shipped_vehicle_loads_and_a_range_holds_its_centre_of_mass() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/vehicles");
    let mut ranges = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let vehicle = Vehicle::load(&entry.unwrap().path()).unwrap();
        ranges += usize::from(vehicle.com_height_range_m.is_some());
    }
    assert!(ranges >= 6);
    let range = "com_height_range = { value = [0.5, 1.0], unit = \"m\", source = \"x\", grade = \"assumed\" }";
    let error = vehicle_error("[mass]", &format!("{range}\n[mass]"));
    says(&error, &["bug.toml", "`com_height_range`", "0.5 to 1 m", "mass.dry_com_b", "1.38"]);
}

#[test]
fn sensors_that_cannot_be_are_refused() {
    let with = |section: &str| scenario_error("[run]", &format!("{section}\n\n[run]"));
    let error = with("[sensors]\nnavigation = \"sextant\"");
    says(&error, &["`sensors.navigation`", "sextant", "perfect, sensors"]);
    let error = with("[sensors.altimeter]\ndrop_outs = { value = [[1.0, 0.0005]], unit = \"s\" }");
    says(&error, &["`sensors.altimeter.drop_outs`", "0.0005", "whole"]);
    let error = with("[sensors.imu]\ndrop_out_probability = { value = 1.5, unit = \"1\" }");
    says(&error, &["`sensors.imu.drop_out_probability`", "1.5", "[0, 1]"]);
    let error = vehicle_error("[0.3, 2000.0]", "[2000.0, 0.3]");
    says(&error, &["`sensors.altimeter.range`", "must rise"]);
    let error = vehicle_error("[-0.5, 0.0, 0.8660254]", "[0.0, 0.0, 0.0]");
    says(&error, &["`sensors.star_tracker.boresight_b`", "no direction"]);
    // A vehicle without sensors flies with perfect navigation only.
    let bare = BUG.split("[sensors.imu]").next().unwrap();
    let bare = Vehicle::parse(Path::new("bare.toml"), bare);
    let text = format!("{SCENARIO}\n[sensors]\nnavigation = \"sensors\"\n");
    let error = Scenario::parse(Path::new("landing.toml"), &text, &bare.unwrap()).unwrap_err();
    says(&error.to_string(), &["`sensors.navigation`", "BUG", "no section [sensors]"]);
}
