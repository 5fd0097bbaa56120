"""MuJoCo's lander from contact to rest: error and time against the step.

`python -m touchdown_cosim.bench_mujoco [--json] [--repeats N] [--integrators NAME ...] [--vehicle FILE]`

What is timed is `mujoco.rollout`, MuJoCo's native loop over `mj_step`, without sensors and without Python.
The strut law is the exact one: a first run moves the servos' set-points from Python (mujoco_touchdown.py)
and records them, the timed run replays them and must end in the same bits. So the timed run leaves out four
comparisons a step, in MuJoCo's favour. Only touchdowns whose struts stay in their first stage qualify.
Times are CPU time of the one thread, so that a busy machine distorts them little.

Errors are against MuJoCo's own run with steps of 0.02 ms: final position of O, final tilt, peak stroke.
"""

import argparse
import json
import statistics
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np

from .land import FAILED, INTERRUPTED, complain
from .mujoco_lander import Vehicle
from .mujoco_touchdown import TICK_S, Touchdown
from .touchdown_cases import GRAVITY_M_S2, PROPELLANT_KG, Case
from .touchdown_verdict import judge

INTEGRATORS = ("Euler", "implicitfast", "discrete", "RK4")
STEPS_S = (4e-3, 2e-3, 1e-3, 0.5e-3, 0.25e-3, 0.125e-3)
REFERENCE_STEP_S, REFERENCE_INTEGRATOR = 0.02e-3, "Euler"
STOP_TIME_S = 12
FLIGHT_STEPS, FLIGHT_HEIGHT_M = 5000, 1000.0

FLAT = Case(
    propellant_kg=PROPELLANT_KG,
    gravity_m_s2=GRAVITY_M_S2,
    down_m_s=1.0,
    across_m_s=0.3,
    travel_deg=0.0,
    roll_deg=0.0,
    pitch_deg=0.0,
    yaw_deg=0.0,
    rate_x_deg_s=0.0,
    rate_y_deg_s=0.0,
    rate_z_deg_s=0.0,
    slope_deg=0.0,
    downhill_deg=0.0,
    friction=0.6,
    captured=0,
)
CASES = {
    "flat": FLAT,
    "two legs first, downhill": replace(FLAT, slope_deg=8.0, across_m_s=0.6),
    "one leg first, across": replace(FLAT, slope_deg=8.0, across_m_s=0.6, travel_deg=90.0, yaw_deg=45.0),
    "tilted and turning": replace(FLAT, roll_deg=3.0, pitch_deg=-4.0, rate_y_deg_s=5.0, rate_z_deg_s=3.0),
    "rocking on held pads": replace(FLAT, captured=1, across_m_s=1.2),
}


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
        if len(rows) % 250 < ticks_a_row and at_rest(vehicle, case, np.array(rows)):
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


def at_rest(vehicle: Vehicle, case: Case, history: np.ndarray) -> bool:
    return judge(vehicle, case, history, time_is_up=False) is not None


