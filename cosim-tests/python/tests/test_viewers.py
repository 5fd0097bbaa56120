"""The log in Foxglove Studio itself, as its own packages bring it, in a headless browser."""

import io
import json
import shutil
import time
from collections.abc import Callable

import numpy as np
import pytest
from matplotlib import image
from mcap.reader import make_reader
from playwright.sync_api import Locator

from conftest import ROOT, TARGET
from studio import LAYOUT, Studio, studio

VIEWER = ROOT / "cosim-tests" / "viewers"


@pytest.fixture
def foxglove(tmp_path):
    """Foxglove Studio, nothing opened, nothing configured."""
    shutil.copy(VIEWER / "index.html", tmp_path)
    (tmp_path / "node_modules").symlink_to(TARGET / "viewers" / "node_modules")
    with studio(tmp_path) as viewer:
        yield viewer


def picture(panel: Locator) -> np.ndarray:
    """Red, green and blue from 0 to 1, each an array of rows."""
    pixels = image.imread(io.BytesIO(panel.screenshot()), format="png")
    return np.moveaxis(pixels[..., :3], -1, 0)


def has_curve(panel: Locator) -> bool:
    """Whether the first curve's blue is there, right of the legend."""
    red, _, blue = picture(panel)
    right = np.s_[:, red.shape[1] // 2 :]
    return np.count_nonzero(blue[right] - red[right] > 0.2) > 50


def shows_landed_lander(panel: Locator) -> bool:
    """Whether the gold body stands on grey ground, in a red ring of 5 m."""
    red, green, blue = picture(panel)
    ground = (abs(red - green) < 0.03) & (abs(red - blue) < 0.06) & (red > 0.3) & (red < 0.7)
    gold = (red > 0.4) & (red > 1.2 * blue) & (green > 1.1 * blue)
    ring = (red > 0.8) & (red > 2.0 * green)
    return ground.mean() > 0.5 and gold.mean() > 2e-3 and ring.mean() > 2e-3


def becomes(condition: Callable[[], bool], within_s: float = 60.0) -> bool:
    """Waits, since a viewer reads and draws beside its page."""
    end = time.monotonic() + within_s
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.5)
    return False


def test_foxglove_opens_every_channel_unasked(landing, foxglove: Studio):
    with landing.log.open("rb") as log:
        summary = make_reader(log).get_summary()
    foxglove.open_log(landing.log)
    listed = foxglove.topics().splitlines()
    for id, channel in summary.channels.items():
        schema = summary.schemas[channel.schema_id].name
        count = f"{summary.statistics.channel_message_counts[id]:,}"
        first = listed.index(channel.topic)
        assert listed[first + 1 : first + 3] == [schema, count]
    assert "No problems found" in foxglove.problems()


def test_foxglove_draws_the_landing_by_the_layout(landing, foxglove: Studio):
    foxglove.open_log(landing.log)
    foxglove.import_layout(LAYOUT)
    foxglove.go_to(1.0)
    assert becomes(lambda: shows_landed_lander(foxglove.panel("3D")))
    panels = json.loads(LAYOUT.read_text(encoding="utf-8"))["configById"].values()
    titles = [panel["title"] for panel in panels if "title" in panel]
    assert len(titles) == 8
    for title in titles:
        assert becomes(lambda: has_curve(foxglove.panel(title))), title
    assert not foxglove.errors


def test_foxglove_reads_half_a_log_and_says_so(landing, foxglove: Studio, tmp_path):
    half = tmp_path / "half.mcap"
    half.write_bytes(landing.log.read_bytes()[: landing.log.stat().st_size // 2])
    foxglove.open_log(half)
    assert "/telemetry" in foxglove.topics()
    assert "This file is unindexed" in foxglove.problems()
