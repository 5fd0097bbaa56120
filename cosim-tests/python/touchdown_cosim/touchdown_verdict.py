"""The verdict on a recorded touchdown, written down again from truth-model/README.md, "Verdict".

The kit's own verdict is Rust and judges the kit's own trajectories. This one shares no code with it, so
that a comparison of outcomes tests the verdict as well as the motion. It works on whole histories at once
(columns: mujoco_touchdown.py), and counts a bounce as near the ground however high it is.
"""

from dataclasses import dataclass

import numpy as np

from .mujoco_lander import Vehicle
from .touchdown_cases import Case

CRASH_SPEED_M_S = 5.0
SLIDE_LIMIT_M = 1.0
REST_SPEED_M_S = 5e-3
REST_RATE_RAD_S = 1e-3
REST_TICKS = 500
REST_DRIFT_M = 1e-4
REST_TURN_RAD = 1e-4
REST_FEET = 3
TIP_TICKS = 500
BOTTOMED_GAP_M = 1e-4
TICK_S = 1e-3
# A pad that slides in MuJoCo hops by micrometres; on the ground means loaded within so many ticks.
HOP_TICKS = 20


@dataclass(frozen=True)
class Verdict:
    """Results under the names of `lander touchdowns`; NaN where nothing was measured."""

    outcome: str
    end_time_s: float
    contact_time_s: float
    rest_tilt_deg: float
    tip_energy_margin_j: float
    tip_time_s: float
    peak_stroke_m: float
    slide_distance_m: float


@dataclass(frozen=True)
class Seen:
    """What the verdict looks at, per tick."""

    pads_loaded: np.ndarray
    # Pads that carried load within the time of rest.
    pads_felt: np.ndarray
    structure: np.ndarray
    stroke_m: np.ndarray
    speed_m_s: np.ndarray
    rate_rad_s: np.ndarray
    tilt_deg: np.ndarray
    margin_j: np.ndarray
    supported: np.ndarray
    attitude: np.ndarray
    footprint_w: np.ndarray


