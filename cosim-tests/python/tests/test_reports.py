"""Every report in a real browser: no errors, nothing missing, figures drawn, no word over another."""

import json
import re
import subprocess
from dataclasses import dataclass
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from matplotlib import image

from conftest import LANDER, ROOT, run
from test_replay import BROWSER

WIDTH = 1100

# Of each figure: its place on the page, what is drawn in it, and words that are cut off, too small or over another.
MEASURE = """
const rectangle = (r) => ({left: r.left, top: r.top, right: r.right, bottom: r.bottom});
const cross = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1
  && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 2;
const figures = [...document.querySelectorAll('figure svg')].map((svg) => {
  const box = rectangle(svg.getBoundingClientRect());
  const words = [...svg.querySelectorAll('text')].map((t) => ({text: t.textContent, ...rectangle(t.getBoundingClientRect())}));
  const out = words.filter((w) => w.left < box.left || w.right > box.right || w.top < box.top || w.bottom > box.bottom);
  const small = words.filter((w) => Math.min(w.right - w.left, w.bottom - w.top) < 6 && w.text.length > 1);
  const over = words.flatMap((a, i) => words.slice(i + 1).filter((b) => cross(a, b)).map((b) => a.text + ' / ' + b.text));
  const shapes = svg.querySelectorAll('polyline, circle, rect, line, path, polygon').length;
  return {box, shapes, out: out.map((w) => w.text), small: small.map((w) => w.text), over};
});
const page = document.documentElement;
const tables = [...document.querySelectorAll('table')].map((t) => t.getBoundingClientRect().right);
const found = document.createElement('pre');
found.id = 'measured';
found.textContent = JSON.stringify({figures, tables, height: page.scrollHeight, wide: page.scrollWidth});
document.body.append(found);
"""

CAMPAIGN = """
name = "small"
kind = "touchdown"
scenario = "{scenarios}/tip-over.toml"
runs = {{ value = 60, unit = "1" }}
seed = {{ value = 3, unit = "1" }}

[case]
captured = {{ value = 1.0, unit = "1" }}

[[design]]
key = "scenario.contact.engine"
distribution = "constant"
value = "strut"

[[dispersion]]
key = "case.across_m_s"
distribution = "uniform"
low = {{ value = 0.1, unit = "m/s" }}
high = {{ value = 2.5, unit = "m/s" }}

[[dispersion]]
key = "case.slope_deg"
distribution = "uniform"
low = {{ value = 0.0, unit = "deg" }}
high = {{ value = 10.0, unit = "deg" }}

[rare_event]
samples = {{ value = 500, unit = "1" }}
"""
MAP = """
name = "mapped"
kind = "touchdown"
scenario = "{scenarios}/tip-over.toml"
runs = {{ value = 1, unit = "1" }}

[case]
slope_deg = {{ value = 0.0, unit = "deg" }}

[[design]]
key = "scenario.contact.engine"
distribution = "constant"
value = "strut"

[map]
across = {{ value = [0.0, 4.0], unit = "m/s" }}
down = {{ value = [0.5, 4.0], unit = "m/s" }}
cells = {{ value = [5, 5], unit = "1" }}
depth = {{ value = 1, unit = "1" }}

[[map.cases]]
name = "level, captured"
captured = {{ value = 1.0, unit = "1" }}

[[map.cases]]
name = "downhill, sliding"
slope_deg = {{ value = 12.0, unit = "deg" }}
"""

AXES = """
[[axis]]
name = "footprint_factor"
key = "vehicle.gear.feet_b"
as = "factor"
values = {{ value = [0.7, 1.0, 1.3], unit = "1" }}
"""
TWO_AXES = AXES + """
[[axis]]
name = "com_raised"
key = "vehicle.mass.dry_com_b[3]"
as = "added"
low = {{ value = -0.3, unit = "m" }}
high = {{ value = 0.3, unit = "m" }}
count = {{ value = 3, unit = "1" }}
"""


@dataclass(frozen=True)
class Seen:
    """A report as the browser shows it."""

    html: str
    measured: dict
    errors: list
    picture: np.ndarray


def browse(page: Path, *options: str) -> subprocess.CompletedProcess:
    command = [*BROWSER, f"--user-data-dir={page.parent / 'profile'}", *options, page.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)


def look_at(page: Path) -> Seen:
    html = page.read_text(encoding="utf-8")
    instrumented = page.with_name("measured.html")
    script = f"<script>{MEASURE}</script></body>"
    instrumented.write_text(html.replace("</body>", script), encoding="utf-8")
    size = f"--window-size={WIDTH},800"
    document = browse(instrumented, size, "--dump-dom").stdout
    found = re.search(r'<pre id="measured">(.*?)</pre>', document, re.DOTALL)[1]
    measured = json.loads(unescape(found))
    shot = page.with_name("shot.png")
    size = f"--window-size={WIDTH},{int(measured['height'])}"
    done = browse(page, size, f"--screenshot={shot}", "--enable-logging=stderr")
    errors = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    return Seen(html, measured, errors, image.imread(shot)[..., :3])


# Name of a report: its command, its study and its page.
STUDIES = {
    "campaign": ("campaign", CAMPAIGN, "small/report.html"),
    "rare": ("rare", CAMPAIGN, "small/rare-event.html"),
    "map": ("map", MAP, "mapped/report.html"),
    "curves": ("design", CAMPAIGN + AXES, "small/report.html"),
    "heat maps": ("design", CAMPAIGN + TWO_AXES, "small/report.html"),
}


@pytest.fixture(scope="module", params=["paper", *STUDIES])
def report(request, tmp_path_factory) -> Seen:
    out = tmp_path_factory.mktemp(request.param.replace(" ", "-"))
    if request.param == "paper":
        done = run([LANDER, "paper", "--runs", "2", "--out", out])
        page = out / "report.html"
        assert done.stdout == f"{page}\n", done.stderr
    else:
        command, text, page = STUDIES[request.param]
        page = out / page
        study = out / "study.toml"
        study.write_text(text.format(scenarios=ROOT / "models" / "scenarios"), encoding="utf-8")
        done = run([LANDER, command, study, "--out", out])
    assert done.returncode == 0, done.stderr
    return look_at(page)


def test_it_needs_nothing_else_and_the_browser_has_no_complaint(report):
    elsewhere = r"""(src|href)\s*=|@import|url\(|fetch\(|<script|https?://(?!www\.w3\.org)"""
    assert not re.search(elsewhere, report.html)
    assert report.errors == []


def test_nothing_reaches_beyond_the_page(report):
    assert report.measured["wide"] <= WIDTH
    assert max(report.measured["tables"]) <= WIDTH


def test_every_figure_is_drawn_and_its_words_can_be_read(report):
    figures = report.measured["figures"]
    assert figures and len(figures) == report.html.count("<figure>")
    for figure in figures:
        assert figure["shapes"] >= 5
        assert (figure["out"], figure["small"], figure["over"]) == ([], [], []), figure
        sides = ("left", "top", "right", "bottom")
        left, top, right, bottom = (round(figure["box"][side]) for side in sides)
        drawn = report.picture[top:bottom, left:right].min(axis=-1) < 0.9
        # An empty frame with its axes covers less than a hundredth; a bar fills a third of its picture's rows.
        assert drawn.mean() > 0.01 and drawn.any(axis=1).mean() > 0.3
