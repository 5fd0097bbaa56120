//! What the paper prints for BUG against what the vehicle file and the mass model give.
//! Tolerances: half of the last printed digit, unless a line says otherwise.

use std::path::Path;

use lander_models::frames::from_paper_axes;
use lander_models::quantity::{Limit, Section};
use lander_models::scenario::Disturbances;
use lander_models::vehicle::{G0_M_S2, Vehicle};

const BUG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/vehicles/bug.toml");
const PRINTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/paper/printed.toml");

fn printed() -> Section {
    Section::read(Path::new(PRINTED), true).unwrap()
}

fn number(key: &str, unit: &str) -> f64 {
    printed().number(key, unit, Limit::Any).unwrap()
}

fn column(key: &str, unit: &str) -> [f64; 3] {
    printed().vector(key, unit, Limit::Any).unwrap()
}

#[track_caller]
fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

#[test]
fn wet_and_dry_rows_are_reproduced_and_the_mid_row_within_0_3_percent() {
    let mass = Vehicle::load(Path::new(BUG)).unwrap().mass;
    let rows = [
        ("inertia_paper_xx_wet_mid_dry", 0),
        ("inertia_paper_yy_wet_mid_dry", 1),
        ("inertia_paper_zz_wet_mid_dry", 2),
    ];
    // The mid row's fill is not printed; its CoM height is, and it fixes the fill.
    let fill_at = |com_m: f64| {
        let (dry, fuel) = (&mass.dry, &mass.propellant);
        dry.mass_kg * (com_m - dry.com_b.z) / (fuel.com_b.z - com_m)
    };
    for (n, propellant_kg) in [85.5, fill_at(1.45), 0.0].into_iter().enumerate() {
        let now = mass.at(propellant_kg);
        close(now.com_b.z, column("com_height_wet_mid_dry", "m")[n], 0.005);
        // The mid row's is 5.6 mm on the line between two ends that are rounded to 5 mm each.
        let lateral_m = if n == 1 { 0.01 } else { 0.005 };
        close(now.com_b.x, column("com_lateral_wet_mid_dry", "m")[n], lateral_m);
        for (key, axis) in rows {
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            let axis_b = nalgebra::Vector3::from(from_paper_axes(unit));
            let expected = column(key, "kg.m2")[n];
            // Wet and dry to the printed digit; mid to the 0.3 % that `mass.rs` states: its fill is
            // known only through a height rounded to 5 mm, 7 % of the way from dry to wet.
            let tolerance = if n == 1 { 0.003 * expected } else { 0.05 };
            close(axis_b.dot(&(now.inertia_b * axis_b)), expected, tolerance);
        }
    }
}

#[test]
fn the_table_gives_the_printed_rows_and_keeps_near_two_bodies() {
    let text = std::fs::read_to_string(BUG).unwrap();
    let text = text.replacen("[mass]", "[mass]\nmodel = \"table\"", 1);
    let table = Vehicle::parse(Path::new(BUG), &text).unwrap().mass;
    let two_bodies = Vehicle::load(Path::new(BUG)).unwrap().mass;
    // "20 s" at Earth's weight and 225 s of specific impulse.
    let mid_kg = 259.5 * (-20.0_f64 / 225.0).exp() - 174.0;
    for (n, propellant_kg) in [85.5, mid_kg, 0.0].into_iter().enumerate() {
        let now = table.at(propellant_kg);
        // The mid row's fill is written to 0.01 kg: 2e-3 kg m² of its slope.
        close(now.com_b.z, column("com_height_wet_mid_dry", "m")[n], 1e-5);
        close(now.com_b.x, column("com_lateral_wet_mid_dry", "m")[n], 1e-5);
        for (key, axis) in [
            ("inertia_paper_xx_wet_mid_dry", 1),
            ("inertia_paper_yy_wet_mid_dry", 2),
            ("inertia_paper_zz_wet_mid_dry", 0),
        ] {
            close(now.inertia_b[(axis, axis)], column(key, "kg.m2")[n], 2e-3);
        }
        // Moments as in the test above; the two bodies' product of inertia, 0.7 % of a moment, has
        // no row in the paper.
        let expected = two_bodies.at(propellant_kg);
        for axis in 0..3 {
            let moment = expected.inertia_b[(axis, axis)];
            close(now.inertia_b[(axis, axis)], moment, if n == 1 { 0.003 * moment } else { 0.05 });
        }
        close(now.com_b.z, expected.com_b.z, 0.005);
    }
}

