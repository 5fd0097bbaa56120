//! One parameter of a study: a number or word in a scenario file, a vehicle file or a contact state,
//! named by its key path, and how it is spread.

use lander_models::quantity::{ConfigError, Section};
use toml::{Table, Value as Toml};

use super::distribution::{Distribution, Value};
use crate::touchdowns::{COLUMNS, Case};

/// Where a parameter lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    Scenario,
    Vehicle,
    /// The contact state of a touchdown.
    Case,
}

/// How a draw becomes the parameter's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Use {
    Value,
    /// Added to what the file has; of a list, to each number.
    Added,
    /// Times what the file has; of a list, each number.
    Factor,
}

#[derive(Clone, Debug)]
pub struct Parameter {
    /// As the study file writes it: `scenario.initial.velocity_w[3]`.
    pub key: String,
    /// Column of the results, unit included.
    pub column: String,
    pub root: Root,
    /// Guidance knows it too. Else it is an error of the world that guidance must cope with.
    pub known: bool,
    pub distribution: Distribution,
    /// Below `root`.
    path: Vec<String>,
    /// Numbers in square brackets at the end, from 0.
    indices: Vec<usize>,
    what: Use,
}

/// The files of a run, changed in place.
#[derive(Clone, Debug)]
pub struct Files {
    pub scenario: Table,
    pub vehicle: Table,
}

impl Parameter {
    pub fn read(s: Section, known: bool) -> Result<Self, ConfigError> {
        let parameter = Self::of(&s, known, Distribution::read(&s)?)?;
        s.finish()?;
        Ok(parameter)
    }

    /// With the `key` and `as` of a section, spread by a distribution.
    pub fn of(s: &Section, known: bool, distribution: Distribution) -> Result<Self, ConfigError> {
        let key = s.text("key")?;
        let (root, path, indices) = parse_path(&key).map_err(|reason| s.error("key", reason))?;
        let what = match s.choice("as", &["value", "added", "factor"])? {
            "added" => Use::Added,
            "factor" => Use::Factor,
            _ => Use::Value,
        };
        if what != Use::Value && distribution.unit.is_none() {
            return Err(s.error("as", "is for numbers, but the distribution gives text"));
        }
        if what == Use::Factor && distribution.unit.as_deref() != Some("1") {
            return Err(s.error("as", "is \"factor\", so the distribution must be in \"1\""));
        }
        let column = column_name(root, &path, &indices, what, distribution.unit.as_deref());
        Ok(Self { key, column, root, known, distribution, path, indices, what })
    }

    /// A parameter of the scenario that is set as drawn, from the section that has its distribution.
    pub fn of_scenario(path: &[&str], distribution: Distribution) -> Self {
        let path: Vec<String> = path.iter().map(|key| (*key).to_owned()).collect();
        let column =
            column_name(Root::Scenario, &path, &[], Use::Value, distribution.unit.as_deref());
        Self {
            key: format!("scenario.{}", path.join(".")),
            column,
            root: Root::Scenario,
            known: false,
            distribution,
            path,
            indices: Vec::new(),
            what: Use::Value,
        }
    }

    /// The value that leaves what the file has, if there is one whatever the file.
    pub fn neutral(&self) -> Option<Value> {
        match self.what {
            Use::Value => None,
            Use::Added => Some(Value::Number(0.0)),
            Use::Factor => Some(Value::Number(1.0)),
        }
    }

