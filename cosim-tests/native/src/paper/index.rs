//! Where each of the paper's tables and figures stands in the report, and which can't.

use crate::report::Table;

const ROWS: [(&str, &str); 16] = [
    ("Table I, tip-over against footprint", "Static tip-over"),
    ("Table II, tip-over against height", "Static tip-over"),
    ("Table III, BUG's parameters", "Vehicle parameters"),
    ("Table IV, centre of mass and inertia", "Centre of mass and inertia"),
    ("Table V, comparison of vehicles", "Vehicle comparison"),
    ("Table VI, engine", "Engine"),
    ("Table VII, convexification", "Convexification"),
    ("Table VIII, perturbations", "Perturbations"),
    ("Fig. 1, the vehicle", "Vehicle parameters: drawn from the vehicle file"),
    ("Fig. 2 and 3, engine and hot fire", "none: photographs"),
    (
        "Fig. 4, chamber pressure",
        "none: a test record, of which no number is printed but less than 1.5 % RMS",
    ),
    ("Fig. 5, lossless convexification", "Convexification: with planned thrusts in it"),
    ("Fig. 6, hop over the tilt limit", "Tilt sweep; Hop trajectories"),
    ("Fig. 7, closed loop against open loop", "Monte Carlo"),
    ("ΔV, equation (1)", "ΔV"),
    ("θ_crit, equation (eq:feasibility)", "Critical tilt; Feasible speeds"),
];

pub fn table() -> Table {
    Table {
        name: "contents".to_owned(),
        caption: "The paper's tables, figures and results, and where they stand here. Beyond \
                  the paper: dynamic tip-over, contact state and outcomes of the Monte Carlo, \
                  replanning cadence."
            .to_owned(),
        header: ["in the paper", "here"].map(str::to_owned).to_vec(),
        rows: ROWS.map(|(paper, here)| vec![paper.to_owned(), here.to_owned()]).to_vec(),
    }
}
