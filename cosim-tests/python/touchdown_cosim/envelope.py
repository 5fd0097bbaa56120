"""Feasibility of descents that the planner refused, from convex programs of fixed flight time.

`python -m touchdown_cosim.envelope docs/validation/envelope.csv --out docs/validation/envelope-refused.csv`

With the flight time given, held thrust accelerations and no thrust floor make the descent convex but for the
mass, which is iterated: v_n and r_n are linear in the impulses w_j, ‖w_j‖ ≤ h_j ≤ ρ_max/m_j d, w_jz ≥ h_j cos θ,
z ≥ 0 four times an interval, and the target is met up to a priced slack. Each program has one optimum, so nothing depends on a starting
point; flight times are scanned on a grid and refined about the best. A plan needs no such proof: its
re-propagation is one. This needs clarabel (requirements-bench.txt).
"""

import argparse
import csv
import math
import sys
from pathlib import Path

import numpy as np

INTERVALS, HEIGHTS = 60, 4
GRAVITY_M_S2, THRUST_N, TILT_RAD, DRY_KG = 1.625, 5200.0, math.radians(29), 174.0
FLOW_S_M = 1 / (225.0 * 9.80665)
# The slack's price against a scaled unit of Δv; the planner's acceptance limit of the miss.
SLACK_WEIGHT, MISS_MAX = 1e2, 1e-2
TIMES, TIME_RATIO, REFINEMENTS, MASS_PASSES = 36, 1.15, 10, 3


def program(r0_m, v0_m_s, flight_s, mass_kg):
    """Impulses, miss and Δv of the best flight of one duration, for given masses at the nodes."""
    import clarabel
    from scipy import sparse

    n, d = INTERVALS, flight_s / INTERVALS
    length = max(np.linalg.norm(r0_m), v0_m_s @ v0_m_s / (2 * GRAVITY_M_S2), 1.0)
    speed = math.sqrt(length * GRAVITY_M_S2)
    columns = 4 * n + 12  # w by interval, h, slacks
    h = 3 * n
    cost = np.concatenate([np.zeros(3 * n), np.ones(n), np.full(12, SLACK_WEIGHT)])
    # The last height is the target's.
    heights = HEIGHTS * n - 1
    t = d / HEIGHTS * np.arange(1, HEIGHTS * n + 1)
    since = np.maximum(t[:, None] - d * np.arange(n), 0)
    lever = np.where(since < d, since**2 / (2 * d), since - d / 2) * speed / length
    rows = sparse.lil_matrix((6 + 2 * n + n + heights + 12, columns))
    rhs = np.zeros(rows.shape[0])
    fall = np.array([0, 0, -GRAVITY_M_S2])
    for axis in range(3):
        rows[axis, axis : 3 * n : 3] = 1
        rows[3 + axis, axis : 3 * n : 3] = lever[-1]
        rhs[axis] = -(v0_m_s + fall * flight_s)[axis] / speed
        rhs[3 + axis] = -(r0_m + v0_m_s * flight_s + fall * flight_s**2 / 2)[axis] / length
    for row in range(6):
        rows[row, h + n + 2 * row], rows[row, h + n + 2 * row + 1] = 1, -1
    for j in range(n):
        rows[6 + j, h + j] = 1
        rhs[6 + j] = THRUST_N / mass_kg[j] * d / speed
        rows[6 + n + j, h + j], rows[6 + n + j, 3 * j + 2] = math.cos(TILT_RAD), -1
        rows[6 + 2 * n + j, h + j] = -1
    for k in range(heights):
        rows[6 + 3 * n + k, 2 : 3 * n : 3] = -lever[k]
        rhs[6 + 3 * n + k] = (r0_m[2] + v0_m_s[2] * t[k] - GRAVITY_M_S2 * t[k] ** 2 / 2) / length
    for slack in range(12):
        rows[6 + 3 * n + heights + slack, h + n + slack] = -1
    cones = sparse.lil_matrix((4 * n, columns))
    for j in range(n):
        cones[4 * j, h + j] = -1
        for axis in range(3):
            cones[4 * j + 1 + axis, 3 * j + axis] = -1
    a = sparse.vstack([rows, cones]).tocsc()
    b = np.concatenate([rhs, np.zeros(4 * n)])
    shape = [clarabel.ZeroConeT(6), clarabel.NonnegativeConeT(rows.shape[0] - 6)]
    shape += [clarabel.SecondOrderConeT(4)] * n
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    quadratic = sparse.csc_matrix((columns, columns))
    answer = clarabel.DefaultSolver(quadratic, cost, a, b, shape, settings).solve()
    x = np.array(answer.x)
    w = x[: 3 * n].reshape(n, 3) * speed
    miss_r = (w * lever[-1][:, None]).sum(axis=0) * length / speed - rhs[3:6] * length
    miss_v = w.sum(axis=0) - rhs[:3] * speed
    miss = max(np.linalg.norm(miss_r), np.linalg.norm(miss_v))
    return w, miss, answer.obj_val


