//! The page of a design study.

use super::design_figures as figures;
use super::{Page, Table, campaign};
use crate::study::designs::{DesignSummary, Difference, OfDesign, p_words};
use crate::study::distribution::Value;
use crate::study::summary::short;
use crate::study::{Kind, Study};

pub fn page(study: &Study, summary: &DesignSummary) -> Page {
    let mut page = Page::new(&format!("Design study {}", study.name));
    let what = match study.kind {
        Kind::Landing => "landings in a closed loop of truth and guidance, which knows the design",
        Kind::Touchdown => "touchdowns from a state at contact to rest, engine off",
    };
    page.paragraph(&format!(
        "{} {what}, at each of {} designs. All designs fly the same draws, so two of them differ by the design alone, \
         and the difference of their shares is surer than either share. The baseline is {}.",
        summary.runs_each,
        summary.designs.len(),
        study.designs().name(summary.baseline as u64)
    ));
    designs(&mut page, study);
    page.heading("Outcomes");
    for figure in figures::outcomes(study, summary) {
        page.figure(figure);
    }
    steps(&mut page, study, summary);
    page.heading("Margins and loads");
    for figure in figures::results(study, summary) {
        page.figure(figure);
    }
    if summary.designs.iter().any(|design| design.criteria.is_some()) {
        page.heading("Criteria that simulate nothing");
        page.paragraph(
            "Each draw was also judged by the static tip angle over an edge (T.16), which knows no velocity, and by the speed \
             towards an edge at which held pads tip a rigid vehicle that stands on the slope (T.24), an energy criterion. Pads \
             that slide and legs that crush take up energy: T.24 calls tip-overs that do not happen. It knows no lean, no rate \
             and no leg that touches first, so it misses others.",
        );
        page.filed_table(criteria(study, summary));
    }
    campaign::inputs(&mut page, study);
    page.heading("All numbers");
    page.paragraph(
        "Shares: Clopper and Pearson's bounds, two-sided, 95 %. Differences to the baseline: bounds by Newcombe's method 10 \
         for paired shares, 95 % each, not of all designs at once; p: McNemar's exact test. Quantiles by rank with bootstrap \
         bounds; their difference is the median of the differences draw by draw.",
    );
    page.folded_table("Outcomes of every design", outcomes(study, summary));
    page.folded_table("Margins and loads of every design", results(study, summary));
    page.heading("Again");
    page.paragraph(
        "The same bytes come from the same study file, scenario, vehicle and build, on any number of threads:",
    );
    let first = summary.baseline;
    page.code(&format!(
        "lander design {0}.toml\nlander design {0}.toml --run {first} --log run.mcap     # one run alone, with its log",
        study.name
    ));
    page.origin(study);
    page.study_file(study);
    page
}

fn designs(page: &mut Page, study: &Study) {
    let words =
        |values: &[Value]| values.iter().map(Value::to_string).collect::<Vec<_>>().join(", ");
    let rows: Vec<_> = study
        .axes
        .iter()
        .map(|axis| {
            let moved = axis.parameters.iter().map(|m| match m.values == axis.values {
                true => format!("{}{}", m.parameter.key, m.parameter.how()),
                false => format!("{}{}: {}", m.parameter.key, m.parameter.how(), words(&m.values)),
            });
            let moved: Vec<String> = moved.collect();
            let baseline = axis.values[axis.baseline].to_string();
            vec![axis.label(), words(&axis.values), baseline, moved.join("; ")]
        })
        .collect();
    page.table("t", &["axis", "values", "baseline", "moves"], &rows);
}

