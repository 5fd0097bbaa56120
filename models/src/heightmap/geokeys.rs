//! Where a GeoTIFF lies on its map (OGC 19-008r4, GeoTIFF 1.1).

use std::io::{Read, Seek};
use std::ops::Range;

use tiff::decoder::Decoder;
use tiff::tags::Tag;

use super::{HeightmapError, MARGIN, Window};

const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const CITATION: u16 = 1026;
const PROJECTED_CRS: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;
const LINEAR_UNITS: u16 = 3076;
const VERTICAL_UNITS: u16 = 4099;

const PROJECTED: u16 = 1;
const PIXEL_IS_AREA: u16 = 1;
const USER_DEFINED: u16 = 32767;
const METRE: u16 = 9001;
/// GDAL's XML of band metadata, among them unit, scale and offset.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// The grid of pixel centres relative to the world origin.
pub(super) struct Georeference {
    pub west_m: f64,
    pub spacing_m: f64,
    pub nodata: Option<f64>,
    north_m: f64,
}

impl Georeference {
    pub fn read<R: Read + Seek>(
        decoder: &mut Decoder<R>,
        window: &Window,
    ) -> Result<Self, HeightmapError> {
        let keys = GeoKeys::read(decoder)?;
        keys.check(window)?;
        check_band(decoder, keys.short(VERTICAL_UNITS), window.unit_vouched)?;
        let (corner, spacing_m) = placement(decoder)?;
        // A tie point names the corner of its pixel where pixels are areas (the default).
        let half_m = match keys.short(RASTER_TYPE).unwrap_or(PIXEL_IS_AREA) {
            PIXEL_IS_AREA => 0.5 * spacing_m,
            _ => 0.0,
        };
        Ok(Self {
            west_m: corner[0] + half_m - window.origin_map_m[0],
            north_m: corner[1] - half_m - window.origin_map_m[1],
            spacing_m,
            nodata: nodata(decoder)?,
        })
    }

    /// World y of the southernmost line of pixel centres, m.
    pub fn south_m(&self, height: u32) -> f64 {
        self.north_m - (f64::from(height) - 1.0) * self.spacing_m
    }

    /// The nodes that cover `extent_m` to both sides of the origin, and what interpolation needs.
    pub fn span(
        &self,
        first_m: f64,
        count: u32,
        extent_m: f64,
        axis: &'static str,
    ) -> Result<Range<usize>, HeightmapError> {
        let start = ((-extent_m - first_m) / self.spacing_m).floor() - MARGIN;
        let end = ((extent_m - first_m) / self.spacing_m).ceil() + MARGIN + 1.0;
        if start < 0.0 || end > f64::from(count) {
            return Err(HeightmapError::Outside {
                axis,
                low: first_m,
                high: first_m + (f64::from(count) - 1.0) * self.spacing_m,
                need: extent_m + MARGIN * self.spacing_m,
            });
        }
        Ok(start as usize..end as usize)
    }
}

/// Map coordinates of the first pixel's reference corner, and the pixel's side.
fn placement<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<([f64; 2], f64), HeightmapError> {
    if decoder.find_tag(Tag::ModelTransformationTag)?.is_some() {
        return Err(HeightmapError::Rotated);
    }
    let scale = doubles(decoder, Tag::ModelPixelScaleTag, "ModelPixelScale")?;
    let [x, y, _] = scale[..] else {
        return Err(HeightmapError::Malformed { tag: "ModelPixelScale", found: scale });
    };
    // Writers round the two independently.
    if !(x > 0.0 && x.is_finite() && (x - y).abs() <= 1e-9 * x) {
        return Err(HeightmapError::Pixels { x, y });
    }
    let tie = doubles(decoder, Tag::ModelTiepointTag, "ModelTiepoint")?;
    match tie[..] {
        [column, line, _, east, north, _] if tie.iter().all(|value| value.is_finite()) => {
            Ok(([east - column * x, north + line * x], x))
        }
        _ => Err(HeightmapError::Malformed { tag: "ModelTiepoint", found: tie }),
    }
}

