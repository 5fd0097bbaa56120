//! The page of a campaign.

use lander_models::scenario::Disturbances;

use super::{Page, figures, percent};
use crate::study::data::Data;
use crate::study::parameter::case_unit;
use crate::study::summary::{Correlation, Summary, short};
use crate::study::{Kind, Study, StudyError};
use crate::touchdowns::COLUMNS;

/// Results whose sensitivity is shown.
const SENSITIVE: [&str; 3] = ["stability_distance_m", "position_error_m", "peak_stroke_m"];
/// Bars of a figure.
const STRONGEST: usize = 8;

pub fn page(study: &Study, data: &Data, summary: &Summary) -> Result<Page, StudyError> {
    let mut page = Page::new(&format!("Study {}", study.name));
    let what = match study.kind {
        Kind::Landing => {
            "landings in a closed loop of truth and guidance, contact to rest included"
        }
        Kind::Touchdown => "touchdowns from a state at contact to rest, engine off",
    };
    page.paragraph(&format!("{} {what}.", summary.runs));
    if let Some(layout) = study.sobol_layout() {
        page.paragraph(&format!(
            "They are laid out for Sobol' indices, {} to a row. Tables of outcomes and results and the rank \
             correlations take the first two of each row, which are independent.",
            layout.matrices
        ));
    }
    inputs(&mut page, study);
    page.heading("Outcomes");
    outcomes(&mut page, summary);
    page.figure(figures::outcomes(&summary.groups));
    page.heading("Results");
    results(&mut page, summary);
    for figure in [figures::distribution_functions(data)?, figures::footprint(data)?] {
        figure.into_iter().for_each(|figure| page.figure(figure));
    }
    sensitivity(&mut page, summary);
    page.heading("Again");
    page.paragraph(
        "The same bytes come from the same study file, scenario, vehicle and version, on any number of threads:",
    );
    page.code(&format!(
        "lander campaign {0}.toml\nlander campaign {0}.toml --run 0 --log run.mcap     # one run alone, with its log",
        study.name
    ));
    worst(&mut page, data)?;
    page.origin(study);
    page.study_file(study);
    Ok(page)
}

pub fn inputs(page: &mut Page, study: &Study) {
    page.heading("What was drawn");
    let row = |parameter: &crate::study::parameter::Parameter| {
        let known = if parameter.known { "truth and guidance" } else { "truth" };
        let distribution = parameter.distribution.to_string();
        let key = format!("{}{}", parameter.key, parameter.how());
        vec![key, distribution, known.to_owned()]
    };
    let of_case = study.case.iter().map(|(index, value)| {
        let column = COLUMNS[*index].0;
        let value = format!("is {value} {}", case_unit(column));
        vec![format!("case.{column}"), value, "truth".to_owned()]
    });
    let rows: Vec<_> = of_case.chain(study.parameters.iter().map(row)).collect();
    if !rows.is_empty() {
        page.table("t", &["parameter", "distribution", "known to"], &rows);
    }
    let disturbances = study.run(0).map(|run| run.truth.scenario.disturbances);
    match disturbances.map(|disturbances| of_scenario(&disturbances)) {
        Ok(rows) if study.kind == Kind::Landing && !rows.is_empty() => {
            let header = ["drawn by each run's seed", "one standard deviation", "unit"];
            page.table("t", &header, &rows);
        }
        _ if rows.is_empty() => page.paragraph("Nothing but the noise of each run's seed."),
        _ => {}
    }
    let modes: Vec<_> = study
        .failures
        .modes
        .iter()
        .map(|mode| {
            let numbers = mode.parameters.iter().map(|p| {
                let key = p.key.rsplit('.').next().unwrap_or(&p.key);
                format!("{key} {}", p.distribution)
            });
            let probability = match study.failures.forced {
                true => "forced in turn".to_owned(),
                false => format!("{:.3} %", 100.0 * mode.probability),
            };
            vec![mode.name.clone(), probability, numbers.collect::<Vec<_>>().join("; ")]
        })
        .collect();
    if !modes.is_empty() {
        page.table("t", &["failure mode", "probability a run", "its numbers"], &modes);
    }
}

