//! A GeoTIFF is read as GDAL wrote it, and one that leaves a doubt is refused by name.

use std::fs::File;
use std::path::{Path, PathBuf};

use lander_models::scenario::{Scenario, Terrain};
use lander_models::vehicle::Vehicle;
use tiff::encoder::TiffEncoder;
use tiff::encoder::colortype::{ColorType, Gray16, Gray32Float, Gray64Float, RGB32Float};
use tiff::tags::Tag;

const LANDING: &str = include_str!("../scenarios/landing.toml");
const CRS: &str = "Moon_Test_Grid";
const SIDE: usize = 16;
const SPACING_M: f64 = 10.0;
/// Outer corner of the north-western pixel.
const CORNER: [f64; 2] = [1000.0, 2000.0];
/// Middle of the map: 80 m from each outer edge.
const ORIGIN: [f64; 2] = [1080.0, 1920.0];

/// A small GeoTIFF with all that is needed; tests spoil one thing each.
struct Map {
    values: Vec<f64>,
    geo_keys: Vec<u16>,
    scale: Vec<f64>,
    tie: Vec<f64>,
    citation: String,
    nodata: Option<&'static str>,
    metadata: Option<&'static str>,
    transformation: bool,
}

impl Map {
    fn new() -> Self {
        // Elevation 100 m + 0.02 per m eastwards + 0.05 per m northwards, from the middle.
        let centre = |index: usize| (index as f64 - 0.5 * (SIDE as f64 - 1.0)) * SPACING_M;
        let value = |at: usize| 100.0 + 0.02 * centre(at % SIDE) - 0.05 * centre(at / SIDE);
        Self {
            values: (0..SIDE * SIDE).map(value).collect(),
            geo_keys: keys(&[
                [1024, 0, 1, 1],
                [1025, 0, 1, 1],
                [1026, 34737, CRS.len() as u16 + 1, 0],
                [3072, 0, 1, 32767],
                [3076, 0, 1, 9001],
                [4099, 0, 1, 9001],
            ]),
            scale: vec![SPACING_M, SPACING_M, 0.0],
            tie: vec![0.0, 0.0, 0.0, CORNER[0], CORNER[1], 0.0],
            citation: format!("{CRS}|"),
            nodata: None,
            metadata: None,
            transformation: false,
        }
    }

    /// Writes samples of one kind under a name of the test's own.
    fn write<C: ColorType>(&self, name: &str, samples: &[C::Inner]) -> PathBuf
    where
        [C::Inner]: tiff::encoder::TiffValue,
    {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("heightmap");
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join(format!("{name}.tif"));
        let mut encoder = TiffEncoder::new(File::create(&file).unwrap()).unwrap();
        let mut image = encoder.new_image::<C>(SIDE as u32, SIDE as u32).unwrap();
        let tags = image.encoder();
        tags.write_tag(Tag::ModelPixelScaleTag, &self.scale[..]).unwrap();
        tags.write_tag(Tag::ModelTiepointTag, &self.tie[..]).unwrap();
        if !self.geo_keys.is_empty() {
            tags.write_tag(Tag::GeoKeyDirectoryTag, &self.geo_keys[..]).unwrap();
        }
        tags.write_tag(Tag::GeoAsciiParamsTag, &self.citation[..]).unwrap();
        if let Some(text) = self.nodata {
            tags.write_tag(Tag::GdalNodata, text).unwrap();
        }
        if let Some(text) = self.metadata {
            tags.write_tag(Tag::Unknown(42112), text).unwrap();
        }
        if self.transformation {
            tags.write_tag(Tag::ModelTransformationTag, &[0.0; 16][..]).unwrap();
        }
        image.write_data(samples).unwrap();
        file
    }

    fn floats(&self, name: &str) -> PathBuf {
        let samples: Vec<f32> = self.values.iter().map(|value| *value as f32).collect();
        self.write::<Gray32Float>(name, &samples)
    }
}

fn keys(entries: &[[u16; 4]]) -> Vec<u16> {
    let head = [1, 1, 0, entries.len() as u16];
    head.into_iter().chain(entries.iter().flatten().copied()).collect()
}

fn load(map: &Path, extra: &str) -> Result<Terrain, String> {
    let bug = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/vehicles/bug.toml"));
    let table = format!(
        "[terrain.heightmap]\nfile = \"{}\"\ncrs = \"{CRS}\"\n\
         origin_map = {{ value = {ORIGIN:?}, unit = \"m\" }}\n{extra}\n[initial]",
        map.display()
    );
    let text = LANDING.replacen("[initial]", &table, 1);
    let scenario = Scenario::parse(Path::new("map.toml"), &text, &Vehicle::load(bug).unwrap());
    scenario.map(|scenario| scenario.terrain).map_err(|error| error.to_string())
}

