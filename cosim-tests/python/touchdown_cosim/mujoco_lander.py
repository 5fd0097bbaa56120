"""The lander of a vehicle file as a MuJoCo model: a hull on a free joint, one footpad a leg on a slide.

Built from the vehicle file and the equations of truth-model/README.md alone, so that an error in the
kit's own contact engine is not repeated here. Body axes and units are those of docs/CONVENTIONS.md.

Modelling choices, after MuJoCo's documentation ("Modeling": contact parameters; "Computation": friction
cones, integrators):

* `cone="elliptic"` with `impratio`: a true Coulomb cone whose tangential slip is stiffer than its normal.
* `solref` holds a pad on the ground at 500 Hz, critically damped, as stiff as the kit's pads; MuJoCo keeps
  the time constant at two steps or more by itself. `solimp` near one makes contact hard.
* The strut (T.10) is a position servo on the slide: force = clamp(k (s_p - s) - c s', ± F_crush), which MuJoCo
  clamps natively and integrates implicitly. Its set-point is the crushed length s_p (T.12).
"""

import tomllib
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

# Of truth-model/README.md, "Contact".
FOOT_GYRATION_M = 0.1
EXTENSION_STOP_M = 0.02
CAPTURED_FRICTION = 1e3
PAD_TIME_CONSTANT_S = 1.0 / (2.0 * np.pi * 500.0)

IMPRATIO = 100.0
SOLIMP = "0.99 0.999 1e-4"

# Legs stroke along the body axis.
STROKE_AXIS_B = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Mass:
    """Mass, kg; centre of mass from O, m; inertia about it, kg m²; body axes."""

    mass_kg: float
    com_b: np.ndarray
    inertia_b: np.ndarray


def together(*parts: Mass) -> Mass:
    """Rigid union; a part of negative mass and inertia is taken away."""
    mass_kg = sum(part.mass_kg for part in parts)
    com_b = sum(part.mass_kg * part.com_b for part in parts) / mass_kg
    inertia_b = sum(part.inertia_b + part.mass_kg * steiner(part.com_b - com_b) for part in parts)
    return Mass(mass_kg, com_b, inertia_b)


def steiner(offset: np.ndarray) -> np.ndarray:
    """Parallel-axis term of a unit mass."""
    return offset @ offset * np.eye(3) - np.outer(offset, offset)


class Vehicle:
    """Numbers of a vehicle file, by section and key."""

    def __init__(self, file: Path):
        self.table = tomllib.loads(file.read_text(encoding="utf-8"))
        if "primary_top_b" in self.table["gear"]:
            raise RuntimeError(f"{file}: key `gear.primary_top_b`: legs stroke along the body axis here")

    def number(self, section: str, key: str):
        value = self.table[section][key]["value"]
        return np.array(value) if isinstance(value, list) else value

    def gear(self, key: str):
        return self.number("gear", key)

    @property
    def pad_centres_b(self) -> np.ndarray:
        """At the struts' free length, m."""
        return self.gear("feet_b") + np.array([0.0, 0.0, self.gear("pad_radius")])

    def mass(self, propellant_kg: float) -> Mass:
        dry = Mass(
            self.number("mass", "dry_mass"),
            self.number("mass", "dry_com_b"),
            np.diag(self.number("mass", "dry_inertia_b")),
        )
        gyration = self.number("mass", "propellant_gyration_radius_b")
        com_b = self.number("mass", "propellant_com_b")
        return together(dry, Mass(propellant_kg, com_b, propellant_kg * np.diag(gyration**2)))

    def hull(self, propellant_kg: float) -> Mass:
        """The vehicle less its feet."""
        foot_kg = self.gear("foot_mass")
        own = foot_kg * FOOT_GYRATION_M**2 * np.eye(3)
        feet = [Mass(-foot_kg, centre_b, -own) for centre_b in self.pad_centres_b]
        return together(self.mass(propellant_kg), *feet)


@dataclass(frozen=True)
class Site:
    """The ground that a lander meets: a plane through the world's origin."""

    gravity_m_s2: float
    slope_deg: float
    downhill_deg: float
    friction: float
    captured: bool

    @property
    def normal_w(self) -> np.ndarray:
        slope, downhill = np.radians([self.slope_deg, self.downhill_deg])
        across = np.sin(slope)
        return np.array([across * np.cos(downhill), across * np.sin(downhill), np.cos(slope)])


