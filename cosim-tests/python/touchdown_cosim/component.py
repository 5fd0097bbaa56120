"""One FMU through FMPy's low-level API, its values set and read as whole vectors."""

import re
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2Discard,
    fmi2Terminated,
)
from fmpy.fmi3 import FMU3Slave, fmi3Error


class ComponentError(RuntimeError):
    """An FMU cannot be used, or refused a call; then the message is the one that it logged."""


class Fmi2:
    """What FMI 2.0 calls differently."""

    def __init__(self, log: Callable, **options):
        self.fmu = FMU2Slave(**options)
        # Kept here: the FMU calls back as long as it lives.
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = fmi2CallbackLoggerTYPE(
            lambda environment, _name, status, category, message: log(
                environment, status, category, message.replace(b"%%", b"%")
            )
        )
        self.get, self.set = self.fmu.getReal, self.fmu.setReal

    def instantiate(self, **options):
        self.fmu.instantiate(callbacks=self._callbacks, **options)

    def start(self):
        self.fmu.setupExperiment()
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def step(self, time_s: float, step_s: float) -> bool:
        try:
            self.fmu.doStep(time_s, step_s)
        except FMICallException as stopped:
            if stopped.status == fmi2Discard and self.fmu.getBooleanStatus(fmi2Terminated):
                return True
            raise
        return False


class Fmi3:
    """What FMI 3.0 calls differently."""

    def __init__(self, log: Callable, sizes: dict[int, int], **options):
        self.fmu = FMU3Slave(**options)
        self._log, self._sizes = log, sizes
        self.set = self.fmu.setFloat64

    def instantiate(self, **options):
        self.fmu.instantiate(logMessage=self._log, **options)

    def start(self):
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def get(self, references: list[int]) -> list[float]:
        return self.fmu.getFloat64(references, sum(self._sizes[r] for r in references))

    def step(self, time_s: float, step_s: float) -> bool:
        _event, terminate, _early, _time_s = self.fmu.doStep(time_s, step_s)
        return terminate


class Component:
    """An instance from instantiation to release; use it in a `with` block.

    `instantiation` goes to FMPy's `instantiate`."""

    def __init__(self, file: Path, name: str, **instantiation):
        self.name = name
        self._errors: list[str] = []
        self._folder = Path(tempfile.mkdtemp(prefix=f"{file.stem}-"))
        try:
            self._load(file, instantiation)
        except BaseException as error:
            shutil.rmtree(self._folder, ignore_errors=True)
            if isinstance(error, Exception):
                # FMPy raises anything from OSError to a bare Exception.
                raise ComponentError(f"{file}: {error}") from error
            raise

    def _load(self, file: Path, instantiation: dict):
        self.description = fmpy.read_model_description(file)
        variables = self.description.modelVariables
        real = [v for v in variables if v.type in ("Float64", "Real")]
        sizes = {v.valueReference: size(v) for v in real}
        self.inputs = {v.name: v.valueReference for v in real if v.causality == "input"}
        self.outputs = {v.name: v.valueReference for v in real if v.causality == "output"}
        # Names of the scalars in all outputs: what `get(outputs.values())` returns.
        self.columns = [n for v, r in self.outputs.items() for n in scalars(v, sizes[r])]
        self.references = {v.name: v.valueReference for v in variables}
        fmpy.extract(file, self._folder)
        options = {
            "instanceName": self.name,
            "guid": self.description.guid,
            "modelIdentifier": self.description.coSimulation.modelIdentifier,
            "unzipDirectory": str(self._folder),
        }
        if self.description.fmiVersion == "2.0":
            self._api = Fmi2(self._log, **options)
        else:
            self._api = Fmi3(self._log, sizes, **options)
        self.fmu = self._api.fmu
        self._checked(self._api.instantiate, **instantiation)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

    def initialize(self, scenario_file: Path):
        """To the state at t = 0 of a scenario."""
        references = self.references
        self._checked(self.fmu.setString, [references["scenario_file"]], [str(scenario_file)])
        self._checked(self.fmu.setBoolean, [references["terminate_at_end"]], [True])
        self._checked(self._api.start)

    def get(self, references: list[int]) -> list[float]:
        """All scalars of the variables, one after another."""
        return self._checked(self._api.get, references)

    def set(self, references: list[int], values: list[float]):
        self._checked(self._api.set, references, values)

    def step(self, time_s: float, step_s: float) -> bool:
        """Advances by one communication step; true when the FMU asks for the end."""
        return self._checked(self._api.step, time_s, step_s)

    def _log(self, _environment, status: int, _category: bytes, message: bytes):
        # FMI 2.0 has the same number for an error.
        if status >= fmi3Error:
            self._errors.append(message.decode("utf-8"))

    def _checked(self, call, *arguments, **options):
        self._errors.clear()
        try:
            return call(*arguments, **options)
        except Exception as error:
            reason = self._errors[0] if self._errors else str(error)
            # The C function that refused is of no use to the reader of a scenario's error.
            reason = re.sub(r"^fmi[23]\w+: ", "", reason)
            raise ComponentError(reason) from error


def size(variable) -> int:
    """Number of values; the arrays of this kit have one dimension."""
    return int(variable.dimensions[0].start) if variable.dimensions else 1


def scalars(name: str, count: int) -> list[str]:
    return [name] if count == 1 else [f"{name}[{n + 1}]" for n in range(count)]