/// Designs that differ from the baseline along one axis.
fn steps(page: &mut Page, study: &Study, summary: &DesignSummary) {
    let all = study.designs();
    let baseline: Vec<usize> =
        all.places(summary.baseline as u64).map(|(_, place)| place).collect();
    let moved = |design: u64| {
        let places = all.places(design).zip(&baseline);
        let moved = places.filter(|((_, place), base)| place != *base);
        moved
            .map(|((axis, place), _)| format!("{} {}", axis.label(), axis.values[place]))
            .collect::<Vec<_>>()
    };
    let mut rows: Vec<(f64, Vec<String>)> = Vec::new();
    for (number, design) in summary.designs.iter().enumerate() {
        let moved = moved(number as u64);
        let (Some(tipped), [change]) = (design.outcome("tipped"), moved.as_slice()) else {
            continue;
        };
        let Some(Difference { bounded, p_value, pairs }) = tipped.difference else { continue };
        let points =
            [bounded.value, bounded.low, bounded.high].map(|d| format!("{:+.2}", 100.0 * d));
        let [value, low, high] = points;
        rows.push((
            bounded.value,
            vec![
                change.clone(),
                format!("{:.2}", 100.0 * tipped.share.share),
                format!("{value} ({low} to {high})"),
                format!("{} / {}", pairs.only_second, pairs.only_first),
                p_words(p_value),
            ],
        ));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rows: Vec<_> = rows.into_iter().map(|(_, cells)| cells).collect();
    page.paragraph("One change at a time, what helps most against tip-over first:");
    page.filed_table(Table {
        name: "changes".to_owned(),
        caption: "Tip-over of the designs that differ from the baseline along one axis. Difference in percentage points with \
                  95 % bounds."
            .to_owned(),
        header: ["change", "tipped, %", "difference", "draws saved / lost", "p"].map(str::to_owned).to_vec(),
        rows,
    });
}

fn header(study: &Study, more: &[&str]) -> Vec<String> {
    let axes = study.axes.iter().map(crate::study::axis::Axis::label);
    axes.chain(more.iter().map(|word| (*word).to_owned())).collect()
}

fn cells(design: &OfDesign, more: Vec<String>) -> Vec<String> {
    design.values.iter().map(Value::to_string).chain(more).collect()
}

fn outcomes(study: &Study, summary: &DesignSummary) -> Table {
    let percent = |share: f64| format!("{:.2}", 100.0 * share);
    let mut rows = Vec::new();
    for design in &summary.designs {
        for outcome in &design.outcomes {
            let share = &outcome.share;
            let mut more = vec![share.outcome.clone(), share.runs.to_string()];
            more.extend([share.share, share.share_low, share.share_high].map(percent));
            match outcome.difference {
                None => more.extend(["", "", "", ""].map(str::to_owned)),
                Some(Difference { bounded: b, p_value, .. }) => {
                    more.extend([b.value, b.low, b.high].map(percent));
                    more.push(p_words(p_value));
                }
            }
            rows.push(cells(design, more));
        }
    }
    Table {
        name: "outcomes".to_owned(),
        caption: format!(
            "Of {} runs each, shares in per cent, differences in percentage points.",
            summary.runs_each
        ),
        header: header(
            study,
            &[
                "outcome",
                "runs",
                "share, %",
                "share from, %",
                "share to, %",
                "difference, points",
                "difference from, points",
                "difference to, points",
                "p",
            ],
        ),
        rows,
    }
}

fn results(study: &Study, summary: &DesignSummary) -> Table {
    let bounded = |b: crate::statistics::quantile::Bounded| {
        format!("{} ({} to {})", short(b.value), short(b.low), short(b.high))
    };
    let mut rows = Vec::new();
    for design in &summary.designs {
        for (name, _) in figures::SHOWN {
            let Some(result) = design.result(name) else { continue };
            let mut more = vec![name.to_owned(), result.quantiles.measured.to_string()];
            more.extend(
                [0.01, 0.5, 0.99].map(|q| result.quantiles.at(q).map_or(String::new(), bounded)),
            );
            more.push(result.median_difference.map_or(String::new(), bounded));
            rows.push(cells(design, more));
        }
    }
    Table {
        name: "margins".to_owned(),
        caption: "Quantiles over the runs in which each was measured.".to_owned(),
        header: header(study, &["result", "measured", "1 %", "median", "99 %", "difference"]),
        rows,
    }
}

fn criteria(study: &Study, summary: &DesignSummary) -> Table {
    let percent = |share: f64| format!("{:.2}", 100.0 * share);
    let mut rows = Vec::new();
    for design in &summary.designs {
        let (Some(criteria), Some(tipped)) = (design.criteria, design.outcome("tipped")) else {
            continue;
        };
        let mut more = vec![percent(tipped.share.share)];
        for called in [criteria.static_angle, criteria.captured_pads] {
            more.extend([called.share, called.missed, called.false_alarms].map(percent));
        }
        rows.push(cells(design, more));
    }
    Table {
        name: "criteria".to_owned(),
        caption:
            "Per cent of the runs: tipped over, and called so by the static angle and by T.24."
                .to_owned(),
        header: header(
            study,
            &[
                "tipped",
                "static: called",
                "static: missed",
                "static: false",
                "T.24: called",
                "T.24: missed",
                "T.24: false",
            ],
        ),
        rows,
    }
}
