//! How one parameter is spread: a table of a study file, and its inverse distribution function.
//!
//! Every draw is a function of one uniform number in [0, 1), so plain sampling, stratified designs and
//! searches in standard normal space share this one place.

use lander_models::quantity::{ConfigError, Limit, Section};
use serde::Serialize;

use crate::statistics::normal::{self, share_below};

/// What a parameter can be set to.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    Number(f64),
    Text(String),
}

impl std::fmt::Display for Value {
    /// As a cell of a table: a number that was never measured is empty.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) if number.is_finite() => number.fmt(f),
            Self::Number(_) => Ok(()),
            Self::Text(text) => f.write_str(text),
        }
    }
}

impl std::fmt::Display for Distribution {
    /// In words, with its unit.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let unit = match self.unit.as_deref() {
            None | Some("1") => String::new(),
            Some(unit) => format!(" {unit}"),
        };
        match &self.shape {
            Shape::Constant(value) => write!(f, "is {value}{unit}"),
            Shape::Choice(values) => {
                let words: Vec<String> = values.iter().map(|(v, _)| v.to_string()).collect();
                write!(f, "one of {}{unit}", words.join(", "))
            }
            Shape::Uniform { low, high } => write!(f, "uniform, {low} to {high}{unit}"),
            Shape::Normal { mean, deviation, low, high } => {
                write!(f, "normal, {mean} ± {deviation}{unit}")?;
                let bounds = [("above", low), ("below", high)];
                for (word, bound) in bounds.into_iter().filter(|(_, bound)| bound.is_finite()) {
                    write!(f, ", {word} {bound}{unit}")?;
                }
                Ok(())
            }
            Shape::LogNormal { median, spread } => {
                write!(f, "log-normal, median {median}{unit}, spread {spread}")
            }
            Shape::Triangular { low, mode, high } => {
                write!(f, "triangular, {low} to {high}{unit}, peak {mode}{unit}")
            }
        }
    }
}

/// Shape with its numbers, all in the parameter's unit.
#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Constant(Value),
    /// Values with the share of the draws up to each.
    Choice(Vec<(Value, f64)>),
    Uniform {
        low: f64,
        high: f64,
    },
    /// Of mean and standard deviation, cut off outside [low, high].
    Normal {
        mean: f64,
        deviation: f64,
        low: f64,
        high: f64,
    },
    /// The logarithm is normal; `spread` is its standard deviation.
    LogNormal {
        median: f64,
        spread: f64,
    },
    Triangular {
        low: f64,
        mode: f64,
        high: f64,
    },
}

#[derive(Clone, Debug, PartialEq)]
pub struct Distribution {
    shape: Shape,
    /// Unit of the numbers; `None` for text.
    pub unit: Option<String>,
    /// Draws are rounded to whole multiples of it.
    step: Option<f64>,
}

const NAMES: [&str; 6] = ["constant", "choice", "uniform", "normal", "log_normal", "triangular"];

/// Values of a design parameter at most.
const LEVELS_MAX: f64 = 100.0;

/// A truncated normal keeps at least this share of the whole: beyond, its bounds are a mistake.
const LEAST_SHARE: f64 = 1e-6;

impl Distribution {
    /// Takes its keys from the table of a parameter, which may have others.
    pub fn read(s: &Section) -> Result<Self, ConfigError> {
        s.text("distribution")?;
        let name = s.choice("distribution", &NAMES)?;
        let (shape, unit) = match name {
            "constant" => read_constant(s)?,
            "choice" => read_choice(s)?,
            "uniform" => {
                let unit = s.unit_of("low")?;
                let [low, high] = read_range(s, &unit)?;
                (Shape::Uniform { low, high }, Some(unit))
            }
            "triangular" => {
                let unit = s.unit_of("low")?;
                let [low, high] = read_range(s, &unit)?;
                let mode = s.number("mode", &unit, Limit::Within(low, high))?;
                (Shape::Triangular { low, mode, high }, Some(unit))
            }
            "log_normal" => {
                let unit = s.unit_of("median")?;
                let median = s.number("median", &unit, Limit::Positive)?;
                // exp(8.6 · 2) is 3e7: what is wider is no measured quantity.
                let spread = s.number("spread", "1", Limit::Within(1e-9, 2.0))?;
                (Shape::LogNormal { median, spread }, Some(unit))
            }
            _ => read_normal(s)?,
        };
        let step = match &unit {
            Some(unit) if s.has("step") => Some(s.number("step", unit, Limit::Positive)?),
            _ => None,
        };
        let distribution = Self { shape, unit, step };
        distribution.check_step(s)?;
        Ok(distribution)
    }

