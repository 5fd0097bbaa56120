"""Lands the lander with FMPy: `python -m touchdown_cosim SCENARIO --fmus DIR --lander FILE`.

Exit codes: 0 done, 1 gate not passed, 2 bad input or failed run, 130 interrupted.
"""

import argparse
import signal
import struct
import subprocess
import sys
import tomllib
from contextlib import ExitStack
from pathlib import Path

FAILED = 2
INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> int:
    options = parse(arguments)
    try:
        return land(options)
    except KeyboardInterrupt:
        return INTERRUPTED


def parse(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="touchdown_cosim", description=__doc__.splitlines()[0])
    parser.add_argument("scenario", type=Path, help="scenario file")
    parser.add_argument("--json", action="store_true", help="print the results as JSON")
    parser.add_argument("--gate", action="store_true", help="exit with 1 unless landed")
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder for the files")
    parser.add_argument("--fmus", type=Path, required=True, help="folder of the two FMUs")
    parser.add_argument("--lander", type=Path, required=True, help="the lander binary")
    return parser.parse_args(arguments)


def land(options: argparse.Namespace) -> int:
    # Here and not above, so that Ctrl-C during the imports ends quietly too.
    from . import schedule
    from .component import Component, ComponentError
    from .master import Master

    plan = schedule.load()
    scenario = options.scenario.absolute()
    try:
        with ExitStack() as stack:
            components = {}
            for name, model in plan.components.items():
                fmu = Component(options.fmus / f"{model}.fmu", name)
                components[name] = stack.enter_context(fmu)
                components[name].initialize(scenario)
            # The FMUs have accepted the file by now.
            stop_time_s = tomllib.loads(scenario.read_text())["run"]["stop_time"]["value"]
            return record(Master(plan, components), stop_time_s, options)
    except (ComponentError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return FAILED


def record(master, stop_time_s: float, options: argparse.Namespace) -> int:
    """Streams rows to `lander record`, which writes the files and says the verdict."""
    command = [options.lander, "record", "--scenario", options.scenario, "--out", options.out]
    command += [flag for flag, on in (("--json", options.json), ("--gate", options.gate)) if on]
    # Its own session: Ctrl-C reaches this process only, and the log is closed by closing the pipe.
    recorder = subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True)
    try:
        master.run(stop_time_s, lambda row: recorder.stdin.write(pack(row)))
    except BrokenPipeError:
        pass  # The recorder has said why.
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    finally:
        close(recorder)
    return recorder.returncode


def pack(row: list[float]) -> bytes:
    return struct.pack(f"<{len(row)}d", *row)


def close(recorder: subprocess.Popen):
    try:
        recorder.stdin.close()
    except BrokenPipeError:
        pass
    recorder.wait()
