"""The archives as any FMI importer meets them."""

import json
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

from conftest import FMUS, SCENARIOS, TARGET, run
from touchdown_cosim import schedule
from touchdown_cosim.component import Component, ComponentError
from touchdown_cosim.variants import VARIANTS, fmu_file

PLAN = schedule.load()


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("model", PLAN.components.values())
def test_fmpy_finds_no_problem(model, variant):
    assert validate_fmu(str(fmu_file(FMUS, model, variant))) == []


def test_check_passes_and_lands_as_both_masters_do(landing):
    """Its importer is another than FMPy and its master another than both: the digest is theirs."""
    files = [fmu_file(FMUS, model, each) for model in PLAN.components.values() for each in VARIANTS]
    done = run([TARGET / "release" / "fmu-build", "check", "--json", *files])
    assert done.returncode == 0, done.stdout + done.stderr
    *_, coupled = json.loads(done.stdout)["files"]
    notes = [check["note"] for check in coupled["checks"]]
    digest = landing.results["digest"]
    assert [note.split(":")[0] for note in notes] == ["fmi2", "fmi3", "fmi3-arrays"]
    assert all("landed at " in note and note.endswith(digest) for note in notes), notes


@pytest.mark.parametrize("variant", ["fmi3", "fmi3-arrays"])
def test_the_terminals_of_both_models_join_every_wire(variant):
    """Against the schema of FMI 3.0.2; members join by name, an output to an input."""
    schema = etree.XMLSchema(
        file=Path(fmpy.__file__).parent / "schema/fmi3/fmi3TerminalsAndIcons.xsd"
    )
    members, inputs = {}, set()
    for model in PLAN.components.values():
        file = fmu_file(FMUS, model, variant)
        variables = {v.name: v for v in fmpy.read_model_description(file).modelVariables}
        with zipfile.ZipFile(file) as archive:
            content = archive.read("terminalsAndIcons/terminalsAndIcons.xml")
        terminals = etree.fromstring(content)
        schema.assertValid(terminals)
        members[model] = {
            m.get("memberName"): variables[m.get("variableName")].causality
            for m in terminals.iter("TerminalMemberVariable")
        }
        inputs |= {v.name for v in variables.values() if v.causality == "input"}
    truth, guidance = members.values()
    assert truth.keys() == guidance.keys() == inputs
    assert all({truth[name], guidance[name]} == {"input", "output"} for name in inputs)


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_parameter_changes_the_scenario(variant):
    changes = "initial.position_w[3] = 123.0; initial.velocity_w = [1, 2, 3]"
    with Component(fmu_file(FMUS, "lander-truth", variant), "truth") as truth:
        truth.fmu.setString([truth.references["scenario_changes"]], [changes])
        truth.initialize(SCENARIOS / "landing.toml")
        seen = dict(zip(truth.columns, truth.get(list(truth.outputs.values())), strict=True))
    assert [seen[f"position_w[{n}]"] for n in (1, 2, 3)] == [300.0, 100.0, 123.0]
    assert [seen[f"velocity_w[{n}]"] for n in (1, 2, 3)] == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ("site.gravity = -1", "landing.toml: key `site.gravity`: .*greater than 0"),
        ("site.wind = 3", "landing.toml: key `site.wind`: .*not known"),
        ("site.gravity", "must be KEY = VALUE"),
    ],
)
def test_a_wrong_change_is_refused_as_in_the_file(changes, reason):
    with Component(fmu_file(FMUS, "lander-truth"), "truth") as truth:
        truth.fmu.setString([truth.references["scenario_changes"]], [changes])
        with pytest.raises(ComponentError, match=reason):
            truth.initialize(SCENARIOS / "landing.toml")
