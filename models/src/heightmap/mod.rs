//! Elevations from a GeoTIFF, placed in the world frame.
//!
//! One band of 32 or 64 bit floats on a projected grid in metres, north up, square pixels. The
//! file must say so itself: nothing is assumed about a coordinate system, a unit or a missing
//! value, and each doubt is an error. The map's easting and northing are taken as world x and y;
//! the projection's distortion and the curvature of the body are left out.

mod error;
mod geokeys;

use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

pub use error::HeightmapError;
use geokeys::Georeference;

/// Samples that one run may hold, 128 MiB of them.
pub const SAMPLES_MAX: usize = 1 << 24;
/// Beyond this an elevation is not one in metres above a reference surface, m.
pub const ELEVATION_MAX_M: f64 = 1e5;
/// Samples beyond the window that cubic interpolation needs on each side.
const MARGIN: f64 = 2.0;

/// What part of which map a scenario wants.
#[derive(Clone, Debug)]
pub struct Window {
    /// The coordinate system that the file must name.
    pub crs: String,
    /// Easting and northing of the world origin, m.
    pub origin_map_m: [f64; 2],
    /// Half the side of the square around the origin that must be covered, m.
    pub extent_m: f64,
    /// The scenario vouches for elevations in metres where the file does not state a unit.
    pub unit_vouched: bool,
}

/// Elevations at the nodes of a square grid, world axes.
#[derive(Clone, PartialEq)]
pub struct HeightGrid {
    pub columns: usize,
    pub rows: usize,
    pub spacing_m: f64,
    /// World x of the first column, m.
    pub west_m: f64,
    /// World y of the first row, m.
    pub south_m: f64,
    /// Above the map's own datum, m; rows from south to north, each from west to east.
    pub elevations_m: Vec<f64>,
}

impl HeightGrid {
    /// Reads the window from a GeoTIFF.
    pub fn load(file: &Path, window: &Window) -> Result<Self, HeightmapError> {
        let opened = File::open(file).map_err(HeightmapError::Unreadable)?;
        let mut decoder = Decoder::new(BufReader::new(opened))?;
        check_samples(&mut decoder)?;
        let map = Georeference::read(&mut decoder, window)?;
        let (width, height) = decoder.dimensions()?;
        let columns = map.span(map.west_m, width, window.extent_m, "easting")?;
        let rows = map.span(map.south_m(height), height, window.extent_m, "northing")?;
        let samples = columns.len().saturating_mul(rows.len());
        if samples > SAMPLES_MAX {
            return Err(HeightmapError::TooLarge { samples });
        }
        let mut grid = Self {
            columns: columns.len(),
            rows: rows.len(),
            spacing_m: map.spacing_m,
            west_m: map.west_m + columns.start as f64 * map.spacing_m,
            south_m: map.south_m(height) + rows.start as f64 * map.spacing_m,
            elevations_m: vec![0.0; samples],
        };
        // The file's rows run from north to south.
        let lines = height as usize - rows.end..height as usize - rows.start;
        grid.fill(&mut decoder, &columns, &lines)?;
        grid.check(&map, &columns, &lines)?;
        Ok(grid)
    }

    /// Copies the window's part of every strip or tile that touches it.
    fn fill(
        &mut self,
        decoder: &mut Decoder<BufReader<File>>,
        columns: &Range<usize>,
        lines: &Range<usize>,
    ) -> Result<(), HeightmapError> {
        let (chunk_width, chunk_height) = decoder.chunk_dimensions();
        let (chunk_width, chunk_height) = (chunk_width as usize, chunk_height as usize);
        if chunk_width == 0 || chunk_height == 0 {
            return Err(HeightmapError::Malformed { tag: "RowsPerStrip", found: vec![0.0] });
        }
        let across = (decoder.dimensions()?.0 as usize).div_ceil(chunk_width);
        for down in lines.start / chunk_height..lines.end.div_ceil(chunk_height) {
            for right in columns.start / chunk_width..columns.end.div_ceil(chunk_width) {
                let index = (down * across + right) as u32;
                let (data_width, data_height) = decoder.chunk_data_dimensions(index);
                let values = floats(decoder.read_chunk(index)?)?;
                let (left, top) = (right * chunk_width, down * chunk_height);
                let shared_lines = overlap(lines, top..top + data_height as usize);
                let shared = overlap(columns, left..left + data_width as usize);
                for line in shared_lines {
                    let from = (line - top) * data_width as usize - left;
                    let to = (lines.end - 1 - line) * self.columns - columns.start;
                    for column in shared.clone() {
                        self.elevations_m[to + column] = values[from + column];
                    }
                }
            }
        }
        Ok(())
    }