const EXTENT: &str = "extent = { value = 40.0, unit = \"m\" }";

/// The error, which must name scenario, key, map and all of `parts`.
#[track_caller]
fn refused(map: &Path, parts: &[&str]) {
    let error = load(map, EXTENT).unwrap_err();
    let name = map.file_name().unwrap().to_str().unwrap();
    for part in ["map.toml", "`terrain.heightmap.file`", name].iter().chain(parts) {
        assert!(error.contains(part), "`{error}` does not say `{part}`");
    }
}

#[test]
fn nodes_lie_where_the_map_puts_them() {
    let map = Map::new();
    for file in [map.floats("float32"), map.write::<Gray64Float>("float64", &map.values)] {
        let terrain = load(&file, EXTENT).unwrap();
        let grid = terrain.heightmap.unwrap().grid;
        // Centres lie at -75, -65 … 75 m; -40 m needs that at -45 m, and two more.
        assert_eq!((grid.columns, grid.rows), (14, 14));
        assert_eq!((grid.west_m, grid.south_m, grid.spacing_m), (-65.0, -65.0, 10.0));
        for (index, elevation_m) in grid.elevations_m.iter().enumerate() {
            let x_m = grid.west_m + (index % grid.columns) as f64 * grid.spacing_m;
            let y_m = grid.south_m + (index / grid.columns) as f64 * grid.spacing_m;
            let expected_m = 100.0 + 0.02 * x_m + 0.05 * y_m;
            // Half a unit in the last place of a 32 bit float near 100.
            assert!((elevation_m - expected_m).abs() < 4e-6, "{x_m} {y_m} {elevation_m}");
        }
    }
}

#[test]
fn a_tie_point_may_name_a_pixel_s_centre() {
    let mut map = Map::new();
    // RasterType 2: pixel is point.
    map.geo_keys[4 + 4 + 3] = 2;
    map.tie[3..5].copy_from_slice(&[CORNER[0] + 5.0, CORNER[1] - 5.0]);
    let grid = load(&map.floats("point"), EXTENT).unwrap().heightmap.unwrap().grid;
    assert_eq!((grid.west_m, grid.south_m), (-65.0, -65.0));
}

#[test]
fn a_file_of_gdal_s_is_read_as_gdal_reads_it() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/hills.toml");
    let (scenario, _) = Scenario::load(file.as_ref()).unwrap();
    let grid = scenario.terrain.heightmap.unwrap().grid;
    // Line 23, column 24 and line 10, column 40: rasterio 1.4.4 with GDAL 3.10.3. Tiled, deflated,
    // floating-point predictor.
    for (x_m, y_m, expected_m) in [(10.0, 10.0, -1195.25), (330.0, 270.0, -1208.0)] {
        let column = ((x_m - grid.west_m) / grid.spacing_m) as usize;
        let row = ((y_m - grid.south_m) / grid.spacing_m) as usize;
        assert_eq!(grid.elevations_m[row * grid.columns + column], expected_m);
    }
}

#[test]
fn what_is_no_float_map_is_refused() {
    refused(Path::new("nowhere.tif"), &["cannot be read"]);
    let text = Map::new().floats("text");
    std::fs::write(&text, "easting,northing,height").unwrap();
    refused(&text, &["not a TIFF"]);
    let map = Map::new();
    let whole = vec![100_u16; SIDE * SIDE];
    refused(&map.write::<Gray16>("integers", &whole), &["format 1", "16 bits", "float"]);
    let bands = vec![100.0_f32; 3 * SIDE * SIDE];
    refused(&map.write::<RGB32Float>("bands", &bands), &["3 bands", "must have 1"]);
    let cut = map.floats("cut");
    File::options().write(true).open(&cut).unwrap().set_len(200).unwrap();
    refused(&cut, &["not a TIFF that can be decoded"]);
}

