"""fmi-sim, the importer of rust-fmi, flies each FMU alone through a whole landing.

It takes inputs from a file: truth gets the commands of the landing that FMPy has flown, guidance
its readings. FMI 2.0 and FMI 3.0 with scalars: fmi-sim 0.7.0 reads one value of an array.
"""

import csv
import subprocess
from pathlib import Path

import numpy as np
import pytest

from conftest import FMUS, TARGET
from touchdown_cosim import schedule
from touchdown_cosim.component import Component
from touchdown_cosim.variants import fmu_file

FMI_SIM = TARGET / "importers" / "bin" / "fmi-sim"
STEP_S = schedule.load().step_s


def simulate(fmu: Path, inputs: dict[str, np.ndarray], folder: Path) -> dict[str, np.ndarray]:
    """Every output at every communication point, as fmi-sim writes them."""
    steps = len(next(iter(inputs.values()))) - 1
    # The products that fmi-sim makes, so that it has a row at each of its times.
    table = {"time": np.arange(steps + 1) * STEP_S} | inputs
    given, made = folder / "inputs.csv", folder / "outputs.csv"
    with given.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(table)
        writer.writerows(np.stack(list(table.values()), axis=1).tolist())
    command = [FMI_SIM, "--model", fmu, "-i", given, "-o", made, "co-simulation"]
    command += ["-s", "0", "-f", repr(table["time"][-1].item()), "--output-interval", repr(STEP_S)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    with made.open(newline="") as file:
        header, *rows = csv.reader(file)
    return dict(zip(header, np.array(rows, dtype=float).T, strict=True))


@pytest.mark.parametrize("variant", ["fmi2", "fmi3"])
@pytest.mark.parametrize("model", ["lander-truth", "scvx-guidance"])
def test_fmi_sim_flies_what_fmpy_flew(model, variant, landing_table, tmp_path):
    fmu = fmu_file(FMUS, model, variant)
    with Component(fmu, model) as component:
        names, columns = list(component.inputs), component.columns
    # A command flies in the step whose row records it; a reading is that of the row before.
    shift = -1 if model == "lander-truth" else 0
    inputs = {name: np.roll(landing_table[name], shift) for name in names if name in landing_table}
    outputs = simulate(fmu, inputs, tmp_path)
    for name in columns:
        found, flown = outputs[name], landing_table[name]
        assert (np.isnan(found) == np.isnan(flown)).all(), name
        # Origin: fmi-sim interpolates to the end of an interval, t0 + 1 * (t1 - t0), which rounds
        # an input by one part in 2^53; measured is up to 6e-11 of the greatest value, at contact.
        scale = max(1.0, np.nanmax(np.abs(flown), initial=0.0))
        assert np.nanmax(np.abs(found - flown), initial=0.0) <= 1e-8 * scale, name
