"""A touchdown in MuJoCo from contact to rest, and the CPU time of its native loop for that.

What is timed is `mujoco.rollout`, MuJoCo's native loop over `mj_step`, without sensors and without Python.
The strut law is the exact one: a first run moves the servos' set-points from Python (mujoco_touchdown.py)
and records them, the timed run replays them and must end in the same bits. So the timed run leaves out four
comparisons a step, in MuJoCo's favour. Only touchdowns whose struts stay in their first stage qualify.
"""

import time
from dataclasses import dataclass

import mujoco
import mujoco.rollout
import numpy as np

from .mujoco_lander import Vehicle
from .mujoco_touchdown import TICK_S, Touchdown
from .touchdown_cases import Case
from .touchdown_verdict import judge

# Who still moves after so long does not come to rest.
STOP_TIME_S = 12
FLIGHT_STEPS, FLIGHT_HEIGHT_M = 5000, 1000.0
UNTIMED = mujoco.mjtDisableBit.mjDSBL_SENSOR | mujoco.mjtDisableBit.mjDSBL_AUTORESET


@dataclass(frozen=True)
class End:
    """A run from contact to rest."""

    steps: int
    position_w: np.ndarray
    tilt_deg: float
    peak_stroke_m: float
    final_state: np.ndarray
    initial_state: np.ndarray
    set_points: np.ndarray


def to_rest(vehicle: Vehicle, case: Case, step_s: float, integrator: str) -> End | None:
    """Runs to the verdict; `None` if it isn't `landed`: then the step was too long."""
    touchdown = Touchdown(vehicle, case, step_s, integrator)
    model, data = touchdown.model, touchdown.data
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    initial = state_of(model, data)
    ticks_a_row = max(1, round(step_s / TICK_S))
    steps_a_row = max(1, round(TICK_S / step_s))
    rows, set_points = [touchdown.row()] * ticks_a_row, []
    while len(rows) < STOP_TIME_S / TICK_S:
        for _ in range(steps_a_row):
            set_points.append(data.ctrl.copy())
            touchdown.step()
        if not np.isfinite(data.qacc).all():
            return None
        # A step longer than a tick shows the verdict the same row for each of its ticks.
        rows += [touchdown.row()] * ticks_a_row
        if len(rows) % 250 < ticks_a_row and judge(vehicle, case, np.array(rows), time_is_up=False):
            break
    verdict = judge(vehicle, case, np.array(rows), time_is_up=True)
    if verdict.outcome != "landed":
        return None
    if verdict.peak_stroke_m >= vehicle.gear("stroke_1"):
        raise ValueError(f"stroke of {verdict.peak_stroke_m} m: the second stage cannot be replayed")
    return End(
        steps=len(set_points),
        position_w=data.qpos[:3].copy(),
        tilt_deg=verdict.rest_tilt_deg,
        peak_stroke_m=verdict.peak_stroke_m,
        final_state=state_of(model, data),
        initial_state=initial,
        set_points=np.array(set_points),
    )


def state_of(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    return state


def replay_s(vehicle: Vehicle, case: Case, step_s: float, integrator: str, end: End) -> float:
    """CPU seconds of a native replay."""
    touchdown = Touchdown(vehicle, case, step_s, integrator)
    model, data = touchdown.model, touchdown.data
    model.opt.disableflags |= UNTIMED
    # Written once, so that their pages are there before the clock starts.
    states = np.ones((1, end.steps, end.initial_state.size))
    sensors = np.ones((1, end.steps, model.nsensordata))
    with mujoco.rollout.Rollout(nthread=0) as native:
        started = time.thread_time()
        native.rollout(
            model, data, end.initial_state[None], end.set_points[None], state=states, sensordata=sensors
        )
        seconds = time.thread_time() - started
    if not np.array_equal(states[0, -1], end.final_state):
        raise RuntimeError("the replay ended elsewhere than the run with the strut law")
    return seconds


def flight_us(vehicle: Vehicle, case: Case) -> float:
    """CPU microseconds of a step of a tick in free fall."""
    touchdown = Touchdown(vehicle, case, TICK_S, "Euler")
    model, data = touchdown.model, touchdown.data
    data.qpos[2] += FLIGHT_HEIGHT_M
    model.opt.disableflags |= UNTIMED
    initial = state_of(model, data)
    with mujoco.rollout.Rollout(nthread=0) as native:
        started = time.thread_time()
        native.rollout(model, data, initial[None], nstep=FLIGHT_STEPS)
        return (time.thread_time() - started) / FLIGHT_STEPS * 1e6
