"""The kit's two contact engines against each other, class by class.

`python -m touchdown_cosim.compare_engines --lander FILE [--cases N] [--out FILE.csv]`

Random touchdowns of BUG (`touchdown_cases.anywhere`) through `lander touchdowns` with each engine. Prints
the agreement and every disagreement with both margins; with `--out` writes the disagreements, a row each.
Exit codes: 0 done, 2 bad input or failed run.
"""

import argparse
import sys
from dataclasses import astuple
from pathlib import Path

from . import touchdown_cases
from .compare_mujoco import COMPARED, classes, figures, kit_verdicts, pads, write
from .land import FAILED, INTERRUPTED, complain
from .touchdown_cases import COLUMNS, Case

ENGINES = ("rapier", "strut")


def compare(lander: Path, vehicle_file: Path, cases: list[Case]) -> list[dict]:
    """A row a case: its columns, then the results of both engines."""
    rows = [dict(zip(COLUMNS, astuple(case), strict=True)) for case in cases]
    for engine in ENGINES:
        for row, verdict in zip(rows, kit_verdicts(lander, vehicle_file, cases, engine), strict=True):
            for name in COMPARED:
                value = verdict[name]
                row[f"{engine}_{name}"] = value if name == "outcome" else float(value or "nan")
    return rows


def disagreements(rows: list[dict]) -> list[dict]:
    return [row for row in rows if row["rapier_outcome"] != row["strut_outcome"]]


def report(rows: list[dict]) -> str:
    """Agreement, the classes, and every disagreement with both margins."""
    lines = [*classes(rows, *ENGINES), "disagreements: the case, then rapier / strut"]
    return "\n".join(lines + [describe(row) for row in disagreements(rows)])


def describe(row: dict) -> str:
    """One disagreement in a line."""
    return (
        f"  {row['down_m_s']} m/s down, {row['across_m_s']} across, slope {row['slope_deg']} deg, {pads(row)}: "
        f"{row['rapier_outcome']}/{row['strut_outcome']}, {figures(row, *ENGINES)}"
    )


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="compare_engines", description=__doc__.splitlines()[0])
    parser.add_argument("--lander", type=Path, required=True, help="the lander binary")
    parser.add_argument("--vehicle", type=Path, default=Path("models/vehicles/bug.toml"))
    parser.add_argument("--cases", type=int, default=1000, help="how many touchdowns")
    parser.add_argument("--out", type=Path, help="CSV file, a row a disagreement")
    options = parser.parse_args(arguments)
    try:
        rows = compare(options.lander, options.vehicle, touchdown_cases.anywhere(options.cases))
        apart = disagreements(rows)
        if options.out and apart:
            write(options.out, apart)
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        complain(error)
        return FAILED
    print(report(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
