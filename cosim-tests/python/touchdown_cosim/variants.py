"""The variants of an FMU, by the middle of its file's name; the first is the default."""

from pathlib import Path

VARIANTS = ("fmi3", "fmi3-arrays", "fmi2")


def fmu_file(folder: Path, model: str, variant: str = VARIANTS[0]) -> Path:
    return folder / f"{model}.{variant}.fmu"
