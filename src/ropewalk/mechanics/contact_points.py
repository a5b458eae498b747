"""Contact points: every place where a load touches its line, from the declarations of the loads."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.footfall import Footfall
from ropewalk.mechanics.sideways import Sideways
from ropewalk.model.axles import Axles
from ropewalk.model.carriage import Carriage
from ropewalk.model.fmu import Fmu
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.history import DriveTable, ForceTable, beginning
from ropewalk.model.load import AnyLoad, ExternalModel, MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.overlap import course_of
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.run import HIGH_ORDER
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.model.travel import FreeTravel, Measure, Travel
from ropewalk.model.trolley import Trolley
from ropewalk.model.vehicle import Vehicle
from ropewalk.model.walker import Walker
from ropewalk.permission import check_code

FEET = {"left": ("left", "right"), "right": ("right", "left")}
"""Names of the feet of a person, the first one first."""


@dataclass(frozen=True)
class ContactPoint:
    """A wheel, foot or contact of a load."""

    load: str  # name of its load
    part: str  # name within it, empty where it is the only one
    on: str
    measured: Measure
    start: float  # m from the start of the line, as measured; negative: before it
    speed: Any = 0.0  # m/s as measured, a history
    at_end: str = "leave"
    margin: float | None = None  # m
    force: Any = (0.0, 0.0)  # N, a history
    contact: str = "clamped"
    friction: float | None = None
    friction_model: str = "capstan"
    mass: float = 0.0  # kg, that follows the line up and down
    across: float = 0.0  # kg, more of it in the other directions: what the wheel pulls along
    air_drag: float = 0.0  # kg/m
    lift: int = 0  # 1: runs above and may leave the line, -1: below
    free: FreeTravel | None = None
    with_last: bool = False  # it bears the same body as the contact before it
    moved: bool = False  # that is moved level from outside as prescribed, its wheels roll
    ahead: float = 0.0  # m, of the middle of the load, where that counts
    ground: bool = True  # whether there is level ground beside its line
    given: bool = field(default=True)  # False for a force that is found while the motion goes on

    @property
    def name(self) -> str:
        """Name of the contact in results."""
        return f"{self.load}.{self.part}" if self.part else self.load


def wheels_of(scenario: Scenario) -> list[ContactPoint]:
    """All wheels of all loads, in order."""
    found = list[ContactPoint]()
    for name, load in scenario.loads.items():
        if isinstance(load, Pantograph):
            found += _strips(name, load, scenario)
        else:
            found += _wheels(name, load, scenario)
    return found


def _strips(name: str, load: Pantograph, scenario: Scenario) -> Iterator[ContactPoint]:
    """The strips of a pantograph below each contact wire that it comes to, its own first.

    Methods of a high order have them at particles: along x a wire moves by millimetres.
    """
    course = course_of(scenario.overhead_lines, load.on)
    smooth = getattr(scenario.run, "method", "") in HIGH_ORDER
    last = (list(course) if load.fastest >= 0.0 else list(course)[::-1])[-1]  # from others it goes over to the next
    for key in (load.on, *(other for other in course if other != load.on)):
        for strip, ahead in load.strips.items():
            part = ".".join(word for word in ("" if key == load.on else key, strip) if word)
            yield ContactPoint(
                name, part, key, "material" if smooth else load.travel.measured,
                load.travel.start - course[key] + ahead, speed=load.travel.speed,
                at_end=load.travel.at_end if key == last else "leave", lift=-1, ahead=ahead, ground=False,
            )  # fmt: skip


def _wheels(name: str, load: AnyLoad, scenario: Scenario) -> Iterator[ContactPoint]:
    places = load.starts()
    if isinstance(load, MovingForce):
        yield ContactPoint(
            name, "", load.on, places[0].measured, places[0].start, **_prescribed(load.travel), force=load.force,
            contact=load.contact, friction=load.friction, friction_model=load.friction_model,
        )  # fmt: skip
    elif isinstance(load, Axles):
        for place, (_, pressing) in zip(places, load.axles, strict=True):
            yield ContactPoint(
                name, place.label, load.on, place.measured, place.start, speed=load.travel.speed,
                force=(0.0, -pressing),
            )  # fmt: skip
    elif isinstance(load, MovingMass):
        yield ContactPoint(
            name, "", load.on, places[0].measured, places[0].start, **_travel(load.travel), force=load.force,
            contact=load.contact, mass=load.mass, air_drag=load.air_drag, lift=_lift(load),
        )  # fmt: skip
    elif isinstance(load, Trolley):
        alone, start = not load.also_on, places[0].start
        for line_of in load.lines:
            course = _travel(load.travel) if alone else _rolling(load.travel, len(load.lines))
            first = line_of == load.on
            yield ContactPoint(
                name, "" if alone else line_of, line_of, places[0].measured if alone else "material", start, **course,
                force=load.force if first else (0.0, 0.0), mass=load.mass if first else 0.0,
                air_drag=load.air_drag if first else 0.0, lift=_lift(load), with_last=not first,
                moved=not alone and isinstance(load.travel, Travel),
            )  # fmt: skip
    elif isinstance(load, Carriage):
        for i, place in enumerate(places):
            course = _travel(_of_wheel(load, drives=i == load.count // 2))
            if load.haul is not None and load.haul.speed is not None:
                course["speed"] = load.haul.speed
            yield ContactPoint(
                name, place.label, load.on, place.measured, place.start, **course, mass=load.of_wheel,
                lift=int(load.lift_off),
            )  # fmt: skip
    elif isinstance(load, Oscillator):
        soft = load.contact_stiffness is not None
        yield ContactPoint(
            name, "", load.on, places[0].measured, places[0].start, **_travel(load.travel),
            mass=0.0 if soft else load.wheel_mass, across=load.mass + load.wheel_mass if soft else 0.0,
            lift=0 if soft else _lift(load),
        )  # fmt: skip
    elif isinstance(load, Vehicle):
        across = shares(load)
        for place, (part, wheel) in zip(places, load.wheels.items(), strict=True):
            soft = wheel.contact_stiffness is not None
            yield ContactPoint(
                name, part if len(places) > 1 else "", load.on, place.measured, place.start,
                **_prescribed(load.travel), mass=0.0 if soft else wheel.mass,
                across=across[part] + (wheel.mass if soft else 0.0), lift=0 if soft else _lift(load),
            )  # fmt: skip
    elif isinstance(load, Matrices):
        for place, (part, axle), carried in zip(places, load.wheels.items(), condensed(load), strict=True):
            own = load.coordinates.index(axle.coordinate)
            yield ContactPoint(
                name, part if len(places) > 1 else "", load.on, place.measured, place.start,
                **_prescribed(load.travel), mass=load.mass[own][own], across=carried - load.mass[own][own],
                lift=_lift(load),
            )  # fmt: skip
    elif isinstance(load, Footsteps):
        side = Sideways.of(scenario, load, load.first_foot) if load.lateral else None
        start = places[0].start if load.at_end != "leave" or load.towards == "end" else 0.0  # may be beyond the end
        for number, foot in enumerate(FEET[load.first_foot]):
            force = Footfall(load, number, scenario.gravity, side)
            yield ContactPoint(name, foot, load.on, "material", start, force=force, given=False)
    elif isinstance(load, Walker):
        for foot in FEET[load.first_foot]:
            yield ContactPoint(name, foot, load.on, "material", places[0].start, mass=load.foot_mass, given=False)
    else:
        assert isinstance(load, Stepper | Fmu)
        count = contacts_of(name, load)
        parts = list(load.contacts) if isinstance(load, Fmu) else [str(number + 1) for number in range(count)]
        for number, part in enumerate(parts):
            start = places[number if isinstance(load, Fmu) else 0].start
            yield ContactPoint(
                name, part if count > 1 else "", load.on, "material", start, given=False,
                force=ForceTable(time=(0.0, load.every), value=((0.0, 0.0), (0.0, 0.0))),  # filled as it goes
            )  # fmt: skip


def contacts_of(name: str, load: ExternalModel) -> int:
    """How many contacts an external load may have: of a stepper its attribute `contacts`, an option of that name, or 1.

    Raises:
        RopewalkError: there is no such model.
    """
    if isinstance(load, Fmu):
        return len(load.contacts)
    model = named(name, load.model) if isinstance(load.model, str) else load.model
    return int(getattr(model, "contacts", load.options.get("contacts", 1)))


def named(name: str, place: str) -> Any:
    """What module:name or file.py:name stands for, for the load of a name.

    Raises:
        RopewalkError: there is no such thing, or external code is forbidden.
    """
    check_code(name, "model", place)
    home, _, attribute = place.rpartition(":")
    try:
        if not home.endswith(".py"):
            return getattr(importlib.import_module(home), attribute)
        spec = importlib.util.spec_from_file_location(Path(home).stem, home)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return getattr(module, attribute)
    except (Exception, SystemExit) as error:
        why = f"it ends the program, {error!r}" if isinstance(error, SystemExit) else error
        raise RopewalkError(f"load {name}: its model {place} cannot be found ({why})") from error


def _prescribed(travel: Travel) -> dict[str, Any]:
    return {"speed": travel.speed, "at_end": travel.at_end, "margin": travel.margin}


def _travel(travel: Travel | FreeTravel) -> dict[str, Any]:
    if isinstance(travel, Travel):
        return _prescribed(travel)
    return {
        "speed": travel.driver.speed if travel.driver is not None else travel.speed, "at_end": travel.at_end,
        "margin": travel.margin, "friction": travel.friction, "friction_model": travel.friction_model, "free": travel,
    }  # fmt: skip


def _rolling(travel: Travel | FreeTravel, n: int) -> dict[str, Any]:
    """How wheels roll along one of n lines that carry a load; they have no friction where the load is moved."""
    if isinstance(travel, FreeTravel):
        return _travel(travel.model_copy(update=_shared(travel, n)))
    speed = beginning(travel.speed)
    return _prescribed(travel) | {"free": FreeTravel(start=travel.start, speed=speed, at_end=travel.at_end)}


def _shared(travel: FreeTravel, n: int) -> dict[str, Any]:
    """The n-th part of what acts along a line."""
    drive: Any = travel.drive
    if isinstance(drive, DriveTable):
        shared: Any = drive.model_copy(update={"value": tuple(force / n for force in drive.value)})
    else:
        shared = (lambda t: drive(t) / n) if callable(drive) else drive / n
    found: dict[str, Any] = {"drive": shared, "viscous": travel.viscous / n}
    if (brake := travel.brake) is not None:
        all_of = {"force": brake.force, "rate": brake.rate, "stiffness": brake.stiffness}
        found["brake"] = brake.model_copy(update={key: own / n for key, own in all_of.items() if own is not None})
    return found


def _of_wheel(load: Carriage, *, drives: bool) -> FreeTravel:
    """The travel of one wheel of a carriage: its share of what acts along the line; a driver acts at one of them."""
    found = _shared(load.travel, load.count) | {"driver": load.travel.driver if drives else None}
    if load.haul is not None and load.haul.speed is not None:
        found["speed"] = beginning(load.haul.speed) * (1.0 if load.haul.to == "end" else -1.0)
    return load.travel.model_copy(update=found)


def _lift(load: MovingMass | Trolley | Oscillator | Vehicle | Matrices) -> int:
    return 0 if not load.lift_off else (1 if load.side == "above" else -1)


def shares(load: Vehicle) -> dict[str, float]:
    """Mass that each wheel of a vehicle pulls along: its bodies, shared as by levers about the outer springs."""
    names = list(load.wheels)
    if len(names) == 1:
        return {names[0]: sum(body.mass for body in load.bodies.values())}
    found = dict.fromkeys(names, 0.0)
    for body in load.bodies.values():  # to the two wheels on both sides of its centre
        ahead = [n for n in names if load.wheels[n].at >= body.at]
        behind = [n for n in names if load.wheels[n].at < body.at]
        front = min(ahead, key=lambda n: load.wheels[n].at) if ahead else max(names, key=lambda n: load.wheels[n].at)
        rear = max(behind, key=lambda n: load.wheels[n].at) if behind else min(names, key=lambda n: load.wheels[n].at)
        if front == rear or not ahead or not behind:
            found[front if ahead else rear] += body.mass
            continue
        a, b = load.wheels[rear].at, load.wheels[front].at
        part = (body.at - a) / (b - a)
        found[front] += part * body.mass
        found[rear] += (1.0 - part) * body.mass
    return found


def condensed(load: Matrices) -> list[float]:
    """Return the mass that each wheel of a vehicle given by matrices carries, its own included, kg.

    The masses are condensed to the wheels by the static displacements of the coordinates above them (R. J. Guyan,
    AIAA J. 3 (1965), 380), and act along the line as those of a `vehicle` do.
    """
    M, K = np.array(load.mass), np.array(load.stiffness)
    wheels = [load.coordinates.index(axle.coordinate) for axle in load.wheels.values()]
    above = [i for i in range(M.shape[0]) if i not in wheels]
    follow = np.zeros((M.shape[0], len(wheels)))
    follow[wheels, np.arange(len(wheels))] = 1.0
    follow[above] = -np.linalg.lstsq(K[np.ix_(above, above)], K[np.ix_(above, wheels)], rcond=None)[0]
    found: list[float] = (follow.T @ M @ follow.sum(axis=1)).tolist()
    return found
