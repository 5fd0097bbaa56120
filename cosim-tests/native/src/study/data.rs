//! The runs of a study, column by column from its merged table.

use lander_models::Outcome;

use super::StudyError;
use super::campaign::Campaign;
use super::table::Reader;

/// A column of words of which there are few: each once, and a code a row.
#[derive(Clone, Debug, Default)]
pub struct Words {
    pub names: Vec<String>,
    pub codes: Vec<u16>,
}

impl Words {
    /// The code of a word, new or known.
    pub fn code(&mut self, word: &str) -> u16 {
        let place = self.names.iter().position(|name| name == word).unwrap_or_else(|| {
            self.names.push(word.to_owned());
            self.names.len() - 1
        });
        place as u16
    }

    pub fn get(&self, row: usize) -> &str {
        &self.names[usize::from(self.codes[row])]
    }

    pub fn iter(&self) -> impl Iterator<Item = &str> {
        (0..self.codes.len()).map(|row| self.get(row))
    }
}

/// Results of the touchdown from contact to rest. A crash ends a run milliseconds after contact, where its row has
/// what they were by then: legs hardly stroked, nothing tilted yet.
const OF_TOUCHDOWN: [&str; 9] = [
    "rest_tilt_deg",
    "least_hull_clearance_m",
    "least_nozzle_clearance_m",
    "peak_stroke_m",
    "peak_leg_load_n",
    "peak_acceleration_m_s2",
    "tip_energy_margin_j",
    "stability_distance_m",
    "slide_distance_m",
];

/// All runs of a study, or an even part of them. Numbers stay in the file until they are asked for, so that
/// memory holds a column at a time.
pub struct Data<'a> {
    reader: &'a Reader,
    /// Names joined by `+`, or `none`.
    pub failures: Words,
    pub outcomes: Words,
    part: Part,
}

/// Of each `of` runs in a row, those from `from` and below `to`.
#[derive(Clone, Copy, Debug)]
struct Part {
    of: usize,
    from: usize,
    to: usize,
}

impl Part {
    fn pick<T>(self, all: Vec<T>) -> Vec<T> {
        if self.to - self.from == self.of {
            return all;
        }
        let kept = all.into_iter().enumerate();
        kept.filter(|(run, _)| (self.from..self.to).contains(&(run % self.of)))
            .map(|(_, value)| value)
            .collect()
    }
}

impl<'a> Data<'a> {
    pub fn new(reader: &'a Reader) -> Result<Self, StudyError> {
        let whole = Part { of: 1, from: 0, to: 1 };
        let words = |name| Ok::<_, StudyError>(reader.words(name)?.unwrap_or_default());
        Ok(Self { reader, failures: words("failures")?, outcomes: words("outcome")?, part: whole })
    }

    /// Of each `of` runs in a row those from `from` and below `to`. Of all runs, not of a part.
    pub fn part(&self, of: usize, from: usize, to: usize) -> Self {
        let part = Part { of, from, to };
        let words =
            |all: &Words| Words { names: all.names.clone(), codes: part.pick(all.codes.clone()) };
        let (failures, outcomes) = (words(&self.failures), words(&self.outcomes));
        Self { reader: self.reader, failures, outcomes, part }
    }

    /// A column of numbers, NaN where nothing was measured; `None` if there is none of that name.
    pub fn column(&self, name: &str) -> Result<Option<Vec<f64>>, StudyError> {
        let Some(all) = self.reader.numbers(name)? else { return Ok(None) };
        let mut values = self.part.pick(all);
        if OF_TOUCHDOWN.contains(&name) {
            for (value, outcome) in values.iter_mut().zip(self.outcomes.iter()) {
                if outcome == Outcome::Crashed.name() {
                    *value = f64::NAN;
                }
            }
        }
        Ok(Some(values))
    }

    /// What was measured of a column, rising.
    pub fn sorted(&self, name: &str) -> Result<Vec<f64>, StudyError> {
        let mut values = self.column(name)?.unwrap_or_default();
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        Ok(values)
    }

    pub fn runs(&self) -> usize {
        self.outcomes.codes.len()
    }
}

/// The table of a campaign, which must have been merged.
pub fn open(campaign: &Campaign) -> Result<Reader, StudyError> {
    Reader::open(campaign)?.ok_or_else(|| StudyError::Missing {
        folder: campaign.folder.clone(),
        first: 0,
        last: campaign.study.runs - 1,
    })
}