#[test]
fn derived_figures_agree_with_the_printed_ones() {
    let vehicle = Vehicle::load(Path::new(BUG)).unwrap();
    let (mass, engine) = (&vehicle.mass, &vehicle.engine);
    let diameter_m = number("footprint_diameter", "m");
    for foot_b in vehicle.gear.feet_b() {
        close(2.0 * foot_b.xy().norm(), diameter_m, 1e-6);
    }
    close(mass.wet_mass_kg(), number("wet_mass", "kg"), 0.05);
    close(vehicle.hull.top_height_m / diameter_m, number("aspect_ratio", "1"), 0.005);
    close(
        mass.propellant.capacity_kg / mass.wet_mass_kg(),
        number("propellant_fraction", "1"),
        0.005,
    );
    close(engine.thrust_max_n / engine.thrust_min_n, number("throttle_ratio", "1"), 0.05);
    let earth_weight_n = mass.wet_mass_kg() * G0_M_S2;
    close(engine.thrust_max_n / earth_weight_n, number("thrust_to_earth_weight", "1"), 0.05);
    let delta_v = engine.isp_s * G0_M_S2 * (mass.wet_mass_kg() / mass.dry.mass_kg).ln();
    close(delta_v, number("delta_v", "m/s"), 0.5);
    let wet = mass.at(mass.propellant.capacity_kg);
    let tip_deg = (0.5 * diameter_m).atan2(wet.com_b.z).to_degrees();
    close(tip_deg, number("tip_angle", "deg"), 0.5);
    let critical_deg = (mass.wet_mass_kg() * 1.625 / engine.thrust_min_n).acos().to_degrees();
    close(critical_deg, number("critical_tilt", "deg"), 0.5);
    let isp = printed().vector::<2>("specific_impulse_range", "s", Limit::Positive).unwrap();
    close(0.5 * (isp[0] + isp[1]), engine.isp_s, 1e-9);
    let tilt_deg = number("body_tilt_max", "deg") - number("guidance_tilt_max", "deg");
    close(tilt_deg, 5.0, 1e-9);
}

#[test]
fn both_tip_over_tables_follow_from_the_paper_s_formula() {
    // 0.01°: the paper truncates its last row of Table I (60.255 to 60.25).
    for [diameter_m, angle_deg] in printed().points::<2>("tip_by_footprint", "m, deg").unwrap() {
        close((0.5 * diameter_m).atan2(1.0).to_degrees(), angle_deg, 0.01);
    }
    for [height_m, angle_deg] in printed().points::<2>("tip_by_height", "m, deg").unwrap() {
        close(1.0_f64.atan2(height_m).to_degrees(), angle_deg, 0.01);
    }
}

#[test]
fn the_comparison_table_is_consistent_but_for_one_row() {
    let row = |key, unit| printed().vector::<7>(key, unit, Limit::Positive).unwrap();
    let (height, footprint) = (row("comparison_height", "m"), row("comparison_footprint", "m"));
    let ratio = row("comparison_aspect_ratio", "1");
    for n in 0..7 {
        close(height[n] / footprint[n], ratio[n], 0.005);
    }
    let four = |key, unit| printed().vector::<4>(key, unit, Limit::Positive).unwrap();
    let (mass, ratio) =
        (four("comparison_wet_mass", "kg"), four("comparison_thrust_to_weight", "1"));
    let thrust_kn = row("comparison_thrust_high", "kN");
    let computed = |n: usize| 1e3 * thrust_kn[n] / (mass[n] * G0_M_S2);
    // Thrusts are printed to 0.1 kN: 2.5 % of Colibri's.
    for (n, printed) in ratio.into_iter().enumerate().take(3) {
        close(computed(n), printed, 0.025 * printed);
    }
    // Morpheus: 20 kN and 1,050 kg give 1.94, not the printed 2.3, which needs 24 kN.
    close(computed(3), 1.94, 0.005);
    close(ratio[3], 2.3, 1e-9);
}

#[test]
fn the_disturbance_presets_are_the_paper_s_two_tables() {
    let (runs, engine) = (Disturbances::MONTE_CARLO_TABLE, Disturbances::ENGINE_TABLE);
    // Conversion of degrees rounds once.
    for (value, key, unit) in [
        (runs.initial_position_m, "mc_position", "m"),
        (runs.initial_velocity_m_s, "mc_velocity", "m/s"),
        (runs.mass, "mc_mass", "1"),
        (runs.thrust_bias, "mc_thrust_bias", "1"),
        (runs.thrust_noise, "mc_thrust_noise", "1"),
        (runs.pointing_bias_rad.to_degrees(), "mc_pointing_bias", "deg"),
        (runs.pointing_jitter_rad.to_degrees(), "mc_pointing_jitter", "deg"),
        (runs.gravity, "mc_gravity", "1"),
        (runs.specific_impulse, "mc_specific_impulse", "1"),
        (runs.acceleration_noise_m_s2, "mc_process_noise", "m/s2"),
        (engine.thrust_bias, "thrust_error_1_sigma", "1"),
        (engine.pointing_bias_rad.to_degrees(), "pointing_error_1_sigma", "deg"),
    ] {
        close(value, number(key, unit), 1e-15);
    }
}