def rotations(quaternions: np.ndarray) -> np.ndarray:
    """Body to world, from (w, x, y, z)."""
    w, x, y, z = quaternions.T
    return np.stack([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)


def see(vehicle: Vehicle, case: Case, history: np.ndarray) -> Seen:
    feet = len(vehicle.gear("feet_b"))
    position_w, quaternion, stroke_m, velocity_w, rate_b, _, loads_n, structure_n = np.split(
        history, np.cumsum([3, 4, feet, 3, 3, feet, feet]), axis=1
    )
    attitude = rotations(quaternion)
    rate_w = np.einsum("tij,tj->ti", attitude, rate_b)
    mass = vehicle.mass(case.propellant_kg)
    com_arm_w = attitude @ mass.com_b
    com_velocity_w = velocity_w + np.cross(rate_w, com_arm_w)
    feet_b = vehicle.gear("feet_b") + stroke_m[:, :, None] * np.array([0.0, 0.0, 1.0])
    feet_w = position_w[:, None] + np.einsum("tij,tfj->tfi", attitude, feet_b)
    inertia_w = attitude @ mass.inertia_b @ attitude.transpose(0, 2, 1)
    spin_w = np.einsum("tij,tj->ti", inertia_w, rate_w)

    margin_j, supported = np.full(len(history), np.inf), np.full(len(history), True)
    for n in range(feet):
        arm_w = position_w + com_arm_w - feet_w[:, n]
        edge_w = feet_w[:, (n + 1) % feet] - feet_w[:, n]
        edge_w = edge_w / np.linalg.norm(edge_w, axis=1, keepdims=True)
        # Rotation about +edge carries a point above it outwards, feet being counter-clockwise.
        outward_m = np.einsum("ti,ti->t", arm_w, np.cross(edge_w, [0.0, 0.0, 1.0]))
        radius_w = arm_w - edge_w * np.einsum("ti,ti->t", arm_w, edge_w)[:, None]
        radius_m = np.linalg.norm(radius_w, axis=1)
        climb_m = radius_m * np.sqrt(1.0 - edge_w[:, 2] ** 2) - radius_w[:, 2]
        barrier_j = mass.mass_kg * case.gravity_m_s2 * climb_m  # (T.14)
        momentum_w = spin_w + mass.mass_kg * np.cross(arm_w, com_velocity_w)
        momentum = np.maximum(np.einsum("ti,ti->t", momentum_w, edge_w), 0.0)
        inertia = np.einsum("ti,tij,tj->t", edge_w, inertia_w, edge_w) + mass.mass_kg * radius_m**2
        energy_j = momentum**2 / (2.0 * inertia)
        beyond = outward_m > 0.0
        supported &= ~beyond
        margin_j = np.minimum(margin_j, np.where(beyond, -barrier_j, barrier_j - energy_j))  # (T.15)

    return Seen(
        pads_loaded=(loads_n > 0.0).sum(axis=1),
        pads_felt=recently(loads_n > 0.0, REST_TICKS).sum(axis=1),
        structure=(structure_n > 0.0).any(axis=1),
        stroke_m=stroke_m.max(axis=1),
        speed_m_s=np.linalg.norm(com_velocity_w, axis=1),
        rate_rad_s=np.linalg.norm(rate_b, axis=1),
        tilt_deg=np.degrees(np.arctan2(np.hypot(*attitude[:, :2, 2].T), attitude[:, 2, 2])),
        margin_j=margin_j,
        supported=supported,
        attitude=attitude,
        footprint_w=feet_w.mean(axis=1),
    )


def lasting(condition: np.ndarray) -> np.ndarray:
    """For how many ticks in a row the condition has held."""
    ticks = np.arange(1, len(condition) + 1)
    return ticks - np.maximum.accumulate(np.where(condition, 0, ticks))


def recently(condition: np.ndarray, ticks: int) -> np.ndarray:
    """Whether the condition has held within the last ticks."""
    count = np.cumsum(condition, axis=0)
    count[ticks:] -= count[:-ticks].copy()
    return count > 0


def first_true(condition: np.ndarray) -> int:
    """Index of the first true, or the length."""
    return int(np.argmax(condition)) if condition.any() else len(condition)


def stands_still(seen: Seen) -> np.ndarray:
    """Per tick, whether it has now been slow, and where it was, for the time of rest."""
    still = (
        (seen.margin_j > 0.0)
        & (seen.speed_m_s < REST_SPEED_M_S)
        & (seen.rate_rad_s < REST_RATE_RAD_S)
    )
    stands = (seen.pads_felt >= REST_FEET) | recently(seen.structure, REST_TICKS)
    rests = (lasting(still) > REST_TICKS) & stands
    drift_m = np.linalg.norm((seen.footprint_w[REST_TICKS:] - seen.footprint_w[:-REST_TICKS])[:, :2], axis=1)
    # Two rotations a small angle apart differ by sqrt(2) times it in the Frobenius norm.
    change = seen.attitude[REST_TICKS:] - seen.attitude[:-REST_TICKS]
    turn_rad = np.linalg.norm(change, axis=(1, 2)) / np.sqrt(2.0)
    rests[REST_TICKS:] &= (drift_m <= REST_DRIFT_M) & (turn_rad <= REST_TURN_RAD)
    return rests


def judge(vehicle: Vehicle, case: Case, history: np.ndarray, time_is_up: bool) -> Verdict | None:
    """The verdict, or `None` while undecided. Row 0 is the state before the first tick."""
    seen = see(vehicle, case, history)
    felt = (seen.pads_loaded > 0) | seen.structure
    first = first_true(felt)
    new_impact = felt & ~np.append(False, seen.pads_loaded[:-1] > 0)
    crashed = first_true(new_impact & (np.append(0.0, seen.speed_m_s[:-1]) > CRASH_SPEED_M_S))
    outside = lasting(~seen.supported)
    head_down = seen.attitude[:, 2, 2] < 0.0
    # The tick that finds it outside is the first of the run, so 500 ticks later it is the 501st.
    tipped = first_true((outside > TIP_TICKS) | ((outside > 0) & (seen.structure | head_down)))
    at_rest = first_true(stands_still(seen) & (np.arange(len(history)) >= first))
    end = min(crashed, tipped, at_rest)
    decided = end < len(history)
    if not decided and not time_is_up:
        return None
    end = min(end, len(history) - 1)

    after = slice(first, end + 1)
    touched = first <= end
    bottom_m = vehicle.gear("stroke_max") - BOTTOMED_GAP_M
    slide_m = np.nan
    if touched:
        slide_m = float(np.hypot(*(seen.footprint_w[end] - seen.footprint_w[first])[:2]))
    if end == crashed:
        outcome = "crashed"
    elif outside[end] > 0:
        outcome = "tipped"
    elif seen.structure[after].any():
        outcome = "struck"
    elif (seen.stroke_m[after] > bottom_m).any():
        outcome = "bottomed"
    elif not touched or not seen.pads_loaded[max(end - HOP_TICKS, 0) : end + 1].any():
        outcome = "no_contact"
    elif end != at_rest or slide_m > SLIDE_LIMIT_M:
        outcome = "slid"
    else:
        outcome = "landed"
    return Verdict(
        outcome=outcome,
        end_time_s=end * TICK_S,
        # Row n is the end of the tick that began at n - 1.
        contact_time_s=(first - 1) * TICK_S if touched else np.nan,
        rest_tilt_deg=float(seen.tilt_deg[end]) if touched else np.nan,
        tip_energy_margin_j=float(seen.margin_j[after].min()) if touched else np.nan,
        tip_time_s=(end - outside[end]) * TICK_S if outcome == "tipped" else np.nan,
        peak_stroke_m=float(seen.stroke_m[after].max()) if touched else np.nan,
        slide_distance_m=slide_m,
    )
