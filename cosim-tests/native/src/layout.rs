//! What stands where in a row: the time, then the outputs of the recorded components.

use std::ops::Range;

use lander_models::signals::{Interface, Signal};

use crate::schedule::{Pair, Schedule};

/// Name of a row's first column.
pub const TIME: &str = "time_s";

#[derive(Clone, Debug)]
pub struct Layout {
    signals: Vec<(&'static Signal, Range<usize>)>,
    width: usize,
}

impl Layout {
    pub fn new(schedule: &Schedule, interfaces: &Pair<&'static Interface>) -> Self {
        let outputs = schedule.rows.iter().flat_map(|side| interfaces[*side].outputs);
        let mut width = 1;
        let signals = outputs
            .map(|signal| {
                let columns = width..width + signal.size;
                width = columns.end;
                (signal, columns)
            })
            .collect();
        Self { signals, width }
    }

    /// Number of f64 in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Columns of a signal; empty if the row has none of that name.
    pub fn columns(&self, name: &str) -> Range<usize> {
        self.signals
            .iter()
            .find(|(signal, _)| signal.name == name)
            .map_or(0..0, |(_, columns)| columns.clone())
    }

    /// Value of a scalar signal, NaN if the row has none of that name.
    pub fn scalar(&self, row: &[f64], name: &str) -> f64 {
        row[self.columns(name)].first().copied().unwrap_or(f64::NAN)
    }

    /// First `N` scalars of a signal, if the row has them.
    pub fn vector<const N: usize>(&self, row: &[f64], name: &str) -> Option<[f64; N]> {
        row[self.columns(name)].first_chunk().copied()
    }

    /// Name of each column, in FMI spelling.
    pub fn column_names(&self) -> impl Iterator<Item = String> {
        let scalars = self
            .signals
            .iter()
            .flat_map(|(signal, _)| (0..signal.size).map(|index| signal.scalar_name(index)));
        std::iter::once(TIME.to_owned()).chain(scalars)
    }
}
