"""A broken claim fails its test and leaves no record; the worst of several is the one recorded."""

import claims
import pytest
from claims import Claim

ABOUT = {"section": "s", "claim": "c", "reference": "r", "origin": "o", "unit": "m"}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(claims, "TARGET", tmp_path)
    return tmp_path / "validation"


@pytest.mark.parametrize("broken", [-1.1, 1.1, float("nan")])
def test_a_broken_claim_is_not_told(folder, broken):
    with pytest.raises(AssertionError, match="x is broken"):
        Claim("x", **ABOUT, at_most=1.0).holds(0.5, broken)
    assert not folder.exists()


def test_the_worst_is_recorded(folder):
    Claim("most", **ABOUT, at_most=1.0).holds(0.5, -0.7, 0.6)
    Claim("least", **ABOUT, at_least=3.8, noise=1e-9).holds(5.0, 4.0)
    (least, most) = sorted(folder.iterdir())
    assert "measured = -0.7\n" in most.read_text() and "at_most = 1.0\n" in most.read_text()
    assert "measured = 4.0\n" in least.read_text() and "noise = 1e-09\n" in least.read_text()
    assert "test = cosim-tests/python/tests/test_claims.py:" in most.read_text()


def test_a_claim_has_one_bound():
    with pytest.raises(AssertionError, match="one bound"):
        Claim("x", **ABOUT, at_most=1.0, at_least=1.0)
