"""What people will copy works as it stands."""

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

import fmpy

from conftest import FMUS, ROOT
from touchdown_cosim.component import Component
from touchdown_cosim.variants import fmu_file

EXAMPLES = ROOT / "cosim-tests" / "examples"


def test_the_short_script_lands(landing):
    fmus = [fmu_file(FMUS, model) for model in ("lander-truth", "scvx-guidance")]
    command = [sys.executable, EXAMPLES / "land.py", *fmus]
    done = subprocess.run(command, capture_output=True, text=True)
    end_s = landing.results["end_time_s"]
    assert done.stdout.startswith(f"outcome 1 after {end_s:.2f} s"), done.stdout + done.stderr


def test_the_gate_lets_a_landing_pass(tmp_path):
    gate = [sys.executable, "-m", "pytest", EXAMPLES / "test_gate.py", "--quiet", "-k", "landing"]
    done = subprocess.run(
        [*gate, "-p", "no:cacheprovider"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout


def test_the_truth_fmu_serves_guidance_of_others(tmp_path):
    """A Python FMU, built by `pythonfmu3`, with names of its own."""
    builder = Path(sys.executable).with_name("pythonfmu3")
    source = EXAMPLES / "braking_guidance.py"
    subprocess.run([builder, "build", "-f", source], cwd=tmp_path, check=True)
    spec = importlib.util.spec_from_file_location("braking_guidance", source)
    wires = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(wires)
    about = fmpy.read_model_description(tmp_path / "BrakingGuidance.fmu")
    folder = fmpy.extract(tmp_path / "BrakingGuidance.fmu", tmp_path / "unpacked")
    guidance = fmpy.instantiate_fmu(folder, about, "CoSimulation")
    of = {v.name: v.valueReference for v in about.modelVariables}
    guidance.enterInitializationMode()
    guidance.exitInitializationMode()
    with Component(fmu_file(FMUS, "lander-truth"), "truth") as truth:
        truth.initialize(EXAMPLES / "drop.toml")
        readings = [truth.outputs[name] for name in wires.READINGS]
        commands = [truth.inputs[name] for name in wires.COMMANDS.values()]
        for n in range(6000):
            time_s = round(n * 0.01, 9)
            guidance.setFloat64([of[name] for name in wires.READINGS.values()], truth.get(readings))
            guidance.doStep(time_s, 0.01)
            truth.set(commands, guidance.getFloat64([of[name] for name in wires.COMMANDS]))
            if truth.step(time_s, 0.01):
                break
        names = ["outcome", "contact_speed_down_m_s", "contact_speed_across_m_s"]
        outcome, down_m_s, across_m_s = truth.get([truth.outputs[name] for name in names])
    guidance.terminate()
    guidance.freeInstance()
    shutil.rmtree(folder)
    assert outcome == 1.0
    # The limits of a touchdown in this kit's verdict in words (cosim-tests/README.md).
    assert down_m_s < 2.0
    assert across_m_s < 0.5
