//! Truth and guidance together, from starts that nobody tuned for.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use cosim::layout::Layout;
use cosim::master::Master;
use cosim::schedule::{Pair, Schedule};
use guidance_fmu::{Guidance, Phase};
use lander_models::signals::{GUIDANCE, Interface, TRUTH};
use lander_models::{ModelError, Outcome, Scenario, Settings};
use truth_model::TruthModel;

const INTERFACES: Pair<&Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models")
}

/// The default landing from another start, as a scenario file of its own.
fn scenario(name: &str, position_w: [f64; 3], velocity_w: [f64; 3], propellant_kg: f64) -> PathBuf {
    let text = fs::read_to_string(models().join("scenarios/landing.toml")).unwrap();
    let text = text
        .replace("../vehicles", &models().join("vehicles").display().to_string())
        .replace("[300.0, 100.0, 500.0]", &format!("{position_w:?}"))
        .replace("[-15.0, -5.0, -25.0]", &format!("{velocity_w:?}"))
        .replace("value = 85.5", &format!("value = {propellant_kg:?}"));
    let file = std::env::temp_dir().join(format!("closed-loop-{}-{name}.toml", std::process::id()));
    fs::write(&file, text).unwrap();
    file
}

/// What a flight came to.
struct Flown {
    last: Vec<f64>,
    layout: Layout,
    tilt_max_deg: f64,
    phases: Vec<f64>,
    forbidden_thrust: bool,
}

impl Flown {
    fn value(&self, name: &str) -> f64 {
        self.layout.scalar(&self.last, name)
    }

    fn outcome(&self) -> Outcome {
        Outcome::from_code(self.value("outcome")).unwrap()
    }
}

fn fly(scenario_file: PathBuf) -> Flown {
    let schedule = Schedule::load(&INTERFACES).unwrap();
    let layout = Layout::new(&schedule, &INTERFACES);
    let (scenario, _) = Scenario::load(&scenario_file).unwrap();
    let settings = Settings { scenario_file: scenario_file.clone() };
    let mut master = Master::new::<TruthModel, Guidance>(&schedule, &settings).unwrap();
    let (mut last, mut phases) = (Vec::new(), Vec::new());
    let (mut tilt_max_deg, mut forbidden_thrust) = (0.0_f64, false);
    master
        .run::<ModelError>(scenario.stop_time, |row| {
            tilt_max_deg = tilt_max_deg.max(layout.scalar(row, "tilt_deg"));
            let command_n = layout.scalar(row, "thrust_command_n");
            forbidden_thrust |= command_n != 0.0 && !(800.0..=5200.0).contains(&command_n);
            phases.push(layout.scalar(row, "phase"));
            last = row.to_vec();
            Ok(ControlFlow::Continue(()))
        })
        .unwrap();
    phases.dedup();
    fs::remove_file(scenario_file).unwrap();
    Flown { last, layout, tilt_max_deg, phases, forbidden_thrust }
}

#[test]
fn dispersed_starts_all_land_within_the_limits_of_the_default_landing() {
    // Knuth's MMIX generator: any spread-out numbers do.
    let mut seed = 2026_u64;
    let mut uniform = |half_width: f64| {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * half_width
    };
    for n in 0..10 {
        // Three times the paper's 10 m and 2 m/s (Table VIII) on each axis.
        let position_w = [300.0, 100.0, 500.0].map(|x| x + uniform(30.0));
        let velocity_w = [-15.0, -5.0, -25.0].map(|v| v + uniform(6.0));
        let flown = fly(scenario(&format!("dispersed-{n}"), position_w, velocity_w, 85.5));
        let start = format!("from {position_w:?} m at {velocity_w:?} m/s");
        // The default landing's own limits: the project's acceptance list.
        assert_eq!(flown.outcome(), Outcome::Landed, "{start}");
        assert!(flown.value("contact_speed_down_m_s") <= 2.0, "{start}");
        assert!(flown.value("contact_speed_across_m_s") <= 0.5, "{start}");
        assert!(flown.value("position_error_m") <= 5.0, "{start}");
        assert!(flown.tilt_max_deg <= 34.0 && !flown.forbidden_thrust, "{start}");
    }
}

#[test]
fn with_too_little_propellant_for_the_target_it_lands_short_of_it() {
    let flown = fly(scenario("short", [300.0, 100.0, 500.0], [-15.0, -5.0, -25.0], 5.0));
    // A plan to land anywhere, not the law without a plan.
    assert!(!flown.phases.contains(&f64::from(Phase::FallBack as u8)), "{:?}", flown.phases);
    assert_eq!(flown.outcome(), Outcome::Landed);
    assert!(flown.value("position_error_m") > 50.0);
    assert!(!flown.forbidden_thrust);
}

#[test]
fn low_and_fast_over_the_target_it_climbs_and_lands() {
    let flown = fly(scenario("low", [0.0, 0.0, 30.0], [6.0, 0.0, -10.0], 85.5));
    assert_eq!(flown.outcome(), Outcome::Landed);
    assert!(flown.value("contact_speed_down_m_s") <= 2.0);
}

#[test]
fn a_landing_goes_through_its_phases_in_order() {
    let flown = fly(scenario("order", [300.0, 100.0, 500.0], [-15.0, -5.0, -25.0], 85.5));
    use Phase::{Burn, Coast, CutOff, Standby, Terminal};
    let expected = [Standby, Coast, Burn, Coast, Burn, Terminal, CutOff].map(|p| p as u8);
    assert_eq!(
        flown.phases,
        expected.map(f64::from),
        "the minimum-fuel flight is burn, coast, burn"
    );
}
