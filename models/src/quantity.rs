//! Reads vehicle and scenario files so that a wrong one is refused with file, key and reason.
//!
//! A number is a table `{ value = 174.0, unit = "kg" }`; a vehicle's numbers also carry
//! `source` and `grade`. Units are checked, never converted: the file says what the code uses.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

use crate::time::Ticks;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConfigError {
    #[error("{}: cannot be read: {reason}", file.display())]
    Unreadable { file: PathBuf, reason: String },
    #[error("{}: not valid TOML: {reason}", file.display())]
    Syntax { file: PathBuf, reason: String },
    #[error("{}: key `{key}`: {reason}", file.display())]
    Key { file: PathBuf, key: String, reason: String },
}

/// How well a number is known. A vehicle file grades every one.
pub const GRADES: [&str; 4] = ["documented", "derived", "assumed", "unknown"];

/// Largest magnitude of any number: beyond every quantity of a lander, and its products of a few
/// are far from overflow.
const LARGEST: f64 = 1e16;

/// What a number must satisfy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    Any,
    Positive,
    NotNegative,
    /// Closed interval.
    Within(f64, f64),
}

impl Limit {
    /// What `value` should have been, if it is not within the limit.
    pub fn violated_by(self, value: f64) -> Option<String> {
        let (ok, need) = match self {
            Self::Any => (true, String::new()),
            Self::Positive => (value > 0.0, "must be greater than 0".to_owned()),
            Self::NotNegative => (value >= 0.0, "must not be negative".to_owned()),
            Self::Within(low, high) => {
                ((low..=high).contains(&value), format!("must lie in [{low}, {high}]"))
            }
        };
        (!ok).then_some(need)
    }
}

/// The content of a TOML file, or `ConfigError::Unreadable` or `Syntax`.
pub fn read_table(file: &Path) -> Result<Table, ConfigError> {
    let text = std::fs::read_to_string(file).map_err(|error| ConfigError::Unreadable {
        file: file.to_owned(),
        reason: error.to_string(),
    })?;
    parse_table(file, &text)
}

/// As `read_table`, from text in memory; `file` only names it in errors.
pub fn parse_table(file: &Path, text: &str) -> Result<Table, ConfigError> {
    text.parse().map_err(|error: toml::de::Error| ConfigError::Syntax {
        file: file.to_owned(),
        reason: error.to_string().trim().replace('\n', " "),
    })
}

/// One table of a file. Every key that nobody asked for is an error at `finish`.
pub struct Section {
    file: PathBuf,
    path: String,
    table: Table,
    /// Vehicle files must say where each number comes from.
    provenance: bool,
    used: RefCell<BTreeSet<String>>,
}

impl Section {
    /// The root table of `file`. With `provenance`, numbers need `source` and `grade`.
    pub fn read(file: &Path, provenance: bool) -> Result<Self, ConfigError> {
        Ok(Self::of(file, read_table(file)?, provenance))
    }

    /// As `read`, with changes applied to what the file says (`crate::changes`).
    pub fn read_changed(file: &Path, changes: &str) -> Result<Self, ConfigError> {
        let mut section = Self::read(file, false)?;
        crate::changes::apply(&mut section.table, file, changes)?;
        Ok(section)
    }

    /// As `read`, from text already in memory; `file` only names it.
    pub fn parse(file: &Path, text: &str, provenance: bool) -> Result<Self, ConfigError> {
        Ok(Self::of(file, parse_table(file, text)?, provenance))
    }

    /// As `read`, from a table already in memory; `file` only names it.
    pub fn of(file: &Path, table: Table, provenance: bool) -> Self {
        Self::over(file.to_owned(), String::new(), table, provenance)
    }

    fn over(file: PathBuf, path: String, table: Table, provenance: bool) -> Self {
        Self { file, path, table, provenance, used: RefCell::default() }
    }

    /// The file that the section is from.
    pub fn file(&self) -> &Path {
        &self.file
    }

    pub fn error(&self, key: &str, reason: impl Into<String>) -> ConfigError {
        let key =
            if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        ConfigError::Key { file: self.file.clone(), key, reason: reason.into() }
    }

    fn take(&self, key: &str) -> Option<&Value> {
        self.used.borrow_mut().insert(key.to_owned());
        self.table.get(key)
    }

    fn need(&self, key: &str) -> Result<&Value, ConfigError> {
        self.take(key).ok_or_else(|| self.error(key, "is missing"))
    }

    /// Whether an optional key is there. Asking makes it known.
    pub fn has(&self, key: &str) -> bool {
        self.take(key).is_some()
    }