#[test]
fn a_doubtful_coordinate_system_is_refused() {
    let spoilt = |name: &str, spoil: &dyn Fn(&mut Map)| {
        let mut map = Map::new();
        spoil(&mut map);
        map.floats(name)
    };
    let key = |map: &mut Map, number: usize, value: u16| map.geo_keys[4 + 4 * number + 3] = value;
    refused(&spoilt("none", &|map| map.geo_keys.clear()), &["GeoKeyDirectory", "georeferenced"]);
    refused(&spoilt("degrees", &|map| key(map, 0, 2)), &["model type 2", "projected (1)"]);
    refused(&spoilt("other", &|map| key(map, 3, 32633)), &["EPSG:32633", CRS]);
    refused(&spoilt("unnamed", &|map| map.citation = "|".repeat(20)), &["no coordinate system"]);
    refused(&spoilt("feet", &|map| key(map, 4, 9002)), &["EPSG 9002", "metres"]);
    refused(&spoilt("unstated", &|map| map.geo_keys[4 + 16] = 3077), &["not stated", "metres"]);
    refused(&spoilt("turned", &|map| map.transformation = true), &["rotated or sheared"]);
    refused(&spoilt("oblong", &|map| map.scale[1] = 12.0), &["10 by 12", "square"]);
    refused(&spoilt("flat", &|map| map.scale[0] = 0.0), &["0 by 10", "larger than 0"]);
    let ties = |map: &mut Map| map.tie.extend([0.0; 6]);
    refused(&spoilt("ties", &ties), &["malformed ModelTiepoint"]);
    refused(&spoilt("nan", &|map| map.tie[3] = f64::NAN), &["malformed ModelTiepoint"]);
}

#[test]
fn elevations_must_be_metres_and_say_so() {
    let mut map = Map::new();
    map.geo_keys[4 + 20 + 3] = 9002;
    refused(&map.floats("vertical-feet"), &["EPSG 9002", "must be in metres"]);
    map.geo_keys[4 + 20] = 4096;
    let silent = map.floats("silent");
    refused(&silent, &["no unit of elevation", "elevation_unit"]);
    load(&silent, &format!("{EXTENT}\nelevation_unit = \"m\"")).unwrap();
    let error = load(&silent, &format!("{EXTENT}\nelevation_unit = \"ft\"")).unwrap_err();
    assert!(error.contains("`terrain.heightmap.elevation_unit`"), "{error}");
    map.metadata = Some("<GDALMetadata><Item sample=\"0\" role=\"unittype\">ft</Item>");
    refused(&map.floats("band-feet"), &["\"ft\"", "must be in metres"]);
    map.metadata = Some("<GDALMetadata><Item sample=\"0\" role=\"unittype\">m</Item>");
    load(&map.floats("band-metres"), EXTENT).unwrap();
    map.metadata = Some("<Item role=\"unittype\">m</Item><Item role=\"scale\">0.5</Item>");
    refused(&map.floats("scaled"), &["scale 0.5", "plain elevations"]);
}

#[test]
fn missing_samples_count_only_where_they_are_used() {
    let mut map = Map::new();
    map.nodata = Some("-9999");
    map.values[0] = -9999.0;
    load(&map.floats("corner"), EXTENT).unwrap();
    map.values[3 * SIDE + 5] = -9999.0;
    map.values[7 * SIDE + 2] = -9999.0;
    refused(&map.floats("holes"), &["2 of 196", "line 3", "column 5", "-9999"]);
    map.nodata = Some("none");
    refused(&map.floats("nodata-text"), &["\"none\"", "no number"]);
    map.nodata = None;
    for (name, value) in [("nan", f64::NAN), ("radius", 1.7374e6)] {
        let mut map = Map::new();
        map.values[8 * SIDE + 9] = value;
        let limit = ["1 of 196", "line 8", "column 9", "limit 100000 m"];
        refused(&map.floats(&format!("sample-{name}")), &limit);
    }
}

#[test]
fn a_map_that_does_not_reach_is_refused() {
    let file = Map::new().floats("reach");
    for extent in ["56.0", "1e15"] {
        let wide = format!("extent = {{ value = {extent}, unit = \"m\" }}");
        let error = load(&file, &wide).unwrap_err();
        for part in ["easting", "from -75.000 to 75.000 m", "must reach"] {
            assert!(error.contains(part), "`{error}` does not say `{part}`");
        }
    }
    load(&file, "extent = { value = 55.0, unit = \"m\" }").unwrap();
}

#[test]
fn a_loaded_map_prints_in_a_line_and_differs_where_a_sample_does() {
    let mut map = Map::new();
    let one = format!("{:?}", load(&map.floats("one"), EXTENT).unwrap());
    map.values[8 * SIDE + 8] += 1e-3;
    let other = format!("{:?}", load(&map.floats("other-digest"), EXTENT).unwrap());
    assert_ne!(one, other);
    assert!(one.len() < 1000, "{one}");
}
