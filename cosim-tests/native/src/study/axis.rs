//! `[[axis]]` of a study: a design parameter and the values that it takes. Every combination of the axes'
//! values is a design, and every design flies the same draws: row k of one is comparable with row k of another.

use lander_models::quantity::{ConfigError, Limit, Section};

use super::distribution::{Distribution, Value};
use super::parameter::{Parameter, column_unit};

/// A report has a place for so many.
const AXES_MAX: usize = 2;

#[derive(Clone, Debug)]
pub struct Axis {
    /// In words that make a column's name.
    pub name: String,
    /// Of the results, unit included.
    pub column: String,
    /// Of its values; `None` for words.
    pub unit: Option<String>,
    pub values: Vec<Value>,
    /// Which of them the other designs are compared with.
    pub baseline: usize,
    /// What it moves. Guidance knows the design.
    pub parameters: Vec<Moved>,
}

/// A parameter and its values, one for each of the axis.
#[derive(Clone, Debug)]
pub struct Moved {
    pub parameter: Parameter,
    pub values: Vec<Value>,
}

impl Axis {
    /// All axes of a study.
    pub fn read_all(root: &Section) -> Result<Vec<Self>, ConfigError> {
        let axes: Vec<Self> =
            root.sections("axis")?.into_iter().map(Self::read).collect::<Result<_, _>>()?;
        if axes.len() > AXES_MAX {
            let reason = format!("has {} axes, at most {AXES_MAX} fit a picture", axes.len());
            return Err(root.error("axis", reason));
        }
        if let [one, other] = axes.as_slice()
            && one.column == other.column
        {
            return Err(root.error("axis", format!("has two of the name {:?}", one.name)));
        }
        Ok(axes)
    }

    fn read(s: Section) -> Result<Self, ConfigError> {
        let name = s.text("name")?;
        let fit = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        if name.is_empty() || !name.chars().all(fit) {
            let reason = format!("is {name:?}, must be of a-z, 0-9 and _: it names a column");
            return Err(s.error("name", reason));
        }
        let levels = Distribution::read_levels(&s)?;
        let values = levels.extremes();
        let list = if s.has("values") { "values" } else { "count" };
        if values.len() < 2 {
            return Err(s.error(list, "has one value, must have two or more"));
        }
        if let Some(twice) = (1..values.len()).find(|n| values[..*n].contains(&values[*n])) {
            return Err(s.error(list, format!("has {} twice", values[twice])));
        }
        let first = Parameter::of(&s, true, levels.clone())?;
        let baseline = read_baseline(&s, &first, &levels, &values)?;
        let mut parameters = vec![Moved { parameter: first, values: values.clone() }];
        for with in s.sections("with")? {
            let factor = with.number_or("times", "1", Limit::Any, 1.0)?;
            let scaled = levels.times(factor);
            let values = scaled.extremes();
            parameters.push(Moved { parameter: Parameter::of(&with, true, scaled)?, values });
            with.finish()?;
        }
        s.finish()?;
        let unit = levels.unit.clone();
        let column = format!("design_{name}{}", column_unit(unit.as_deref()));
        Ok(Self { name, column, unit, values, baseline, parameters })
    }

    /// Name and unit as a picture has them.
    pub fn label(&self) -> String {
        let words = self.name.replace('_', " ");
        match self.unit.as_deref() {
            None | Some("1") => words,
            Some(unit) => format!("{words}, {unit}"),
        }
    }
}

/// `baseline` of an axis: one of its values; that which changes nothing if it isn't given.
fn read_baseline(
    s: &Section,
    parameter: &Parameter,
    levels: &Distribution,
    values: &[Value],
) -> Result<usize, ConfigError> {
    let value = match (s.has("baseline"), &levels.unit) {
        (false, _) => parameter.neutral(),
        (true, None) => Some(Value::Text(s.text("baseline")?)),
        (true, Some(unit)) => Some(Value::Number(s.number("baseline", unit, Limit::Any)?)),
    };
    let Some(value) = value else {
        return Err(s.error("baseline", "is missing: name one of the axis' values"));
    };
    let place = values.iter().position(|known| *known == value);
    place.ok_or_else(|| {
        let known: Vec<String> = values.iter().map(Value::to_string).collect();
        s.error("baseline", format!("is {value}, must be one of {}", known.join(", ")))
    })
}

/// The combinations of the axes' values, by number: the first axis moves fastest.
#[derive(Clone, Copy, Debug)]
pub struct Designs<'a>(pub &'a [Axis]);

impl<'a> Designs<'a> {
    /// One, without a name, where there are no axes.
    pub fn count(&self) -> u64 {
        self.0.iter().map(|axis| axis.values.len() as u64).product()
    }

    /// Which value each axis has.
    pub fn places(&self, mut design: u64) -> impl Iterator<Item = (&'a Axis, usize)> + use<'a> {
        self.0.iter().map(move |axis| {
            let length = axis.values.len() as u64;
            let place = (design % length) as usize;
            design /= length;
            (axis, place)
        })
    }

    pub fn values(&self, design: u64) -> Vec<Value> {
        self.places(design).map(|(axis, place)| axis.values[place].clone()).collect()
    }

    /// What a design sets.
    pub fn draws(&self, design: u64) -> Vec<(&'a Parameter, Value)> {
        let moved = |(axis, place): (&'a Axis, usize)| {
            axis.parameters.iter().map(move |m| (&m.parameter, m.values[place].clone()))
        };
        self.places(design).flat_map(moved).collect()
    }

    /// The design that the others are compared with.
    pub fn baseline(&self) -> u64 {
        let number = |(number, step), axis: &Axis| {
            (number + axis.baseline as u64 * step, step * axis.values.len() as u64)
        };
        self.0.iter().fold((0, 1), number).0
    }

    /// In words: `footprint 0.8, com_raised 0.1 m`.
    pub fn name(&self, design: u64) -> String {
        let word = |(axis, place): (&Axis, usize)| {
            let unit = axis.unit.as_deref().filter(|unit| *unit != "1");
            let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
            format!("{} {}{unit}", axis.name, axis.values[place])
        };
        self.places(design).map(word).collect::<Vec<_>>().join(", ")
    }
}
