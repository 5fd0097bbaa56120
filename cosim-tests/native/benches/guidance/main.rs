//! `cargo bench -p cosim --bench guidance [-- --json]`: how fast the planner is and how near to the
//! optimum, beside CVXPY with Clarabel on the same problem and generated C on the same conic program.
//! Then the planner's times over its envelope. Three tables in one run, on one core.

mod cases;
mod ours;
mod peer;
mod states;
mod table;

use std::error::Error;

use table::{Plan, Solve, Tables};

fn main() -> Result<(), Box<dyn Error>> {
    let json = std::env::args().any(|word| word == "--json");
    let cases = cases::all();
    let mut plans = Vec::new();
    let mut programs = Vec::new();
    let mut solves = Vec::new();
    for case in &cases {
        eprintln!("planner: {}", case.name());
        let plan = ours::plan(case)?;
        if case.mode == cases::Mode::OnOff {
            let program = ours::program(case)?;
            solves.push(ours::solve(case, &program)?);
            programs.push((case.name(), program));
        }
        plans.push(plan);
    }
    eprintln!("CVXPY, QOCOGEN");
    let peer = peer::run(&cases, &programs);
    if let Ok(peer) = &peer {
        plans.extend(peer.descents.iter().flat_map(Plan::of_peer));
        solves.extend(programs.iter().zip(&peer.programs).flat_map(Solve::of_peer));
    }
    eprintln!("planner: states of the envelope");
    let mut tables = Tables { plans, solves, states: states::run()? };
    tables.compare();
    if json {
        println!("{}", serde_json::to_string_pretty(&tables)?);
    } else {
        tables.print(&peer);
    }
    Ok(())
}
