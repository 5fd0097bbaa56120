//! Changes to a scenario from outside its file: `run.seed = 7; initial.velocity_w[1] = -12.5`.

use std::path::Path;

use toml::{Table, Value};

use crate::quantity::ConfigError;

/// Applies `changes` to a file's content: `KEY = VALUE`, with semicolons between. A key has dots
/// between its parts and may end in the number of an element, counted from 1. A plain value keeps
/// the unit that the file has there; a key that the file does not have needs its table
/// `{ value = …, unit = … }`.
pub(crate) fn apply(table: &mut Table, file: &Path, changes: &str) -> Result<(), ConfigError> {
    for change in changes.split(';').map(str::trim).filter(|change| !change.is_empty()) {
        let (key, text) = change.split_once('=').unwrap_or((change, ""));
        let key = key.trim();
        let refused = |reason: String| {
            let (file, key) = (file.to_owned(), key.to_owned());
            ConfigError::Key { file, key, reason: format!("change `{change}`: {reason}") }
        };
        let value = format!("value = {text}").parse::<Table>();
        let value = value.ok().and_then(|mut parsed| parsed.remove("value"));
        let value = value.ok_or_else(|| refused("must be KEY = VALUE".to_owned()))?;
        set(table, key, value).map_err(refused)?;
    }
    Ok(())
}

fn set(table: &mut Table, key: &str, value: Value) -> Result<(), String> {
    let (path, element) = match key.strip_suffix(']').and_then(|key| key.split_once('[')) {
        Some((path, number)) => (path, Some(number)),
        None => (key, None),
    };
    let (parents, last) = path.rsplit_once('.').unwrap_or(("", path));
    let mut parent = table;
    for part in parents.split('.').filter(|part| !part.is_empty()) {
        let child = parent.entry(part).or_insert_with(|| Value::Table(Table::new()));
        parent = child.as_table_mut().ok_or_else(|| format!("`{part}` is not a table"))?;
    }
    let Some(mut place) = parent.get_mut(last) else {
        if element.is_some() {
            return Err("the file has no such list".to_owned());
        }
        parent.insert(last.to_owned(), value);
        return Ok(());
    };
    if !value.is_table() && place.get("value").is_some() {
        place = &mut place["value"];
    }
    if let Some(number) = element {
        let index = number.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        let items = place.as_array_mut();
        let item = items.zip(index).and_then(|(items, index)| items.get_mut(index));
        place = item.ok_or_else(|| format!("there is no element {number}"))?;
    }
    *place = value;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "
        [site]
        gravity = { value = 1.625, unit = \"m/s2\" }
        [initial]
        velocity_w = { value = [-15.0, -5.0, -25.0], unit = \"m/s\" }
        [guidance]
        mode = \"descent\"";

    fn changed(changes: &str) -> Result<Table, String> {
        let mut table: Table = FILE.parse().unwrap();
        apply(&mut table, Path::new("file.toml"), changes).map_err(|error| error.to_string())?;
        Ok(table)
    }

    #[test]
    fn values_elements_text_and_new_keys() {
        let table = changed(
            "site.gravity = 3.71; initial.velocity_w[2]=-1; guidance.mode = \"off\"; \
             run.seed = { value = 7, unit = \"1\" };",
        )
        .unwrap();
        assert_eq!(table["site"]["gravity"]["value"].as_float(), Some(3.71));
        assert_eq!(table["site"]["gravity"]["unit"].as_str(), Some("m/s2"));
        assert_eq!(table["initial"]["velocity_w"]["value"][1].as_integer(), Some(-1));
        assert_eq!(table["guidance"]["mode"].as_str(), Some("off"));
        assert_eq!(table["run"]["seed"]["value"].as_integer(), Some(7));
        assert_eq!(changed("").unwrap(), changed(" ; ").unwrap());
    }

    #[test]
    fn what_can_not_be_changed_is_named() {
        for (changes, part) in [
            ("site.gravity", "change `site.gravity`: must be KEY = VALUE"),
            ("site.gravity = much", "must be KEY = VALUE"),
            ("initial.velocity_w[4] = 1", "there is no element 4"),
            ("initial.velocity_w[0] = 1", "there is no element 0"),
            ("site.gravity[1] = 1", "there is no element 1"),
            ("guidance.mode.more = 1", "`mode` is not a table"),
            ("site.lists[1] = 1", "the file has no such list"),
        ] {
            let error = changed(changes).unwrap_err();
            assert!(error.starts_with("file.toml: key `") && error.contains(part), "{error}");
        }
    }
}
