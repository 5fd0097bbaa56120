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

/// Turns of the planner and its peers. A machine that clocks itself down, or a neighbour, slows what runs a while.
const ROUNDS: usize = 2;

fn main() -> Result<(), Box<dyn Error>> {
    let json = std::env::args().any(|word| word == "--json");
    let cases = cases::all();
    let (mut plans, mut solves) = (Vec::new(), Vec::new());
    let mut peer = Err("no round was run".to_owned());
    for round in 1..=ROUNDS {
        let mut programs = Vec::new();
        for case in &cases {
            eprintln!("round {round} of {ROUNDS}, planner: {}", case.name());
            if case.mode == cases::Mode::OnOff {
                let program = ours::program(case)?;
                table::keep_fastest(&mut solves, [ours::solve(case, &program)?]);
                programs.push((case.name(), program));
            }
            table::keep_fastest(&mut plans, [ours::plan(case)?]);
        }
        eprintln!("round {round} of {ROUNDS}, CVXPY, QOCOGEN");
        peer = peer::run(&cases, &programs);
        let Ok(peer) = &peer else { break };
        table::keep_fastest(&mut plans, peer.descents.iter().flat_map(Plan::of_peer));
        let generated = programs.iter().zip(&peer.programs).flat_map(Solve::of_peer);
        table::keep_fastest(&mut solves, generated);
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
