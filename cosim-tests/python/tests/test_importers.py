"""Importers that nobody here wrote fly the default landing to the same verdict.

They load `lander.ssp` (FMI 2.0) and `lander-fmi3.ssp`. All but the kit's own master let every FMU
step before they exchange: guidance then answers a step of 10 ms later, and the lander touches down
at another moment, but all of them at the same.
"""

import json
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssv

from conftest import FMUS, ROOT
from touchdown_cosim import schedule
from touchdown_cosim.component import Component
from touchdown_cosim.master import Master
from touchdown_cosim.variants import VARIANTS, fmu_file

PLAN = schedule.load()
LANDED = 1.0
TIPPED = 3.0
# Past the end of the landing: the FMUs then hold their outputs.
STOP_S = 30.0
SYSTEMS = {"fmi2": FMUS / "lander.ssp", "fmi3": FMUS / "lander-fmi3.ssp"}
BOTH = pytest.mark.parametrize("version", SYSTEMS)


@pytest.fixture(scope="module")
def together_s() -> float:
    """Contact time with both FMUs stepped before any exchange: the schedule, rearranged."""
    kinds = {"transfer": 0, "step": 1, "record": 2}
    plan = schedule.Schedule(
        PLAN.step_s, sorted(PLAN.actions, key=lambda a: kinds[a["do"]]), PLAN.rows, PLAN.components
    )
    components = {n: Component(fmu_file(FMUS, m), n) for n, m in PLAN.components.items()}
    for component in components.values():
        component.initialize("")
    Master(plan, components).run(lambda row: None)
    truth = components["truth"]
    [contact_s] = truth.get([truth.outputs["contact_time_s"]])
    for component in components.values():
        component.__exit__()
    return contact_s


def test_fmpy_ssp(together_s):
    rows = simulate_ssp(str(SYSTEMS["fmi2"]), stop_time=STOP_S, step_size=PLAN.step_s)
    assert rows["truth.outcome"][-1] == LANDED


@BOTH
@pytest.mark.parametrize(("scenario", "outcome"), [("landing", LANDED), ("tip-over", TIPPED)])
def test_ecos(version, scenario, outcome, together_s, tmp_path):
    system = bind(version, scenario, tmp_path)
    code = f"""
import ecospy
with ecospy.EcosSimulation(ssp_path={str(system)!r}, step_size={PLAN.step_s}) as simulation:
    simulation.init(parameter_set={scenario!r})
    simulation.step({round(STOP_S / PLAN.step_s)})
    print("verdict", *map(simulation.get_real, ["truth::outcome", "truth::contact_time_s"]))
"""
    found, contact_s = verdict(code, tmp_path)
    assert found == outcome
    if scenario == "landing":
        assert contact_s == together_s


@pytest.mark.parametrize(("scenario", "outcome"), [("landing", LANDED), ("tip-over", TIPPED)])
def test_libcosim(scenario, outcome, together_s, tmp_path):
    """FMI 2.0 only."""
    system = bind("fmi2", scenario, tmp_path)
    code = f"""
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
step_ns = {round(PLAN.step_s * 1e9)}
execution = CosimExecution.from_ssp_file(ssp_path={str(system)!r}, step_size=step_ns)
observer = CosimObserver.create_last_value()
execution.add_observer(observer=observer)
truth = next(s.index for s in execution.slave_infos() if s.name == b"truth")
references = {{v.name: v.reference for v in execution.slave_variables(truth)}}
assert execution.step(step_count={round(STOP_S / PLAN.step_s)})
wanted = [references[b"outcome"], references[b"contact_time_s"]]
print("verdict", *observer.last_real_values(truth, wanted))
"""
    found, contact_s = verdict(code, tmp_path)
    assert found == outcome
    if scenario == "landing":
        assert contact_s == together_s