    /// A step is for rounding: it may move no draw out of its bounds by more than half of what lies between them.
    fn check_step(&self, s: &Section) -> Result<(), ConfigError> {
        let (Some(step), Some([low, high])) = (self.step, self.bounds()) else { return Ok(()) };
        if step > 0.5 * (high - low) {
            let reason = format!("is {step}, must be at most half of {low} to {high}");
            return Err(s.error("step", reason));
        }
        Ok(())
    }

    fn bounds(&self) -> Option<[f64; 2]> {
        match self.shape {
            Shape::Uniform { low, high } | Shape::Triangular { low, high, .. } => Some([low, high]),
            _ => None,
        }
    }

    /// As `read`, of a design's values: a list of `values`, or `count` of them from `low` to `high`.
    pub fn read_levels(s: &Section) -> Result<Self, ConfigError> {
        let (values, unit) = if s.has("count") { read_count(s)? } else { read_values(s)? };
        let levels = values.into_iter().map(|value| (value, 0.0)).collect();
        Ok(Self { shape: Shape::Choice(levels), unit, step: None })
    }

    /// The same, in another parameter's scale.
    pub fn times(&self, factor: f64) -> Self {
        let Shape::Choice(values) = &self.shape else { return self.clone() };
        let scaled = values.iter().map(|(value, share)| match value {
            Value::Number(number) => (Value::Number(number * factor), *share),
            Value::Text(_) => (value.clone(), *share),
        });
        Self { shape: Shape::Choice(scaled.collect()), ..self.clone() }
    }

    /// The value below which a share `u` in [0, 1) of the draws lies.
    pub fn quantile(&self, u: f64) -> Value {
        let number = match &self.shape {
            Shape::Constant(value) => return value.clone(),
            Shape::Choice(values) => {
                let found = values.iter().find(|(_, share)| u < *share).or(values.last());
                return found.map_or(Value::Number(f64::NAN), |(value, _)| value.clone());
            }
            Shape::Uniform { low, high } => low + u * (high - low),
            Shape::Normal { mean, deviation, low, high } => {
                let [from, to] = [low, high].map(|bound| share_below((bound - mean) / deviation));
                let z = standard_normal(from + u * (to - from));
                (mean + deviation * z).clamp(*low, *high)
            }
            Shape::LogNormal { median, spread } => median * libm::exp(spread * standard_normal(u)),
            Shape::Triangular { low, mode, high } => {
                let (width, rise) = (high - low, mode - low);
                if u * width < rise {
                    low + (u * width * rise).sqrt()
                } else {
                    high - ((1.0 - u) * width * (high - mode)).sqrt()
                }
            }
        };
        Value::Number(self.step.map_or(number, |step| (number / step).round() * step))
    }

    /// Values at which the parameter is tried before any run: the ends of a bounded distribution,
    /// every choice, and a value in the middle.
    pub fn extremes(&self) -> Vec<Value> {
        match &self.shape {
            Shape::Choice(values) => values.iter().map(|(value, _)| value.clone()).collect(),
            Shape::Normal { low, high, .. } => [low, high]
                .into_iter()
                .filter(|bound| bound.is_finite())
                .map(|bound| Value::Number(*bound))
                .chain([self.quantile(0.5)])
                .collect(),
            _ => [0.0, 0.5, 1.0 - f64::EPSILON].map(|u| self.quantile(u)).to_vec(),
        }
    }

    /// Whether every draw lies within the `extremes`.
    pub fn is_bounded(&self) -> bool {
        match self.shape {
            Shape::Normal { low, high, .. } => low.is_finite() && high.is_finite(),
            Shape::LogNormal { .. } => false,
            _ => true,
        }
    }

    /// Whether every draw is the same.
    pub fn is_constant(&self) -> bool {
        matches!(self.shape, Shape::Constant(_))
    }
}

fn read_constant(s: &Section) -> Result<(Shape, Option<String>), ConfigError> {
    Ok(match s.text("value") {
        Ok(text) => (Shape::Constant(Value::Text(fit_for_a_cell(s, "value", text)?)), None),
        Err(_) => {
            let unit = s.unit_of("value")?;
            let value = s.number("value", &unit, Limit::Any)?;
            (Shape::Constant(Value::Number(value)), Some(unit))
        }
    })
}

