"""Writes hills.tif: gentle made-up hills on a lunar polar stereographic grid, a sample for the
GeoTIFF reader and for the scenario `hills`. Needs numpy and rasterio.

    python make_hills.py
"""

from pathlib import Path

import numpy as np
import rasterio
from rasterio.transform import from_origin

SPACING_M, SIDE = 20.0, 48
WEST_M, NORTH_M = 30_000.0, -60_000.0  # outer corner of the first pixel

CRS = """PROJCS["Moon_2000_South_Pole_Stereographic",
    GEOGCS["Moon_2000", DATUM["D_Moon_2000", SPHEROID["Moon_2000_IAU_IAG", 1737400, 0]],
        PRIMEM["Reference_Meridian", 0], UNIT["degree", 0.0174532925199433]],
    PROJECTION["Polar_Stereographic"],
    PARAMETER["latitude_of_origin", -90], PARAMETER["central_meridian", 0],
    PARAMETER["scale_factor", 1], PARAMETER["false_easting", 0], PARAMETER["false_northing", 0],
    UNIT["metre", 1]]"""

# Offsets of the pixel centres from the middle of the map, x east, y north.
offsets_m = (np.arange(SIDE) - (SIDE - 1) / 2) * SPACING_M
x, y = np.meshgrid(offsets_m, -offsets_m)
hills_m = (
    -1200.0
    + 5.0 * np.sin(2 * np.pi * x / 420.0)
    + 4.0 * np.cos(2 * np.pi * (y - 0.4 * x) / 350.0)
    - 12.0 * np.exp(-((x - 220.0) ** 2 + (y + 180.0) ** 2) / 90.0**2)
)
profile = dict(
    driver="GTiff",
    width=SIDE,
    height=SIDE,
    count=1,
    dtype="float32",
    crs=CRS,
    transform=from_origin(WEST_M, NORTH_M, SPACING_M, SPACING_M),
    nodata=-3.4028226550889045e38,
    tiled=True,
    blockxsize=32,
    blockysize=32,
    compress="deflate",
    predictor=3,
)
with rasterio.open(Path(__file__).with_name("hills.tif"), "w", **profile) as out:
    # Sixteenths of a metre, so that the file stays small.
    out.write((np.round(hills_m * 16) / 16).astype("float32"), 1)
    out.set_band_unit(1, "m")
