//! The rows of a study in memory, by column.

use super::StudyError;
use super::campaign::Campaign;
use super::row::Content;

#[derive(Clone, Debug, Default)]
pub struct Data {
    pub outcomes: Vec<String>,
    /// Names joined by `+`, or `none`.
    pub failures: Vec<String>,
    /// Name and values of each column of numbers; NaN where nothing was measured.
    pub numbers: Vec<(String, Vec<f64>)>,
}

impl Data {
    /// Reads all shards.
    pub fn read(campaign: &Campaign) -> Result<Self, StudyError> {
        let columns = &campaign.columns.all;
        let named = |name: &str| columns.iter().position(|(column, _)| column == name);
        let places: Vec<usize> =
            (0..columns.len()).filter(|index| columns[*index].1 == Content::Number).collect();
        let numbers = places.iter().map(|index| (columns[*index].0.clone(), Vec::new())).collect();
        let mut data = Self { numbers, ..Self::default() };
        for shard in campaign.shards() {
            let rows = shard.read()?.ok_or_else(|| StudyError::Missing {
                folder: campaign.folder.clone(),
                first: shard.runs.start,
                last: shard.runs.end - 1,
            })?;
            for row in &rows {
                let cells: Vec<&str> = row.split(',').collect();
                let cell = |index: Option<usize>| index.and_then(|i| cells.get(i)).copied();
                data.outcomes.push(cell(named("outcome")).unwrap_or_default().to_owned());
                data.failures.push(cell(named("failures")).unwrap_or_default().to_owned());
                for (place, (_, values)) in places.iter().zip(&mut data.numbers) {
                    // A shard's rows are as they were written: what is no number is empty.
                    values
                        .push(cell(Some(*place)).and_then(|c| c.parse().ok()).unwrap_or(f64::NAN));
                }
            }
        }
        Ok(data)
    }

    /// The runs for which `keep` holds.
    pub fn only(&self, keep: impl Fn(usize) -> bool) -> Self {
        fn of<T: Clone>(values: &[T], keep: impl Fn(usize) -> bool) -> Vec<T> {
            let kept = values.iter().enumerate().filter(|(run, _)| keep(*run));
            kept.map(|(_, value)| value.clone()).collect()
        }
        let column = |(name, values): &(String, Vec<f64>)| (name.clone(), of(values, &keep));
        Self {
            outcomes: of(&self.outcomes, &keep),
            failures: of(&self.failures, &keep),
            numbers: self.numbers.iter().map(column).collect(),
        }
    }

    /// A column of numbers by name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.numbers.iter().find(|(column, _)| column == name).map(|(_, values)| values.as_slice())
    }
}
