"""A gate for continuous integration: `pytest test_gate.py` fails unless every scenario lands.

Copy it beside your scenarios, and list them.
"""

import json
import subprocess

import pytest


@pytest.mark.parametrize("scenario", ["landing", "slope-10"])
def test_it_lands_softly_on_the_target(scenario, tmp_path):
    command = ["cargo", "land", scenario, "--json", "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    landing = json.loads(done.stdout)
    assert landing["outcome"] == "landed"
    assert landing["contact_speed_down_m_s"] < 2.0
    assert landing["position_error_m"] < 1.0
    assert landing["peak_stroke_m"] < 0.15
