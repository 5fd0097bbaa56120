"""The Python side of `cosim-tests/claims`: asserts a claim and records it for docs/VALIDATION.md."""

import inspect
import re
from dataclasses import dataclass

from conftest import ROOT, TARGET


@dataclass(frozen=True)
class Claim:
    """Fields as in the Rust crate; give `at_most` (for the magnitude) or `at_least`."""

    id: str
    section: str
    claim: str
    reference: str
    origin: str
    unit: str = ""
    at_most: float | None = None
    at_least: float | None = None
    # Results smaller than this are rounding noise, and told as such.
    noise: float = 0.0

    def __post_init__(self):
        assert re.fullmatch("[A-Za-z0-9-]+", self.id), "an id has letters, digits and dashes only"
        assert (self.at_most is None) != (self.at_least is None), "a claim has one bound"

    def holds(self, *measured: float):
        """Asserts the bound for each measurement, then records the worst."""
        caller = inspect.stack()[1]
        assert measured, f"{self.id}: nothing was measured"
        for value in measured:
            held = abs(value) <= self.at_most if self.at_least is None else value >= self.at_least
            assert held, f"{self.id} is broken: {value} {self.unit} {self}"
        worst = max(measured, key=abs) if self.at_least is None else min(measured)
        print(f"{self.claim}: {worst:e} {self.unit}")
        place = f"{ROOT.joinpath(caller.filename).relative_to(ROOT)}:{caller.lineno}"
        self._record(worst, place)

    def _record(self, measured: float, place: str):
        kind = "at_most" if self.at_least is None else "at_least"
        fields = {
            "id": self.id,
            "section": self.section,
            "claim": self.claim,
            "reference": self.reference,
            "unit": self.unit,
            kind: repr(float(getattr(self, kind))),
            "origin": self.origin,
            "noise": repr(float(self.noise)),
            "measured": repr(float(measured)),
            "test": place,
        }
        folder = TARGET / "validation"
        folder.mkdir(parents=True, exist_ok=True)
        text = "".join(f"{key} = {value}\n" for key, value in fields.items())
        name = f"{self.id}@{re.sub('[/.:]', '-', place)}"
        (folder / name).write_text(text, encoding="utf-8")
