"""The kit's touchdowns against the same lander in MuJoCo, class by class.

`python -m touchdown_cosim.compare_mujoco --lander FILE [--cases N] [--out FILE.csv]`

Both engines fly the same grid (touchdown_cases.py); the kit's verdict is Rust's, MuJoCo's is that of
touchdown_verdict.py. Prints the agreement and every disagreement with both margins, and what MuJoCo makes
of it with a fifth of the step; with `--out` writes a row a case. Exit codes: 0 done, 2 bad input or failed run.
"""

import argparse
import csv
import math
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import asdict, astuple
from pathlib import Path

import numpy as np

from . import touchdown_cases
from .land import FAILED, INTERRUPTED, complain
from .mujoco_lander import Vehicle
from .mujoco_touchdown import TICK_S, Touchdown
from .touchdown_cases import COLUMNS, Case
from .touchdown_verdict import Verdict, judge

# As long as the kit's own sub-steps, with MuJoCo's explicit integrator: the nearest to its own fine-step
# runs for the time, with root mean square errors over each of the benchmark's families within 1.5 % of the
# peak stroke and 4 mm of the final position (bench_mujoco).
STEP_S = 0.25e-3
FINE_STEP_S = 0.05e-3
INTEGRATOR = "Euler"
# Tip-over is decided within 5 s; who still slides after 12 s slides for good.
STOP_TIME_S = 12.0

COMPARED = ["outcome", "tip_energy_margin_j", "slide_distance_m", "peak_stroke_m", "rest_tilt_deg"]


def mujoco_verdict(vehicle: Vehicle, case: Case, step_s=STEP_S) -> Verdict:
    """One case in MuJoCo, to its verdict."""
    return run_to_verdict(Touchdown(vehicle, case, step_s, INTEGRATOR))


def run_to_verdict(touchdown: Touchdown) -> Verdict:
    history = touchdown.row()[None]
    while True:
        history = np.concatenate([history, touchdown.run(1.0)])
        time_is_up = len(history) > STOP_TIME_S / TICK_S
        verdict = judge(touchdown.vehicle, touchdown.case, history, time_is_up)
        if verdict:
            return verdict


def kit_verdicts(lander: Path, vehicle_file: Path, cases: list[Case], engine="rapier") -> list[dict]:
    """All cases through `lander touchdowns` with one of its engines."""
    with tempfile.TemporaryDirectory() as folder:
        file, out = Path(folder) / "cases.csv", Path(folder) / "touchdowns.csv"
        touchdown_cases.write(file, cases)
        command = [lander, "touchdowns", "--cases", file, "--vehicle", vehicle_file, "--out", out]
        done = subprocess.run(
            [*command, "--engine", engine, "--stop-time", str(STOP_TIME_S)],
            stdout=subprocess.DEVNULL,
            check=False,
        )
        if done.returncode:
            raise RuntimeError(f"{lander} touchdowns failed with {done.returncode}")
        with out.open(encoding="utf-8") as rows:
            return list(csv.DictReader(rows))


def compare(lander: Path, vehicle_file: Path, cases: list[Case], say=lambda text: None) -> list[dict]:
    """A row a case: its columns, the results of both engines, whether the classes agree."""
    kit = kit_verdicts(lander, vehicle_file, cases)
    vehicle, started, rows = Vehicle(vehicle_file), time.monotonic(), []
    for n, (case, ours) in enumerate(zip(cases, kit, strict=True)):
        theirs = asdict(mujoco_verdict(vehicle, case))
        row = dict(zip(COLUMNS, astuple(case), strict=True))
        for name in COMPARED:
            row[f"kit_{name}"] = ours[name] if name == "outcome" else float(ours[name] or "nan")
            row[f"mujoco_{name}"] = theirs[name]
        row["agree"] = int(ours["outcome"] == theirs["outcome"])
        row["mujoco_fine_outcome"] = ""
        rows.append(row)
        left_s = (time.monotonic() - started) / (n + 1) * (len(cases) - n - 1)
        say(f"MuJoCo {n + 1}/{len(cases)} touchdowns, {left_s:.0f} s left")
    return rows


