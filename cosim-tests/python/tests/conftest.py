"""Where the built kit is, and a landing to look at. `cargo verify` builds what these need."""

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from touchdown_cosim import table

ROOT = Path(__file__).parents[3]
TARGET = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")
FMUS = TARGET / "fmu"
LANDER = TARGET / "release" / "lander"
SCENARIOS = ROOT / "models" / "scenarios"


def fmpy_command(scenario: Path, out: Path, *flags: str) -> list:
    command = [sys.executable, "-m", "touchdown_cosim", scenario, "--out", out]
    return command + ["--fmus", FMUS, "--lander", LANDER, *flags]


def run(command: list, **options) -> subprocess.CompletedProcess:
    environment = os.environ | {"PYTHONPATH": str(ROOT / "cosim-tests" / "python")}
    return subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, **options
    )


@dataclass(frozen=True)
class Landed:
    results: dict
    log: Path
    results_file: Path


def fly(name: str, out: Path) -> Landed:
    """Lands a scenario of the kit with FMPy."""
    done = run(fmpy_command(SCENARIOS / f"{name}.toml", out, "--json"))
    assert done.returncode == 0, done.stderr
    return Landed(json.loads(done.stdout), out / f"{name}.mcap", out / f"{name}.json")


@pytest.fixture
def kit(tmp_path) -> Path:
    """A copy of the scenarios and vehicles that a test may spoil."""
    for folder in ("scenarios", "vehicles"):
        shutil.copytree(ROOT / "models" / folder, tmp_path / "kit" / folder)
    return tmp_path / "kit"


def replace(file: Path, old: str, new: str):
    text = file.read_text(encoding="utf-8")
    assert old in text, f"{file.name} no longer contains {old}"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")


@pytest.fixture(scope="session")
def landing_table() -> dict:
    """Every column of the default landing."""
    return table.fly(SCENARIOS / "landing.toml", FMUS)


@pytest.fixture(scope="session")
def landing(tmp_path_factory) -> Landed:
    """The default landing, flown once for all tests."""
    return fly("landing", tmp_path_factory.mktemp("landing"))
