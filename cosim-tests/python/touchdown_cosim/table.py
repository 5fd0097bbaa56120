"""A whole landing as one table in memory, for plots and tests."""

from contextlib import ExitStack
from pathlib import Path

import numpy as np

from . import schedule
from .component import Component
from .master import Master
from .variants import fmu_file


def fly(scenario: Path, fmus: Path) -> dict[str, np.ndarray]:
    """Flies a scenario with both FMUs; every column of every row, by name."""
    plan = schedule.load()
    with ExitStack() as stack:
        components = {
            name: stack.enter_context(Component(fmu_file(fmus, model), name))
            for name, model in plan.components.items()
        }
        for component in components.values():
            component.initialize(scenario.absolute())
        rows = []
        Master(plan, components).run(rows.append)
        names = ["time_s"] + [n for part in plan.rows for n in components[part].columns]
    return dict(zip(names, np.array(rows).T, strict=True))


def vectors(table: dict[str, np.ndarray], name: str, size: int) -> np.ndarray:
    """The scalars `name[1]` … `name[size]` side by side, one row a time."""
    return np.stack([table[f"{name}[{n + 1}]"] for n in range(size)], axis=1)