def look_closer(vehicle: Vehicle, rows: list[dict]):
    """What MuJoCo makes of the disagreements with a finer step."""
    for row in rows:
        if not row["agree"]:
            case = Case(**{name: row[name] for name in COLUMNS})
            row["mujoco_fine_outcome"] = mujoco_verdict(vehicle, case, FINE_STEP_S).outcome


def classes(rows: list[dict], first: str, second: str) -> list[str]:
    """How often two engines agree on the class, by pads, and every pair of classes."""
    agree = [row[f"{first}_outcome"] == row[f"{second}_outcome"] for row in rows]
    lines = [f"{len(rows)} touchdowns, classes agree in {sum(agree)}: {100.0 * sum(agree) / len(rows):.1f} %"]
    for name, captured in (("sliding", 0), ("captured", 1)):
        such = [same for same, row in zip(agree, rows, strict=True) if row["captured"] == captured]
        lines.append(f"  {name} pads: {sum(such)} of {len(such)}")
    pairs = Counter((row[f"{first}_outcome"], row[f"{second}_outcome"]) for row in rows)
    return lines + [f"  {ours:>10} / {theirs:<10} {n:5d}" for (ours, theirs), n in sorted(pairs.items())]


def figures(row: dict, first: str, second: str) -> str:
    """What two engines measured of one touchdown."""
    return ", ".join(
        f"{label} {row[f'{first}_{name}']:.{digits}f}/{row[f'{second}_{name}']:.{digits}f} {unit}"
        for label, name, digits, unit in (
            ("margin", "tip_energy_margin_j", 1, "J"),
            ("slide", "slide_distance_m", 3, "m"),
            ("stroke", "peak_stroke_m", 4, "m"),
        )
    )


def pads(row: dict) -> str:
    return "captured" if row["captured"] else f"friction {row['friction']}"


def report(rows: list[dict]) -> str:
    """Agreement, the classes, and every disagreement with both margins."""
    lines = classes(rows, "kit", "mujoco")
    near = [row for row in rows if abs(row["mujoco_tip_energy_margin_j"]) < 30.0]
    lines.append(f"{len(near)} with a tip-over margin within 30 J of zero in MuJoCo")
    lines.append("disagreements: the case, then kit / MuJoCo (MuJoCo with a fifth of the step)")
    return "\n".join(lines + [describe(row) for row in rows if not row["agree"]])


def describe(row: dict) -> str:
    """One disagreement in a line."""
    return (
        f"  {row['down_m_s']} m/s down, {row['across_m_s']} across towards {row['travel_deg']} deg, "
        f"slope {row['slope_deg']} deg, heading {row['yaw_deg']} deg, {pads(row)}: "
        f"{row['kit_outcome']}/{row['mujoco_outcome']} ({row['mujoco_fine_outcome']}), "
        f"{figures(row, 'kit', 'mujoco')}"
    )


def shown(value) -> str:
    """Six digits: the engines agree to fewer."""
    if not isinstance(value, float):
        return str(value)
    return "" if math.isnan(value) else f"{value:.6g}"


def write(file: Path, rows: list[dict]):
    """Whole or not at all."""
    part = file.with_name(file.name + ".part")
    with part.open("w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(rows[0])
        writer.writerows([shown(value) for value in row.values()] for row in rows)
    part.replace(file)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="compare_mujoco", description=__doc__.splitlines()[0])
    parser.add_argument("--lander", type=Path, required=True, help="the lander binary")
    parser.add_argument("--vehicle", type=Path, default=Path("models/vehicles/bug.toml"))
    parser.add_argument("--cases", type=int, help="so many of the grid, drawn once and for all")
    parser.add_argument("--out", type=Path, help="CSV file, a row a case")
    options = parser.parse_args(arguments)
    cases = touchdown_cases.grid()
    if options.cases is not None:
        cases = touchdown_cases.some(cases, options.cases)
    said = [time.monotonic()]

    def say(text: str):
        if time.monotonic() > said[0] + 10.0:
            said[0] = time.monotonic()
            print(text, file=sys.stderr)

    try:
        rows = compare(options.lander, options.vehicle, cases, say)
        look_closer(Vehicle(options.vehicle), rows)
        if options.out:
            write(options.out, rows)
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        complain(error)
        return FAILED
    print(report(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