def state_of(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    return state


def timed(vehicle: Vehicle, case: Case, step_s: float, integrator: str, end: End, repeats: int):
    """CPU seconds of each native replay."""
    touchdown = Touchdown(vehicle, case, step_s, integrator)
    model, data = touchdown.model, touchdown.data
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_SENSOR | mujoco.mjtDisableBit.mjDSBL_AUTORESET
    states = np.empty((1, end.steps, end.initial_state.size))
    sensors = np.empty((1, end.steps, model.nsensordata))
    seconds = []
    with mujoco.rollout.Rollout(nthread=0) as native:
        for _ in range(repeats):
            started = time.thread_time()
            native.rollout(
                model, data, end.initial_state[None], end.set_points[None], state=states, sensordata=sensors
            )
            seconds.append(time.thread_time() - started)
    if not np.array_equal(states[0, -1], end.final_state):
        raise RuntimeError("the replay ended elsewhere than the run with the strut law")
    return seconds


def flight_us(vehicle: Vehicle, repeats: int) -> float:
    """CPU microseconds of a step of a tick in free fall, the least of several runs."""
    touchdown = Touchdown(vehicle, FLAT, TICK_S, "Euler")
    model, data = touchdown.model, touchdown.data
    data.qpos[2] += FLIGHT_HEIGHT_M
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_SENSOR
    initial, seconds = state_of(model, data), []
    with mujoco.rollout.Rollout(nthread=0) as native:
        for _ in range(repeats):
            started = time.thread_time()
            native.rollout(model, data, initial[None], nstep=FLIGHT_STEPS)
            seconds.append(time.thread_time() - started)
    return min(seconds) / FLIGHT_STEPS * 1e6


def bench(
    vehicle: Vehicle,
    repeats: int,
    steps_s=STEPS_S,
    integrators=INTEGRATORS,
    cases=CASES,
    say=lambda text: None,
) -> list[dict]:
    """A row per case, integrator and step."""
    rows = []
    for name, case in cases.items():
        say(name)
        exact = to_rest(vehicle, case, REFERENCE_STEP_S, REFERENCE_INTEGRATOR)
        for integrator in integrators:
            for step_s in steps_s:
                row = {"name": name, "integrator": integrator, "step_ms": step_s * 1e3}
                end = to_rest(vehicle, case, step_s, integrator)
                row["at_rest"] = end is not None
                if end:
                    seconds = timed(vehicle, case, step_s, integrator, end, repeats)
                    row |= {
                        "steps": end.steps,
                        "position_error_m": float(np.linalg.norm(end.position_w - exact.position_w)),
                        "tilt_error_deg": abs(end.tilt_deg - exact.tilt_deg),
                        "peak_stroke_error": end.peak_stroke_m / exact.peak_stroke_m - 1.0,
                        "step_us_min": min(seconds) / end.steps * 1e6,
                        "step_us_median": statistics.median(seconds) / end.steps * 1e6,
                        "touchdown_ms_median": statistics.median(seconds) * 1e3,
                    }
                rows.append(row | {"case": asdict(case)})
    return rows


def table(rows: list[dict]) -> str:
    head = "integrator     step ms   position m    tilt deg  peak stroke   us a step (min)   ms a touchdown"
    lines = []
    for row in rows:
        if not lines or row["name"] != name:
            name = row["name"]
            lines += ["", name, head]
        line = f"{row['integrator']:<13}{row['step_ms']:>9.3f}"
        if row["at_rest"]:
            line += f"{row['position_error_m']:>13.1e}{row['tilt_error_deg']:>12.1e}"
            line += f"{100.0 * row['peak_stroke_error']:>+11.2f} %{row['step_us_median']:>10.1f}"
            line += f" ({row['step_us_min']:.1f}){row['touchdown_ms_median']:>17.1f}"
        else:
            line += "   does not come to rest"
        lines.append(line)
    return "\n".join(lines[1:])


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="bench_mujoco", description=__doc__.splitlines()[0])
    parser.add_argument("--vehicle", type=Path, default=Path("models/vehicles/bug.toml"))
    parser.add_argument("--repeats", type=int, default=7, help="timed runs of each")
    parser.add_argument("--integrators", nargs="+", choices=INTEGRATORS, default=INTEGRATORS)
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    options = parser.parse_args(arguments)
    try:
        vehicle = Vehicle(options.vehicle)
        flight = flight_us(vehicle, options.repeats)
        rows = bench(
            vehicle,
            options.repeats,
            integrators=options.integrators,
            say=lambda text: print(text, file=sys.stderr),
        )
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        complain(error)
        return FAILED
    if options.json:
        print(json.dumps({"mujoco": mujoco.__version__, "flight_us": flight, "rows": rows}, indent=1))
    else:
        print(f"flight: {flight:.1f} us a step of {1e3 * TICK_S:.0f} ms")
        print(table(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
