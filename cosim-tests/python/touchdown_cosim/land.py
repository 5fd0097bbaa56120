"""Lands the lander with FMPy: `python -m touchdown_cosim SCENARIO --fmus DIR --lander FILE`.

Exit codes: 0 done, 1 gate not passed, 2 bad input or failed run, 130 interrupted.
"""

import argparse
import math
import signal
import struct
import subprocess
import sys
from contextlib import ExitStack, suppress
from pathlib import Path

from .variants import VARIANTS, fmu_file

FAILED = 2
INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> int:
    options = parse(arguments)
    try:
        return land(options)
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        # Without this Python would exit with 1, which means a gate that was not passed.
        complain(error)
        return FAILED


def complain(error: Exception):
    """One line on stderr, if anybody listens."""
    reason = str(error) if isinstance(error, (RuntimeError, OSError)) else repr(error)
    with suppress(OSError, AttributeError):
        sys.stderr.write(f"error: {' '.join(reason.splitlines())}\n")


def parse(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="touchdown_cosim", description=__doc__.splitlines()[0])
    parser.add_argument("scenario", type=Path, help="scenario file")
    parser.add_argument("--json", action="store_true", help="print the results as JSON")
    parser.add_argument("--gate", action="store_true", help="exit with 1 unless landed")
    parser.add_argument("--out", type=Path, default=Path("results"), help="folder for the files")
    parser.add_argument("--fmus", type=Path, required=True, help="folder of the FMUs")
    parser.add_argument("--variant", choices=VARIANTS, default=VARIANTS[0], help="which FMUs")
    parser.add_argument("--lander", type=Path, required=True, help="the lander binary")
    return parser.parse_args(arguments)


def land(options: argparse.Namespace) -> int:
    # Here and not above, so that Ctrl-C during the imports ends quietly too.
    from . import schedule
    from .component import Component
    from .master import Master

    plan = schedule.load()
    with ExitStack() as stack:
        components = {}
        for name, model in plan.components.items():
            fmu = Component(fmu_file(options.fmus, model, options.variant), name)
            components[name] = stack.enter_context(fmu)
            components[name].initialize(options.scenario.absolute())
        return record(Master(plan, components), options)


def record(master, options: argparse.Namespace) -> int:
    """Streams rows to `lander record`, which writes the files and says the verdict."""
    command = [options.lander, "record", "--scenario", options.scenario, "--out", options.out]
    command += [flag for flag, on in (("--json", options.json), ("--gate", options.gate)) if on]
    # From here on Ctrl-C is a flag: an exception could cut a row in two, or miss the recorder.
    interrupts = []
    signal.signal(signal.SIGINT, lambda *_: interrupts.append(True))
    # Its own session: Ctrl-C reaches this process only, and the log is closed by closing the pipe.
    recorder = subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True)

    def send(row: list[float]):
        recorder.stdin.write(struct.pack(f"<{len(row)}d", *row))

    def on_row(row: list[float]):
        send(row)
        if interrupts:
            raise KeyboardInterrupt

    try:
        master.run(on_row)
    except KeyboardInterrupt:
        pass  # The recorder sees a run that ends in flight.
    except BrokenPipeError:
        pass  # The recorder has said why.
    except Exception:
        # A row at no time tells the recorder that this is no end to judge.
        with suppress(BrokenPipeError):
            send([math.nan] * master.width)
        raise
    finally:
        close(recorder)
    if recorder.returncode < 0:
        raise RuntimeError(f"{options.lander} was ended by signal {-recorder.returncode}")
    return recorder.returncode


def close(recorder: subprocess.Popen):
    with suppress(BrokenPipeError):
        recorder.stdin.close()
    recorder.wait()
