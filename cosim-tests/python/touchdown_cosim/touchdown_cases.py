"""Touchdowns as rows of a CSV file, as `lander touchdowns` reads them, and the grid of the comparison.

A case is the state at contact, engine off: velocity of the centre of mass, attitude against the
vertical, body rates, and the ground. Azimuths count from world x towards world y.
"""

import csv
import random
from dataclasses import astuple, dataclass, fields
from itertools import product
from pathlib import Path


@dataclass(frozen=True)
class Case:
    propellant_kg: float
    gravity_m_s2: float
    down_m_s: float
    across_m_s: float
    travel_deg: float
    roll_deg: float
    pitch_deg: float
    yaw_deg: float
    rate_x_deg_s: float
    rate_y_deg_s: float
    rate_z_deg_s: float
    slope_deg: float
    downhill_deg: float
    friction: float
    captured: int


COLUMNS = [field.name for field in fields(Case)]

# Around the captured-pad tip speeds of BUG, 1.5 m/s downhill to 3.2 m/s over a foot, and beyond
# what one leg can absorb.
ACROSS_M_S = (0.5, 1.5, 2.25, 3.0)
DOWN_M_S = (0.5, 1.5, 3.0)
# Slope, direction of travel against downhill.
GROUND_DEG = ((0.0, 0.0), (7.5, 0.0), *product((15.0,), (0.0, 90.0, 180.0)))
HEADING_DEG = (0.0, 22.5, 45.0)
# Friction, captured.
PADS = ((0.2, 0), (0.6, 0), (1.0, 0), (0.6, 1))
# Near the end of a landing; the Moon.
PROPELLANT_KG = 5.0
GRAVITY_M_S2 = 1.625


def grid() -> list[Case]:
    """Every combination of horizontal and vertical speed, ground, heading and pads."""
    axes = product(GROUND_DEG, PADS, HEADING_DEG, DOWN_M_S, ACROSS_M_S)
    return [
        Case(
            propellant_kg=PROPELLANT_KG,
            gravity_m_s2=GRAVITY_M_S2,
            down_m_s=down,
            across_m_s=across,
            travel_deg=travel,
            roll_deg=0.0,
            pitch_deg=0.0,
            yaw_deg=heading,
            rate_x_deg_s=0.0,
            rate_y_deg_s=0.0,
            rate_z_deg_s=0.0,
            slope_deg=slope,
            downhill_deg=0.0,
            friction=friction,
            captured=captured,
        )
        for (slope, travel), (friction, captured), heading, down, across in axes
    ]


def some(cases: list[Case], count: int) -> list[Case]:
    """`count` of the cases, drawn once and for all, in their order."""
    chosen = random.Random(1).sample(range(len(cases)), min(count, len(cases)))
    return [cases[n] for n in sorted(chosen)]


def anywhere(count: int) -> list[Case]:
    """`count` touchdowns of BUG from all over its envelope and beyond, drawn once and for all."""
    draw = random.Random(1)

    def between(low: float, high: float) -> float:
        # Three digits, so that a row can be typed.
        return round(draw.uniform(low, high), 3)

    return [
        Case(
            propellant_kg=between(0.0, 85.5),
            gravity_m_s2=GRAVITY_M_S2,
            down_m_s=between(0.3, 3.5),
            across_m_s=between(0.0, 3.0),
            travel_deg=between(-180.0, 180.0),
            roll_deg=between(-8.0, 8.0),
            pitch_deg=between(-8.0, 8.0),
            yaw_deg=between(-180.0, 180.0),
            rate_x_deg_s=between(-8.0, 8.0),
            rate_y_deg_s=between(-8.0, 8.0),
            rate_z_deg_s=between(-8.0, 8.0),
            slope_deg=between(0.0, 15.0),
            downhill_deg=between(-180.0, 180.0),
            friction=between(0.2, 1.0),
            captured=int(draw.random() < 0.2),
        )
        for _ in range(count)
    ]


def write(file: Path, cases: list[Case]):
    with file.open("w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(astuple(case) for case in cases)
