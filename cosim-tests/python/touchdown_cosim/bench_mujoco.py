"""MuJoCo's lander from contact to rest: error and time against the step.

`python -m touchdown_cosim.bench_mujoco [--json] [--rounds N] [--integrators NAME ...] [--vehicle FILE]`

The touchdowns are the families of `cosim-tests/benchmark.toml`. Errors are root mean squares over a family
against MuJoCo's own run with steps of 0.02 ms: final position of O, final tilt, peak stroke. Times are CPU
time (mujoco_rest.py), per member the least of several rounds. A step that does not bring every member to
rest has no row. With `--paced` a round of a family, or of `flight`, is timed for each line of its name on
stdin, each answered by an empty line, so that the kit's benchmark can take turns with it.
"""

import argparse
import json
import sys
import tomllib
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path

import mujoco
import numpy as np

from .land import FAILED, INTERRUPTED, complain
from .mujoco_lander import Vehicle
from .mujoco_rest import End, flight_us, replay_s, to_rest
from .mujoco_touchdown import TICK_S
from .touchdown_cases import Case

INTEGRATORS = ("Euler", "implicitfast", "discrete", "RK4")
STEPS_S = (2e-3, 1e-3, 0.5e-3, 0.25e-3, 0.125e-3, 0.0625e-3)
REFERENCE_STEP_S, REFERENCE_INTEGRATOR = 0.02e-3, "Euler"
FLIGHT = "flight"
FILE = Path(__file__).parents[2] / "benchmark.toml"


def families(file: Path) -> dict[str, list[Case]]:
    """By name, each touchdown with every factor on its speeds."""
    table = tomllib.loads(file.read_text(encoding="utf-8"))
    named = {touchdown.pop("name"): Case(**table["base"] | touchdown) for touchdown in table["touchdown"]}
    return {
        name: [faster(case, factor) for factor in table["speed_factors"]] for name, case in named.items()
    }


def faster(case: Case, factor: float) -> Case:
    return replace(case, down_m_s=case.down_m_s * factor, across_m_s=case.across_m_s * factor)


@dataclass(frozen=True)
class Errors:
    """Root mean squares."""

    place_error_m: float
    tilt_error_deg: float
    stroke_error_percent: float

    @classmethod
    def of(cls, ends: list[End], exact: list[End]):
        def rms(error) -> float:
            errors = [error(end, fine) for end, fine in zip(ends, exact, strict=True)]
            return float(np.sqrt(np.mean(np.square(errors))))

        return cls(
            rms(lambda end, fine: np.linalg.norm(end.position_w - fine.position_w)),
            rms(lambda end, fine: end.tilt_deg - fine.tilt_deg),
            rms(lambda end, fine: 100.0 * (end.peak_stroke_m / fine.peak_stroke_m - 1.0)),
        )


@dataclass
class Series:
    """A family with one integrator and step, and the least CPU seconds of each member so far."""

    name: str
    cases: list[Case]
    integrator: str
    step_s: float
    ends: list[End]
    errors: Errors

    def __post_init__(self):
        self.least_s = np.full(len(self.cases), np.inf)

    def time(self, vehicle: Vehicle):
        """Once more, each member."""
        for n, (case, end) in enumerate(zip(self.cases, self.ends, strict=True)):
            replayed_s = replay_s(vehicle, case, self.step_s, self.integrator, end)
            self.least_s[n] = min(self.least_s[n], replayed_s)

    def row(self) -> dict:
        return {
            "name": self.name,
            "integrator": self.integrator,
            "step_ms": self.step_s * 1e3,
            "step_us": self.least_s.sum() / sum(end.steps for end in self.ends) * 1e6,
            "to_rest_ms": self.least_s.mean() * 1e3,
        } | asdict(self.errors)


def prepare(
    vehicle: Vehicle,
    cases: dict[str, list[Case]],
    steps_s=STEPS_S,
    integrators=("Euler",),
    say=lambda text: None,
) -> list[Series]:
    """Runs all with the strut law; a series for each that comes to rest. On all cores."""
    reference = REFERENCE_INTEGRATOR, REFERENCE_STEP_S
    kinds = [reference, *product(integrators, steps_s)]
    with ProcessPoolExecutor() as pool:
        runs = {
            (name, kind): [pool.submit(to_rest, vehicle, case, kind[1], kind[0]) for case in family]
            for name, family in cases.items()
            for kind in kinds
        }
        ends = {}
        for (name, kind), family in runs.items():
            if kind is reference:
                say(f"MuJoCo's errors: {name}")
            ends[name, kind] = [run.result() for run in family]
    return [
        Series(name, cases[name], *kind, family, Errors.of(family, ends[name, reference]))
        for (name, kind), family in ends.items()
        if kind is not reference and None not in family
    ]


def rounds_asked():
    """Names from stdin, each answered when the caller is through with it."""
    for line in sys.stdin:
        yield line.rstrip("\n")
        print(flush=True)


def table(rows: list[dict]) -> str:
    head = "integrator     step ms   place m   tilt deg   stroke %   us a step   ms to rest"
    lines, name = [], None
    for row in rows:
        if row["name"] != name:
            name = row["name"]
            lines += ["", name, head]
        lines.append(
            f"{row['integrator']:<13}{row['step_ms']:>9.4f}{row['place_error_m']:>10.1e}"
            f"{row['tilt_error_deg']:>11.1e}{row['stroke_error_percent']:>11.3f}"
            f"{row['step_us']:>12.1f}{row['to_rest_ms']:>13.1f}"
        )
    return "\n".join(lines[1:])


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="bench_mujoco", description=__doc__.splitlines()[0])
    parser.add_argument("--vehicle", type=Path, default=Path("models/vehicles/bug.toml"))
    parser.add_argument("--rounds", type=int, default=3, help="timed runs of each")
    parser.add_argument("--paced", action="store_true", help="time what stdin names instead")
    parser.add_argument("--integrators", nargs="+", choices=INTEGRATORS, default=["Euler"])
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    options = parser.parse_args(arguments)

    def say(text: str):
        print(text, file=sys.stderr)

    try:
        vehicle, cases = Vehicle(options.vehicle), families(FILE)
        in_flight = next(iter(cases.values()))[0]
        series = prepare(vehicle, cases, integrators=options.integrators, say=say)
        rounds = rounds_asked() if options.paced else options.rounds * [FLIGHT, *cases]
        flight = np.inf
        for name in rounds:
            if name == FLIGHT:
                flight = min(flight, flight_us(vehicle, in_flight))
            for timed in series:
                if timed.name == name:
                    timed.time(vehicle)
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        complain(error)
        return FAILED
    rows = [timed.row() for timed in series]
    if options.json:
        print(json.dumps({
            "mujoco": mujoco.__version__,
            "reference_step_ms": REFERENCE_STEP_S * 1e3,
            "flight_us": flight,
            "rows": rows,
        }, indent=1))
    else:
        print(f"flight: {flight:.1f} us a step of {1e3 * TICK_S:.0f} ms")
        print(table(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
