"""The schedule that the native master executes too."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

FILE = Path(__file__).parents[2] / "schedule.toml"


@dataclass(frozen=True)
class Schedule:
    step_s: float
    actions: list[dict]
    rows: list[str]
    components: dict[str, str]


def load(file: Path = FILE) -> Schedule:
    """Reads the schedule; the native side holds it against the signal table."""
    content = tomllib.loads(file.read_text(encoding="utf-8"))
    return Schedule(
        step_s=content["communication_step"]["value"],
        actions=content["actions"],
        rows=content["rows"],
        components=content["components"],
    )
