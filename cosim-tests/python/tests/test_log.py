"""The log in Rerun, which nobody here wrote, and the names in the layout."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from matplotlib import image
from mcap.reader import make_reader

from conftest import ROOT

RERUN = Path(sys.executable).with_name("rerun")


def check(log: Path) -> int:
    return subprocess.run([RERUN, "mcap", "check", log], capture_output=True, timeout=120).returncode


def test_rerun_accepts_the_log_and_not_half_of_it(landing, tmp_path):
    assert check(landing.log) == 0
    half = tmp_path / "half.mcap"
    half.write_bytes(landing.log.read_bytes()[: landing.log.stat().st_size // 2])
    assert check(half) != 0


def test_rerun_draws_ground_and_robot_unasked(landing, tmp_path):
    log = shutil.copy(landing.log, tmp_path / "landing.mcap")
    shot = tmp_path / "shot.png"
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x800x24", RERUN, log, "--screenshot-to", shot]
    # It would listen on every interface otherwise.
    options = ["--bind", "127.0.0.1", "--window-size", "1280x800"]
    # What Rerun remembers of other files stays out of it.
    environment = os.environ | {"XDG_DATA_HOME": str(tmp_path)}
    subprocess.run([*command, *options], env=environment, capture_output=True, timeout=180, check=True)
    pixels = image.imread(shot)[..., :3]
    red, green, blue = np.moveaxis(pixels, -1, 0)
    points = (green > 0.4) & (green > 1.3 * red) & (green > 1.3 * blue)
    # The terrain's points, in a three-dimensional view that nobody asked for.
    assert points.mean() > 1e-3
    assert pixels.std() > 0.05


def test_the_layout_names_what_the_log_has(landing):
    layout = json.loads((ROOT / "cosim-tests" / "foxglove-layout.json").read_text(encoding="utf-8"))
    with landing.log.open("rb") as log:
        summary = make_reader(log).get_summary()
    topics = {channel.topic for channel in summary.channels.values()}
    telemetry = next(s.data for s in summary.schemas.values() if s.name == "lander.Telemetry")
    panels = layout["configById"]
    assert set(panels["3D!landing"]["topics"]) <= topics
    paths = [path["value"] for panel in panels.values() for path in panel.get("paths", [])]
    assert len(paths) > 10
    for path in paths:
        topic, field = path.split(".")
        # A field's name in the descriptor follows its length.
        assert topic in topics and bytes([len(field)]) + field.encode() in telemetry, path
