"""Loads as constants: every wheel as its static force, or as a rigid mass with the weight that it bears."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ropewalk.compare.trace import Trace
from ropewalk.decouple import standing_force, steps
from ropewalk.errors import RopewalkError
from ropewalk.mechanics.contact_points import ContactPoint, wheels_of
from ropewalk.mechanics.loading import loading_of
from ropewalk.model.axles import Axles
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.load import AnyLoad, GivenForces, MovingForce, Travelling
from ropewalk.model.mass import MovingMass
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.scenario import Scenario
from ropewalk.model.travel import FreeTravel, Travel
from ropewalk.model.walker import Walker
from ropewalk.solve.start import setting_of
from ropewalk.solve.vehicle_statics import resting_forces

SEGMENTS = 400  # of constant speed, at most, with which a free travel is followed
STANDARD_GRAVITY = 9.80665  # m/s^2, where a scenario has none and gives weights: what makes masses of them

Wheels = dict[str, tuple[str, ...]]


def without_refusal(load: AnyLoad) -> AnyLoad:
    """The same load, leaving its line where it was to be refused there: another model may take it there earlier."""
    travel = getattr(load, "travel", None)
    if isinstance(travel, Travel) and travel.at_end == "refuse":
        return load.model_copy(update={"travel": travel.model_copy(update={"at_end": "leave"})})
    return load


def wheels_in(scenario: Scenario, contacts: list[str]) -> Wheels:
    """Contacts of a result that belong together: each by itself, but for feet and models, which take turns."""
    found: Wheels = {}
    for name, load in scenario.loads.items():
        own = [contact for contact in contacts if contact == name or contact.startswith(f"{name}.")]
        if isinstance(load, Travelling | Pantograph):
            found |= {contact: (contact,) for contact in own}
        else:
            found[name] = tuple(own)
    return found


def contacts_in(found: Mapping[str, Trace]) -> Wheels:
    """Every wheel standing for itself."""
    return {wheel: (wheel,) for wheel in found}


@dataclass(frozen=True)
class ConstantForces:
    """The loads of a scenario without what moves in them.

    Whose travel is prescribed keeps it. Whose is not goes as it does in full: what slides freely by a table of its
    places, who walks with the same mean speed; a constant force would not know how.

    Args:
        scenario: the full one.
        found: what its wheels do.
        segments: of constant speed, at most, with which a free travel is followed.
    """

    scenario: Scenario
    found: Mapping[str, Trace]
    segments: int = SEGMENTS

    def forces(self) -> tuple[dict[str, GivenForces], Wheels]:
        """The static force of each wheel, and which contact stands for it.

        Raises:
            RopewalkError: a load cannot be replaced.
        """
        loads: dict[str, GivenForces] = {}
        wheels: Wheels = {}
        for name, load in self.scenario.loads.items():
            if isinstance(load, Axles):
                loads[name] = load
                wheels |= {label: (label,) for label, _ in self._wheels(name, load)}
                continue
            if isinstance(load, MovingForce):
                kept = without_refusal(load)
                assert isinstance(kept, MovingForce)
                loads[name], wheels[name] = kept, (name,)
                continue
            for label, wheel in self._wheels(name, load):
                force, own = self._static(name, load, label), self._name(label)
                if wheel is not None and isinstance(load, Travelling) and isinstance(load.travel, Travel):
                    self._refuse_to_wait(wheel)
                    loaded = without_refusal(standing_force(load, wheel, force))
                    assert isinstance(loaded, MovingForce)
                    loads[own] = loaded
                else:
                    loads[own] = MovingForce(on=load.on, force=force, travel=self._travel(load, label))
                wheels[label] = (own,)
        return loads, wheels

    def masses(self) -> tuple[dict[str, AnyLoad], Wheels]:
        """A rigid mass of the static force of each wheel, and which contact stands for it.

        Raises:
            RopewalkError: a load cannot be replaced.
        """
        loads: dict[str, AnyLoad] = {}
        wheels: Wheels = {}
        for name, load in self.scenario.loads.items():
            if isinstance(load, MovingForce | MovingMass):
                loads[name], wheels[name] = load, (name,)
                continue
            if isinstance(load, Axles):
                raise RopewalkError(f"load {name}: a train of forces does not define the bodies above its axles")
            for label, wheel in self._wheels(name, load):
                own, g = self._name(label), self.scenario.gravity
                weight = -self._static(name, load, label)[-1]
                if not weight > 0.0:
                    raise RopewalkError(f"load {label} carries no weight that a rigid mass could replace")
                travel: Any = load.travel if isinstance(load, Travelling) else self._travel(load, label)
                if wheel is not None and isinstance(travel, Travel):
                    travel = travel.model_copy(update={"start": wheel.start})
                more: dict[str, Any] = {} if g else {"force": (0.0, -weight)}
                for key in ("lift_off", "side"):
                    if hasattr(load, key):
                        more[key] = getattr(load, key)
                if getattr(load, "force", None) is not None:
                    more["force"] = load.force  # type: ignore[union-attr]
                mass = MovingMass(on=load.on, mass=weight / (g or STANDARD_GRAVITY), travel=travel, **more)
                loads[own], wheels[label] = without_refusal(mass), (own,)
        return loads, wheels

    def _wheels(self, name: str, load: AnyLoad) -> list[tuple[str, ContactPoint | None]]:
        """Label and place of each wheel of a load."""
        if isinstance(load, Pantograph):
            raise RopewalkError(
                f"load {name}: a pantograph is pressed against its wire from below and has no weight that a force or "
                "mass could replace"
            )
        if getattr(load, "also_on", ()):
            raise RopewalkError(
                f"load {name}: the distribution of its weight to its lines depends on their deflections"
            )
        if isinstance(load, Travelling):
            return [(wheel.name, wheel) for wheel in wheels_of(self.scenario) if wheel.load == name]
        return [(name, None)]

    def _name(self, label: str) -> str:
        own = label.replace(".", "-")
        return own if own == label or own not in self.scenario.loads else f"{own}_2"

    def _static(self, name: str, load: AnyLoad, label: str) -> tuple[float, ...]:
        """Force of a wheel at rest on level ground, N; of a model that does not say, what it has pressed with."""
        if isinstance(load, Walker | Footsteps):
            return 0.0, -load.mass * self.scenario.gravity
        if isinstance(load, Travelling):
            return self._at_rest()[label]
        trace = self.found[name]
        on = np.isfinite(trace.xi)
        if not on.any():
            raise RopewalkError(f"load {name} never touches its line")
        return tuple(trace.force[on].mean(axis=0).tolist())

    def _at_rest(self) -> dict[str, tuple[float, ...]]:
        scenario = self.scenario
        is_chain = not (scenario.has_bending_stiffness or scenario.is_network)
        loading = setting_of(scenario, 0.0).loading if is_chain else loading_of(scenario, 0.0)
        forces = resting_forces(loading)
        return {wheel.name: tuple(forces[:, k].tolist()) for k, wheel in enumerate(loading.wheels)}

    def _refuse_to_wait(self, wheel: ContactPoint) -> None:
        if wheel.start < 0.0 and not isinstance(wheel.speed, int | float):
            raise RopewalkError(
                f"load {wheel.name} starts before its line with a speed that varies, which compare does not support; "
                "let it start on the line"
            )

    def _travel(self, load: AnyLoad, label: str) -> Travel:
        """How a load whose travel is not prescribed went in full.

        Raises:
            RopewalkError: it was never on its line.
        """
        trace = self.found[label]
        on = np.flatnonzero(np.isfinite(trace.xi))
        if on.size < 2:
            raise RopewalkError(f"load {label} is never on its line")
        first, last = on[0], on[-1]
        path = getattr(load, "path", None) or getattr(getattr(load, "travel", None), "path", None)  # on a net
        if isinstance(load, Travelling) and isinstance(load.travel, FreeTravel):
            kept = np.unique(np.linspace(first, last, min(self.segments + 1, on.size)).astype(int))
            kept = kept[np.isfinite(trace.xi[kept])]
            xi, time = trace.xi[kept], trace.time[kept]
            table: Any = steps(time, np.diff(xi) / np.diff(time))
            return Travel(speed=table, start=max(float(xi[0]), 0.0), at_end="leave", path=path)
        speed = float((trace.xi[last] - trace.xi[first]) / (trace.time[last] - trace.time[first]))
        start = max(float(trace.xi[first] - speed * trace.time[first]), 0.0)
        return Travel(speed=speed, start=start, at_end="leave", path=path)
