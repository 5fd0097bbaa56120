"""The FMUs as any FMI importer meets them: valid, and restartable from a saved state."""

from contextlib import ExitStack

import pytest
from fmpy.validation import validate_fmu

from conftest import FMUS, SCENARIOS
from touchdown_cosim import schedule
from touchdown_cosim.component import Component
from touchdown_cosim.master import Master
from touchdown_cosim.variants import VARIANTS, fmu_file

PLAN = schedule.load()


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("model", PLAN.components.values())
def test_fmpy_finds_no_problem(model, variant):
    assert validate_fmu(str(fmu_file(FMUS, model, variant))) == []


@pytest.fixture
def components():
    with ExitStack() as stack:
        yield {
            name: stack.enter_context(Component(fmu_file(FMUS, model), name))
            for name, model in PLAN.components.items()
        }


def rows(master, start, end):
    collected = []
    for index in range(start, end):
        master.communication_step(index, collected.append)
    return [[value.hex() for value in row] for row in collected]


def test_a_state_saved_in_flight_continues_bit_for_bit(components):
    """Saved, flown on, restored and flown again; then once more from the serialised bytes."""
    for component in components.values():
        component.initialize(SCENARIOS / "landing.toml")
    master = Master(PLAN, components)
    rows(master, 0, 1000)
    states = {name: component.fmu.getFMUState() for name, component in components.items()}
    stored = {name: c.fmu.serializeFMUState(states[name]) for name, c in components.items()}
    # 3 s: guidance plans anew several times in between.
    flown = rows(master, 1000, 1300)
    for name, component in components.items():
        component.fmu.setFMUState(states[name])
    assert rows(master, 1000, 1300) == flown
    for name, component in components.items():
        component.fmu.setFMUState(component.fmu.deserializeFMUState(stored[name]))
    assert rows(master, 1000, 1300) == flown


@pytest.mark.parametrize(
    # The tip-over touches at 0.469 s: struts move and pads hold while the state is saved.
    ("scenario", "saved", "end"),
    [("landing", 500, 600), ("tip-over", 50, 150)],
)
def test_a_stored_state_continues_in_a_new_instance(scenario, saved, end, components):
    file = SCENARIOS / f"{scenario}.toml"
    for component in components.values():
        component.initialize(file)
    master = Master(PLAN, components)
    rows(master, 0, saved)
    stored = {name: c.fmu.serializeFMUState(c.fmu.getFMUState()) for name, c in components.items()}
    flown = rows(master, saved, end)
    with ExitStack() as stack:
        others = {}
        for name, model in PLAN.components.items():
            other = stack.enter_context(Component(fmu_file(FMUS, model), name))
            other.initialize(file)
            other.fmu.setFMUState(other.fmu.deserializeFMUState(stored[name]))
            others[name] = other
        assert rows(Master(PLAN, others), saved, end) == flown