/// Errors that the scenario itself draws: name, one standard deviation, unit.
fn of_scenario(d: &Disturbances) -> Vec<Vec<String>> {
    let rows = [
        ("initial position, an axis", d.initial_position_m, "m"),
        ("initial velocity, an axis", d.initial_velocity_m_s, "m/s"),
        ("mass", 100.0 * d.mass, "%"),
        ("thrust, a run", 100.0 * d.thrust_bias, "%"),
        ("thrust, noise", 100.0 * d.thrust_noise, "%"),
        ("thrust direction, an axis, a run", d.pointing_bias_rad.to_degrees(), "deg"),
        ("thrust direction, an axis, noise", d.pointing_jitter_rad.to_degrees(), "deg"),
        ("gravity", 100.0 * d.gravity, "%"),
        ("specific impulse", 100.0 * d.specific_impulse, "%"),
        ("acceleration, an axis, noise", d.acceleration_noise_m_s2, "m/s2"),
    ];
    let drawn = rows.into_iter().filter(|(_, deviation, _)| *deviation > 0.0);
    drawn
        .map(|(name, deviation, unit)| vec![name.to_owned(), short(deviation), unit.to_owned()])
        .collect()
}

fn outcomes(page: &mut Page, summary: &Summary) {
    let rows: Vec<_> = summary
        .groups
        .iter()
        .flat_map(|group| group.outcomes.iter().map(move |share| (group, share)))
        .map(|(group, share)| {
            let [value, bounds] = percent([share.share, share.share_low, share.share_high]);
            let runs = format!("{} of {}", share.runs, group.runs);
            vec![group.failures.clone(), share.outcome.clone(), runs, value, bounds]
        })
        .collect();
    page.table("", &["failures", "outcome", "runs", "share", "95 % bounds"], &rows);
    page.paragraph(
        "Bounds: Clopper and Pearson, two-sided. An outcome that was never met has an upper bound all the same.",
    );
}

fn results(page: &mut Page, summary: &Summary) {
    let rows: Vec<_> = summary
        .results
        .iter()
        .map(|result| {
            let mut cells = vec![result.result.clone(), result.measured.to_string()];
            for share in [0.01, 0.5, 0.99] {
                cells.push(result.at(share).map_or(String::new(), |bounded| {
                    format!(
                        "{} ({} to {})",
                        short(bounded.value),
                        short(bounded.low),
                        short(bounded.high)
                    )
                }));
            }
            cells
        })
        .collect();
    page.table("", &["result", "measured in", "1 %", "median", "99 %"], &rows);
    page.paragraph("Quantiles by rank, in brackets their 95 % bootstrap bounds.");
}

fn sensitivity(page: &mut Page, summary: &Summary) {
    for result in SENSITIVE {
        let of_result: Vec<&Correlation> =
            summary.sensitivity.iter().filter(|c| c.result == result).take(STRONGEST).collect();
        if !of_result.is_empty() {
            page.figure(figures::sensitivity(result, &of_result));
        }
    }
    let rows: Vec<_> = summary
        .sobol
        .iter()
        .filter(|index| SENSITIVE.contains(&index.result.as_str()))
        .map(|s| {
            let cell = |b: crate::statistics::quantile::Bounded| {
                format!("{:.2} ({:.2} to {:.2})", b.value, b.low, b.high)
            };
            let (first, total) = (cell(s.index.first), cell(s.index.total));
            vec![s.result.clone(), s.parameter.clone(), first, total]
        })
        .collect();
    if !rows.is_empty() {
        page.table("", &["result", "parameter", "Sobol' index alone", "with others"], &rows);
    }
}

/// Runs to look at first.
fn worst(page: &mut Page, data: &Data) -> Result<(), StudyError> {
    let extreme = |name: &str, least: bool| {
        let Some(values) = data.column(name)? else { return Ok(None) };
        let measured = values.iter().enumerate().filter(|(_, value)| value.is_finite());
        let order = |a: &(usize, &f64), b: &(usize, &f64)| a.1.total_cmp(b.1);
        let found = if least { measured.min_by(order) } else { measured.max_by(order) };
        let which = if least { "least" } else { "greatest" };
        let cells = |(run, value): (usize, &f64)| {
            let outcome = data.outcomes.get(run).to_owned();
            vec![format!("{which} {name}"), short(*value), run.to_string(), outcome]
        };
        Ok::<_, StudyError>(found.map(cells))
    };
    let mut rows = Vec::new();
    rows.extend(extreme("stability_distance_m", true)?);
    for name in ["position_error_m", "contact_speed_down_m_s", "peak_stroke_m"] {
        rows.extend(extreme(name, false)?);
    }
    page.table("", &["the run with the", "value", "is run", "outcome"], &rows);
    Ok(())
}