    /// A sub-table that must be there.
    pub fn section(&self, key: &str) -> Result<Self, ConfigError> {
        match self.need(key)? {
            Value::Table(table) => Ok(self.child(key, table.clone())),
            other => Err(self.error(key, format!("must be a table, is {}", other.type_str()))),
        }
    }

    /// A sub-table, empty if it isn't there.
    pub fn optional_section(&self, key: &str) -> Result<Self, ConfigError> {
        if self.has(key) { self.section(key) } else { Ok(self.child(key, Table::new())) }
    }

    /// A list of sub-tables (`[[key]]`), empty if it isn't there. The first is `key[1]` in errors.
    pub fn sections(&self, key: &str) -> Result<Vec<Self>, ConfigError> {
        if !self.has(key) {
            return Ok(Vec::new());
        }
        let wrong = |found: &Value| {
            self.error(key, format!("must be a list of tables, has {}", found.type_str()))
        };
        let value = self.need(key)?;
        let items = value.as_array().ok_or_else(|| wrong(value))?;
        let tables = items.iter().zip(1..).map(|(item, number)| match item {
            Value::Table(table) => Ok(self.child(&format!("{key}[{number}]"), table.clone())),
            other => Err(wrong(other)),
        });
        tables.collect()
    }

    /// Names of the keys that are there.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.table.keys().map(String::as_str)
    }

    fn child(&self, key: &str, table: Table) -> Self {
        let path =
            if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        Self::over(self.file.clone(), path, table, self.provenance)
    }

    pub fn text(&self, key: &str) -> Result<String, ConfigError> {
        match self.need(key)? {
            Value::String(text) => Ok(text.clone()),
            other => Err(self.error(key, format!("must be text, is {}", other.type_str()))),
        }
    }

    /// A list of texts.
    pub fn texts(&self, key: &str) -> Result<Vec<String>, ConfigError> {
        let value = self.need(key)?;
        let items = value.as_array().map(Vec::as_slice).unwrap_or_default();
        let texts: Option<Vec<_>> =
            items.iter().map(|item| item.as_str().map(str::to_owned)).collect();
        texts
            .filter(|texts| !texts.is_empty())
            .ok_or_else(|| self.error(key, format!("must be a list of texts, is {value}")))
    }

    /// One of `choices`; the first is the default when the key is absent.
    pub fn choice(&self, key: &str, choices: &[&'static str]) -> Result<&'static str, ConfigError> {
        if !self.has(key) {
            return Ok(choices[0]);
        }
        let text = self.text(key)?;
        choices.iter().copied().find(|choice| *choice == text).ok_or_else(|| {
            self.error(key, format!("is \"{text}\", must be one of {}", choices.join(", ")))
        })
    }

    pub fn number(&self, key: &str, unit: &str, limit: Limit) -> Result<f64, ConfigError> {
        let value = self.quantity(key, unit)?;
        let value = self.finite(key, &value)?;
        self.check(key, value, unit, limit)
    }

    /// As `number`, or `default` if the key is absent.
    pub fn number_or(
        &self,
        key: &str,
        unit: &str,
        limit: Limit,
        default: f64,
    ) -> Result<f64, ConfigError> {
        if self.has(key) { self.number(key, unit, limit) } else { Ok(default) }
    }

    /// The unit that the file gives a number, for numbers whose unit is not known beforehand.
    pub fn unit_of(&self, key: &str) -> Result<String, ConfigError> {
        let unit = self.need(key)?.get("unit").and_then(Value::as_str);
        unit.map(str::to_owned)
            .ok_or_else(|| self.error(key, "has no unit: write { value = …, unit = \"…\" }"))
    }

    /// A duration in s, a whole number of ticks.
    pub fn ticks(&self, key: &str, limit: Limit) -> Result<Ticks, ConfigError> {
        Ticks::from_seconds(self.number(key, "s", limit)?)
            .map_err(|error| self.error(key, error.to_string()))
    }

    /// As `ticks`, or `default` if the key is absent.
    pub fn ticks_or(&self, key: &str, limit: Limit, default: Ticks) -> Result<Ticks, ConfigError> {
        if self.has(key) { self.ticks(key, limit) } else { Ok(default) }
    }

    /// An array of exactly `N` numbers, each within `limit`.
    pub fn vector<const N: usize>(
        &self,
        key: &str,
        unit: &str,
        limit: Limit,
    ) -> Result<[f64; N], ConfigError> {
        let value = self.quantity(key, unit)?;
        self.array(key, &value, unit, limit)
    }

    /// A list of points, each an array of exactly `N` numbers.
    pub fn points<const N: usize>(
        &self,
        key: &str,
        unit: &str,
    ) -> Result<Vec<[f64; N]>, ConfigError> {
        match self.quantity(key, unit)? {
            Value::Array(rows) => {
                rows.iter().map(|row| self.array(key, row, unit, Limit::Any)).collect()
            }
            other => Err(self.error(key, format!("must be a list, is {}", other.type_str()))),
        }
    }

    /// A list of any number of numbers, each within `limit`.
    pub fn numbers(&self, key: &str, unit: &str, limit: Limit) -> Result<Vec<f64>, ConfigError> {
        match self.quantity(key, unit)? {
            Value::Array(items) => items
                .iter()
                .map(|item| self.check(key, self.finite(key, item)?, unit, limit))
                .collect(),
            other => Err(self.error(key, format!("must be a list, is {}", other.type_str()))),
        }
    }

    fn array<const N: usize>(
        &self,
        key: &str,
        value: &Value,
        unit: &str,
        limit: Limit,
    ) -> Result<[f64; N], ConfigError> {
        let items = value
            .as_array()
            .filter(|items| items.len() == N)
            .ok_or_else(|| self.error(key, format!("must be a list of {N} numbers, is {value}")))?;
        let mut numbers = [0.0; N];
        for (slot, item) in numbers.iter_mut().zip(items) {
            *slot = self.check(key, self.finite(key, item)?, unit, limit)?;
        }
        Ok(numbers)
    }

    /// The `value` of `{ value, unit, … }` after its unit (and provenance) were checked.
    fn quantity(&self, key: &str, unit: &str) -> Result<Value, ConfigError> {
        let example = format!("{{ value = …, unit = \"{unit}\" }}");
        let table = match self.need(key)? {
            Value::Table(table) => table,
            Value::Integer(_) | Value::Float(_) | Value::Array(_) => {
                return Err(self.error(key, format!("has no unit: write {example}")));
            }
            other => {
                let kind = other.type_str();
                return Err(self.error(key, format!("must be a number {example}, is {kind}")));
            }
        };
        let known: &[&str] = if self.provenance {
            &["value", "unit", "source", "grade"]
        } else {
            &["value", "unit"]
        };
        if let Some(stray) = table.keys().find(|name| !known.contains(&name.as_str())) {
            return Err(self.error(&format!("{key}.{stray}"), "is not known here"));
        }
        match table.get("unit").and_then(Value::as_str) {
            None => return Err(self.error(key, format!("has no unit: write {example}"))),
            Some(given) if given != unit => {
                return Err(self.error(key, format!("is in \"{given}\", must be in \"{unit}\"")));
            }
            Some(_) => {}
        }
        if self.provenance {
            self.check_provenance(key, table)?;
        }
        table.get("value").cloned().ok_or_else(|| self.error(key, "has no value"))
    }

    fn check_provenance(&self, key: &str, table: &Table) -> Result<(), ConfigError> {
        if table.get("source").and_then(Value::as_str).is_none_or(|s| s.trim().is_empty()) {
            return Err(self.error(key, "has no source"));
        }
        match table.get("grade").and_then(Value::as_str) {
            Some(grade) if GRADES.contains(&grade) => Ok(()),
            _ => Err(self.error(key, format!("needs a grade: one of {}", GRADES.join(", ")))),
        }
    }

    fn finite(&self, key: &str, value: &Value) -> Result<f64, ConfigError> {
        let number = match value {
            Value::Integer(whole) => *whole as f64,
            Value::Float(number) => *number,
            other => {
                return Err(self.error(key, format!("must be a number, is {}", other.type_str())));
            }
        };
        if number.abs() <= LARGEST {
            Ok(number)
        } else {
            Err(self.error(key, format!("is {number:e}, must be finite, {LARGEST:e} at most")))
        }
    }

    fn check(&self, key: &str, value: f64, unit: &str, limit: Limit) -> Result<f64, ConfigError> {
        match limit.violated_by(value) {
            None => Ok(value),
            Some(need) => Err(self.error(key, format!("is {value} {unit}, {need}"))),
        }
    }

    /// Refuses keys that were never asked for.
    pub fn finish(self) -> Result<(), ConfigError> {
        let used = self.used.borrow();
        match self.table.keys().find(|key| !used.contains(*key)) {
            None => Ok(()),
            Some(stray) => {
                let known: Vec<&str> = used.iter().map(String::as_str).collect();
                Err(self.error(stray, format!("is not known; known here: {}", known.join(", "))))
            }
        }
    }
}
