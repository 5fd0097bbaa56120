//! The paper's printed numbers, as models/paper/printed.toml has them.

use std::path::Path;

use lander_models::ConfigError;
use lander_models::quantity::{Limit, Section};

const TEXT: &str = include_str!("../../../../models/paper/printed.toml");

pub struct Printed(Section);

impl Printed {
    /// # Errors
    /// A file that is no TOML.
    pub fn load() -> Result<Self, ConfigError> {
        Ok(Self(Section::parse(Path::new("models/paper/printed.toml"), TEXT, true)?))
    }

    pub fn number(&self, key: &str, unit: &str) -> Result<f64, ConfigError> {
        self.0.number(key, unit, Limit::Any)
    }

    pub fn row<const N: usize>(&self, key: &str, unit: &str) -> Result<[f64; N], ConfigError> {
        self.0.vector(key, unit, Limit::Any)
    }

    pub fn rows<const N: usize>(
        &self,
        key: &str,
        unit: &str,
    ) -> Result<Vec<[f64; N]>, ConfigError> {
        self.0.points(key, unit)
    }
}