/// A word stands in a cell of the results as it is.
fn fit_for_a_cell(s: &Section, key: &str, text: String) -> Result<String, ConfigError> {
    match text.contains([',', '"']) || text.contains(char::is_control) {
        true => {
            Err(s.error(key, format!("has {text:?}: no commas, quotes or line ends in a word")))
        }
        false => Ok(text),
    }
}

/// A list of `values`, at least one, and their unit.
fn read_values(s: &Section) -> Result<(Vec<Value>, Option<String>), ConfigError> {
    let (values, unit) = match s.texts("values") {
        Ok(texts) => {
            let fit = |text| fit_for_a_cell(s, "values", text).map(Value::Text);
            (texts.into_iter().map(fit).collect::<Result<Vec<_>, _>>()?, None)
        }
        Err(_) => {
            let unit = s.unit_of("values")?;
            let numbers = s.numbers("values", &unit, Limit::Any)?;
            (numbers.into_iter().map(Value::Number).collect(), Some(unit))
        }
    };
    if values.is_empty() {
        return Err(s.error("values", "must have at least one value"));
    }
    Ok((values, unit))
}

fn read_choice(s: &Section) -> Result<(Shape, Option<String>), ConfigError> {
    let (values, unit) = read_values(s)?;
    let weights = if s.has("weights") {
        s.numbers("weights", "1", Limit::NotNegative)?
    } else {
        vec![1.0; values.len()]
    };
    if weights.len() != values.len() {
        let (has, needs) = (weights.len(), values.len());
        return Err(s.error("weights", format!("has {has} weights for {needs} values")));
    }
    let total: f64 = weights.iter().sum();
    if total <= 0.0 {
        return Err(s.error("weights", "are all 0, one must be greater"));
    }
    let mut share = 0.0;
    let shares = weights.iter().map(|weight| {
        share += weight / total;
        share
    });
    Ok((Shape::Choice(values.into_iter().zip(shares).collect()), unit))
}

/// `count` values from `low` to `high`, exact at both ends.
fn read_count(s: &Section) -> Result<(Vec<Value>, Option<String>), ConfigError> {
    let unit = s.unit_of("low")?;
    let [low, high] = read_range(s, &unit)?;
    let count = s.number("count", "1", Limit::Within(2.0, LEVELS_MAX))?;
    if count.fract() != 0.0 {
        return Err(s.error("count", format!("is {count}, must be a whole number")));
    }
    let last = count - 1.0;
    let level = |n: u32| (low * (last - f64::from(n)) + high * f64::from(n)) / last;
    Ok(((0..count as u32).map(|n| Value::Number(level(n))).collect(), Some(unit)))
}

/// `low` and `high` of a distribution that lies between them.
fn read_range(s: &Section, unit: &str) -> Result<[f64; 2], ConfigError> {
    let low = s.number("low", unit, Limit::Any)?;
    let high = s.number("high", unit, Limit::Any)?;
    if low < high {
        Ok([low, high])
    } else {
        Err(s.error("high", format!("is {high} {unit}, must be greater than low, {low} {unit}")))
    }
}

fn read_normal(s: &Section) -> Result<(Shape, Option<String>), ConfigError> {
    let unit = s.unit_of("mean")?;
    let mean = s.number("mean", &unit, Limit::Any)?;
    let deviation = s.number("deviation", &unit, Limit::Positive)?;
    let low = s.number_or("low", &unit, Limit::Any, f64::NEG_INFINITY)?;
    let high = s.number_or("high", &unit, Limit::Any, f64::INFINITY)?;
    if low >= high {
        let reason = format!("is {high} {unit}, must be greater than low, {low} {unit}");
        return Err(s.error("high", reason));
    }
    let [from, to] = [low, high].map(|bound| share_below((bound - mean) / deviation));
    if to - from < LEAST_SHARE {
        let reason =
            format!("has a share of {:e} in [low, high], must be {LEAST_SHARE:e}", to - from);
        return Err(s.error("deviation", reason));
    }
    Ok((Shape::Normal { mean, deviation, low, high }, Some(unit)))
}

