"""The table of docs/validation/pontryagin.csv is what the shooting finds."""

import csv
from pathlib import Path

import numpy as np
import pytest

from touchdown_cosim.pontryagin import COLUMNS, shoot

TABLE = Path(__file__).parents[3] / "docs/validation/pontryagin.csv"
ROWS = [[float(value) for value in row.values()] for row in csv.DictReader(TABLE.open())]


@pytest.mark.parametrize("row", ROWS[:4])
def test_rows_are_found_again(row):
    flight = shoot(np.array(row[:3]), np.array(row[3:6]))
    # The last digit of the table.
    assert flight.propellant_kg == pytest.approx(row[COLUMNS.index("propellant_kg")], abs=1e-6)


def test_free_of_gravity_losses_two_impulses_cost_less():
    """Two impulses along the same coast are a lower bound that finite thrust comes near (rocket equation)."""
    r0, v0 = np.array([300.0, 100.0, 500.0]), np.array([-15.0, -5.0, -25.0])
    flight = shoot(r0, v0, tilt_deg=90.0)
    times_s = np.linspace(10.0, 30.0, 2001)[:, None]
    gravity = np.array([0.0, 0.0, -1.625])
    first = -r0 / times_s - v0 - 0.5 * gravity * times_s
    last = -(v0 + first + gravity * times_s)
    delta_v = (np.linalg.norm(first, axis=1) + np.linalg.norm(last, axis=1)).min()
    impulsive_kg = 259.5 * (1.0 - np.exp(-delta_v / (225.0 * 9.80665)))
    # Gravity acts for 2.5 s of the last burn against 20 m/s² of thrust: some percent.
    assert impulsive_kg < flight.propellant_kg < 1.1 * impulsive_kg