def build(
    vehicle: Vehicle, site: Site, propellant_kg: float, step_s: float, integrator="implicitfast"
) -> mujoco.MjModel:
    """The model; qpos is O, attitude (w, x, y, z) and the strokes, qvel v_O in world, rate in body axes."""
    pad_friction = CAPTURED_FRICTION if site.captured else site.friction
    hull = vehicle.hull(propellant_kg)
    i = hull.inertia_b
    inertia = (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
    legs = [leg(vehicle, n, centre_b, pad_friction) for n, centre_b in enumerate(vehicle.pad_centres_b)]
    struts = [strut(vehicle, n) for n in range(len(legs))]
    touches = [touch(f"pad{n}") for n in range(len(legs))] + [touch("hull"), touch("nozzle")]
    return mujoco.MjModel.from_xml_string(f"""
<mujoco model="{vehicle.table["name"]}">
  <option timestep="{step_s!r}" gravity="0 0 {-site.gravity_m_s2!r}" integrator="{integrator}"
          cone="elliptic" impratio="{IMPRATIO}"/>
  <default>
    <geom contype="1" conaffinity="2" condim="3" mass="0" solimp="{SOLIMP}"
          solref="{PAD_TIME_CONSTANT_S} 1" friction="{site.friction!r} 0 0"/>
  </default>
  <worldbody>
    <geom name="ground" type="plane" size="0 0 1" zaxis="{numbers(site.normal_w)}"
          contype="2" conaffinity="1" friction="0 0 0"/>
    <body name="lander">
      <freejoint/>
      <inertial pos="{numbers(hull.com_b)}" mass="{hull.mass_kg!r}" fullinertia="{numbers(inertia)}"/>
      {cylinder("hull", *hull_extent(vehicle))}
      {cylinder("nozzle", *nozzle_extent(vehicle))}
      {"".join(legs)}
    </body>
  </worldbody>
  <actuator>{"".join(struts)}</actuator>
  <sensor>{"".join(touches)}</sensor>
</mujoco>""")


def leg(vehicle: Vehicle, n: int, centre_b: np.ndarray, friction: float) -> str:
    foot_kg = vehicle.gear("foot_mass")
    own = foot_kg * FOOT_GYRATION_M**2
    return f"""
<body name="foot{n}" pos="{numbers(centre_b)}">
  <inertial pos="0 0 0" mass="{foot_kg!r}" diaginertia="{own} {own} {own}"/>
  <joint name="leg{n}" type="slide" axis="{numbers(STROKE_AXIS_B)}" limited="true"
         range="{-EXTENSION_STOP_M} {vehicle.gear("stroke_max")!r}"
         solreflimit="{PAD_TIME_CONSTANT_S} 1" solimplimit="{SOLIMP}"/>
  <geom name="pad{n}" type="sphere" size="{vehicle.gear("pad_radius")!r}" friction="{friction!r} 0 0"/>
</body>"""


def strut(vehicle: Vehicle, n: int) -> str:
    crush_n = vehicle.gear("crush_load_1")
    return (
        f'<position name="strut{n}" joint="leg{n}" kp="{vehicle.gear("stiffness")!r}" '
        f'kv="{vehicle.gear("damping")!r}" forcelimited="true" forcerange="{-crush_n} {crush_n}"/>'
    )


def touch(geom: str) -> str:
    """Net force of the ground on a part."""
    return f'<contact name="{geom}_touch" geom1="ground" geom2="{geom}" data="force" reduce="netforce"/>'


def hull_extent(vehicle: Vehicle) -> tuple[float, float, float]:
    return tuple(vehicle.number("hull", key) for key in ("radius", "bottom_height", "top_height"))


def nozzle_extent(vehicle: Vehicle) -> tuple[float, float, float]:
    exit_m = vehicle.number("engine", "nozzle_exit_height")
    pivot_m = vehicle.number("engine", "gimbal_pivot_b")[2]
    return vehicle.number("engine", "nozzle_exit_radius"), exit_m, max(pivot_m, exit_m + 0.01)


def cylinder(name: str, radius_m: float, bottom_m: float, top_m: float) -> str:
    centre_m, half_m = 0.5 * (bottom_m + top_m), 0.5 * (top_m - bottom_m)
    return f'<geom name="{name}" type="cylinder" pos="0 0 {centre_m}" size="{radius_m} {half_m}"/>'


def numbers(values) -> str:
    return " ".join(repr(float(value)) for value in values)
