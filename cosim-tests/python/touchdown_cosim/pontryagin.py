"""Minimum-fuel descents by Pontryagin's principle: full thrust, coast, full thrust, by indirect shooting.

`python -m touchdown_cosim.pontryagin [--r0 X Y Z] [--v0 X Y Z] [--tilt-deg D]`: one flight to rest at the origin
`python -m touchdown_cosim.pontryagin --table ROWS --out FILE.csv`: random flights about the descent

Maximise the final mass of r' = v, v' = T û/m + g, m' = -α T with 0 ≤ T ≤ T_max, û within a cone about
the vertical, and free time. With costates λ_r, λ_v, λ_m (λ_v is Lawden's primer vector):

    H = λ_r·v + λ_v·(T û/m + g) - α λ_m T = 0
    λ_r' = 0,  λ_v' = -λ_r,  λ_m' = (λ_v·û) T/m²
    û maximises λ_v·û within the cone;  S = λ_v·û/(α m) - λ_m;  T = T_max where S > 0, else 0

So λ_v is linear in time, the mass is known while the engine runs, and a burn is a quadrature. The nine unknowns
λ_v(0), λ_r and three durations meet r = v = 0 and H = 0 at the end and S = 0 at both switches; λ_m(0) = 1
fixes the scale. There are no nodes in time and no convex program. The engine's floor is never met.
"""

import argparse
import csv
import sys
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from .land import FAILED, complain

GRAVITY_W = np.array([0.0, 0.0, -1.625])
THRUST_N, MASS_KG = 5200.0, 259.5
FLOW_S_M = 1 / (225.0 * 9.80665)
R0_M, V0_M_S, TILT_DEG = (300.0, 100.0, 500.0), (-15.0, -5.0, -25.0), 29.0
SPREAD_M, SPREAD_M_S = 60.0, 6.0
# Gauss-Legendre. Where û meets the cone within a burn it has a kink, which leaves an error of 1e-6.
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(24)
RESIDUAL_MAX = 1e-9
STARTS = 200
AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Flight:
    propellant_kg: float
    first_burn_s: float
    coast_s: float
    last_burn_s: float
    # Largest angle of the thrust from the vertical; the limit where it is active.
    tilt_max_deg: float


COLUMNS = [*(f"r0_{axis}_m" for axis in AXES), *(f"v0_{axis}_m_s" for axis in AXES), *Flight.__dataclass_fields__]


def direction(primer, tilt_rad):
    """The unit vectors within the cone that have the largest product with each primer."""
    across = np.linalg.norm(primer[:, :2], axis=1)
    tilt = np.minimum(np.arctan2(across, primer[:, 2]), tilt_rad)
    heading = primer[:, :2] / np.maximum(across, np.finfo(float).tiny)[:, None]
    return np.column_stack([np.sin(tilt)[:, None] * heading, np.cos(tilt)])


class Extremal:
    """The flight that leaves (r0, v0) with given costates and switches after given durations."""

    def __init__(self, r0, v0, tilt_rad, unknowns):
        self.primer0, self.lambda_r, self.tilt_rad = unknowns[:3], unknowns[3:6], tilt_rad
        self.durations_s = unknowns[6:]
        self.t, self.r, self.v, self.mass, self.lambda_m = 0.0, r0, v0, MASS_KG, 1.0
        self.tilts = []
        first_s, coast_s, last_s = self.durations_s
        start = self.switching()
        self.burn(first_s)
        first_switch = self.switching()
        self.fall(coast_s)
        self.switches = [first_switch, self.switching()]
        self.burn(last_s)
        self.outer = [start, self.switching()]

    def primer(self, t):
        return self.primer0 - np.multiply.outer(t, self.lambda_r)

    def switching(self):
        """S now."""
        primer = self.primer(self.t)[None]
        gain = np.sum(primer * direction(primer, self.tilt_rad))
        return gain / (FLOW_S_M * self.mass) - self.lambda_m

    def fall(self, duration_s):
        self.r = self.r + self.v * duration_s + 0.5 * GRAVITY_W * duration_s**2
        self.v = self.v + GRAVITY_W * duration_s
        self.t += duration_s

    def burn(self, duration_s):
        after, weights = 0.5 * duration_s * (1 + POINTS), 0.5 * duration_s * WEIGHTS
        primer = self.primer(self.t + after)
        u = direction(primer, self.tilt_rad)
        self.tilts.append(np.arccos(u[:, 2].min()))
        mass = self.mass - FLOW_S_M * THRUST_N * after
        acceleration = THRUST_N / mass[:, None] * u
        self.fall(duration_s)
        self.r = self.r + ((duration_s - after) * weights) @ acceleration
        self.v = self.v + weights @ acceleration
        self.lambda_m += weights @ (np.sum(primer * u, axis=1) * THRUST_N / mass**2)
        self.mass -= FLOW_S_M * THRUST_N * duration_s

    def residual(self):
        """Target miss in 100 m and 10 m/s, S at both switches, H at the end."""
        hamiltonian = self.lambda_r @ self.v + self.primer(self.t) @ GRAVITY_W
        hamiltonian += FLOW_S_M * THRUST_N * self.switching()
        return np.concatenate([self.r / 100, self.v / 10, self.switches, [hamiltonian]])

    def is_consistent(self):
        """Whether the engine is on where S > 0 and off where S < 0.

        S' is that of λ_v·û over α m, and λ_v·û is convex in time: S falls, then rises, and its two zeros are
        the switches if it is positive at both ends.
        """
        return min(self.durations_s) > 0 and min(self.outer) > 0


