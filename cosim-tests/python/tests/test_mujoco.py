"""An outside engine: the same lander in MuJoCo.

First MuJoCo's own model against closed forms, so that the peer is known to be right; then part of the grid
of `touchdown_cosim.compare_mujoco` against the kit's engine and verdict. The whole grid: docs/validation.
"""

import csv
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from conftest import LANDER, ROOT
from touchdown_cosim import bench_mujoco, compare_mujoco, touchdown_cases
from touchdown_cosim.compare_mujoco import STEP_S, mujoco_verdict, run_to_verdict
from touchdown_cosim.mujoco_lander import Vehicle
from touchdown_cosim.mujoco_touchdown import START_GAP_M, Touchdown
from touchdown_cosim.touchdown_cases import Case

BUG = ROOT / "models" / "vehicles" / "bug.toml"
GRAVITY_M_S2 = 1.625
FAMILIES = bench_mujoco.families(bench_mujoco.FILE)
FLAT = FAMILIES["flat"][0]


def symmetric_bug() -> Vehicle:
    """BUG with its dry centre of mass on the axis, as the closed forms assume."""
    vehicle = Vehicle(BUG)
    vehicle.table["mass"]["dry_com_b"]["value"] = [0.0, 0.0, 1.38]
    return vehicle


def test_hull_and_feet_together_are_the_vehicle():
    vehicle = Vehicle(BUG)
    touchdown = Touchdown(vehicle, FLAT, 1e-3, "Euler")
    model, data = touchdown.model, touchdown.data
    mujoco.mj_forward(model, data)
    expected = vehicle.mass(FLAT.propellant_kg)
    # Rounding of sums near 200.
    assert model.body_subtreemass[1] == pytest.approx(expected.mass_kg, abs=1e-12)
    assert data.subtree_com[1] - data.qpos[:3] == pytest.approx(expected.com_b, abs=1e-12)
    # Angular momentum about the centre of mass at unit rates, upright: the columns of the inertia.
    momentum = []
    for rate_b in np.eye(3):
        data.qvel[:] = 0.0
        data.qvel[3:6] = rate_b
        mujoco.mj_forward(model, data)
        mujoco.mj_subtreeVel(model, data)
        momentum.append(data.subtree_angmom[1].copy())
    assert np.array(momentum) == pytest.approx(expected.inertia_b, abs=1e-9)


def test_a_flat_drop_crushes_what_the_energy_balance_says():
    vehicle = symmetric_bug()
    speed_m_s = 1.8
    case = replace(FLAT, propellant_kg=0.0, down_m_s=speed_m_s, across_m_s=0.0)
    verdict = mujoco_verdict(vehicle, case)
    # The damper has each strut at its crush load from the start (truth-model, tests/touchdown.rs).
    sprung_kg = 174.0 - 4.0 * vehicle.gear("foot_mass")
    weight_n, crush_n = sprung_kg * GRAVITY_M_S2, 4.0 * vehicle.gear("crush_load_1")
    energy_j = 0.5 * sprung_kg * speed_m_s**2 + weight_n * 2e-3
    stroke_m = energy_j / (crush_n - weight_n)
    # 1.5 %: what the step of 0.25 ms is chosen for (bench_mujoco).
    assert stroke_m < vehicle.gear("stroke_1")
    assert verdict.peak_stroke_m == pytest.approx(stroke_m, rel=0.015)
    assert verdict.outcome == "landed"


def test_sliding_pads_slow_down_by_coulomb_friction():
    case = replace(FLAT, propellant_kg=0.0, down_m_s=0.5, across_m_s=2.0, friction=0.2)
    verdict = mujoco_verdict(symmetric_bug(), case)
    # Friction takes mu times the normal impulse, of the impact and then of the weight.
    impact_m_s = np.sqrt(0.5**2 + 2.0 * GRAVITY_M_S2 * 2e-3)
    expected_m = (2.0 - 0.2 * impact_m_s) ** 2 / (2.0 * 0.2 * GRAVITY_M_S2)
    # 0.5 %: the acceptance of slides.
    assert verdict.slide_distance_m == pytest.approx(expected_m, rel=5e-3)
    assert verdict.outcome == "slid"


