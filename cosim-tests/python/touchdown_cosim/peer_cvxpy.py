"""Powered descent by successive convexification as a textbook writes it: multiple shooting in CVXPY with Clarabel.

The problem, the nodes, the tolerances, the first guess and the outer loop are those of guidance-fmu's planner
for one burn of N intervals (its README, (G.1) to (G.19)). What differs is the subproblem: states at all nodes, the
dynamics linearised between them with a virtual control, log-mass z = ln m, thrust bounds linearised in z. With a thrust
floor its linearised form (G.13) is there from the start: that takes fewest iterations here.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import cvxpy as cp
import numpy as np

G0_M_S2 = 9.80665
TOLERANCE = 1e-8
SLACK_WEIGHT = 1e2
# The stopping rule and the steps of the outer loop, as in the planner.
DEFECT, THRUST_DEFECT, FUEL_CHANGE, PATH_DEFECT_M = 1e-4, 1e-5, 2e-5, 1e-3
LOSSLESS_GAP_MAX = 1e-4
TRUST_START, TRUST_CAP, TRUST_CUT = 0.5, 0.8, 0.35
STIFFNESS_START, STIFFNESS_GROWTH, STIFFNESS_MAX = 1e-2, 10.0, 1.0
OUTER_MAX = 30


@dataclass(frozen=True)
class Problem:
    """A descent to rest at the origin. Angles from the vertical; frame z up."""

    r0_m: tuple[float, float, float]
    v0_m_s: tuple[float, float, float]
    mass_kg: float
    gravity_m_s2: float
    isp_s: float
    thrust_min_n: float
    thrust_max_n: float
    tilt_max_rad: float
    glide_slope_rad: float
    intervals: int

    def scaled(self) -> SimpleNamespace:
        """In units of length L, velocity √(L g), initial mass: all of order one."""
        r0, v0 = np.array(self.r0_m), np.array(self.v0_m_s)
        length = max(np.linalg.norm(r0), v0 @ v0 / (2 * self.gravity_m_s2), 1.0)
        velocity = np.sqrt(length * self.gravity_m_s2)
        weight = self.mass_kg * self.gravity_m_s2
        return SimpleNamespace(
            length=length,
            velocity=velocity,
            r0=r0 / length,
            v0=v0 / velocity,
            g=np.array([0.0, 0.0, -1.0]),
            flow=velocity / (self.isp_s * G0_M_S2),
            thrust_min=self.thrust_min_n / weight,
            thrust_max=self.thrust_max_n / weight,
            cos_tilt=np.cos(self.tilt_max_rad),
            tan_slope=np.tan(self.glide_slope_rad),
            n=self.intervals,
        )


@dataclass
class Iterate:
    """States at nodes; thrust acceleration u and its bound s, held in intervals of length `step`."""

    r: np.ndarray
    v: np.ndarray
    z: np.ndarray
    u: np.ndarray
    s: np.ndarray
    step: float


@dataclass
class Result:
    fuel_kg: float
    outer_iterations: int
    # Position and velocity at the end of an exact roll-out of the thrust, m and m/s.
    miss_m: float
    miss_m_s: float
    lossless_gap: float
    flight_s: float
    # CPU times: what is built and compiled beforehand, then the outer loop.
    construction_ms: float
    loop_ms: float


def first_guess(p: SimpleNamespace) -> Iterate:
    """(G.19): thrust acceleration linear in time, the cheapest of seven flight times."""
    fall = p.v0[2] + np.sqrt(p.v0[2] ** 2 + 2 * max(p.r0[2], 0.0))
    unit = max(fall, np.sqrt(2 * np.linalg.norm(p.r0)))
    guesses = []
    for factor in (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0):
        end = factor * unit
        dv, dr = -p.v0, -p.r0 - p.v0 * end
        a, b = 6 * dr / end**2 - 2 * dv / end, 6 * dv / end**2 - 12 * dr / end**3
        step = end / p.n
        u = a + np.outer((np.arange(p.n) + 0.5) * step, b) - p.g
        guesses.append((step * np.linalg.norm(u, axis=1).sum(), u, step))
    _, u, step = min(guesses, key=lambda guess: guess[0])
    return roll_out(p, u, step)


def roll_out(p: SimpleNamespace, u: np.ndarray, step: float) -> Iterate:
    """The exact states under held accelerations from the initial state (G.4)."""
    s = np.linalg.norm(u, axis=1)
    v = np.vstack([p.v0, p.v0 + np.cumsum((u + p.g) * step, axis=0)])
    r = np.vstack([p.r0, p.r0 + np.cumsum(v[:-1] * step + (u + p.g) * step**2 / 2, axis=0)])
    z = np.concatenate([[0.0], -p.flow * np.cumsum(s) * step])
    return Iterate(r, v, z, u, s, step)


def data(p: SimpleNamespace, ref: Iterate, trust: float, stiffness: float) -> dict[str, np.ndarray]:
    """All that changes between two subproblems."""
    r_step = ref.v[:-1] + ref.step * (ref.u + p.g)
    v_step = ref.u + p.g
    low, high = p.thrust_min * np.exp(-ref.z[1:]), p.thrust_max * np.exp(-ref.z[:-1])
    return {
        "step": ref.step,
        "half_square": ref.step**2 / 2,
        "r_step": r_step,
        "r_constant": ref.step**2 / 2 * p.g - ref.step * r_step,
        "v_step": v_step,
        "v_constant": ref.step * (p.g - v_step),
        "s": ref.s,
        "s_step": ref.s * ref.step,
        "low": low,
        "low_constant": low * (1 + ref.z[1:]),
        "high": high,
        "high_constant": high * (1 + ref.z[:-1]),
        "direction": ref.u / np.linalg.norm(ref.u, axis=1)[:, None],
        "step_min": (1 - trust) * ref.step,
        "step_max": (1 + trust) * ref.step,
        "stiffness": stiffness / (2 * ref.step**2),
        "stiffness_step": stiffness / ref.step,
    }


class Subproblem:
    """The convex program about a reference, from numbers or from parameters."""

    def __init__(self, p: SimpleNamespace, d: dict):
        n, d = p.n, SimpleNamespace(**d)
        r, v, z = cp.Variable((n + 1, 3)), cp.Variable((n + 1, 3)), cp.Variable(n + 1)
        u, s, step = cp.Variable((n, 3)), cp.Variable(n), cp.Variable()
        virtual_r, virtual_v = cp.Variable((n, 3)), cp.Variable((n, 3))
        rows = [
            r[0] == p.r0,
            v[0] == p.v0,
            z[0] == 0,
            r[n] == 0,
            v[n] == 0,
            r[1:] == r[:-1] + d.step * v[:-1] + d.half_square * u + d.r_step * step + d.r_constant + virtual_r,
            v[1:] == v[:-1] + d.step * u + d.v_step * step + d.v_constant + virtual_v,
            z[1:] == z[:-1] - p.flow * (d.step * s + d.s * step - d.s_step),
            cp.norm(u, axis=1) <= s,
            s >= d.low_constant - cp.multiply(d.low, z[1:]),
            s <= d.high_constant - cp.multiply(d.high, z[:-1]),
            u[:, 2] >= p.cos_tilt * s,
            cp.norm(r[1:n, :2], axis=1) <= p.tan_slope * r[1:n, 2],
            step >= d.step_min,
            step <= d.step_max,
        ]
        if p.thrust_min > 0:
            along = cp.sum(cp.multiply(d.direction, u), axis=1)
            rows.append(along >= d.low_constant - cp.multiply(d.low, z[1:]))
        slack = cp.sum(cp.abs(virtual_r)) + cp.sum(cp.abs(virtual_v))
        proximal = d.stiffness * cp.square(step) - d.stiffness_step * step
        # -z is the fuel; over the flow, its Δv.
        self.problem = cp.Problem(cp.Minimize(-z[n] / p.flow + SLACK_WEIGHT * slack + proximal), rows)
        self.variables = (r, v, z, u, s, step)

    def solve(self) -> Iterate:
        self.problem.solve(
            solver=cp.CLARABEL,
            warm_start=True,
            tol_gap_abs=TOLERANCE,
            tol_gap_rel=TOLERANCE,
            tol_feas=TOLERANCE,
            max_threads=1,
        )
        *arrays, step = (variable.value for variable in self.variables)
        return Iterate(*arrays, float(step))


class Naive:
    """Writes and compiles the program anew for every solve."""

    def __init__(self, p: SimpleNamespace, start: dict):
        self.p = p

    def solve(self, d: dict) -> Iterate:
        return Subproblem(self.p, d).solve()


class Dpp:
    """Compiles one parametrised program beforehand, then sets the parameters."""

    def __init__(self, p: SimpleNamespace, start: dict):
        self.parameters = {name: cp.Parameter(np.shape(value)) for name, value in start.items()}
        self.parameters["stiffness"] = cp.Parameter(nonneg=True)
        self.set(start)
        self.subproblem = Subproblem(p, self.parameters)
        if not self.subproblem.problem.is_dcp(dpp=True):
            raise ValueError("the program is not DPP")
        self.subproblem.problem.get_problem_data(cp.CLARABEL)

    def set(self, d: dict):
        for name, value in d.items():
            self.parameters[name].value = value

    def solve(self, d: dict) -> Iterate:
        self.set(d)
        return self.subproblem.solve()


class Defects:
    """How far an iterate is from the true problem, in physical units, and its merit."""

    def __init__(self, problem: Problem, p: SimpleNamespace, x: Iterate):
        a = x.u + p.g
        r = x.r[1:] - (x.r[:-1] + x.v[:-1] * x.step + a * x.step**2 / 2)
        v = x.v[1:] - (x.v[:-1] + a * x.step)
        norm = np.linalg.norm(x.u, axis=1)
        self.delta_v = norm.sum() * x.step
        mass = np.concatenate([[1.0], np.exp(-p.flow * x.step * np.cumsum(norm))])
        thrust = max((norm * mass[:-1] - p.thrust_max).max(), (p.thrust_min - norm * mass[1:]).max(), 0.0)
        self.gap = ((x.s - norm) / x.s).max()
        # Without a floor a gap is harmless.
        lossy = problem.thrust_min_n > 0 and self.gap > LOSSLESS_GAP_MAX
        outside = np.maximum(np.linalg.norm(x.r[1:-1, :2], axis=1) - p.tan_slope * x.r[1:-1, 2], 0.0)
        self.feasible = (
            np.abs(r).max() * p.length <= DEFECT
            and np.abs(v).max() * p.velocity <= DEFECT
            and thrust <= THRUST_DEFECT * p.thrust_max
            and outside.max() * p.length <= PATH_DEFECT_M
            and not lossy
        )
        self.merit = self.delta_v + SLACK_WEIGHT * (
            np.abs(r).sum() + np.abs(v).sum() + outside.sum() + thrust / p.thrust_max
        )


def plan(problem: Problem, method: Callable) -> Result:
    """The planner's outer loop, with `Naive` or `Dpp`."""
    p = problem.scaled()
    reference = first_guess(p)
    trust, stiffness, merit = TRUST_START, STIFFNESS_START, np.inf
    delta_v = np.linalg.norm(reference.u, axis=1).sum() * reference.step
    started = time.process_time()
    solver = method(p, data(p, reference, trust, stiffness))
    built = time.process_time()
    for outer in range(1, OUTER_MAX + 1):
        candidate = solver.solve(data(p, reference, trust, stiffness))
        defects = Defects(problem, p, candidate)
        flat = abs(defects.delta_v / delta_v - 1) <= FUEL_CHANGE
        if defects.feasible and flat:
            break
        if flat:
            stiffness = STIFFNESS_MAX
        if defects.merit < merit:
            trust = min(2 * trust, TRUST_CAP)
            reference, merit, delta_v = candidate, defects.merit, defects.delta_v
        else:
            trust *= TRUST_CUT
            stiffness = min(STIFFNESS_GROWTH * stiffness, STIFFNESS_MAX)
    else:
        raise RuntimeError(f"no convergence in {OUTER_MAX} iterations")
    end = time.process_time()
    flown = roll_out(p, candidate.u, candidate.step)
    return Result(
        fuel_kg=float(problem.mass_kg * -np.expm1(flown.z[-1])),
        outer_iterations=outer,
        miss_m=float(np.linalg.norm(flown.r[-1]) * p.length),
        miss_m_s=float(np.linalg.norm(flown.v[-1]) * p.velocity),
        lossless_gap=float(defects.gap),
        flight_s=float(candidate.step * p.n * p.velocity / problem.gravity_m_s2),
        construction_ms=1e3 * (built - started),
        loop_ms=1e3 * (end - built),
    )