/// The standard normal number below which a share `u` lies; finite for every draw.
pub fn standard_normal(u: f64) -> f64 {
    // Half the spacing of the draws keeps 0 out.
    normal::quantile(u.clamp(0.25 * f64::EPSILON, 1.0 - 0.5 * f64::EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Distribution, ConfigError> {
        let s = Section::parse("study.toml".as_ref(), text, false).unwrap();
        let distribution = Distribution::read(&s)?;
        s.finish()?;
        Ok(distribution)
    }

    fn number(distribution: &Distribution, u: f64) -> f64 {
        match distribution.quantile(u) {
            Value::Number(number) => number,
            Value::Text(text) => panic!("{text}"),
        }
    }

    #[test]
    fn quantiles_are_those_of_scipy() {
        let m = |key: &str, value: f64| format!("{key} = {{ value = {value:?}, unit = \"m\" }}\n");
        let spread = "spread = { value = 0.3, unit = \"1\" }\n";
        // SciPy 1.17: norm(2, 0.5).ppf, truncnorm(-1, 2, 2, 0.5).ppf, lognorm(0.3, scale=2).ppf,
        // uniform(1, 3).ppf, triang(0.25, 1, 4).ppf at 0.1 and 0.9.
        let cases = [
            (
                "normal",
                m("mean", 2.0) + &m("deviation", 0.5),
                1.3592242172276996,
                2.6407757827723004,
            ),
            (
                "normal",
                m("mean", 2.0) + &m("deviation", 0.5) + &m("low", 1.5) + &m("high", 3.0),
                1.6476760894526274,
                2.6278576820751076,
            ),
            ("log_normal", m("median", 2.0) + spread, 1.3616289098792482, 2.9376579558337426),
            ("uniform", m("low", 1.0) + &m("high", 4.0), 1.3, 3.7),
            (
                "triangular",
                m("low", 1.0) + &m("high", 5.0) + &m("mode", 2.0),
                1.632455532033676,
                3.904554884989668,
            ),
        ];
        for (name, keys, low, high) in cases {
            let distribution = read(&format!("distribution = \"{name}\"\n{keys}")).unwrap();
            for (u, expected) in [(0.1, low), (0.9, high)] {
                let found = number(&distribution, u);
                // The inverse error function is good to some 1e-9.
                assert!((found - expected).abs() < 1e-8, "{name} at {u}: {found}, {expected}");
            }
            assert!((0..=53).all(|n| number(&distribution, 1.0 - 2.0_f64.powi(-n)).is_finite()));
        }
    }

    #[test]
    fn choices_keep_their_weights_and_steps_round() {
        let text = "distribution = \"choice\"\nvalues = [\"sliding\", \"captured\"]\n\
                    weights = { value = [3, 1], unit = \"1\" }";
        let pads = read(text).unwrap();
        assert_eq!(pads.quantile(0.74), Value::Text("sliding".into()));
        assert_eq!(pads.quantile(0.76), Value::Text("captured".into()));
        let onset = "distribution = \"uniform\"\nlow = { value = 0, unit = \"s\" }\n\
                     high = { value = 40, unit = \"s\" }\nstep = { value = 0.5, unit = \"s\" }";
        assert_eq!(number(&read(onset).unwrap(), 0.34), 13.5);
    }

    #[test]
    fn impossible_distributions_are_refused_by_key_and_value() {
        let q = |key: &str, value: &str| format!("{key} = {{ value = {value}, unit = \"m\" }}\n");
        let normal = |deviation: &str| q("mean", "1.0") + &q("deviation", deviation);
        for (name, keys, words) in [
            ("gauss", String::new(), ["distribution", "is \"gauss\", must be one of constant"]),
            ("normal", normal("-0.1"), ["deviation", "is -0.1 m, must be greater than 0"]),
            ("normal", normal("nan"), ["deviation", "must be finite"]),
            ("normal", normal("0.1") + &q("low", "9.0"), ["deviation", "in [low, high]"]),
            ("normal", q("mean", "1.0"), ["deviation", "is missing"]),
            ("uniform", q("low", "2.0") + &q("high", "1.0"), ["high", "greater than low, 2 m"]),
            (
                "triangular",
                q("low", "1.0") + &q("high", "2.0") + &q("mode", "3.0"),
                ["mode", "must lie in [1, 2]"],
            ),
            ("choice", q("values", "[]"), ["values", "at least one"]),
            (
                "choice",
                q("values", "[1, 2]") + "weights = { value = [0, 0], unit = \"1\" }",
                ["weights", "are all 0"],
            ),
            ("uniform", q("low", "1.0") + &q("high", "2.0") + &q("mean", "1.0"), ["mean", "known"]),
        ] {
            let error = read(&format!("distribution = \"{name}\"\n{keys}")).unwrap_err();
            let error = error.to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }
}
