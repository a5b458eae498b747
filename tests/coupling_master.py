"""Master: couples FMUs and vehicles step by step, for teaching and for tests of what they do together.

All inputs are told for the end of a step. Where who gives them has gone ahead already (sequential scheme), they are
known; else they are extrapolated from the last values: y_n (order 0), 2 y_n - y_{n-1} (1), 3 y_n - 3 y_{n-1} + y_{n-2}
(2). With iterations everybody goes back and repeats the step with what was found at its end.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple, Protocol, Self

import numpy as np

from ropewalk.cosim.vehicle import LoneVehicle
from ropewalk.errors import RopewalkError, did_you_mean
from ropewalk.mechanics.chain import Array

Scheme = Literal["sequential", "parallel"]


class Part(Protocol):
    """One of those that are coupled: an FMU, or an object that behaves like one."""

    def begin(self, inputs: Mapping[str, float]) -> None:
        """Begin with inputs."""

    def look(self, name: str) -> float:
        """An output now."""

    def step(self, t: float, h: float, inputs: Mapping[str, float]) -> None:
        """Go on from t by h seconds, with the values of inputs at the end."""

    def get_state(self) -> Any:
        """All that changes."""

    def set_state(self, state: Any) -> None:
        """Go back to it."""


class Link(NamedTuple):
    """An output of one simulator that is an input of another."""

    giver: str
    output: str
    taker: str
    input: str
    factor: float = 1.0


class FmuPart:
    """An FMU for co-simulation (FMI 2.0), through FMPy.

    Args:
        file: the .fmu file.
        parameters: variable: value, set before it begins.

    Raises:
        RopewalkError: FMPy is missing, or the file cannot be used.
    """

    def __init__(self, file: str | Path, **parameters: float | bool) -> None:
        try:
            from fmpy import extract, read_model_description
            from fmpy.fmi2 import FMU2Slave
        except ImportError as error:
            raise RopewalkError(
                "coupling FMUs needs FMPy, which is not installed: pip install 'ropewalk[fmi]'"
            ) from error
        if not Path(file).is_file():
            raise RopewalkError(f"{file}: there is no such file")
        about = read_model_description(str(file))
        self._folder = extract(str(file))
        self.name, self._parameters = about.modelName, parameters
        self._variables = {variable.name: variable for variable in about.modelVariables}
        self._fmu = FMU2Slave(
            guid=about.guid, unzipDirectory=self._folder, modelIdentifier=about.coSimulation.modelIdentifier,
            instanceName=about.modelName,
        )  # fmt: skip
        self._fmu.instantiate()
        self._states: list[Any] = []

    def begin(self, inputs: Mapping[str, float]) -> None:
        """Begin with inputs."""
        self._fmu.setupExperiment(startTime=0.0)
        self._set(self._parameters)
        self._fmu.enterInitializationMode()
        self._set(inputs)
        self._fmu.exitInitializationMode()

    def _set(self, values: Mapping[str, float | bool]) -> None:
        reals = {name: value for name, value in values.items() if self._variable(name).type == "Real"}
        if reals:
            self._fmu.setReal([self._variable(name).valueReference for name in reals], list(reals.values()))
        for name in values.keys() - reals.keys():
            self._fmu.setBoolean([self._variable(name).valueReference], [bool(values[name])])

    def _variable(self, name: str) -> Any:
        if name not in self._variables:
            raise RopewalkError(f"{self.name} has no variable {name}; {did_you_mean(name, self._variables)}")
        return self._variables[name]

    def look(self, name: str) -> float:
        """An output now."""
        return float(self._fmu.getReal([self._variable(name).valueReference])[0])

    def step(self, t: float, h: float, inputs: Mapping[str, float]) -> None:
        """Go on from t by h seconds, with the values of inputs at the end.

        Raises:
            RopewalkError: the FMU refuses the step.
        """
        self._set(inputs)
        try:
            self._fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)
        except Exception as error:  # FMPy has an error of its own for each status
            raise RopewalkError(f"{self.name} refused the step from t = {t:g} s by {h:g} s ({error})") from error

    def get_state(self) -> Any:
        """All that changes."""
        self._states.append(self._fmu.getFMUState())
        return self._states[-1]

    def set_state(self, state: Any) -> None:
        """Go back to it."""
        self._fmu.setFMUState(state)

    def forget(self) -> None:
        """Let all states go."""
        while self._states:
            self._fmu.freeFMUState(self._states.pop())

    def close(self) -> None:
        """Let the FMU go, and what was unpacked of it."""
        self.forget()
        self._fmu.terminate()
        self._fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class VehiclePart:
    """A vehicle as a Python object, with the variables that its FMU would have."""

    def __init__(self, lone_vehicle: LoneVehicle) -> None:
        self.lone_vehicle = lone_vehicle
        self._names = [touch.name for touch in lone_vehicle.vehicle.touches]
        self._stated: dict[str, float] = {}

    def _of(self, inputs: Mapping[str, float], what: str) -> Array:
        return np.array([inputs.get(f"{name}.{what}", 0.0) for name in self._names])

    def begin(self, inputs: Mapping[str, float]) -> None:
        """Begin with inputs; a vehicle that gives motion finds `start_height` and `start_velocity` among them."""
        self._stated = dict(inputs)
        first = "" if self.lone_vehicle.gives == "force" else "start_"
        self.lone_vehicle.place(self._of(inputs, f"{first}height"), self._of(inputs, f"{first}velocity"))

    def look(self, name: str) -> float:
        """An output now."""
        contact, what = name.split(".")
        i = self._names.index(contact)
        if what == "force":
            return float(
                self.lone_vehicle.forces(self._of(self._stated, "height"), self._of(self._stated, "velocity"))[i]
            )
        return float(self.lone_vehicle.heights()[what == "velocity"][i])

    def step(self, t: float, h: float, inputs: Mapping[str, float]) -> None:
        """Go on from t by h seconds, with the values of inputs at the end."""
        names = ("height", "velocity") if self.lone_vehicle.gives == "force" else ("force", "force")
        stated = {**self._stated, **inputs}
        first, last = ((self._of(given, names[0]), self._of(given, names[1])) for given in (self._stated, stated))
        self.lone_vehicle.step(h, first, last)
        self._stated = stated

    def get_state(self) -> Any:
        """All that changes."""
        return self.lone_vehicle.get_state(), dict(self._stated)

    def set_state(self, state: Any) -> None:
        """Go back to it."""
        self.lone_vehicle.set_state(state[0])
        self._stated = dict(state[1])


@dataclass
class Master:
    """Couples parts, in the order in which they are listed.

    Args:
        parts: by name; in the sequential scheme the first goes ahead.
        links: the exchanged values.
        start: (part, input): value at the beginning of what is linked.
        given: (part, input): what it is at an instant in s, known beforehand.
        scheme: sequential (Gauss-Seidel) or parallel (Jacobi).
        order: of the extrapolation, 0 to 2.
        iterations: how often each step is done; more than once needs parts that can go back.
    """

    parts: Mapping[str, Part]
    links: Sequence[Link]
    start: Mapping[tuple[str, str], float] = field(default_factory=dict)
    given: Mapping[tuple[str, str], Callable[[float], float]] = field(default_factory=dict)
    scheme: Scheme = "sequential"
    order: int = 0
    iterations: int = 1

    def run(self, h: float, steps: int) -> dict[tuple[str, str], Array]:
        """Go on from the beginning.

        Args:
            h: macro step, s.
            steps: how many.

        Returns:
            Values of all linked outputs at all macro steps, (steps + 1,), by part and output.
        """
        for name, part in self.parts.items():
            inputs = {i: value for (taker, i), value in self.start.items() if taker == name}
            part.begin(inputs | {i: at(0.0) for (taker, i), at in self.given.items() if taker == name})
        outputs = list(dict.fromkeys((link.giver, link.output) for link in self.links))
        past = {key: [self._look(key)] for key in outputs}
        for n in range(steps):
            self._step(n * h, h, past)
        return {key: np.array(values) for key, values in past.items()}

    def _look(self, key: tuple[str, str]) -> float:
        return self.parts[key[0]].look(key[1])

    def _step(self, t: float, h: float, past: dict[tuple[str, str], list[float]]) -> None:
        ends = {key: self._ahead(values) for key, values in past.items()}
        states = {name: part.get_state() for name, part in self.parts.items()} if self.iterations > 1 else {}
        for sweep in range(self.iterations):
            found = dict(ends)
            for name, part in self.parts.items():
                if sweep:
                    part.set_state(states[name])
                known = found if self.scheme == "sequential" else ends
                inputs = {
                    link.input: link.factor * known[link.giver, link.output]
                    for link in self.links
                    if link.taker == name
                }
                inputs |= {i: at(t + h) for (taker, i), at in self.given.items() if taker == name}
                part.step(t, h, inputs)
                found |= {key: self._look(key) for key in past if key[0] == name}
            ends = found
        for key, values in past.items():
            values.append(ends[key])
        for part in self.parts.values():
            if isinstance(part, FmuPart):
                part.forget()

    def _ahead(self, y: list[float]) -> float:
        """The next value."""
        order = min(self.order, len(y) - 1)
        if order == 0:
            return y[-1]
        return 2.0 * y[-1] - y[-2] if order == 1 else 3.0 * y[-1] - 3.0 * y[-2] + y[-3]
