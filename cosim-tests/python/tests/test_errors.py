"""A wrong scenario is refused in one line that names file, key and reason, and leaves no file."""

import shutil

import pytest

from conftest import LANDER, ROOT, SCENARIOS, fmpy_command, run

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


@pytest.fixture
def kit(tmp_path):
    """A copy of the scenarios and vehicles that a test may spoil."""
    for folder in ("scenarios", "vehicles"):
        shutil.copytree(ROOT / "models" / folder, tmp_path / folder)
    return tmp_path


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
    text = path.read_text()
    assert old in text, f"{file} no longer contains {old}"
    path.write_text(text.replace(old, new, 1))
    named = "moth.toml" if case == "no vehicle" else file
    for command in commands(kit / "scenarios" / "landing.toml", kit / "out"):
        assert_refused(run(command), kit / "out", named, key, reason)


def test_a_missing_file_is_refused(tmp_path):
    for command in commands(tmp_path / "nowhere.toml", tmp_path / "out"):
        assert_refused(run(command), tmp_path / "out", "nowhere.toml", "cannot be read")


def test_a_missing_fmu_is_named(tmp_path):
    command = fmpy_command(SCENARIOS / "landing.toml", tmp_path / "out")
    command[command.index("--fmus") + 1] = tmp_path
    assert_refused(run(command), tmp_path / "out", "lander-truth.fmu")