    /// No sample may be missing, no number or absurd.
    fn check(
        &self,
        map: &Georeference,
        columns: &Range<usize>,
        lines: &Range<usize>,
    ) -> Result<(), HeightmapError> {
        // In the file's order, so that the first one named is the first one there.
        let place = |index: usize| {
            let (row, column) = (index / self.columns, index % self.columns);
            (lines.end - 1 - row, columns.start + column)
        };
        let bad = |test: &dyn Fn(f64) -> bool| {
            let hits = self.elevations_m.iter().enumerate().filter(|(_, value)| test(**value));
            let places: Vec<_> = hits.map(|(index, value)| (place(index), *value)).collect();
            let (line, column) = places.iter().map(|(at, _)| *at).min()?;
            let value = places.iter().find(|(at, _)| *at == (line, column))?.1;
            Some((places.len(), line, column, value))
        };
        let total = self.elevations_m.len();
        if let Some(nodata) = map.nodata {
            // The text may hold more digits than a 32 bit sample.
            let is_nodata = |value: f64| value == nodata || value == f64::from(nodata as f32);
            if let Some((count, line, column, value)) = bad(&is_nodata) {
                return Err(HeightmapError::NoData { count, total, line, column, value });
            }
        }
        if let Some((count, line, column, value)) = bad(&|value| !(value.abs() <= ELEVATION_MAX_M))
        {
            return Err(HeightmapError::Implausible { count, total, line, column, value });
        }
        Ok(())
    }

    /// FNV-1a over all values, so that two grids can be told apart in a line.
    fn digest(&self) -> u64 {
        let placement = [self.spacing_m, self.west_m, self.south_m];
        let bytes = placement.iter().chain(&self.elevations_m).flat_map(|v| v.to_le_bytes());
        bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        })
    }
}

impl fmt::Debug for HeightGrid {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "HeightGrid({}x{}, fnv1a {:016x})", self.columns, self.rows, self.digest())
    }
}

/// One band of floats, before anything is decoded.
fn check_samples(decoder: &mut Decoder<BufReader<File>>) -> Result<(), HeightmapError> {
    let bands = decoder.find_tag_unsigned(Tag::SamplesPerPixel)?.unwrap_or(1);
    if bands != 1 {
        return Err(HeightmapError::Bands { bands });
    }
    let bits: u16 = decoder.find_tag_unsigned(Tag::BitsPerSample)?.unwrap_or(1);
    // TIFF 6.0: absent means unsigned integer.
    match (decoder.find_tag_unsigned::<u16>(Tag::SampleFormat)?.unwrap_or(1), bits) {
        (3, 32 | 64) => Ok(()),
        (format, bits) => Err(HeightmapError::Samples { format, bits }),
    }
}

fn floats(decoded: DecodingResult) -> Result<Vec<f64>, HeightmapError> {
    match decoded {
        DecodingResult::F32(values) => Ok(values.into_iter().map(f64::from).collect()),
        DecodingResult::F64(values) => Ok(values),
        // `check_samples` saw the same tags.
        _ => Err(HeightmapError::Samples { format: 0, bits: 0 }),
    }
}

fn overlap(a: &Range<usize>, b: Range<usize>) -> Range<usize> {
    a.start.max(b.start)..a.end.min(b.end)
}
