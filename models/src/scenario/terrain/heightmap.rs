//! Elevations from a map: `[terrain.heightmap]`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::heightmap::{HeightGrid, Window};
use crate::quantity::{ConfigError, Limit, Section};

#[derive(Clone, Debug)]
pub struct Heightmap {
    pub grid: Arc<HeightGrid>,
    /// Elevation of world z = 0; absent: the elevation at the world origin.
    pub datum_m: Option<f64>,
}

pub(super) fn read(s: &Section) -> Result<Heightmap, ConfigError> {
    let named = PathBuf::from(s.text("file")?);
    let file = s.file().parent().unwrap_or(Path::new("")).join(named);
    let unit_vouched = s.has("elevation_unit") && {
        s.choice("elevation_unit", &["m"])?;
        true
    };
    let window = Window {
        crs: s.text("crs")?,
        origin_map_m: s.vector("origin_map", "m", Limit::Any)?,
        extent_m: s.number("extent", "m", Limit::Positive)?,
        unit_vouched,
    };
    let datum_m = if s.has("datum") { Some(s.number("datum", "m", Limit::Any)?) } else { None };
    let grid = HeightGrid::load(&file, &window)
        .map_err(|error| s.error("file", format!("{} {error}", file.display())))?;
    Ok(Heightmap { grid: Arc::new(grid), datum_m })
}
