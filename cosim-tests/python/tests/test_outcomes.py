"""Every scenario of the kit ends as its file says it should."""

import math

import pytest

from conftest import fly


def test_the_default_landing_lands(landing):
    assert landing.results["outcome"] == "landed"
    assert landing.results["interrupted"] is False


@pytest.mark.parametrize(
    ("name", "outcome"),
    [("slope-10", "landed"), ("hop", "landed"), ("no-ignition", "crashed")],
)
def test_outcome(name, outcome, tmp_path):
    assert fly(name, tmp_path).results["outcome"] == outcome


def test_a_tip_over_says_when(tmp_path):
    results = fly("tip-over", tmp_path).results
    assert results["outcome"] == "tipped"
    assert results["contact_time_s"] < results["tip_time_s"] <= results["end_time_s"]


def test_without_ignition_the_fall_is_the_parabola(tmp_path):
    """Thrown at (-15, -5, -25) m/s under 1.625 m/s², touched only by attitude thrusters."""
    results = fly("no-ignition", tmp_path).results
    expected_m_s = 25.0 + 1.625 * results["contact_time_s"]
    # Origin: contact is found to one tick of 1 ms, in which the speed grows by 1.6 mm/s.
    assert abs(results["contact_speed_down_m_s"] - expected_m_s) < 1.7e-3
    # Origin: some 20 g of propellant, burned 0.3 m from the centre of mass of 260 kg, move that
    # centre by 25 µm within the structure over seconds.
    assert abs(results["contact_speed_across_m_s"] - math.hypot(15.0, 5.0)) < 25e-6
