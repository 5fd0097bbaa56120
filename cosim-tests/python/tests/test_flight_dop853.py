"""The truth FMU's flight against SciPy's DOP853 on the same physics, written down again here.

Commands are those that the landing recorded, the numbers those of the vehicle file. Rigid flight
follows (T.1) to (T.7), (T.50), (T.51) and (T.69) of truth-model/README.md. Slosh is written in maximal
coordinates: every bob is a free point mass in world coordinates, and its rod an equation.
"""

import tomllib
from functools import cache
from itertools import groupby

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from claims import Claim
from conftest import FMUS, ROOT, SCENARIOS
from touchdown_cosim import table
from touchdown_cosim.table import vectors

G0 = 9.80665
VEHICLE = tomllib.loads((ROOT / "models" / "vehicles" / "bug.toml").read_text())
SCENARIO = tomllib.loads((SCENARIOS / "landing.toml").read_text())


@cache
def number(section: str, key: str):
    value = VEHICLE[section][key]["value"]
    return np.array(value) if isinstance(value, list) else value


GRAVITY_W = np.array([0.0, 0.0, -SCENARIO["site"]["gravity"]["value"]])
GIMBAL_RATE = np.radians(number("engine", "gimbal_rate"))
GIMBAL_LIMIT = np.radians(number("engine", "gimbal_limit"))
DRY_INERTIA = np.diag(number("mass", "dry_inertia_b"))
PIVOT = number("engine", "gimbal_pivot_b")
HINGES = number("slosh", "hinges_b")
LENGTH = number("slosh", "length")
DRAG = 2.0 * number("slosh", "damping_ratio") * np.sqrt(G0 / LENGTH)
BODY = 17
"""Scalars before the bobs: O's position and velocity, quaternion (x, y, z, w), rate, propellant,
thrust, gimbal. Then position and velocity of each bob, world frame."""

EYE = np.eye(3)


def cross(a, b):
    """NumPy's own takes ten times as long for one pair."""
    (ax, ay, az), (bx, by, bz) = a, b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def about_origin(mass, com, own):
    """Mass, first moment and inertia about O of a body: together they add up."""
    com = np.array(com)
    return mass, mass * com, own + mass * (com @ com * EYE - np.outer(com, com))


DRY = about_origin(number("mass", "dry_mass"), number("mass", "dry_com_b"), DRY_INERTIA)
PER_KG_AT_COM = (
    1.0,
    number("mass", "propellant_com_b"),
    np.diag(number("mass", "propellant_gyration_radius_b") ** 2),
)
PER_KG = about_origin(*PER_KG_AT_COM)
"""Of propellant: its place and radii of gyration stay, so that everything about O is linear in it."""


def about_centre(mass, moment, inertia):
    """Mass, centre of mass and inertia about it."""
    com = moment / mass
    return mass, com, inertia - (com @ moment * EYE - np.outer(com, moment))


def mass_properties(propellant_kg: float):
    """Of structure and propellant by first principles."""
    return about_centre(*(dry + propellant_kg * kg for dry, kg in zip(DRY, PER_KG)))


def bob_mass(propellant_kg: float) -> float:
    return number("slosh", "share") * propellant_kg / len(HINGES)


HANGING = [
    about_origin(number("slosh", "share") / len(HINGES), h - [0.0, 0.0, LENGTH], np.zeros((3, 3)))
    for h in HINGES
]
REST_PER_KG = [kg - sum(bobs) for kg, *bobs in zip(PER_KG, *HANGING)]
"""Of propellant less bobs that hang straight down."""


def rest_properties(propellant_kg: float):
    """The vehicle less its bobs."""
    return about_centre(*(dry + propellant_kg * kg for dry, kg in zip(DRY, REST_PER_KG)))


def jet(com, flow, gimbal_direction, rate):
    """Coriolis force and jet damping torque about the centre of mass."""
    _, place, own = PER_KG_AT_COM
    apart = place - com
    # To first order what leaves takes its own inertia and that of its place.
    inertia_rate = -flow * (own + apart @ apart * EYE - np.outer(apart, apart))
    radius = number("engine", "nozzle_exit_radius")
    exit_point = PIVOT - gimbal_direction * (PIVOT[2] - number("engine", "nozzle_exit_height"))
    arm = exit_point - com
    disc = radius**2 * np.array([0.25, 0.25, 0.5])
    force = -2.0 * flow * cross(rate, exit_point - place)
    torque = -inertia_rate @ rate - flow * (cross(arm, cross(rate, arm)) + disc * rate)
    return force, torque


def thrust_target(command: float) -> float:
    if command < number("engine", "dead_zone"):
        return 0.0
    return float(np.clip(command, number("engine", "thrust_min"), number("engine", "thrust_max")))


def skew(v):
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def matrix_of(quaternion):
    """Body to world."""
    v, w = quaternion[:3], quaternion[3]
    square = v @ v
    return ((w * w - square) * EYE + 2.0 * np.outer(v, v) + 2.0 * w * skew(v)) / (
        w * w + square
    )


