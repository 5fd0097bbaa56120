//! `cargo bench -p cosim --bench plant [-- --json]`: how fast flight and contact are, how far off, and
//! against MuJoCo at the same error. One table in one run.

mod cases;
mod mujoco;
mod table;
mod timing;
mod work_precision;

use std::error::Error;
use std::path::Path;

use lander_models::Vehicle;
use lander_models::scenario::ContactEngine;
use mujoco::{Peer, Report};
use table::{FLIGHT, Row};
use timing::{FLIGHTS, Series};

/// Every time is the least of so many.
const ROUNDS: u32 = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let json = std::env::args().any(|word| word == "--json");
    let vehicles = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/vehicles");
    let vehicle_file = vehicles.join("bug.toml");
    let vehicle = Vehicle::load(&vehicle_file)?;
    let families = cases::families()?;
    let flown = families.first().and_then(|family| family.members.first()).ok_or("no touchdown")?;
    let flown = cases::model(&vehicle, flown, ContactEngine::Rapier, 1)?;

    // MuJoCo finds its errors meanwhile.
    let mut peer = Peer::start(&vehicle_file);
    let mut series = Vec::new();
    for family in &families {
        eprintln!("errors: {}", family.name);
        series.extend(Series::of_family(&vehicle, family)?);
    }
    let mut flights_us = FLIGHTS.map(|_| f64::INFINITY);
    for round in 1..=ROUNDS {
        // In turns, so that a busy machine slows both.
        for (least_us, (_, thrust_n)) in flights_us.iter_mut().zip(FLIGHTS) {
            *least_us = least_us.min(timing::flight_us(&vehicle, &flown, thrust_n)?);
        }
        peer = peer.and_then(|peer| peer.time(FLIGHT));
        for family in &families {
            eprintln!("times, {round} of {ROUNDS}: {}", family.name);
            for series in series.iter_mut().filter(|series| series.case == family.name) {
                series.time()?;
            }
            peer = peer.and_then(|peer| peer.time(&family.name));
        }
    }

    let peer = peer.and_then(Peer::report);
    let peers = peer.as_ref().map(Report::rows).unwrap_or_default();
    let ours = series.iter().map(Series::row);
    let flights = FLIGHTS.iter().zip(flights_us).map(|((name, _), us)| Row::flight(name, us));
    let mut rows: Vec<Row> = flights.chain(ours).collect();
    table::compare(&mut rows, &peers);
    rows.extend(peers);
    let order = |row: &Row| families.iter().position(|family| family.name == row.case);
    rows.sort_by_key(order);
    if json {
        let mujoco = peer.as_ref().map(|peer| &peer.version);
        let all = serde_json::json!({
            "mujoco": mujoco.ok(), "mujoco_missing": mujoco.err(), "rows": rows,
        });
        println!("{}", serde_json::to_string_pretty(&all)?);
    } else {
        table::print(&rows, &peer);
    }
    Ok(())
}
