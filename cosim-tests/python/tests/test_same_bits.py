"""The native master and FMPy execute one schedule on one numeric code: equal to the last bit."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import LANDER, SCENARIOS, fly, fmpy_command, replace, run


def results(command) -> dict:
    done = run(command)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def native(name, out) -> dict:
    return results([LANDER, "run", SCENARIOS / f"{name}.toml", "--json", "--out", out])


def test_fmpy_and_native_master_agree_on_every_bit_of_every_row(landing, tmp_path):
    assert native("landing", tmp_path)["digest"] == landing.results["digest"]
    # Equal rows give equal files, whoever produced them.
    assert (tmp_path / "landing.mcap").read_bytes() == landing.log.read_bytes()
    assert (tmp_path / "landing.json").read_bytes() == landing.results_file.read_bytes()


@pytest.mark.parametrize("variant", ["fmi2", "fmi3-arrays"])
def test_every_variant_gives_the_same_bits(variant, landing, tmp_path):
    by_fmpy = results(
        fmpy_command(SCENARIOS / "landing.toml", tmp_path, "--json", "--variant", variant)
    )
    assert by_fmpy == landing.results
    assert (tmp_path / "landing.mcap").read_bytes() == landing.log.read_bytes()


def test_the_same_landing_twice_leaves_the_same_files(landing, tmp_path):
    again = fly("landing", tmp_path)
    assert again.log.read_bytes() == landing.log.read_bytes()
    assert again.results_file.read_bytes() == landing.results_file.read_bytes()


@pytest.mark.parametrize("name", ["tip-over", "hop"])
def test_contact_and_lift_off_agree_too(name, tmp_path):
    assert native(name, tmp_path / "native")["digest"] == fly(name, tmp_path).results["digest"]


def test_a_stop_time_within_a_communication_step_ends_both_with_that_step(kit, tmp_path):
    scenario = kit / "scenarios" / "landing.toml"
    replace(scenario, "value = 90.0", "value = 10.004")
    by_native = results([LANDER, "run", scenario, "--json", "--out", tmp_path / "native"])
    by_fmpy = results(fmpy_command(scenario, tmp_path / "fmpy", "--json"))
    assert by_native["end_time_s"] == 10.01
    assert by_native["outcome"] == "no_contact"
    assert by_fmpy == by_native


def test_another_scenario_has_another_digest(landing, tmp_path):
    assert native("slope-10", tmp_path)["digest"] != landing.results["digest"]


@pytest.fixture(scope="module")
def wrong_libm(tmp_path_factory) -> dict[str, str]:
    """The environment of a program whose sin, exp, pow and so on err by 4.4e-16 of the result."""
    library = tmp_path_factory.mktemp("wrong") / "wrong_libm.so"
    source = Path(__file__).with_name("wrong_libm.c")
    command = ["cc", "-O1", "-fno-builtin", "-shared", "-fPIC", "-o", library, source, "-ldl"]
    subprocess.run(command, check=True)
    environment = os.environ | {"LD_PRELOAD": str(library)}
    # It is in force: Python has the host's sine.
    sine = [sys.executable, "-c", "import math; print(repr(math.sin(1.0)))"]
    outputs = [subprocess.check_output(sine, env=env) for env in (None, environment)]
    assert outputs[0] != outputs[1]
    return environment


@pytest.mark.parametrize(
    "name", ["landing", "landing-sensors", "crater-field", "hills", "tip-over", "apollo-11"]
)
def test_no_bit_comes_from_the_host_s_c_library(name, wrong_libm, tmp_path):
    command = [LANDER, "run", SCENARIOS / f"{name}.toml", "--json", "--out", tmp_path]
    by_wrong = subprocess.check_output(command, env=wrong_libm)
    assert json.loads(by_wrong)["digest"] == native(name, tmp_path)["digest"]
