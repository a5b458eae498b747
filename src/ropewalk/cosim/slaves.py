"""Slaves: what runs inside exported FMUs. Imported there, with the pythonfmu that travels in the FMU."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from pythonfmu import Boolean as Truth
from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Status

from ropewalk.cosim.outside import Outside, Stepwise
from ropewalk.cosim.stepwise import stepwise
from ropewalk.cosim.vehicle import Alone, LoneVehicle
from ropewalk.errors import RopewalkError
from ropewalk.scenario import load

ABOUT_FILE, SCENARIO_FILE, VEHICLE_FILE = "about.json", "scenario.yaml", "vehicle.json"
# Exponents of kg, m and s.
_UNITS = {"m": (0, 1, 0), "m/s": (0, 1, -1), "N": (1, 1, -2), "N/m": (1, 0, -2), "N.s/m": (1, 0, -1), "s": (0, 0, 1)}
_AT_END = (
    "true: inputs are values at the end of the step, linear from those given before; false: those at its beginning, "
    "forces are held and heights continue with their velocity"
)


class Measured(Real):  # type: ignore[misc]
    """A real variable with a unit."""

    def __init__(self, name: str, unit: str, **more: Any) -> None:
        super().__init__(name, **more)
        self.unit = unit

    def to_xml(self) -> Element:
        """The variable as XML."""
        node: Element = super().to_xml()
        if self.unit:
            node[0].set("unit", self.unit)
        return node


class ExportedSlave(Fmi2Slave):  # type: ignore[misc]
    """What line and vehicle have in common: variables with units, steps, states."""

    author = "ropewalk"

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        # The loader puts the folder of every instance in front of all places where Python looks for modules. (While the
        # FMU is written, pythonfmu does so, and takes it back itself.)
        if (Path(self.resources) / "slavemodule.txt").is_file():
            sys.path[:] = [place for place in sys.path if place != self.resources]
        self.inputs: dict[str, float] = {}  # inputs and parameters
        self.before: dict[str, float] = {}  # inputs at the beginning of the step
        self.time, self._ready = 0.0, False
        self.inputs_at_end = True
        self._add_truth("inputs_at_end", _AT_END)

    # -- Variables -----------------------------------------------------------------------------------------------

    def take(self, name: str, unit: str, start: float, description: str) -> None:
        """Declare an input."""
        self.before[name] = start
        self._keep(name, unit, start, description, Fmi2Causality.input, Fmi2Variability.continuous)

    def parameter(self, name: str, unit: str, start: float, description: str) -> None:
        """Declare a parameter that is fixed when the motion begins."""
        self._keep(name, unit, start, description, Fmi2Causality.parameter, Fmi2Variability.fixed)

    def give(self, name: str, unit: str, description: str, look: Callable[[], float]) -> None:
        """Declare an output."""

        def found() -> float:
            self._begin()
            return look()

        variable = Measured(
            name, unit, description=description, causality=Fmi2Causality.output,
            variability=Fmi2Variability.continuous, initial=Fmi2Initial.calculated, getter=found,
        )  # fmt: skip
        self.register_variable(variable, nested=False)

    def _keep(self, name: str, unit: str, start: float, description: str, causality: Any, variability: Any) -> None:
        self.inputs[name] = start

        def set_value(value: float) -> None:
            if causality == Fmi2Causality.parameter and value != self.inputs[name]:
                self._ready = False
            self.inputs[name] = value

        variable = Measured(
            name, unit, description=description, causality=causality, variability=variability,
            initial=Fmi2Initial.exact if causality == Fmi2Causality.parameter else None,
            getter=lambda: self.inputs[name], setter=set_value,
        )  # fmt: skip
        self.register_variable(variable, nested=False)

    def _add_truth(self, name: str, description: str) -> None:
        variable = Truth(
            name, description=description, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed,
            initial=Fmi2Initial.exact, getter=lambda: getattr(self, name),
            setter=lambda value: setattr(self, name, value),
        )  # fmt: skip
        self.register_variable(variable, nested=False)

    def to_xml(self, model_options: Any = None) -> Element:
        """The description of the model, with units and what is unknown at the beginning: pythonfmu leaves them out."""
        root: Element = super().to_xml(model_options or {})
        units = Element("UnitDefinitions")
        for unit in dict.fromkeys(v.unit for v in self.vars.values() if isinstance(v, Measured) and v.unit):
            powers = {name: str(p) for name, p in zip(("kg", "m", "s"), _UNITS[unit], strict=True) if p}
            SubElement(SubElement(units, "Unit", {"name": unit}), "BaseUnit", powers)
        root.insert(1, units)  # after CoSimulation
        structure = root.find("ModelStructure")
        outputs = structure.find("Outputs") if structure is not None else None
        if structure is not None and outputs is not None:
            unknowns = SubElement(structure, "InitialUnknowns")
            for unknown in outputs:
                SubElement(unknowns, "Unknown", dict(unknown.attrib))
        return root

    # -- Time ----------------------------------------------------------------------------------------------------

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """Note when it begins: the scenario's own time begins there, at zero."""
        self.time, self._ready = 0.0, False

    def exit_initialization_mode(self) -> None:
        """Begin with the values told so far."""
        self._ready = False
        self._begin()

    def _begin(self) -> None:
        if not self._ready:
            self._ready = True  # the model may ask again
            self.before = {name: self.inputs[name] for name in self.before}
            self.begin()

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Go on by a step; what goes wrong is logged, and the step refused."""
        self._begin()
        try:
            for name in self.before:
                if not np.isfinite(self.inputs[name]):
                    raise RopewalkError(f"input {name} is {self.inputs[name]}")
            if step_size > 0.0:
                self.move(step_size)
        except RopewalkError as error:
            self.log(f"t = {current_time:g} s: {error}", Fmi2Status.error)
            return False
        self.time += step_size
        self.before = {name: self.inputs[name] for name in self.before}
        return True

    def over(self, name: str, h: float, rate: str | None = None) -> tuple[float, float]:
        """An input at the beginning and at the end of a step."""
        if self.inputs_at_end:
            return self.before[name], self.inputs[name]
        return self.inputs[name], self.inputs[name] + (h * self.inputs[rate] if rate is not None else 0.0)

    def begin(self) -> None:
        """Make the motion ready."""
        raise NotImplementedError

    def move(self, h: float) -> None:
        """Go on by h seconds."""
        raise NotImplementedError

    def get_state(self) -> Any:
        """What of the motion changes."""
        raise NotImplementedError

    def set_state(self, state: Any) -> None:
        """Go back to it."""
        raise NotImplementedError

    def _get_fmu_state(self) -> dict[str, Any]:
        self._begin()
        return {"all": (self.get_state(), self.time, dict(self.inputs), dict(self.before), self.inputs_at_end)}

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        self._begin()
        inner, self.time, inputs, before, self.inputs_at_end = state["all"]
        self.inputs.update(inputs)
        self.before.update(before)
        self._ready = True
        self.set_state(inner)


class LineSlave(ExportedSlave):
    """Lines with their supports."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        self._folder = Path(self.resources)
        self._given = given = json.loads((self._folder / ABOUT_FILE).read_text(encoding="utf-8"))
        self.modelName, self.description = given["model"], given["description"]
        self.default_experiment = DefaultExperiment(0.0, given["until"], given["every"])
        self.parameter("step", "s", given["step"], given["step_means"])
        self._sprung = given["gives"] == "force"
        if self._sprung:
            self.parameter("contact_stiffness", "N/m", given["stiffness"], "of the spring between body and line")
            self.parameter("contact_damping", "N.s/m", given["damping"], "of the damper parallel to it")
        self.motion: Stepwise | None = None
        self._seen: dict[str, Any] = {}  # looked up since the last step
        self._supports: dict[str, Any] | None = None
        self._names = [f"contact{i + 1}" for i in range(len(given["places"]))]
        for name, place, height in zip(self._names, given["places"], given["heights"], strict=True):
            self._declare(name, place, height)
        for support in given["supports"]:
            label = "".join(sign if sign.isalnum() and sign.isascii() else "_" for sign in support)
            for axis, way in zip(given["axes"], ("x", "z") if len(given["axes"]) == 2 else "xyz", strict=True):
                what = f"force of the support {support} on its line along {way}"
                self.give(f"support_{label}.force_{axis}", "N", what, self._support(support, given["axes"].index(axis)))

    def _declare(self, name: str, place: float, height: float) -> None:
        given = self._given
        means = {"material": "unstrained distance from the start of the line", "horizontal": "horizontal position x"}
        self.take(f"{name}.place", "m", place, f"{means[given['measured']]}; off the line: no contact")
        if self._sprung:
            self.take(f"{name}.height", "m", height, "of the body's contact, upwards")
            self.take(f"{name}.velocity", "m/s", 0.0, "of the same, upwards; used where inputs_at_end is false")
            self.give(f"{name}.force", "N", "on the line, upwards", lambda: float(self._output(name).force[-1]))
            self.give(f"{name}.line_height", "m", "of the line", lambda: float(self._output(name).place[-1]))
            return
        self.take(f"{name}.force", "N", 0.0, "on the line, upwards")
        if given["along"]:
            self.take(f"{name}.force_along", "N", 0.0, "on the line, along x")
        self.give(f"{name}.height", "m", "of the line", lambda: float(self._output(name).place[-1]))
        what = "of the contact, upwards; it moves along the line"
        self.give(f"{name}.velocity", "m/s", what, lambda: float(self._output(name).velocity[-1]))
        self.give(f"{name}.slope", "", "dz/dx of the line", lambda: float(self._output(name).slope))

    def _output(self, name: str) -> Any:
        assert self.motion is not None
        if name not in self._seen:
            self._seen[name] = self.motion.output(name)
        return self._seen[name]

    def _support(self, support: str, axis: int) -> Callable[[], float]:
        def look() -> float:
            assert self.motion is not None
            if self._supports is None:
                self._supports = self.motion.support_forces()
            return float(self._supports[support][axis])

        return look

    def _forget(self) -> None:
        self._seen, self._supports = {}, None

    def begin(self) -> None:
        """Make the motion ready."""
        given, settings = self._given, []
        if self.inputs["step"] > 0.0:
            settings.append(f"run.step={self.inputs['step']!r} s")
        scenario = load(self._folder / SCENARIO_FILE, settings)
        stiffness, damping = (self.inputs.get(f"contact_{part}", 0.0) for part in ("stiffness", "damping"))
        outside = Outside(given["line"], stiffness, damping, given["side"])
        self.motion = stepwise(scenario, dict.fromkeys(self._names, outside), step=given["every"])
        for name in self._names:
            self._tell(name, 0.0)
        self._forget()

    def _xi(self, name: str, h: float) -> tuple[float, float]:
        assert self.motion is not None
        places = self.over(f"{name}.place", h) if h else (self.inputs[f"{name}.place"],) * 2
        if self._given["measured"] == "material":
            return places
        line = self._given["line"]
        first, last = self._given["span"]
        return tuple(  # type: ignore[return-value]
            self.motion.below(line, x) if first <= x <= last else (-1.0 if x < first else 1e30) for x in places
        )

    def _tell(self, name: str, h: float) -> None:
        """Tell the line what a contact does during a step of h seconds; of none, where it is."""
        assert self.motion is not None
        first, last = self._xi(name, h)
        speed = (last - first) / h if h and np.isfinite(last - first) and abs(last) < 1e30 and last >= 0.0 else 0.0
        if self._sprung:
            heights = self.over(f"{name}.height", h, f"{name}.velocity")
            rise = (heights[1] - heights[0]) / h if h else 0.0
            self.motion.set_motion(name, first, heights[0] if h else self.inputs[f"{name}.height"], rise, speed)
            return
        up = self.over(f"{name}.force", h)
        along = self.over(f"{name}.force_along", h) if self._given["along"] else (0.0, 0.0)
        rest = (0.0,) * (self.motion.dim - 2)
        begins, ends = ((along[i], *rest, up[i]) for i in (0, 1))
        self.motion.set_force(name, first, begins if h else ends, speed, last=ends)

    def move(self, h: float) -> None:
        """Go on by h seconds."""
        assert self.motion is not None
        for name in self._names:
            self._tell(name, h)
        self.motion.step(h)
        self._forget()

    def get_state(self) -> Any:
        """What of the motion changes."""
        assert self.motion is not None
        return self.motion.get_state()

    def set_state(self, state: Any) -> None:
        """Go back to it."""
        assert self.motion is not None
        self.motion.set_state(state)
        self._forget()


