"""A stored state continues bit for bit: here, in another instance, in another process."""

import json
import os
import subprocess
import sys
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from conftest import FMUS, SCENARIOS
from touchdown_cosim import schedule
from touchdown_cosim.component import Component, ComponentError
from touchdown_cosim.master import Master
from touchdown_cosim.variants import fmu_file

PLAN = schedule.load()

# In flight guidance plans anew between the two steps; the tip-over touches at 0.469 s, so that
# struts move and pads hold while the state is saved.
CASES = [("landing", 500, 600), ("tip-over", 50, 150)]


@contextmanager
def started(scenario: str, variant: str):
    """Both components at t = 0."""
    with ExitStack() as stack:
        components = {}
        for name, model in PLAN.components.items():
            component = Component(fmu_file(FMUS, model, variant), name)
            components[name] = stack.enter_context(component)
            component.initialize(SCENARIOS / f"{scenario}.toml")
        yield components


def rows(components, start: int, end: int) -> list[list[str]]:
    """Every bit of every row between two communication points."""
    collected = []
    master = Master(PLAN, components)
    for index in range(start, end):
        master.communication_step(index, collected.append)
    return [[value.hex() for value in row] for row in collected]


def blobs(components) -> dict[str, bytes]:
    return {name: c.fmu.serializeFMUState(c.fmu.getFMUState()) for name, c in components.items()}


def restore(components, stored: dict[str, bytes]):
    for name, component in components.items():
        component.fmu.setFMUState(component.fmu.deserializeFMUState(stored[name]))


@pytest.mark.parametrize("variant", ["fmi3", "fmi2"])
@pytest.mark.parametrize(("scenario", "saved", "end"), CASES)
def test_a_stored_state_continues_bit_for_bit(scenario, saved, end, variant, tmp_path):
    with started(scenario, variant) as components:
        rows(components, 0, saved)
        states = {name: c.fmu.getFMUState() for name, c in components.items()}
        stored = blobs(components)
        flown = rows(components, saved, end)
        for name, component in components.items():
            component.fmu.setFMUState(states[name])
        assert rows(components, saved, end) == flown, "the same instance"
        restore(components, stored)
        assert rows(components, saved, end) == flown, "the same instance, from bytes"
    with started(scenario, variant) as others:
        restore(others, stored)
        assert rows(others, saved, end) == flown, "another instance"
    for name, blob in stored.items():
        (tmp_path / name).write_bytes(blob)
    command = [sys.executable, __file__, scenario, variant, tmp_path, str(saved), str(end)]
    environment = os.environ | {"PYTHONPATH": ":".join(sys.path)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == flown, "another process"


def test_a_state_of_one_version_continues_in_the_other():
    with started("tip-over", "fmi2") as two, started("tip-over", "fmi3-arrays") as three:
        rows(two, 0, 50)
        restore(three, blobs(two))
        assert rows(three, 50, 150) == rows(two, 50, 150)


def test_a_corrupt_truncated_or_foreign_state_is_refused():
    with started("tip-over", "fmi3") as components:
        rows(components, 0, 50)
        stored = blobs(components)
        truth, blob = components["truth"], stored["truth"]
        middle = len(blob) // 2
        corrupt = blob[:middle] + bytes([blob[middle] ^ 1]) + blob[middle + 1 :]
        for bad, reason in [
            (corrupt, "checksum"),
            (blob[:-1], "truncated"),
            (b"", "truncated"),
            (stored["guidance"], "another model"),
        ]:
            with pytest.raises(ComponentError, match=reason):
                truth._checked(truth.fmu.deserializeFMUState, bad)
        state = truth.fmu.getFMUState()
        truth.fmu.freeFMUState(state)
        # Freed, so no longer a state of this instance.
        with pytest.raises(ComponentError, match="was freed"):
            truth._checked(truth.fmu.setFMUState, 12345)
        rows(components, 50, 60)


def continue_here(scenario, variant, folder, saved, end):
    """In a process of its own: the rows from the stored states on."""
    with started(scenario, variant) as components:
        restore(components, {name: (Path(folder) / name).read_bytes() for name in components})
        json.dump(rows(components, int(saved), int(end)), sys.stdout)


if __name__ == "__main__":
    continue_here(*sys.argv[1:])
