//! The page of a stability map.

use super::{Figure, Page};
use crate::map::file::MapCase;
use crate::map::table::{CaseSummary, cells_csv};
use crate::map::{Atlas, Mapped, picture};
use crate::touchdowns::COLUMNS;

pub fn page(atlas: &Atlas, mapped: &[Mapped], summaries: &[CaseSummary]) -> Page {
    let (study, map) = (atlas.study, atlas.map);
    let mut page = Page::new(&format!("Stability map {}", study.name));
    let [across, down] = [map.across_m_s, map.down_m_s];
    page.paragraph(&format!(
        "Touchdowns with the engine off over a plane of velocities at contact: {} to {} m/s across, {} to {} m/s \
         down. A first grid of {} by {} cells; cells whose corners or neighbours differ in outcome, or that are \
         near another outcome by their own margin, were split up to {} times.",
        across[0], across[1], down[0], down[1], map.cells[0], map.cells[1], map.depth
    ));
    page.paragraph(
        "The velocity across is along azimuth 0. Cases are called by the legs that come down one after another: 2-2 leads \
         with two legs, 1-2-1 with one, 1-1-1-1 with one and no symmetry. Flat: all pads touch at once.",
    );
    cases(&mut page, atlas);
    page.figure(Figure {
        name: "map".to_owned(),
        caption: "Outcomes over the velocities at contact. A cell whose corners differ has a quarter of each. The \
                  line is where the closed form for captured pads (T.24) expects a tip-over to its right."
            .to_owned(),
        svg: picture::draw(atlas, mapped, summaries),
        csv: cells_csv(atlas, mapped),
    });
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let rows: Vec<_> = summaries
        .iter()
        .map(|s| {
            let of = |name: &str| percent(s.outcomes.get(name).copied().unwrap_or(0.0));
            vec![
                s.case.clone(),
                s.touchdowns.to_string(),
                of("landed"),
                of("tipped"),
                percent(s.static_criterion.misclassified),
                percent(s.captured_criterion.misclassified),
                percent(s.captured_criterion.missed),
            ]
        })
        .collect();
    let header = [
        "case",
        "touchdowns",
        "landed",
        "tipped",
        "static angle errs",
        "T.24 errs",
        "of that, missed tip-overs",
    ];
    page.table("", &header, &rows);
    page.paragraph(
        "Shares of the plane. The static criterion calls a touchdown stable wherever the slope is less than the tip \
         angle over every edge; it knows no velocity, so what it misses is every dynamic tip-over.",
    );
    page.heading("Again");
    page.code(&format!("lander map {}.toml", study.name));
    page.study_file(study);
    page
}

/// What each case is, beside its velocity.
fn cases(page: &mut Page, atlas: &Atlas) {
    let row = |case: &MapCase| {
        let state = atlas.state(case, 0.0, 0.0);
        let of = |name: &str| COLUMNS.iter().zip(state).find(|(column, _)| column.0 == name);
        let cell = |name: &str| of(name).map_or(String::new(), |(_, value)| value.to_string());
        let held = of("captured").is_some_and(|(_, captured)| captured == 1.0);
        let mut cells =
            vec![case.name.clone(), cell("slope_deg"), cell("downhill_deg"), cell("friction")];
        cells.push(if held { "held" } else { "sliding" }.to_owned());
        cells.extend([case.heading_deg, case.lean_deg].map(|angle| angle.to_string()));
        cells.push(["x", "y", "z"].map(|axis| cell(&format!("rate_{axis}_deg_s"))).join(" "));
        cells.extend(["propellant_kg", "gravity_m_s2"].map(cell));
        cells
    };
    let header = [
        "case",
        "slope, deg",
        "downhill towards, deg",
        "friction",
        "pads",
        "heading, deg",
        "lean, deg",
        "rates x y z, deg/s",
        "propellant, kg",
        "gravity, m/s2",
    ];
    page.table("", &header, &atlas.map.cases.iter().map(row).collect::<Vec<_>>());
}
