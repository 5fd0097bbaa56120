//! Prints a table of docs/validation: `langley-matrix` or `instability-strip`.

#[allow(dead_code, unused_imports)] // Its tests are not for here.
#[path = "../tests/history.rs"]
mod history;

use history::common::arrival::Arrival;
use history::{MODEL_TIME_S, YAWS_DEG, langley_matrix, strip_case};
use lander_models::scenario::ContactEngine;

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("langley-matrix") => langley_matrix_table(),
        Some("instability-strip") => instability_strip_table(),
        _ => eprintln!("which table: langley-matrix or instability-strip?"),
    }
}

/// Prints docs/validation/langley-matrix.csv, by both contact engines.
fn langley_matrix_table() {
    println!("friction,yaw_deg,down_m_s,pitch_deg,across_m_s,rapier,strut");
    for friction in [0.4, 0.7, 1.0] {
        for (a, landing) in langley_matrix(friction, &YAWS_DEG, &[0.0, 0.75, 1.5, 2.25, 3.0]) {
            let Arrival { yaw_deg, down_m_s, pitch_deg, across_m_s, .. } = a;
            let strut = Arrival { engine: ContactEngine::Strut, ..a }.land(MODEL_TIME_S).letter();
            let rapier = landing.letter();
            println!("{friction},{yaw_deg},{down_m_s},{pitch_deg},{across_m_s},{rapier},{strut}");
        }
    }
}

/// Prints docs/validation/instability-strip.csv: a row per horizontal speed, a letter per vertical
/// speed.
fn instability_strip_table() {
    println!("engine,refinement,across_m_s,ends at 0.5 to 6 m/s down in steps of 0.5");
    for across_m_s in [2.5, 2.75, 3.0, 3.25] {
        for (engine, refinement) in
            [(ContactEngine::Rapier, 1), (ContactEngine::Rapier, 6), (ContactEngine::Strut, 1)]
        {
            let ends: String = (1..=12)
                .map(|n| {
                    let case = strip_case(across_m_s, 0.5 * f64::from(n));
                    Arrival { engine, refinement, ..case }.land(2.0).letter()
                })
                .collect();
            println!("{engine:?},{refinement},{across_m_s},{ends}");
        }
    }
}
