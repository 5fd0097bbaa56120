//! Why a heightmap is refused.

use tiff::TiffError;

use super::{ELEVATION_MAX_M, SAMPLES_MAX};

#[derive(Debug, thiserror::Error)]
pub enum HeightmapError {
    #[error("cannot be read: {0}")]
    Unreadable(std::io::Error),
    #[error("is not a TIFF that can be decoded: {0}")]
    Tiff(#[from] TiffError),
    #[error("has {bands} bands, must have 1")]
    Bands { bands: u16 },
    #[error("has samples of format {format} and {bits} bits, must be float (3) of 32 or 64 bits")]
    Samples { format: u16, bits: u16 },
    #[error("has no {tag}: it is not georeferenced")]
    NoTag { tag: &'static str },
    #[error("has a ModelTransformation: rotated or sheared grids are not read, warp it north up")]
    Rotated,
    #[error("has a malformed {tag}: {found:?}")]
    Malformed { tag: &'static str, found: Vec<f64> },
    #[error("has pixels of {x} by {y} m, must be square and larger than 0")]
    Pixels { x: f64, y: f64 },
    #[error("has a coordinate system of model type {model}, must be projected (1)")]
    NotProjected { model: u16 },
    #[error("names no coordinate system")]
    NoCrs,
    #[error("is in \"{found}\", the scenario expects crs = \"{expected}\"")]
    Crs { found: String, expected: String },
    #[error("has linear units {}, must be metres (EPSG 9001)", code(.0))]
    LinearUnit(Option<u16>),
    #[error("has elevations in {found}, must be in metres")]
    VerticalUnit { found: String },
    #[error("states no unit of elevation: add elevation_unit = \"m\" if it is metres")]
    NoVerticalUnit,
    #[error("has samples with {role} {value}: store plain elevations")]
    Scaled { role: &'static str, value: String },
    #[error("has a nodata value \"{text}\" that is no number")]
    NoDataText { text: String },
    #[error(
        "reaches from {low:.3} to {high:.3} m in {axis} about the origin, must reach {need:.3} m \
         to both sides"
    )]
    Outside { axis: &'static str, low: f64, high: f64, need: f64 },
    #[error("gives {samples} samples within the extent, at most {SAMPLES_MAX} are read")]
    TooLarge { samples: usize },
    #[error(
        "has {count} of {total} samples missing within the extent, the first in line {line}, \
         column {column} (nodata {value})"
    )]
    NoData { count: usize, total: usize, line: usize, column: usize, value: f64 },
    #[error(
        "has {count} of {total} samples within the extent that are no elevation, the first in \
         line {line}, column {column} ({value}, limit {ELEVATION_MAX_M} m)"
    )]
    Implausible { count: usize, total: usize, line: usize, column: usize, value: f64 },
}

fn code(code: &Option<u16>) -> String {
    code.map_or_else(|| "not stated".to_owned(), |code| format!("EPSG {code}"))
}