def test_captured_pads_tip_over_at_the_closed_form_speed():
    """(T.17) with point feet on legs that don't give, level, over an edge, dry."""
    vehicle = symmetric_bug()
    gear = vehicle.table["gear"]
    # The weight compresses them by 0.07 mm. Less damping, and they rebound: 4e3 N s/m adds 2 %.
    gear["stiffness"]["value"], gear["damping"]["value"] = 1e6, 2e4
    gear["crush_load_1"]["value"] = gear["crush_load_2"]["value"] = 1e9
    gear["pad_radius"]["value"] = 1e-3
    edge_m, height_m, mass_kg = 1.3328963, 1.38, 174.0
    inertia = 126.1 + mass_kg * (edge_m**2 + height_m**2)
    barrier_j = mass_kg * GRAVITY_M_S2 * (np.hypot(edge_m, height_m) - height_m)
    speed_m_s = np.sqrt(2.0 * barrier_j * inertia) / (mass_kg * height_m)
    assert speed_m_s == pytest.approx(2.012, abs=1e-3), "the independent table of closed forms"

    def tips(relative: float) -> bool:
        case = replace(
            FLAT, propellant_kg=0.0, down_m_s=0.0, across_m_s=relative * speed_m_s, captured=1
        )
        # So much damping on 2 kg needs an implicit integrator.
        touchdown = Touchdown(vehicle, case, STEP_S, "implicitfast")
        # On the ground: a fall of 2 mm would take 4 % of the momentum about the edge.
        touchdown.data.qpos[2] -= START_GAP_M
        return run_to_verdict(touchdown).outcome == "tipped"

    # 0.5 %: the acceptance of tip speeds; measured within 0.2 %.
    assert not tips(0.995) and tips(1.005)


@pytest.fixture(scope="module")
def rows() -> list[dict]:
    cases = touchdown_cases.some(touchdown_cases.grid(), 20)
    return compare_mujoco.compare(LANDER, BUG, cases)


def test_the_kit_and_mujoco_agree_on_the_class(rows):
    print(compare_mujoco.report(rows))
    # The project's acceptance: 95 %.
    assert np.mean([row["agree"] for row in rows]) >= 0.95
    assert len({row["mujoco_outcome"] for row in rows}) >= 3, "the grid must reach several classes"


def test_where_both_stand_they_stand_alike(rows):
    both = [r for r in rows if r["kit_outcome"] == r["mujoco_outcome"] == "landed"]
    assert len(both) >= 5
    error_deg = [abs(r["kit_rest_tilt_deg"] - r["mujoco_rest_tilt_deg"]) for r in both]
    # One leg's crush of 1 cm more or less on a base of 2.7 m is 0.2 deg; the median stays below.
    assert np.median(error_deg) < 0.2, error_deg


def test_the_committed_table_is_of_this_grid_and_agrees():
    with (ROOT / "docs" / "validation" / "mujoco.csv").open(encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    cases = [Case(*(float(row[name]) for name in touchdown_cases.COLUMNS)) for row in table]
    # At least 200: the project's acceptance.
    assert len(cases) >= 200
    assert cases == touchdown_cases.some(touchdown_cases.grid(), len(cases)), "of another grid"
    agree = [row["kit_outcome"] == row["mujoco_outcome"] for row in table]
    # The project's acceptance: 95 %.
    assert np.mean(agree) >= 0.95


def test_a_shorter_step_is_nearer_to_the_reference():
    vehicle, name = Vehicle(BUG), "flat"
    series = bench_mujoco.prepare(vehicle, {name: FAMILIES[name]}, steps_s=(1e-3, 0.25e-3))
    coarse, fine = (timed.errors for timed in series)
    assert fine.place_error_m < coarse.place_error_m
    assert fine.stroke_error_percent < coarse.stroke_error_percent
    # The promise of compare_mujoco's step.
    assert fine.stroke_error_percent < 1.5 and fine.place_error_m < 4e-3
    for timed in series:
        timed.time(vehicle)
        # Until a round is timed it is without end.
        assert 0.0 < timed.row()["to_rest_ms"] < np.inf


def test_a_step_that_is_too_long_has_no_row():
    # 20 ms is ten times what the footpads' contact takes.
    case = FAMILIES["rocking on held pads"][0]
    assert not bench_mujoco.prepare(Vehicle(BUG), {"held": [case]}, steps_s=(20e-3,))