def accelerations(x, force_b, torque_b, com):
    """Acceleration of O, angular acceleration (body axes) and accelerations of the bobs, from all
    equations of motion and one equation a rod, with the rods' tensions as unknowns."""
    rate, propellant = x[10:13], x[13]
    bobs = x[BODY:].reshape(-1, 2, 3)
    n = len(bobs)
    mass, centre, inertia = rest_properties(propellant) if n else mass_properties(propellant)
    r = matrix_of(x[6:10])
    torque_b = torque_b + cross(com - centre, force_b)
    size = 6 + 4 * n
    matrix, right = np.zeros((size, size)), np.zeros(size)
    matrix[:3, :3] = mass * EYE
    matrix[:3, 3:6] = -mass * r @ skew(centre)
    right[:3] = r @ force_b + mass * (GRAVITY_W - r @ cross(rate, cross(rate, centre)))
    matrix[3:6, 3:6] = inertia
    right[3:6] = torque_b - cross(rate, inertia @ rate)
    for k, (position, velocity) in enumerate(bobs):
        bob, tension = slice(6 + 3 * k, 9 + 3 * k), 6 + 3 * n + k
        place_b = r.T @ (position - x[:3])
        rod = r @ (place_b - HINGES[k])
        along = rod / np.sqrt(rod @ rod)
        drag = bob_mass(propellant) * DRAG * (velocity - x[3:6] - r @ cross(rate, place_b))
        lever = skew(place_b - centre) @ r.T
        matrix[:3, tension] = -along
        right[:3] += drag
        matrix[3:6, tension] = -lever @ along
        right[3:6] += lever @ drag
        # Newton for the bob, divided by its mass; the unknown is the tension.
        matrix[bob, bob] = EYE
        matrix[bob, tension] = along / bob_mass(propellant)
        right[bob] = GRAVITY_W - drag / bob_mass(propellant)
        # Twice differentiated: the rod's length stays.
        hinge_velocity = x[3:6] + r @ cross(rate, HINGES[k])
        apart = velocity - hinge_velocity
        matrix[tension, bob] = rod
        matrix[tension, :3] = -rod
        matrix[tension, 3:6] = rod @ r @ skew(HINGES[k])
        centripetal = r @ cross(rate, cross(rate, HINGES[k]))
        right[tension] = rod @ centripetal - apart @ apart
    solution = np.linalg.solve(matrix, right)
    return solution[:3], solution[3:6], solution[6 : 6 + 3 * n].reshape(n, 3)


def derivative(x, thrust_command, gimbal_command, rcs_torque_b):
    quaternion, rate = x[6:10], x[10:13]
    propellant, thrust, gimbal = x[13], x[14], x[15:17]
    (sin_x, sin_y), (cos_x, cos_y) = np.sin(gimbal), np.cos(gimbal)
    direction = np.array([sin_y * cos_x, -sin_x, cos_y * cos_x])
    engine_flow = thrust / (number("engine", "specific_impulse") * G0)
    com = mass_properties(propellant)[1]
    jet_force, jet_torque = jet(com, engine_flow, direction, rate)
    force = thrust * direction + jet_force
    torque = cross(PIVOT - com, thrust * direction) + jet_torque + rcs_torque_b
    origin, angular, bobs = accelerations(x, force, torque, com)
    q, w = quaternion[:3], quaternion[3]
    quaternion_rate = 0.5 * np.append(w * rate + cross(q, rate), -q @ rate)
    rcs_thrust = np.abs(rcs_torque_b).sum() / number("rcs", "lever_arm")
    flow = engine_flow + rcs_thrust / (number("rcs", "specific_impulse") * G0)
    lag = (np.clip(gimbal_command, -GIMBAL_LIMIT, GIMBAL_LIMIT) - gimbal) / number(
        "engine", "gimbal_lag"
    )
    return np.concatenate([
        x[3:6],
        origin,
        quaternion_rate,
        angular,
        [-flow, (thrust_target(thrust_command) - thrust) / number("engine", "thrust_lag")],
        np.clip(lag, -GIMBAL_RATE, GIMBAL_RATE),
        *(np.concatenate([bob[1], a]) for bob, a in zip(x[BODY:].reshape(-1, 2, 3), bobs)),
    ])


class Thrusters:
    """One axis, on or off (T.69), a tick of 1 ms at a time."""

    def __init__(self, limit: float):
        self.limit, self.owed, self.sense, self.fired = limit, 0.0, 0.0, 0
        self.shortest = round(1000 * number("rcs", "min_pulse"))

    def tick(self, asked: float) -> float:
        impulse = self.limit * 1e-3
        self.owed += min(max(asked, -self.limit), self.limit) * 1e-3
        if self.fired >= self.shortest and self.sense * self.owed <= 0.5 * impulse:
            self.sense = 0.0
        if not self.sense and abs(self.owed) >= (self.shortest - 0.5) * impulse:
            self.sense, self.fired = np.sign(self.owed), 0
        self.owed -= self.sense * impulse
        self.fired += self.sense != 0.0
        return self.sense * self.limit