    /// How its values are used, in a word after its key.
    pub fn how(&self) -> &'static str {
        match self.what {
            Use::Value => "",
            Use::Added => " +",
            Use::Factor => " ×",
        }
    }

    /// Whether nothing is left of what the file, or an axis before it, has.
    pub fn replaces(&self) -> bool {
        self.what == Use::Value
    }

    /// As the readers of scenario and vehicle name it in an error.
    pub fn path_in_file(&self) -> String {
        self.path.join(".")
    }

    /// Puts a draw in its place in a file. The reason why it cannot stand there, if it cannot. What
    /// belongs to the contact state is left for `apply_to_case`.
    pub fn apply(&self, files: &mut Files, drawn: &Value) -> Result<(), String> {
        match self.root {
            Root::Case => Ok(()),
            Root::Scenario => self.apply_to_table(&mut files.scenario, drawn, false),
            Root::Vehicle => self.apply_to_table(&mut files.vehicle, drawn, true),
        }
    }

    /// As `apply`, for what belongs to the contact state alone.
    pub fn apply_to_case(&self, case: &mut Case, drawn: &Value) -> Result<(), String> {
        if self.root != Root::Case {
            return Ok(());
        }
        let column = &self.path[0];
        let known = || COLUMNS.map(|(name, _)| name).join(", ");
        let index = COLUMNS
            .iter()
            .position(|(name, _)| name == column)
            .filter(|_| self.path.len() == 1 && self.indices.is_empty())
            .ok_or_else(|| format!("is not known; known here: {}", known()))?;
        let Value::Number(number) = *drawn else {
            return Err("must be a number".to_owned());
        };
        self.check_unit(case_unit(column))?;
        case[index] = self.combined(case[index], number);
        Ok(())
    }

    fn apply_to_table(
        &self,
        table: &mut Table,
        drawn: &Value,
        provenance: bool,
    ) -> Result<(), String> {
        let Some((last, folders)) = self.path.split_last() else {
            return Err("names a whole file".to_owned());
        };
        let mut table = table;
        for folder in folders {
            let below = table.entry(folder).or_insert_with(|| Toml::Table(Table::new()));
            table = below.as_table_mut().ok_or_else(|| format!("`{folder}` is no table"))?;
        }
        let number = match drawn {
            Value::Text(text) => {
                table.insert(last.clone(), Toml::String(text.clone()));
                return Ok(());
            }
            Value::Number(number) => *number,
        };
        let Some(quantity) = table.get_mut(last) else {
            if self.what != Use::Value || !self.indices.is_empty() {
                return Err("is not in the file, so there is nothing to change".to_owned());
            }
            table.insert(last.clone(), Toml::Table(self.quantity(number, provenance)));
            return Ok(());
        };
        let unit = quantity.get("unit").and_then(Toml::as_str).unwrap_or("text").to_owned();
        self.check_unit(&unit)?;
        let mut value = quantity.get_mut("value").ok_or("has no value")?;
        for index in &self.indices {
            let length = value.as_array().map_or(0, Vec::len);
            value = value
                .as_array_mut()
                .and_then(|items| items.get_mut(*index))
                .ok_or_else(|| format!("has {length} numbers, not [{}]", index + 1))?;
        }
        self.change(value, number)
    }

    /// A number where there was none, as its file would write it.
    fn quantity(&self, number: f64, provenance: bool) -> Table {
        let unit = self.distribution.unit.clone().unwrap_or_default();
        let mut table = Table::new();
        table.insert("value".to_owned(), Toml::Float(number));
        table.insert("unit".to_owned(), Toml::String(unit));
        if provenance {
            table.insert("source".to_owned(), Toml::String("drawn by a study".to_owned()));
            table.insert("grade".to_owned(), Toml::String("assumed".to_owned()));
        }
        table
    }

    fn change(&self, value: &mut Toml, drawn: f64) -> Result<(), String> {
        match value {
            Toml::Array(items) if self.what != Use::Value => {
                items.iter_mut().try_for_each(|item| self.change(item, drawn))
            }
            Toml::Array(items) => Err(format!("is a list of {}: name one with [n]", items.len())),
            Toml::Integer(_) | Toml::Float(_) => {
                let nominal = value.as_float().or(value.as_integer().map(|whole| whole as f64));
                *value = Toml::Float(self.combined(nominal.unwrap_or(f64::NAN), drawn));
                Ok(())
            }
            other => Err(format!("must be a number, is {}", other.type_str())),
        }
    }

    fn combined(&self, nominal: f64, drawn: f64) -> f64 {
        match self.what {
            Use::Value => drawn,
            Use::Added => nominal + drawn,
            Use::Factor => nominal * drawn,
        }
    }

    fn check_unit(&self, unit: &str) -> Result<(), String> {
        match (&self.what, self.distribution.unit.as_deref()) {
            (Use::Factor, _) => Ok(()),
            (_, Some(given)) if given == unit => Ok(()),
            (_, given) => {
                Err(format!("is drawn in \"{}\", must be in \"{unit}\"", given.unwrap_or("text")))
            }
        }
    }
}

/// `scenario.initial.velocity_w[3]` as root, keys and indices from 0.
fn parse_path(key: &str) -> Result<(Root, Vec<String>, Vec<usize>), String> {
    let (keys, brackets) = key.split_once('[').unwrap_or((key, ""));
    let mut words = keys.split('.');
    let root = match words.next() {
        Some("scenario") => Root::Scenario,
        Some("vehicle") => Root::Vehicle,
        Some("case") => Root::Case,
        _ => return Err(format!("is \"{key}\", must start with scenario., vehicle. or case.")),
    };
    let path: Vec<String> = words.map(str::to_owned).collect();
    if path.is_empty() || path.iter().any(String::is_empty) {
        return Err(format!("is \"{key}\", must name a key below \"{keys}\""));
    }
    let wrong = || format!("is \"{key}\": numbers in square brackets count from 1, as in a[3][1]");
    let mut indices = Vec::new();
    if !brackets.is_empty() {
        let inner = brackets.strip_suffix(']').ok_or_else(wrong)?;
        for word in inner.split("][") {
            let number: usize = word.parse().map_err(|_| wrong())?;
            indices.push(number.checked_sub(1).ok_or_else(wrong)?);
        }
    }
    Ok((root, path, indices))
}

