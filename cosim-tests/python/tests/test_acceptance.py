"""What a landing must be: the figures of the project's acceptance list."""

import numpy as np
import pytest

from conftest import FMUS, SCENARIOS, fly
from touchdown_cosim.table import fly as fly_table
from touchdown_cosim.table import vectors

FEET = 4


def check_commands_and_tilt(table):
    commands = np.concatenate([table["thrust_command_n"], [0.0]])
    forbidden = (commands > 0.0) & (commands < 800.0)
    assert not forbidden.any(), "thrust was commanded between off and the engine's floor"
    assert commands.max() <= 5200.0
    assert table["tilt_deg"].max() <= 34.0


def check_touchdown(results):
    assert results["outcome"] == "landed"
    assert 0.0 < results["contact_speed_down_m_s"] <= 2.0
    assert results["contact_speed_across_m_s"] <= 0.5
    assert results["position_error_m"] <= 5.0
    assert results["dead_zone_time_s"] == 0.0
    # Positive: no edge was ever within reach of the energy on board.
    assert results["tip_energy_margin_j"] > 0.0
    assert results["stability_distance_m"] > 0.0
    assert results["least_hull_clearance_m"] > 0.0 and results["least_nozzle_clearance_m"] > 0.0
    assert results["hull_struck"] == results["nozzle_struck"] == results["leg_bottomed"] == 0.0


def test_each_foot_has_its_first_contact_and_the_margins_their_course(landing, landing_table):
    results = landing.results
    times = results["foot_contact_time_s"]
    assert min(times[:FEET]) == results["contact_time_s"] and times[FEET:] == [None, None]
    speeds = results["foot_contact_speed_normal_m_s"]
    assert all(0.0 < speed <= 2.5 for speed in speeds[:FEET])
    # Before contact there is nothing to tip over; from then on the least value is the least.
    touched = landing_table["time_s"] > results["contact_time_s"]
    for now, least in [
        ("tip_margin_now_j", "tip_energy_margin_j"),
        ("stability_distance_now_m", "stability_distance_m"),
    ]:
        assert np.isnan(landing_table[now][~touched]).all()
        assert landing_table[now][touched].min() >= results[least]


def test_the_default_landing(landing, landing_table):
    check_touchdown(landing.results)
    check_commands_and_tilt(landing_table)
    # From (300, 100, 500) m at (-15, -5, -25) m/s, to rest on all feet.
    assert vectors(landing_table, "position_w", 3)[0].tolist() == [300.0, 100.0, 500.0]
    assert vectors(landing_table, "velocity_w", 3)[0].tolist() == [-15.0, -5.0, -25.0]
    assert vectors(landing_table, "foot_contact", FEET)[-1].min() == 1.0
    # 5 mm/s is what the verdict calls rest.
    assert np.linalg.norm(vectors(landing_table, "velocity_w", 3)[-1]) < 5e-3


def test_at_rest_the_struts_carry_the_sprung_weight(landing_table):
    """The hull's weight, that is all but the four feet of 2 kg, on the struts' vertical loads."""
    load_n = vectors(landing_table, "foot_load_n", FEET)[-1].sum()
    tilt = np.radians(landing_table["tilt_deg"][-1])
    expected_n = (landing_table["mass_kg"][-1] - FEET * 2.0) * 1.625
    # 0.1 % for what still rocks at rest; axial loads are along the body's axis.
    assert load_n * np.cos(tilt) == pytest.approx(expected_n, rel=1e-3)


@pytest.mark.parametrize("name", ["slope-10", "hop"])
def test_other_landings(name, tmp_path):
    check_touchdown(fly(name, tmp_path).results)
    table = fly_table(SCENARIOS / f"{name}.toml", FMUS)
    check_commands_and_tilt(table)
    if name == "slope-10":
        assert table["tilt_deg"][-1] == pytest.approx(10.0, abs=1.5)  # unequal crush on 3.8 m
    else:
        assert table["contact_active"][1] == 1.0, "the hop must start in contact"
        assert table["foot_contact[1]"][1] == 1.0
        assert table["altimeter_m"].max() > 20.0
        assert table["position_w[1]"][0] == 200.0


def test_the_bad_touchdown_is_the_one_described(tmp_path):
    results = fly("tip-over", tmp_path).results
    assert results["contact_speed_across_m_s"] == pytest.approx(2.5, abs=1e-9)
    assert results["tip_energy_margin_j"] < 0.0