/// Unit of elevation, and no hidden scale or offset.
fn check_band<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    vertical: Option<u16>,
    vouched: bool,
) -> Result<(), HeightmapError> {
    let xml = match decoder.find_tag(GDAL_METADATA)? {
        Some(value) => value.into_string()?,
        None => String::new(),
    };
    for (role, neutral) in [("scale", 1.0), ("offset", 0.0)] {
        if let Some(value) = band_item(&xml, role)
            && value.parse() != Ok(neutral)
        {
            return Err(HeightmapError::Scaled { role, value: value.to_owned() });
        }
    }
    let unit = band_item(&xml, "unittype");
    if let Some(code) = vertical.filter(|code| *code != METRE) {
        return Err(HeightmapError::VerticalUnit { found: format!("EPSG {code}") });
    }
    if let Some(unit) = unit.filter(|unit| !["m", "metre", "meter"].contains(unit)) {
        return Err(HeightmapError::VerticalUnit { found: format!("\"{unit}\"") });
    }
    if vertical.is_none() && unit.is_none() && !vouched {
        return Err(HeightmapError::NoVerticalUnit);
    }
    Ok(())
}

/// Text of `<Item … role="ROLE">text</Item>`.
fn band_item<'a>(xml: &'a str, role: &str) -> Option<&'a str> {
    let (_, after) = xml.split_once(&format!("role=\"{role}\""))?;
    let (_, text) = after.split_once('>')?;
    Some(text.split_once('<')?.0.trim())
}

fn nodata<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Option<f64>, HeightmapError> {
    let Some(value) = decoder.find_tag(Tag::GdalNodata)? else { return Ok(None) };
    let text = value.into_string()?.trim_matches(['\0', ' ']).to_owned();
    match text.parse() {
        Ok(number) => Ok(Some(number)),
        Err(_) => Err(HeightmapError::NoDataText { text }),
    }
}

fn doubles<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    tag: Tag,
    name: &'static str,
) -> Result<Vec<f64>, HeightmapError> {
    let value = decoder.find_tag(tag)?.ok_or(HeightmapError::NoTag { tag: name })?;
    Ok(value.into_f64_vec()?)
}

/// The GeoKeyDirectory: short keys, and text keys from GeoAsciiParams.
struct GeoKeys {
    directory: Vec<u16>,
    ascii: String,
}

impl GeoKeys {
    fn read<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Self, HeightmapError> {
        let directory = decoder
            .find_tag_unsigned_vec(Tag::GeoKeyDirectoryTag)?
            .ok_or(HeightmapError::NoTag { tag: "GeoKeyDirectory" })?;
        let ascii = match decoder.find_tag(Tag::GeoAsciiParamsTag)? {
            Some(value) => value.into_string()?,
            None => String::new(),
        };
        Ok(Self { directory, ascii })
    }

    fn check(&self, window: &Window) -> Result<(), HeightmapError> {
        let model = self.short(MODEL_TYPE).unwrap_or(0);
        if model != PROJECTED {
            return Err(HeightmapError::NotProjected { model });
        }
        let found = self.crs().ok_or(HeightmapError::NoCrs)?;
        if found != window.crs {
            return Err(HeightmapError::Crs { found, expected: window.crs.clone() });
        }
        match self.short(LINEAR_UNITS) {
            Some(METRE) => Ok(()),
            other => Err(HeightmapError::LinearUnit(other)),
        }
    }

    /// `EPSG:n`, or the name of a user-defined system.
    fn crs(&self) -> Option<String> {
        match self.short(PROJECTED_CRS) {
            Some(code) if code != USER_DEFINED => Some(format!("EPSG:{code}")),
            _ => self.text(CITATION).or_else(|| self.text(PROJECTED_CITATION)),
        }
    }

    /// Location, count and value or offset of a key. Four shorts head the directory.
    fn entry(&self, key: u16) -> Option<[u16; 3]> {
        let entries = self.directory.get(4..)?.chunks_exact(4);
        entries.map(|e| (e[0], [e[1], e[2], e[3]])).find(|(id, _)| *id == key).map(|(_, e)| e)
    }

    fn short(&self, key: u16) -> Option<u16> {
        self.entry(key).filter(|[location, ..]| *location == 0).map(|[_, _, value]| value)
    }

    fn text(&self, key: u16) -> Option<String> {
        let [location, count, offset] = self.entry(key)?;
        if location != Tag::GeoAsciiParamsTag.to_u16() {
            return None;
        }
        let text = self.ascii.get(offset.into()..usize::from(offset) + usize::from(count))?;
        // Texts end in a bar.
        let text = text.trim_end_matches(['|', '\0']).trim();
        (!text.is_empty()).then(|| text.to_owned())
    }
}
