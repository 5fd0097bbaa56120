//! `cargo bench -p cosim --bench plant [-- --json]`: how fast flight and contact are, how far off, and
//! against MuJoCo. One table in one run, on one core.

mod cases;
mod mujoco;
mod table;
mod timing;

use std::error::Error;
use std::path::Path;

use lander_models::Vehicle;
use lander_models::scenario::ContactEngine;
use table::Row;

const ENGINES: [(&str, ContactEngine); 2] =
    [("rapier", ContactEngine::Rapier), ("strut", ContactEngine::Strut)];

fn flight_row(engine: &str, step_us: f64) -> Row {
    Row {
        engine: engine.to_owned(),
        case: "flight".to_owned(),
        step_ms: 1.0,
        step_us,
        to_rest_ms: None,
        place_error_m: None,
        tilt_error_deg: None,
        stroke_error_percent: None,
        ratio_to_mujoco: None,
    }
}

fn peer_rows(peer: &mujoco::Peer) -> Vec<Row> {
    let contact = peer.rows.iter().filter_map(|row| {
        let end = row.end.as_ref()?;
        Some(Row {
            engine: "mujoco".to_owned(),
            case: row.name.clone(),
            step_ms: row.step_ms,
            step_us: end.step_us_min,
            to_rest_ms: Some(1e-3 * end.step_us_min * f64::from(end.steps)),
            place_error_m: Some(end.position_error_m),
            tilt_error_deg: Some(end.tilt_error_deg),
            stroke_error_percent: Some(100.0 * end.peak_stroke_error.abs()),
            ratio_to_mujoco: None,
        })
    });
    std::iter::once(flight_row("mujoco", peer.flight_us)).chain(contact).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let json = std::env::args().any(|word| word == "--json");
    let vehicles = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/vehicles");
    let vehicle_file = vehicles.join("bug.toml");
    let vehicle = Vehicle::load(&vehicle_file)?;
    let mut rows = vec![flight_row("flight", timing::flight_us(&vehicle)?)];
    for (name, engine) in ENGINES {
        for case in &cases::CASES {
            eprintln!("{name}: {}", case.name);
            rows.push(timing::touchdown(&vehicle, case, engine, name)?);
        }
    }
    eprintln!("MuJoCo");
    let peer = mujoco::run(&vehicle_file);
    let peers = peer.as_ref().map(peer_rows).unwrap_or_default();
    table::compare(&mut rows, &peers);
    rows.extend(peers);
    if json {
        println!("{}", serde_json::to_string_pretty(&rows)?);
    } else {
        table::print(&rows, &peer.map(|peer| peer.version));
    }
    Ok(())
}
