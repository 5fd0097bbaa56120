"""A wrong scenario is refused in one line that names file, key and reason, and leaves no file."""

import os
import shutil
import signal
import zipfile

import pytest

from conftest import FMUS, LANDER, SCENARIOS, fmpy_command, replace, run
from mcap.reader import make_reader

CASES = {
    "unknown key": ("landing.toml", "[site]", "[site]\nwind = 3", "site.wind", "is not known"),
    "missing unit": (
        "landing.toml",
        '{ value = 1.625, unit = "m/s2" }',
        "1.625",
        "site.gravity",
        "has no unit",
    ),
    "wrong unit": ("landing.toml", '"m/s2"', '"ft/s2"', "site.gravity", 'must be in "m/s2"'),
    "not a number": ("landing.toml", "1.625", "nan", "site.gravity", "must be finite"),
    "text": ("landing.toml", "1.625", '"much"', "site.gravity", "must be a number"),
    "negative mass": ("bug.toml", "value = 174.0", "value = -174.0", "mass.dry_mass", "-174"),
    "missing key": ("landing.toml", "friction", "#", "terrain.friction", "is missing"),
    "not TOML": ("landing.toml", "[site]", "[site", "", "not valid TOML"),
    "no vehicle": ("landing.toml", "bug.toml", "moth.toml", "", "cannot be read"),
}


def assert_refused(done, out, *named):
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1, done.stderr
    assert done.stderr.startswith("error: ")
    for name in named:
        assert name in done.stderr
    assert not out.exists(), "a refused run left files"


def commands(scenario, out):
    return fmpy_command(scenario, out), [LANDER, "run", scenario, "--out", out]


@pytest.mark.parametrize("case", CASES)
def test_a_wrong_file_is_refused(case, kit):
    file, old, new, key, reason = CASES[case]
    path = next(kit.rglob(file))
    replace(path, old, new)
    named = "moth.toml" if case == "no vehicle" else file
    for command in commands(kit / "scenarios" / "landing.toml", kit / "out"):
        assert_refused(run(command), kit / "out", named, key, reason)


def test_a_missing_file_is_refused(tmp_path):
    for command in commands(tmp_path / "nowhere.toml", tmp_path / "out"):
        assert_refused(run(command), tmp_path / "out", "nowhere.toml", "cannot be read")


def test_a_missing_fmu_is_named(tmp_path):
    command = fmpy_command(SCENARIOS / "landing.toml", tmp_path / "out")
    command[command.index("--fmus") + 1] = tmp_path
    assert_refused(run(command), tmp_path / "out", "lander-truth.fmi3.fmu")


def truncated(fmu):
    os.truncate(fmu, 1000)


def without_library(fmu):
    with zipfile.ZipFile(fmu) as archive:
        kept = {n: archive.read(n) for n in archive.namelist() if not n.endswith(".so")}
    with zipfile.ZipFile(fmu, "w") as archive:
        for name, content in kept.items():
            archive.writestr(name, content)


@pytest.mark.parametrize("spoil", [truncated, without_library])
def test_a_broken_fmu_is_named(spoil, tmp_path):
    fmus = shutil.copytree(FMUS, tmp_path / "fmus")
    spoil(fmus / "scvx-guidance.fmi3.fmu")
    command = fmpy_command(SCENARIOS / "landing.toml", tmp_path / "out", "--gate")
    command[command.index("--fmus") + 1] = fmus
    assert_refused(run(command), tmp_path / "out", "scvx-guidance.fmi3.fmu")


def test_a_run_that_fails_in_flight_leaves_a_log_and_no_verdict(kit):
    """A spin of 1e15 deg/s squares itself in every stage of the integrator, out of a double's range."""
    scenario = kit / "scenarios" / "no-ignition.toml"
    replace(scenario, "rate_b = { value = [0.0, 0.0, 0.0]", "rate_b = { value = [1e15, 1e15, 0.0]")
    out = kit / "out"
    out.mkdir()
    for command in commands(scenario, out):
        (out / "no-ignition.json").write_text('{"outcome": "landed"}', encoding="utf-8")
        done = run([*command, "--json", "--gate"])
        assert done.returncode == 2, done.stderr
        assert done.stdout == ""
        assert sum(line.startswith("error: ") for line in done.stderr.splitlines()) == 1
        assert [file.name for file in out.iterdir()] == ["no-ignition.mcap"]
        with (out / "no-ignition.mcap").open("rb") as log:
            assert make_reader(log, validate_crcs=True).get_summary().statistics.message_count
        (out / "no-ignition.mcap").unlink()


def test_a_recorder_that_is_killed_is_a_failed_run(tmp_path):
    recorder = tmp_path / "recorder"
    recorder.write_text(f"#!/bin/sh\nkill -{signal.SIGKILL:d} $$\n", encoding="utf-8")
    recorder.chmod(0o755)
    command = fmpy_command(SCENARIOS / "tip-over.toml", tmp_path / "out", "--gate")
    command[command.index("--lander") + 1] = recorder
    assert_refused(run(command), tmp_path / "out", "signal 9")
