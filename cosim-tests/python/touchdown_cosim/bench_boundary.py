"""What the FMI boundary costs: `python -m touchdown_cosim.bench_boundary --fmus DIR --lander FILE`.

The default landing by the native master and by FMPy with each variant of the FMUs, all in one run
and in turns; CPU time, the least of several. The difference to native, over the communication steps,
is what a step of both FMUs costs in FMPy: two exchanges, two steps and a row of all outputs.
"""

import argparse
import resource
import subprocess
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from . import schedule
from .component import Component
from .master import Master
from .variants import VARIANTS, fmu_file

SCENARIO = Path(__file__).parents[3] / "models/scenarios/landing.toml"


def by_fmpy(fmus: Path, variant: str) -> tuple[float, int]:
    """Seconds in the loop alone, and communication steps."""
    plan = schedule.load()
    with ExitStack() as stack:
        components = {}
        for name, model in plan.components.items():
            component = Component(fmu_file(fmus, model, variant), name)
            components[name] = stack.enter_context(component)
            component.initialize(SCENARIO)
        rows = []
        start = time.process_time()
        Master(plan, components).run(rows.append)
        return time.process_time() - start, len(rows) - 1


def natively(lander: Path) -> float:
    """Seconds of the whole program, log included."""

    def spent_s() -> float:
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    before_s = spent_s()
    with tempfile.TemporaryDirectory() as folder:
        command = [lander, "run", SCENARIO, "--json", "--out", folder]
        subprocess.run(command, check=True, capture_output=True)
    return spent_s() - before_s


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fmus", type=Path, required=True, help="folder of the FMUs")
    parser.add_argument("--lander", type=Path, required=True, help="the lander binary")
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    native_s = min(natively(options.lander) for _ in range(options.runs))
    least_s = dict.fromkeys(VARIANTS, float("inf"))
    steps = 0
    for _ in range(options.runs):
        for variant in VARIANTS:
            taken_s, steps = by_fmpy(options.fmus, variant)
            least_s[variant] = min(least_s[variant], taken_s)
    print(f"{'native':<12} {native_s:8.3f} s, program and log")
    for variant, taken_s in least_s.items():
        extra_us = (taken_s - native_s) / steps * 1e6
        print(
            f"{variant:<12} {taken_s:8.3f} s, {extra_us:6.0f} us a communication step over native"
        )


if __name__ == "__main__":
    main()