def flight(r0_m, v0_m_s, mass_kg, flight_s):
    """Objective, miss and propellant of the best flight of one duration."""
    masses = np.full(INTERVALS, mass_kg)
    for _ in range(MASS_PASSES):
        w, miss, objective = program(r0_m, v0_m_s, flight_s, masses)
        spent = np.concatenate([[0], np.cumsum(np.linalg.norm(w, axis=1))])
        masses = mass_kg * np.exp(-FLOW_S_M * spent[:-1])
    return objective, miss, mass_kg * -math.expm1(-FLOW_S_M * spent[-1])


def verdict(r0_m, v0_m_s, mass_kg):
    """Whether some duration meets the target with the propellant on board, and the least of what it takes."""
    unit_s = max(math.sqrt(2 * r0_m[2] / GRAVITY_M_S2), np.linalg.norm(v0_m_s) / GRAVITY_M_S2)
    first_s = 0.05 * unit_s
    best = min(
        (*flight(r0_m, v0_m_s, mass_kg, first_s * TIME_RATIO**k), first_s * TIME_RATIO**k) for k in range(TIMES)
    )
    low_s, high_s = best[3] / TIME_RATIO, best[3] * TIME_RATIO
    for _ in range(REFINEMENTS):
        thirds = np.linspace(low_s, high_s, 4)[1:3]
        left, right = ((*flight(r0_m, v0_m_s, mass_kg, time_s), time_s) for time_s in thirds)
        best = min(best, left, right)
        low_s, high_s = (low_s, thirds[1]) if left < right else (thirds[0], high_s)
    _, miss, propellant_kg, flight_s = best
    if miss > MISS_MAX:
        return "out of reach", miss, propellant_kg, flight_s
    return ("feasible" if propellant_kg <= mass_kg - DRY_KG else "fuel"), miss, propellant_kg, flight_s


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table", type=Path, help="of the planner's example `envelope`")
    parser.add_argument("--out", type=Path, required=True, help="table to write")
    arguments = parser.parse_args()
    with arguments.table.open() as file:
        refused = [row for row in csv.DictReader(file) if row["planner"] != "plan"]
    wrong = 0
    with arguments.out.open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["state", "planner", "convex", "miss", "propellant_kg", "on_board_kg", "flight_s"])
        for row in refused:
            r0_m = np.array([float(row[f"r0_{axis}_m"]) for axis in "xyz"])
            v0_m_s = np.array([float(row[f"v0_{axis}_m_s"]) for axis in "xyz"])
            mass_kg = float(row["mass_kg"])
            found, miss, propellant_kg, flight_s = verdict(r0_m, v0_m_s, mass_kg)
            wrong += found == "feasible"
            cells = [f"{miss:.3g}", f"{propellant_kg:.3f}", f"{mass_kg - DRY_KG:.3f}", f"{flight_s:.2f}"]
            table.writerow([row["state"], row["planner"], found, *cells])
    print(f"{len(refused)} refused, {wrong} of them feasible", file=sys.stderr)


if __name__ == "__main__":
    main()
