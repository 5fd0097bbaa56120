"""One touchdown in MuJoCo: the state at contact, the plastic struts, and what is recorded tick by tick."""

from dataclasses import dataclass

import mujoco
import numpy as np

from .mujoco_lander import Site, Vehicle, build, hull_extent, nozzle_extent
from .touchdown_cases import Case

TICK_S = 1e-3
# The lowest point starts this far from the ground, m, as in `lander touchdowns`.
START_GAP_M = 2e-3

# Columns of a history: qpos (O, attitude as w, x, y, z, strokes), qvel (v_O in world axes, rate in body
# axes, stroke rates), then per pad, hull and nozzle the largest load on it within the tick.


class Struts:
    """The exact law (T.10 to T.12): MuJoCo clamps the servo's force, this moves its set-point and limit."""

    def __init__(self, vehicle: Vehicle, model: mujoco.MjModel, data: mujoco.MjData):
        self.loads_n = vehicle.gear("crush_load_1"), vehicle.gear("crush_load_2")
        self.stage_2_m, self.stop_m = vehicle.gear("stroke_1"), vehicle.gear("stroke_max")
        self.stiffness_n_m = vehicle.gear("stiffness")
        self.stroke_m, self.crushed_m = data.qpos[7:], data.ctrl
        self.limits_n = model.actuator_forcerange
        self.elastic_m = self.loads_n[0] / self.stiffness_n_m
        self.all_in_stage_1 = True

    def after_step(self):
        """Keeps what this step crushed, and sets the load at which each strut will flow in the next."""
        were_in_stage_1, self.all_in_stage_1 = self.all_in_stage_1, self.stroke_m.max() < self.stage_2_m
        if were_in_stage_1 and self.all_in_stage_1:
            np.maximum(self.crushed_m, self.stroke_m - self.elastic_m, out=self.crushed_m)
            return
        load_n = np.where(self.stroke_m < self.stage_2_m, *self.loads_n)
        crushed_m = np.minimum(self.stroke_m - load_n / self.stiffness_n_m, self.stop_m)
        np.maximum(self.crushed_m, crushed_m, out=self.crushed_m)
        self.limits_n[:, 0], self.limits_n[:, 1] = -load_n, load_n


@dataclass
class Touchdown:
    """A case in MuJoCo, ready to run."""

    vehicle: Vehicle
    case: Case
    step_s: float
    integrator: str

    def __post_init__(self):
        case = self.case
        site = Site(
            case.gravity_m_s2, case.slope_deg, case.downhill_deg, case.friction, bool(case.captured)
        )
        self.model = build(self.vehicle, site, case.propellant_kg, self.step_s, self.integrator)
        self.data = mujoco.MjData(self.model)
        self.data.qpos[:7], self.data.qvel[:6] = start(self.vehicle, case, site.normal_w)
        self.struts = Struts(self.vehicle, self.model, self.data)

    def step(self):
        mujoco.mj_step(self.model, self.data)
        self.struts.after_step()

    def run(self, seconds: float) -> np.ndarray:
        """The history of the next `seconds`, a row a tick."""
        steps = round(TICK_S / self.step_s)
        forces_n = np.zeros((steps, self.data.sensordata.size))
        rows = []
        for _ in range(round(seconds / TICK_S)):
            for force_n in forces_n:
                self.step()
                force_n[:] = self.data.sensordata
            rows.append(self.row(forces_n))
        return np.array(rows)

    def row(self, forces_n: np.ndarray | None = None) -> np.ndarray:
        """The history's row of the present state; loads are the largest of several steps' if given."""
        forces_n = self.data.sensordata if forces_n is None else forces_n
        loads_n = np.abs(forces_n).reshape(-1, self.model.nsensor, 3).max(axis=(0, 2))
        return np.concatenate([self.data.qpos, self.data.qvel, loads_n])


def start(vehicle: Vehicle, case: Case, normal_w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pose and twist of O with the lowest point of pads, hull and nozzle just above the ground."""
    roll, pitch, yaw = np.radians([case.roll_deg, case.pitch_deg, case.yaw_deg])
    quaternion = np.zeros(4)
    # Turns about world x, then y, then z.
    mujoco.mju_euler2Quat(quaternion, np.array([roll, pitch, yaw]), "XYZ")
    attitude = np.zeros(9)
    mujoco.mju_quat2Mat(attitude, quaternion)
    attitude = attitude.reshape(3, 3)
    normal_b = attitude.T @ normal_w

    lowest_m = (vehicle.pad_centres_b @ normal_b).min() - vehicle.gear("pad_radius")
    rim = np.hypot(normal_b[0], normal_b[1])
    for radius_m, *heights_m in (hull_extent(vehicle), nozzle_extent(vehicle)):
        lowest_m = min(lowest_m, min(heights_m) * normal_b[2] - radius_m * rim)
        lowest_m = min(lowest_m, max(heights_m) * normal_b[2] - radius_m * rim)
    position_w = np.array([0.0, 0.0, (START_GAP_M - lowest_m) / normal_w[2]])

    rate_b = np.radians([case.rate_x_deg_s, case.rate_y_deg_s, case.rate_z_deg_s])
    travel = np.radians(case.travel_deg)
    com_velocity_w = np.array(
        [case.across_m_s * np.cos(travel), case.across_m_s * np.sin(travel), -case.down_m_s]
    )
    com_b = vehicle.mass(case.propellant_kg).com_b
    velocity_w = com_velocity_w - attitude @ np.cross(rate_b, com_b)
    return np.concatenate([position_w, quaternion]), np.concatenate([velocity_w, rate_b])