def two_impulses(r0, v0, tilt_rad):
    """Costates and durations of the cheapest two impulses joined by free fall, within the cone if any are."""
    best = (np.inf,)
    for t_s in np.geomspace(2, 200, 800):
        first = -r0 / t_s - v0 - 0.5 * GRAVITY_W * t_s
        last = -(v0 + first + GRAVITY_W * t_s)
        outside = max(np.arctan2(np.hypot(*dv[:2]), dv[2]) for dv in (first, last)) - tilt_rad
        price = np.linalg.norm(first) + np.linalg.norm(last) + 1e3 * max(0.0, outside)
        if price < best[0]:
            best = (price, t_s, first, last)
    _, t_s, first, last = best
    primer, primer_end = (FLOW_S_M * MASS_KG * dv / np.linalg.norm(dv) for dv in (first, last))
    burns_s = [MASS_KG * np.linalg.norm(dv) / THRUST_N for dv in (first, last)]
    coast_s = max(t_s - 0.5 * sum(burns_s), 0.5)
    return np.concatenate([primer, (primer - primer_end) / t_s, [burns_s[0], coast_s, burns_s[1]]])


def shoot(r0, v0, tilt_deg=TILT_DEG):
    """The cheapest extremal from the two impulses and starts near them; `None` if there is none."""
    tilt_rad = np.radians(tilt_deg)
    guess = two_impulses(r0, v0, tilt_rad)
    random = np.random.default_rng(1)
    for start in range(STARTS):
        spread = 0.2 * random.standard_normal(9) if start else 0.0
        found = least_squares(
            lambda unknowns: Extremal(r0, v0, tilt_rad, unknowns).residual(),
            guess * (1 + spread),
            x_scale=np.maximum(np.abs(guess), 1e-4),
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
            max_nfev=200,
        )
        end = Extremal(r0, v0, tilt_rad, found.x)
        if np.abs(found.fun).max() < RESIDUAL_MAX and end.is_consistent():
            return Flight(MASS_KG - end.mass, *end.durations_s, np.degrees(max(end.tilts)))
    return None


def table(rows, file):
    """`rows` random flights about the descent, normal in each axis."""
    random = np.random.default_rng(2)
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(COLUMNS)
    while rows:
        r0 = (np.array(R0_M) + SPREAD_M * random.standard_normal(3)).round(2)
        v0 = (np.array(V0_M_S) + SPREAD_M_S * random.standard_normal(3)).round(3)
        flight = shoot(r0, v0)
        if flight is None:
            print(f"no flight on-off-on from {r0} m, {v0} m/s", file=sys.stderr)
            continue
        writer.writerow([*r0, *v0, *(f"{value:.6f}" for value in astuple(flight))])
        rows -= 1


def main():
    parser = argparse.ArgumentParser(prog="pontryagin", description=__doc__.splitlines()[0])
    parser.add_argument("--r0", type=float, nargs=3, default=R0_M, metavar="M")
    parser.add_argument("--v0", type=float, nargs=3, default=V0_M_S, metavar="M_S")
    parser.add_argument("--tilt-deg", type=float, default=TILT_DEG, help="limit, at most 90")
    parser.add_argument("--table", type=int, metavar="ROWS")
    parser.add_argument("--out", type=Path, metavar="FILE.csv")
    options = parser.parse_args()
    if options.table is not None:
        with options.out.open("w", encoding="utf-8") if options.out else sys.stdout as file:
            table(options.table, file)
        return 0
    flight = shoot(np.array(options.r0), np.array(options.v0), options.tilt_deg)
    if flight is None:
        complain("no flight on-off-on found")
        return FAILED
    for name, value in zip(Flight.__dataclass_fields__, astuple(flight), strict=True):
        print(f"{name:<14} {value:.6f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