@BOTH
def test_fmucontainer(version, together_s, tmp_path):
    """Makes one FMU of the system, which FMPy then flies."""
    shutil.copy(SYSTEMS[version], tmp_path)
    name = SYSTEMS[version].stem
    container("-container", f"{name}.ssp:{PLAN.step_s}", "-dump-json", folder=tmp_path)
    with zipfile.ZipFile(SYSTEMS[version]) as archive:
        for entry in archive.namelist():
            if entry.endswith(".fmu"):
                (tmp_path / Path(entry).name).write_bytes(archive.read(entry))
    # As read from the SSP, and two outputs to look at.
    dump = (tmp_path / f"{name}-dump.json").read_text(encoding="utf-8")
    system = json.loads(dump.replace(f"{name}.dir/", ""))
    truth = fmu_file(Path(), "lander-truth", version).name
    system["output"] = [[truth, signal, signal] for signal in ("outcome", "contact_time_s")]
    (tmp_path / "shown.json").write_text(json.dumps(system | {"name": "shown.fmu"}))
    container("-container", "shown.json", "-fmi", version[-1], folder=tmp_path)
    rows = fmpy.simulate_fmu(
        str(tmp_path / "shown.fmu"),
        stop_time=STOP_S,
        step_size=PLAN.step_s,
        output_interval=PLAN.step_s,
        output=["outcome", "contact_time_s"],
        validate=False,
    )
    assert rows["outcome"][-1] == LANDED
    assert rows["contact_time_s"][-1] == together_s


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("model", PLAN.components.values())
def test_fmutool_finds_no_error(model, variant):
    command = [script("fmutool"), "-input", fmu_file(FMUS, model, variant), "-check"]
    done = subprocess.run(command, capture_output=True, text=True)
    told = done.stdout + done.stderr
    assert "seems to be compliant" in told and "No semantic error" in told
    assert "ERROR" not in told and "WARNING" not in told, told


@pytest.mark.parametrize("variant", VARIANTS)
def test_fmpy_flies_truth_alone(variant):
    """Without a command it falls: FMPy's own simulation loop, as the command line has it."""
    rows = fmpy.simulate_fmu(
        str(fmu_file(FMUS, "lander-truth", variant)),
        stop_time=1.0,
        step_size=0.01,
        output=["position_w[3]"] if variant != "fmi3-arrays" else ["position_w"],
        start_values={"terminate_at_end": True},
    )
    last = rows[-1][1]
    height_m = last if variant != "fmi3-arrays" else last[2]
    # From 500 m at -25 m/s under 1.625 m/s2; origin: rounding of 1000 ticks at 500 m.
    assert height_m == pytest.approx(500 - 25 - 1.625 / 2, abs=1e-9)


def bind(version: str, scenario: str, folder: Path) -> Path:
    """The system with another of its parameter sets."""
    bound = folder / SYSTEMS[version].name
    with zipfile.ZipFile(SYSTEMS[version]) as source, zipfile.ZipFile(bound, "w") as target:
        for entry in source.namelist():
            content = source.read(entry)
            if entry == "SystemStructure.ssd":
                content = content.replace(b"/landing.ssv", f"/{scenario}.ssv".encode())
            target.writestr(entry, content)
    return bound


def verdict(code: str, folder: Path) -> tuple[float, float]:
    """Outcome and contact time that `code` prints, among whatever else its importer prints. In a
    process of its own: a crash of the importer is a failed test."""
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    [line] = [line for line in done.stdout.splitlines() if line.startswith("verdict ")]
    _, outcome, contact_s = line.split()
    return float(outcome), float(contact_s)


def script(name: str) -> Path:
    return Path(sys.executable).with_name(name)


def container(*arguments: str, folder: Path):
    command = [script("fmucontainer"), *arguments, "-fmu-directory", "."]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@BOTH
def test_every_scenario_has_a_valid_parameter_set(version):
    """Against the schema of SSP 1.0, as FMPy has it."""
    for scenario in (ROOT / "models" / "scenarios").glob("*.toml"):
        values = read_ssv(str(SYSTEMS[version]), f"resources/{scenario.stem}.ssv")
        assert values.name == scenario.stem
        assert [(p.name, p.value) for p in values.parameters] == [
            ("scenario_file", f"scenarios/{scenario.name}")
        ]
