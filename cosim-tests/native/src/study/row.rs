//! A row of a study's table: the run, what it drew, how it ended.

use lander_models::Outcome;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};

use super::distribution::Value;
use super::file::{Kind, Study};
use crate::layout::Layout;
use crate::schedule::{Pair, Schedule, ScheduleError, Side};

const INTERFACES: Pair<&Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };

/// Outputs of interest besides the results: the last place, and how often guidance planned.
const MORE: [&str; 3] = ["position_w", "plans_accepted", "plans_failed"];

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    Whole,
    Number,
    Text,
}

/// The columns of a study and where a row of the co-simulation has their values.
#[derive(Clone, Debug)]
pub struct Columns {
    pub schedule: Schedule,
    pub layout: Layout,
    /// Name and content, in order.
    pub all: Vec<(String, Content)>,
    /// Positions of the results in a row of the co-simulation.
    positions: Vec<usize>,
}

#[derive(Clone, Debug)]
pub struct Row {
    pub number: u64,
    pub seed: u64,
    pub values: Vec<Option<Value>>,
    /// Names joined by `+`, or `none`.
    pub failures: String,
    pub outcome: &'static str,
    /// NaN where nothing was measured.
    pub results: Vec<f64>,
}

impl Columns {
    pub fn new(study: &Study) -> Result<Self, ScheduleError> {
        let mut schedule = Schedule::load(&INTERFACES)?;
        if study.kind == Kind::Touchdown {
            schedule.rows = vec![Side::Truth];
        }
        let layout = Layout::new(&schedule, &INTERFACES);
        let mut all = vec![("run".to_owned(), Content::Whole), ("seed".to_owned(), Content::Whole)];
        let axes = study.axes.iter().map(|axis| (&axis.column, &axis.unit));
        let drawn = study.drawn().map(|p| (&p.column, &p.distribution.unit));
        all.extend(axes.chain(drawn).map(|(column, unit)| {
            let content = if unit.is_some() { Content::Number } else { Content::Text };
            (column.clone(), content)
        }));
        all.push(("failures".to_owned(), Content::Text));
        all.push(("outcome".to_owned(), Content::Text));
        all.push(("end_time_s".to_owned(), Content::Number));
        let mut positions = vec![0];
        let names = schedule.results.iter().map(String::as_str).filter(|name| *name != "outcome");
        for name in names.chain(MORE) {
            // None of guidance's in a touchdown.
            let columns = layout.columns(name);
            for (number, position) in (1..).zip(columns.clone()) {
                let name =
                    if columns.len() == 1 { name.into() } else { format!("{name}_{number}") };
                all.push((name, Content::Number));
                positions.push(position);
            }
        }
        Ok(Self { schedule, layout, all, positions })
    }

    pub fn header(&self) -> String {
        let names: Vec<&str> = self.all.iter().map(|(name, _)| name.as_str()).collect();
        names.join(",")
    }

    /// A result of a row by its column; NaN if there is none of that name.
    pub fn result(&self, row: &Row, name: &str) -> f64 {
        let position = self.all.iter().position(|(column, _)| column == name);
        let first = self.all.len() - row.results.len();
        let index = position.and_then(|position| position.checked_sub(first));
        index.and_then(|index| row.results.get(index)).copied().unwrap_or(f64::NAN)
    }

    /// The outcome of a co-simulation's last row.
    pub fn outcome(&self, row: &[f64]) -> &'static str {
        Outcome::from_code(self.layout.scalar(row, "outcome")).unwrap_or_default().name()
    }

    pub fn results(&self, row: &[f64]) -> Vec<f64> {
        self.positions.iter().map(|position| row[*position]).collect()
    }

    pub fn no_results(&self) -> Vec<f64> {
        vec![f64::NAN; self.positions.len()]
    }
}

impl Row {
    /// The row as a line of CSV, without its end.
    pub fn to_csv(&self) -> String {
        self.cells().join(",")
    }

    /// The row by column; what is empty is `null`.
    pub fn to_json(&self, columns: &Columns) -> serde_json::Value {
        let cells = self.cells().into_iter();
        let entries = columns.all.iter().zip(cells).map(|((name, content), cell)| {
            let value = match content {
                Content::Whole => cell.parse::<u64>().ok().into(),
                Content::Number => cell.parse::<f64>().ok().into(),
                Content::Text => serde_json::Value::from(cell),
            };
            (name.clone(), value)
        });
        serde_json::Value::Object(entries.collect())
    }

    fn cells(&self) -> Vec<String> {
        let mut cells = vec![self.number.to_string(), self.seed.to_string()];
        let cell = |value: &Option<Value>| value.as_ref().map_or(String::new(), Value::to_string);
        cells.extend(self.values.iter().map(cell));
        cells.push(self.failures.clone());
        cells.push(self.outcome.to_owned());
        cells.extend(self.results.iter().map(|number| Value::Number(*number).to_string()));
        cells
    }
}
