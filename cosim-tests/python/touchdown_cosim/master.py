"""Executes the schedule on components: who is set, stepped and read, in which order."""

import itertools
from collections.abc import Callable, Mapping

from .component import Component
from .schedule import Schedule

Row = list[float]


class Master:
    def __init__(self, schedule: Schedule, components: Mapping[str, Component]):
        self._schedule = schedule
        self._components = components
        self._columns = {name: list(components[name].outputs.values()) for name in schedule.rows}
        self.width = 1 + sum(len(components[name].columns) for name in schedule.rows)
        self._wires = {
            (a["from"], a["to"]): self._wire(components[a["from"]], components[a["to"]])
            for a in schedule.actions
            if a["do"] == "transfer"
        }

    @staticmethod
    def _wire(source: Component, sink: Component) -> tuple[list[int], list[int]]:
        """Value references of the outputs and the inputs that share a name."""
        shared = [name for name in source.outputs if name in sink.inputs]
        return [source.outputs[name] for name in shared], [sink.inputs[name] for name in shared]

    def run(self, on_row: Callable[[Row], None]):
        """Until a component asks for the end, which truth does at the stop time."""
        on_row(self.row(0))
        for index in itertools.count():
            if self.communication_step(index, on_row):
                return

    def communication_step(self, index: int, on_row: Callable[[Row], None]) -> bool:
        """From communication point `index` to the next; true when a component asks for the end."""
        ended = False
        for action in self._schedule.actions:
            match action["do"]:
                case "transfer":
                    outputs, inputs = self._wires[action["from"], action["to"]]
                    values = self._components[action["from"]].get(outputs)
                    self._components[action["to"]].set(inputs, values)
                case "step":
                    component = self._components[action["component"]]
                    ended |= component.step(self.time_s(index), self._schedule.step_s)
                case "record":
                    on_row(self.row(index + 1))
                case unknown:
                    raise ValueError(f"schedule.toml: `{unknown}` is no action")
        return ended

    def time_s(self, index: int) -> float:
        """Communication point n·h: adding h up would drift. Rounded to the double nearest to
        the decimal, which the native master's integer ticks give as well."""
        return round(index * self._schedule.step_s, 9)

    def row(self, index: int) -> Row:
        row = [self.time_s(index)]
        for name, references in self._columns.items():
            row += self._components[name].get(references)
        return row
