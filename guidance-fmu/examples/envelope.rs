//! Cold plans, on and off, from random states of the envelope, beside an oracle of feasibility: a table
//! on the output, its summary on the error output. Argument: number of states, 1000 if none.

#[path = "../tests/scvx_scenarios/mod.rs"]
mod scvx_scenarios;

use std::collections::BTreeMap;

use guidance_fmu::scvx::{Settings, solve};
use scvx_scenarios::envelope::{oracle, state, verdict};

fn main() {
    let states = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(1000);
    let mut classes = BTreeMap::new();
    let (mut answered, mut agreed) = (0, 0);
    println!(
        "state,r0_x_m,r0_y_m,r0_z_m,v0_x_m_s,v0_y_m_s,v0_z_m_s,mass_kg,planner,oracle,agree,structure,\
         conic_solves,propellant_kg,oracle_propellant_kg,lossless_gap,miss_m"
    );
    for index in 0..states {
        let problem = state(index);
        let (answer, reference) = (solve(&problem, &Settings::default()), oracle(&problem));
        let (planner, oracle) = (verdict(&answer), verdict(&reference));
        let agree = answer.is_ok() == reference.is_ok() && planner != "no answer";
        answered += u32::from(planner != "no answer");
        agreed += u32::from(agree);
        *classes.entry((planner, oracle)).or_insert(0) += 1;
        let (r, v) = (problem.r0_w, problem.v0_w);
        print!("{index},{:.3},{:.3},{:.3},{:.3},{:.3},{:.3},", r.x, r.y, r.z, v.x, v.y, v.z);
        print!("{:.3},{planner},{oracle},{}", problem.mass_kg, u8::from(agree));
        let oracle_kg =
            reference.map_or(String::new(), |plan| format!("{:.5}", plan.propellant_kg()));
        match answer {
            Ok(plan) => println!(
                ",{:?},{},{:.5},{oracle_kg},{:.1e},{:.1e}",
                plan.structure,
                plan.report.outer_iterations,
                plan.propellant_kg(),
                plan.report.lossless_gap,
                plan.report.miss_m,
            ),
            Err(error) => {
                println!(",,,,{oracle_kg},,");
                if !agree {
                    eprintln!("state {index}: {error}; oracle: {oracle}");
                }
            }
        }
    }
    eprintln!("{states} states: {answered} planned or declared infeasible, {agreed} as the oracle");
    for ((planner, oracle), count) in classes {
        eprintln!("  planner {planner:9} oracle {oracle:9} {count:5}");
    }
}
