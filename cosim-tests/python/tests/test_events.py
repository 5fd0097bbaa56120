"""Events of FMI 3.0, and that the results do not depend on how long a master's steps are."""

import pytest

from conftest import FMUS, SCENARIOS, replace
from touchdown_cosim.component import Component
from touchdown_cosim.variants import fmu_file

TRUTH = fmu_file(FMUS, "lander-truth")

# A mean over the last step, and so the one output that knows how long the steps are.
OF_THE_STEP = "specific_force_b"


def outputs(truth) -> dict[str, str]:
    """Bits of all outputs but those of the step."""
    values = truth.get(list(truth.outputs.values()))
    named = zip(truth.columns, values, strict=True)
    return {name: value.hex() for name, value in named if not name.startswith(OF_THE_STEP)}


def events(scenario, step_s: float, end_s: float, early: bool = True) -> list[tuple[float, dict]]:
    """Times at which the truth FMU asks for Event Mode, with its outputs there."""
    found = []
    with Component(TRUTH, "truth", eventModeUsed=True, earlyReturnAllowed=early) as truth:
        truth.initialize(scenario)
        truth.fmu.enterStepMode()
        time_s, target, terminate = 0.0, 1, False
        while time_s < end_s - 1e-9 and not terminate:
            goal_s = round(target * step_s, 9)
            event, terminate, returned, time_s = truth.fmu.doStep(time_s, goal_s - time_s)
            assert returned == (time_s < goal_s - 1e-9)
            target += not returned
            if event:
                found.append(
                    (time_s, dict(zip(truth.columns, truth.get(list(truth.outputs.values())))))
                )
                truth.fmu.enterEventMode()
                again, ends, *_ = truth.fmu.updateDiscreteStates()
                assert not again and ends == terminate
                truth.fmu.enterStepMode()
    return found


def test_touchdown_and_tip_over_end_their_steps():
    found = events(SCENARIOS / "tip-over.toml", 0.1, 30.0)
    touchdown, verdict = found[0], found[-1]
    # Contact has the time at which its tick began, the event that at which it ended.
    assert touchdown[0] - touchdown[1]["contact_time_s"] == pytest.approx(0.001)
    # Between two communication points: nobody but the event could have told.
    assert round(touchdown[0] * 1000) % 100 != 0
    assert (touchdown[1]["outcome"], verdict[1]["outcome"]) == (0.0, 3.0)


def test_onset_of_a_fault_is_an_event(kit):
    scenario = kit / "scenarios" / "no-ignition.toml"
    replace(
        scenario,
        "[run]",
        '[faults.computer_reset]\nonset = { value = 1.234, unit = "s" }\n'
        'duration = { value = 1.0, unit = "s" }\n\n[run]',
    )
    assert [time_s for time_s, _ in events(scenario, 0.1, 2.0)] == [1.234]
    assert [time_s for time_s, _ in events(scenario, 0.1, 2.0, early=False)] == [1.3]


def test_light_up_and_cut_off_are_events():
    with Component(TRUTH, "truth", eventModeUsed=True, earlyReturnAllowed=True) as truth:
        truth.initialize(SCENARIOS / "landing.toml")
        truth.fmu.enterStepMode()
        command = [truth.inputs["thrust_command_n"]]
        changes = []
        for second, thrust_n in enumerate([2000.0, 0.0]):
            truth.set(command, [thrust_n])
            time_s = float(second)
            while time_s < second + 1.0:
                event, _, _, time_s = truth.fmu.doStep(time_s, second + 1.0 - time_s)
                changes += [time_s] if event else []
    # Cut off in the tick that the command reaches the valves, lit after the ignition delay.
    assert len(changes) == 2
    assert 0.0 < changes[0] < 1.0 < changes[1] < 1.01


def fall(step_s: float, until_s: list[float], **options) -> list[dict[str, str]]:
    """Outputs of a tip-over, without guidance, at some times."""
    seen = []
    with Component(TRUTH, "truth", **options) as truth:
        truth.initialize(SCENARIOS / "tip-over.toml")
        for index in range(round(until_s[-1] / step_s)):
            truth.step(round(index * step_s, 9), step_s)
            if any(abs((index + 1) * step_s - time_s) < 1e-9 for time_s in until_s):
                seen.append(outputs(truth))
    return seen


@pytest.mark.parametrize("step_s", [0.001, 0.005, 0.1, 0.25, 1.0])
def test_results_do_not_depend_on_the_step(step_s):
    """Touchdown at 0.469 s and the fall over lie within; inputs never change."""
    times_s = [1.0, 2.0, 3.0]
    assert fall(step_s, times_s) == fall(0.01, times_s)
