"""One FMU through FMPy's low-level API, its values set and read as whole vectors."""

import re
import shutil
import tempfile
from pathlib import Path

import fmpy
from fmpy.fmi3 import FMU3Slave, fmi3Error


class ComponentError(RuntimeError):
    """An FMU cannot be used, or refused a call; then the message is the one that it logged."""


class Component:
    """An instance from instantiation to release; use it in a `with` block."""

    def __init__(self, fmu_file: Path, name: str):
        self.name = name
        self._errors: list[str] = []
        self._folder = Path(tempfile.mkdtemp(prefix=f"{fmu_file.stem}-"))
        try:
            self._load(fmu_file)
        except BaseException as error:
            shutil.rmtree(self._folder, ignore_errors=True)
            if isinstance(error, Exception):
                # FMPy raises anything from OSError to a bare Exception.
                raise ComponentError(f"{fmu_file}: {error}") from error
            raise
        variables = self.description.modelVariables
        real = [v for v in variables if v.type == "Float64"]
        self.inputs = {v.name: v.valueReference for v in real if v.causality == "input"}
        self.outputs = {v.name: v.valueReference for v in real if v.causality == "output"}
        self._references = {v.name: v.valueReference for v in variables}

    def _load(self, fmu_file: Path):
        self.description = fmpy.read_model_description(fmu_file)
        fmpy.extract(fmu_file, self._folder)
        self.fmu = FMU3Slave(
            instanceName=self.name,
            guid=self.description.guid,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            unzipDirectory=str(self._folder),
        )
        self._checked(self.fmu.instantiate, logMessage=self._log)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

    def initialize(self, scenario_file: Path):
        """To the state at t = 0 of a scenario."""
        reference = self._references["scenario_file"]
        self._checked(self.fmu.setString, [reference], [str(scenario_file)])
        self._checked(self.fmu.enterInitializationMode)
        self._checked(self.fmu.exitInitializationMode)

    def get(self, references: list[int]) -> list[float]:
        return self._checked(self.fmu.getFloat64, references)

    def set(self, references: list[int], values: list[float]):
        self._checked(self.fmu.setFloat64, references, values)

    def step(self, time_s: float, step_s: float) -> bool:
        """Advances by one communication step; true when the FMU asks for the end."""
        _event, terminate, _early, _time_s = self._checked(self.fmu.doStep, time_s, step_s)
        return terminate

    def _log(self, _environment, status: int, _category: bytes, message: bytes):
        if status >= fmi3Error:
            self._errors.append(message.decode("utf-8"))

    def _checked(self, call, *arguments, **options):
        self._errors.clear()
        try:
            return call(*arguments, **options)
        except Exception as error:
            reason = self._errors[0] if self._errors else str(error)
            # The C function that refused is of no use to the reader of a scenario's error.
            reason = re.sub(r"^fmi3\w+: ", "", reason)
            raise ComponentError(reason) from error
