//! A vehicle that differs from another in a few numbers: `base` names its file.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use crate::quantity::{ConfigError, read_table};

const KEY: &str = "base";
/// A vehicle of a vehicle of a vehicle: more is a circle.
const DEPTH_MAX: usize = 3;

/// What `table` says, over what the vehicle says that it names as its base, relative to `file`.
pub(super) fn resolve(file: &Path, table: Table) -> Result<Table, ConfigError> {
    resolve_to(file, table, DEPTH_MAX)
}

fn resolve_to(file: &Path, mut table: Table, depth: usize) -> Result<Table, ConfigError> {
    let Some(base) = table.remove(KEY) else { return Ok(table) };
    let refused = |reason: String| {
        Err(ConfigError::Key { file: file.to_owned(), key: KEY.to_owned(), reason })
    };
    let Value::String(name) = base else {
        return refused(format!("must be text, is {}", base.type_str()));
    };
    if depth == 0 {
        return refused(format!("{name:?} is the base of a base's base: at most {DEPTH_MAX}"));
    }
    let base_file: PathBuf = file.parent().unwrap_or(Path::new("")).join(name);
    let below = resolve_to(&base_file, read_table(&base_file)?, depth - 1)?;
    Ok(over(below, table))
}

/// Sections are taken together; numbers, texts and lists are replaced.
fn over(mut below: Table, above: Table) -> Table {
    for (key, value) in above {
        let value = match (below.remove(&key), value) {
            (Some(Value::Table(low)), Value::Table(high)) if !is_number(&high) => {
                Value::Table(over(low, high))
            }
            (_, value) => value,
        };
        below.insert(key, value);
    }
    below
}

fn is_number(table: &Table) -> bool {
    table.contains_key("value")
}
