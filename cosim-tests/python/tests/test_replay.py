"""The replay page in a browser: it shows the landing, without a network or a server."""

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from matplotlib import image

from conftest import LANDER, run

BROWSER = [
    *("chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"),
    *("--window-size=960,600", "--hide-scrollbars", "--virtual-time-budget=3000"),
]


@pytest.fixture(scope="module")
def page(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("replay")
    done = run([LANDER, "replay", "tip-over", "--out", out])
    assert done.returncode == 0, done.stderr
    file = out / "tip-over.html"
    assert done.stdout == f"{file}\n"
    return file


def browse(page: Path, fragment: str, *options: str) -> str:
    command = [*BROWSER, f"--user-data-dir={page.parent / 'profile'}", *options, f"{page.as_uri()}#{fragment}"]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout


def picture(page: Path, fragment: str) -> np.ndarray:
    """Screenshot, an array of rows of red, green, blue from 0 to 1."""
    file = page.parent / "shot.png"
    browse(page, fragment, f"--screenshot={file}")
    return image.imread(file)[..., :3]


def test_the_page_needs_nothing_else(page):
    text = page.read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)\s*=|@import|url\(|fetch\(|https?://""", text)


def test_it_tells_the_verdict_and_the_state_of_its_time(page):
    document = browse(page, "t=2.4", "--dump-dom")
    assert 'data-ready="yes"' in document, "the script ended early"
    assert "TIPPED OVER" in document and "tips over" in document
    assert re.search(r"2\.40 / \d\.\d\d s", document)
    # Past the static angle of 44° with the two downhill legs crushed, the uphill ones in the air.
    tilt_deg = float(re.search(r"tilt</td><td>([\d.]+)°", document)[1])
    assert 30.0 < tilt_deg < 60.0
    strokes_cm = [float(text) for text in re.findall(r"([\d.]+) cm", document)]
    assert len(strokes_cm) == 4 and sum(stroke > 1.0 for stroke in strokes_cm) == 2


def test_it_draws_lander_ground_and_sky_and_moves(page):
    start, later = picture(page, "t=0.2"), picture(page, "t=2.4")
    red, green, blue = np.moveaxis(start, -1, 0)
    gold = (red > 0.25) & (red > 1.3 * blue) & (green > 1.1 * blue)
    grey = (abs(red - blue) < 0.06) & (red > 0.15) & (red < 0.5)
    dark = start.max(axis=-1) < 0.05
    # The lander stands in the middle of a view that is half ground, half sky.
    middle = np.s_[150:450, 320:640]
    assert gold[middle].mean() > 0.03
    assert grey.mean() > 0.2 and dark.mean() > 0.1
    assert (abs(start - later).max(axis=-1) > 0.1).mean() > 0.02


def test_an_unknown_camera_follows(page):
    assert (picture(page, "t=2.4&camera=nonsense") == picture(page, "t=2.4")).all()


def test_a_scenario_that_is_not_there_leaves_no_page(tmp_path):
    done = run([LANDER, "replay", "nowhere", "--out", tmp_path])
    assert done.returncode == 2 and done.stderr.startswith("error: ")
    assert not list(tmp_path.glob("*.html"))
