"""Somebody else's guidance: a braking law of a dozen lines as an FMI 3.0 FMU of its own.

    pythonfmu3 build -f braking_guidance.py

Free fall until a firm braking would just do, then that braking, leaning against what is left of
the sideways speed; attitude by thrusters alone. Its names are its own: whoever connects it to the
truth FMU says what goes where (`WIRES`).
"""

import math

from pythonfmu3 import Fmi3Causality, Fmi3Slave, Fmi3Variability, Float64

GRAVITY_M_S2 = 1.625
THRUST_N = (800.0, 5200.0)
CUT_OFF_M = 0.45
# Net deceleration at which braking begins; thrust follows what is then needed.
BRAKING_M_S2 = 3.0
TORQUE_N_M = (50.0, 50.0, 35.0)

# Outputs of the truth FMU, and the inputs here that they feed.
READINGS = {
    "altimeter_m": "height",
    "velocity_w[1]": "vx",
    "velocity_w[2]": "vy",
    "velocity_w[3]": "vz",
    "attitude_wb[1]": "qw",
    "attitude_wb[2]": "qx",
    "attitude_wb[3]": "qy",
    "attitude_wb[4]": "qz",
    "rate_b[1]": "wx",
    "rate_b[2]": "wy",
    "rate_b[3]": "wz",
    "mass_kg": "mass",
}
# Outputs here, and the inputs of the truth FMU that they feed.
COMMANDS = {
    "thrust": "thrust_command_n",
    "torque_x": "rcs_torque_command_b[1]",
    "torque_y": "rcs_torque_command_b[2]",
    "torque_z": "rcs_torque_command_b[3]",
}


class BrakingGuidance(Fmi3Slave):
    author = "an example"
    description = "Vertical braking with sideways damping"

    def __init__(self, **options):
        super().__init__(**options)
        self.burning = self.done = False
        self.time = 0.0
        self.register_variable(
            Float64(
                "time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous
            )
        )
        for name in READINGS.values():
            setattr(self, name, 0.0)
            self.register_variable(Float64(name, causality=Fmi3Causality.input, start=0.0))
        for name in COMMANDS:
            setattr(self, name, 0.0)
            self.register_variable(Float64(name, causality=Fmi3Causality.output))

    def do_step(self, current_time, step_size):
        height = max(self.height - CUT_OFF_M, 0.01)
        need = self.vz**2 / (2.0 * height) if self.vz < 0.0 else 0.0
        self.burning |= need >= BRAKING_M_S2
        self.done |= self.burning and (self.height < CUT_OFF_M or self.vz > -0.3)
        # Wanted thrust acceleration, world axes.
        sideways = (-0.5 * self.vx, -0.5 * self.vy)
        wanted = (*sideways, max(need, 1.0) + GRAVITY_M_S2)
        size = math.sqrt(sum(a * a for a in wanted))
        lit = self.burning and not self.done
        self.thrust = min(max(self.mass * size, THRUST_N[0]), THRUST_N[1]) if lit else 0.0
        up = [a / size for a in wanted] if lit else [0.0, 0.0, 1.0]
        self.torque_x, self.torque_y, self.torque_z = self.torque(self.to_body(up))
        self.time = current_time + step_size
        return True

    def to_body(self, v):
        """World to body: the conjugate of the attitude turns it."""
        w, x, y, z = self.qw, -self.qx, -self.qy, -self.qz
        tx, ty, tz = 2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])
        return (
            v[0] + w * tx + y * tz - z * ty,
            v[1] + w * ty + z * tx - x * tz,
            v[2] + w * tz + x * ty - y * tx,
        )

    def torque(self, up_b):
        """Turns body z towards `up_b` and damps all rates."""
        error = (-up_b[1], up_b[0], 0.0)
        rates = (self.wx, self.wy, self.wz)
        asked = (200.0 * e - 250.0 * w for e, w in zip(error, rates, strict=True))
        return [min(max(t, -most), most) for t, most in zip(asked, TORQUE_N_M, strict=True)]
