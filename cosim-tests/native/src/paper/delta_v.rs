//! Equation (1): the velocity that the propellant gives, and what it is spent on.

use lander_models::vehicle::G0_M_S2;

use super::Error;
use super::Inputs;
use super::chapter::{Chapter, cell};
use super::problems::{Start, plan, problem};

/// # Errors
/// A printed number that is missing, a plan that is not found.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let Inputs { printed, bug, .. } = inputs;
    let printed_m_s = printed.number("delta_v", "m/s")?;
    let paper_g0 = printed.number("delta_v_gravity", "m/s2")?;
    let (wet_kg, dry_kg) = (printed.number("wet_mass", "kg")?, printed.number("dry_mass", "kg")?);
    let middle_s = printed.number("delta_v_specific_impulse", "s")?;
    let [low_s, high_s] = printed.row::<2>("specific_impulse_range", "s")?;
    let rows = [low_s, middle_s, high_s].map(|isp_s| {
        let formula = isp_s * paper_g0 * libm::log(wet_kg / dry_kg);
        let kit = isp_s * G0_M_S2 * libm::log(bug.mass.wet_mass_kg() / bug.mass.dry.mass_kg);
        let is_printed =
            if isp_s == middle_s { cell(printed_m_s, 0) } else { "not printed".to_owned() };
        vec![
            cell(isp_s, 0),
            is_printed,
            cell(formula, 2),
            cell(kit, 2),
            cell(kit / middle_s / G0_M_S2 / libm::log(wet_kg / dry_kg) * 100.0 - 100.0, 1),
        ]
    });
    let mut chapter = Chapter::new("ΔV: equation (1)");
    chapter.table(
        "delta-v",
        "Equation (1), section III-C, over the range of specific impulse that Table VI prints.",
        &[
            "specific impulse, s",
            "printed, m/s",
            "paper's formula, g0 = 9.81, m/s",
            "this kit, g0 = 9.80665, m/s",
            "off the middle, %",
        ],
        rows.to_vec(),
    );
    chapter.differs(
        "g0 by 0.03 %; and one figure stands for a range of 118 m/s, since the specific impulse \
         is known to ±7 % only.",
    );
    let mut spent = Vec::new();
    for start in [Start::Descent, Start::Hop] {
        let problem = problem(start, bug, printed)?;
        let plan = plan(&problem).map_err(|source| Error::Plan { what: start.name(), source })?;
        let used_kg = plan.propellant_kg();
        let delta_v =
            problem.isp_s * G0_M_S2 * libm::log(problem.mass_kg / (problem.mass_kg - used_kg));
        let budget = problem.isp_s * G0_M_S2 * libm::log(problem.mass_kg / problem.dry_mass_kg);
        spent.push(vec![
            start.name().to_owned(),
            cell(plan.duration_s(), 1),
            cell(used_kg, 3),
            cell(delta_v, 1),
            cell(100.0 * delta_v / budget, 1),
        ]);
    }
    chapter.table(
        "delta-v-spent",
        "What minimum-fuel flights of this kit's scenarios take of it (29°, engine on and off, \
         to rest at the target).",
        &["flight", "duration, s", "propellant, kg", "ΔV, m/s", "of the budget, %"],
        spent,
    );
    Ok(chapter)
}