class VehicleSlave(ExportedSlave):
    """A vehicle without its line."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        given = json.loads((Path(self.resources) / ABOUT_FILE).read_text(encoding="utf-8"))
        self.modelName, self.description = given["model"], given["description"]
        self._alone = Alone.read((Path(self.resources) / VEHICLE_FILE).read_text(encoding="utf-8"))
        self.default_experiment = DefaultExperiment(0.0, self._alone.until, given["every"])
        self._gives = given["gives"]
        self.lone_vehicle = LoneVehicle(self._alone, self._gives)
        self._names = [touch.name for touch in self._alone.touches]
        for i, (touch, height) in enumerate(zip(self._alone.touches, given["heights"], strict=True)):
            self._declare(i, touch.name, height, touch.rest)

    def _declare(self, i: int, name: str, height: float, rest: float) -> None:
        if self._gives == "force":
            self.take(f"{name}.height", "m", height, "of the line at the contact, upwards")
            self.take(f"{name}.velocity", "m/s", 0.0, "of the same")
            self.give(f"{name}.force", "N", "on the line, upwards", lambda: float(self._forces()[i]))
        else:
            self.parameter(f"{name}.start_height", "m", height, "height of the contact at the beginning")
            self.parameter(f"{name}.start_velocity", "m/s", 0.0, "and its velocity")
            self.take(f"{name}.force", "N", rest, "on the line, upwards")
            self.give(
                f"{name}.height", "m", "of the contact, upwards", lambda: float(self.lone_vehicle.heights()[0][i])
            )
            self.give(f"{name}.velocity", "m/s", "of the same", lambda: float(self.lone_vehicle.heights()[1][i]))
        self.give(
            f"{name}.place", "m", "of the contact along the line, as in the scenario",
            lambda: float(self.lone_vehicle.forward(self.lone_vehicle.t)[i]),
        )  # fmt: skip

    def _inputs(self, what: str) -> np.ndarray[Any, Any]:
        return np.array([self.inputs[f"{name}.{what}"] for name in self._names])

    def _forces(self) -> np.ndarray[Any, Any]:
        return self.lone_vehicle.forces(self._inputs("height"), self._inputs("velocity"))

    def begin(self) -> None:
        """Make the motion ready."""
        self.lone_vehicle = LoneVehicle(self._alone, self._gives)
        first = "" if self._gives == "force" else "start_"
        self.lone_vehicle.place(self._inputs(f"{first}height"), self._inputs(f"{first}velocity"))

    def move(self, h: float) -> None:
        """Go on by h seconds."""
        if self._gives == "force":
            heights = np.array([self.over(f"{name}.height", h, f"{name}.velocity") for name in self._names]).T
            rises = np.array([self.over(f"{name}.velocity", h) for name in self._names]).T
            self.lone_vehicle.step(h, (heights[0], rises[0]), (heights[1], rises[1]))
            return
        forces = np.array([self.over(f"{name}.force", h) for name in self._names]).T
        self.lone_vehicle.step(h, (forces[0], forces[0]), (forces[1], forces[1]))

    def get_state(self) -> Any:
        """What of the motion changes."""
        return self.lone_vehicle.get_state()

    def set_state(self, state: Any) -> None:
        """Go back to it."""
        self.lone_vehicle.set_state(state)