/// Units stand in the names of the case's columns.
pub fn case_unit(column: &str) -> &'static str {
    let units =
        [("_m_s2", "m/s2"), ("_m_s", "m/s"), ("_deg_s", "deg/s"), ("_deg", "deg"), ("_kg", "kg")];
    units.iter().find(|(end, _)| column.ends_with(end)).map_or("1", |(_, unit)| unit)
}

fn column_name(
    root: Root,
    path: &[String],
    indices: &[usize],
    what: Use,
    unit: Option<&str>,
) -> String {
    let mut name = path.join("_");
    if root == Root::Vehicle {
        name = format!("vehicle_{name}");
    }
    for index in indices {
        name += &format!("_{}", index + 1);
    }
    match what {
        Use::Factor => return name + "_factor",
        Use::Added => name += "_added",
        Use::Value => {}
    }
    // Those of the case have theirs in their names.
    let unit = unit.filter(|_| root != Root::Case);
    name + &column_unit(unit)
}

/// The end of a column's name that says its unit.
pub fn column_unit(unit: Option<&str>) -> String {
    let word = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    match unit {
        None | Some("1") => String::new(),
        Some(unit) => format!("_{}", unit.chars().map(word).collect::<String>()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(text: &str) -> Parameter {
        let s = Section::parse("study.toml".as_ref(), text, false).unwrap();
        Parameter::read(s, false).unwrap()
    }

    fn constant(key: &str, what: &str, value: f64, unit: &str) -> Parameter {
        parameter(&format!(
            "key = \"{key}\"\nas = \"{what}\"\ndistribution = \"constant\"\n\
             value = {{ value = {value:?}, unit = \"{unit}\" }}"
        ))
    }

    fn files() -> Files {
        let scenario = "[initial]\nvelocity_w = { value = [1, 2.0, 3.0], unit = \"m/s\" }";
        Files { scenario: scenario.parse().unwrap(), vehicle: Table::new() }
    }

    fn velocity(inputs: &Files) -> Vec<f64> {
        let list = inputs.scenario["initial"]["velocity_w"]["value"].as_array().unwrap();
        let number = |v: &Toml| v.as_float().or(v.as_integer().map(|i| i as f64)).unwrap();
        list.iter().map(number).collect()
    }

    #[test]
    fn a_draw_lands_at_its_path_as_value_added_or_factor() {
        let key = "scenario.initial.velocity_w";
        for (parameter, column, expected) in [
            (
                constant(&format!("{key}[3]"), "value", 9.0, "m/s"),
                "initial_velocity_w_3_m_s",
                [1.0, 2.0, 9.0],
            ),
            (
                constant(&format!("{key}[1]"), "added", 0.5, "m/s"),
                "initial_velocity_w_1_added_m_s",
                [1.5, 2.0, 3.0],
            ),
            (constant(key, "factor", 2.0, "1"), "initial_velocity_w_factor", [2.0, 4.0, 6.0]),
        ] {
            let mut inputs = files();
            parameter.apply(&mut inputs, &parameter.distribution.quantile(0.5)).unwrap();
            assert_eq!((velocity(&inputs), parameter.column.as_str()), (expected.into(), column));
        }
        let mut case = [1.0; COLUMNS.len()];
        let down = constant("case.down_m_s", "added", 0.25, "m/s");
        down.apply_to_case(&mut case, &Value::Number(0.25)).unwrap();
        assert_eq!((case[2], down.column.as_str()), (1.25, "down_m_s_added"));
    }

    #[test]
    fn a_draw_that_fits_nowhere_says_why() {
        for (key, what, unit, word) in [
            ("scenario.initial.velocity_w", "value", "m/s", "is a list of 3: name one with [n]"),
            ("scenario.initial.velocity_w[4]", "value", "m/s", "has 3 numbers, not [4]"),
            ("scenario.initial.velocity_w[1]", "value", "km/s", "must be in \"m/s\""),
            ("scenario.initial.rate_b", "added", "deg/s", "is not in the file"),
            ("case.up_m_s", "value", "m/s", "is not known; known here: propellant_kg"),
            ("case.down_m_s", "value", "deg", "must be in \"m/s\""),
        ] {
            let parameter = constant(key, what, 1.0, unit);
            let one = Value::Number(1.0);
            let applied = parameter.apply(&mut files(), &one);
            let reason = applied.and(parameter.apply_to_case(&mut [0.0; 15], &one)).unwrap_err();
            assert!(reason.contains(word), "{reason}");
        }
        for (key, word) in [
            ("initial.velocity_w", "must start with scenario., vehicle. or case."),
            ("scenario.", "must name a key"),
            ("scenario.a[0]", "count from 1"),
            ("scenario.a[2", "count from 1"),
        ] {
            assert!(parse_path(key).unwrap_err().contains(word), "{key}");
        }
    }
}
