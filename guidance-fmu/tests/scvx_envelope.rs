//! The first states of the envelope campaign, and the residuals of every plan in it.
//! `docs/validation/envelope.csv` holds all 1,000; the example `envelope` makes it.

mod scvx_scenarios;

use claims::{Bound, Claim};
use guidance_fmu::scvx::{Plan, Problem, Settings, Terminal, solve};
use scvx_scenarios::envelope::{oracle, state, verdict};

const STATES: u64 = 60;

/// One row of a column of the report.
fn residual(
    id: &str,
    claim: &str,
    (limit, unit): (f64, &str),
    origin: &str,
    plans: &[Plan],
    value: impl Fn(&Plan) -> f64,
) {
    Claim {
        id,
        section: "Guidance",
        claim,
        reference: "every accepted plan of 60 random states of the envelope",
        unit,
        bound: Bound::AtMost(limit),
        origin,
        noise: 0.0,
    }
    .holds_for(plans.iter().map(value));
}

fn delta_v_m_s(plan: &Plan) -> f64 {
    let held = plan.nodes.windows(2).zip(&plan.u_w);
    held.map(|(ends, u_w)| u_w.norm() * (ends[1].t_s - ends[0].t_s)).sum()
}

#[test]
fn the_envelope_is_planned_or_declared_infeasible() {
    let mut plans = Vec::new();
    let mut disagreements = Vec::new();
    for index in 0..STATES {
        let problem = state(index);
        let (answer, reference) = (solve(&problem, &Settings::default()), oracle(&problem));
        let (planner, oracle) = (verdict(&answer), verdict(&reference));
        assert_ne!(planner, "no answer", "state {index}: {answer:?}");
        if answer.is_ok() != reference.is_ok() {
            disagreements.push(format!("{index}: {planner}, oracle {oracle}"));
        }
        if answer.is_err() {
            // The end of the fall-back chain: nothing refused is left without a plan.
            let softest = Problem { terminal: Terminal::SoftestImpact, ..problem };
            let plan = solve(&softest, &Settings::default());
            assert!(plan.is_ok(), "state {index}: {plan:?}");
        }
        plans.extend(answer);
    }
    // 99 % of 60 states: not one may differ.
    assert!(disagreements.is_empty(), "{disagreements:?}");
    assert!(plans.len() as u64 > STATES / 2 && (plans.len() as u64) < STATES, "{}", plans.len());

    let required = "required of every accepted plan";
    residual(
        "plan-miss",
        "miss of a plan by re-propagation",
        (1.0, "mm"),
        required,
        &plans,
        |plan| 1e3 * plan.report.miss_m,
    );
    residual("plan-gap", "lossless gap (σ − ‖u‖)/σ", (1e-4, ""), required, &plans, |plan| {
        plan.report.lossless_gap
    });
    let origin = "the thrust excursion that converges, 1e-5 of 5200 N";
    residual(
        "plan-thrust",
        "thrust of a burn out of its bounds, at the masses flown",
        (0.052, "N"),
        origin,
        &plans,
        |plan| plan.report.thrust_violation_n,
    );
    let origin = "fuel flat to 2e-5";
    residual(
        "plan-restoration",
        "share of the Δv that brings the last linearised step to its bounds and target",
        (2e-5, ""),
        origin,
        &plans,
        |plan| plan.report.last_step.restoration_m_s.abs() / delta_v_m_s(plan),
    );
    let origin = "Runge-Kutta's own error";
    residual("plan-end-mass", "end mass by re-propagation", (1e-6, "kg"), origin, &plans, |plan| {
        plan.report.mass_error_kg
    });
    let origin = "the thrust excursion that converges, 1e-5 of 5200 N";
    residual(
        "plan-dead-zone",
        "thrust of a burn below its floor",
        (0.052, "N"),
        origin,
        &plans,
        |plan| plan.report.dead_zone_n,
    );
    assert!(plans.iter().all(|plan| plan.report.propellant_left_kg >= 0.0));
}