def hanging(position, velocity, turn, rate):
    """State of bobs that hang straight down the body's axis and turn with it."""
    places = HINGES - [0.0, 0.0, LENGTH]
    return np.concatenate([
        np.concatenate([position + turn.apply(b), velocity + turn.apply(cross(rate, b))])
        for b in places
    ])


def swing_deg(x):
    """Largest angle of a bob from the body's axis."""
    turn = Rotation.from_quat(x[6:10])
    rods = turn.inv().apply(x[BODY:].reshape(-1, 2, 3)[:, 0] - x[:3]) - HINGES
    return np.degrees(np.arctan2(np.hypot(rods[:, 0], rods[:, 1]), -rods[:, 2])).max()


def descent(landed):
    """A landing up to the hand-over to contact."""
    steps = int(np.argmax(landed["contact_active"] > 0.0))
    assert steps > 2000, "the descent takes more than 20 s"
    return {name: column[:steps] for name, column in landed.items()}


def compare(flight, slosh: bool):
    """Largest differences over a descent: m, m/s, deg and deg of swing."""
    position, velocity = vectors(flight, "position_w", 3), vectors(flight, "velocity_w", 3)
    attitude = vectors(flight, "attitude_wb", 4)[:, [1, 2, 3, 0]]
    rate = vectors(flight, "rate_b", 3)
    gimbal_command = vectors(flight, "gimbal_command_rad", 2)
    torque_command = vectors(flight, "rcs_torque_command_b", 3)
    thrusters = [Thrusters(limit) for limit in number("rcs", "torque_max_b")]
    x = np.concatenate([
        position[0], velocity[0], attitude[0], rate[0],
        [flight["propellant_kg"][0], 0.0, 0.0, 0.0],
    ])
    if slosh:
        bobs = hanging(position[0], velocity[0], Rotation.from_quat(attitude[0]), rate[0])
        x = np.concatenate([x, bobs])
    worst = np.zeros(4)
    for n in range(len(flight["time_s"]) - 1):
        # Commands of a row were computed for the step that led to it.
        command = flight["thrust_command_n"][n + 1], gimbal_command[n + 1]
        asked = torque_command[n + 1]
        ticks = [tuple(t.tick(a) for t, a in zip(thrusters, asked)) for _ in range(10)]
        for torque, held in groupby(ticks):
            duration = 1e-3 * len(list(held))
            # 1e-11 relative: a hundredth of the bound over 2,500 steps even if all errors added up.
            solution = solve_ivp(
                lambda _, y, c=(*command, np.array(torque)): derivative(y, *c),
                (0.0, duration), x, method="DOP853", rtol=1e-11, atol=1e-11, first_step=duration,
            )
            x = solution.y[:, -1]
        turn = Rotation.from_quat(x[6:10]).inv() * Rotation.from_quat(attitude[n + 1])
        errors = (
            np.linalg.norm(x[:3] - position[n + 1]),
            np.linalg.norm(x[3:6] - velocity[n + 1]),
            np.degrees(turn.magnitude()),
            abs(swing_deg(x) - flight["slosh_angle_deg"][n + 1]) if slosh else 0.0,
        )
        worst = np.maximum(worst, errors)
    print(f"worst over the descent: {worst} (m, m/s, deg, deg of swing)")
    return worst


def claim(id: str, text: str, unit: str, bound: float, measured: float, origin="acceptance list"):
    Claim(
        id=f"descent-{id}",
        section="Flight: descent",
        claim=text,
        reference="SciPy's DOP853 on equations written down again",
        origin=origin,
        unit=unit,
        at_most=bound,
        # What DOP853 at 1e-11 leaves over a descent, with room.
        noise=1e-2 * bound,
    ).holds(measured)


def test_descent_matches_dop853(landing_table):
    position, velocity, attitude, _ = compare(descent(landing_table), slosh=False)
    claim("position", "position throughout the default descent, 26 s", "m", 1e-3, position)
    claim("velocity", "velocity in the same", "m/s", 1e-4, velocity)
    claim("attitude", "attitude in the same", "°", 1e-4, attitude)


def test_descent_with_slosh_matches_dop853(kit):
    scenario = kit / "scenarios" / "landing.toml"
    scenario.write_text(scenario.read_text() + '\n[slosh]\nactive = "on"\n')
    flight = descent(table.fly(scenario, FMUS))
    assert flight["slosh_angle_deg"].max() > 1.0, "the propellant hardly sloshes"
    position, velocity, attitude, swing = compare(flight, slosh=True)
    bobs = "the same with slosh, bobs as free points on rods: "
    claim("slosh-position", bobs + "position", "m", 1e-3, position)
    claim("slosh-velocity", bobs + "velocity", "m/s", 1e-4, velocity)
    claim("slosh-attitude", bobs + "attitude", "°", 1e-4, attitude)
    claim("slosh-swing", bobs + "swing", "°", 1e-4, swing, origin="as the attitude")
