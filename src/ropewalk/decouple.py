"""The feedback cut: may what travels be replaced by the force that it exerts on rigid ground?

Ground is a line as well: straight along the chord, and so taut that its load hardly moves it. The load runs on it by
the very kernels of the coupled run, so that walkers, drivers, brakes and steppers do there what they do here, and
nothing but the motion of the line makes a difference. Where it is known that a load on ground stands still within
itself, its static forces are taken and no run is needed.
"""

from __future__ import annotations

import copy
import math
import tempfile
from dataclasses import dataclass
from itertools import count, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.capabilities import SYSTEM, WIRES, check_without_feedback, engine_of
from ropewalk.errors import Problem, RopewalkError, ScenarioError
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.contact_points import ContactPoint, wheels_of
from ropewalk.model.crowd import Crowd
from ropewalk.model.fmu import Fmu
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.history import ForceTable, SpeedTable
from ropewalk.model.line import Line, spatial
from ropewalk.model.load import AnyLoad, ExternalModel, GivenForces, MovingForce, Travelling
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.profile import Profile
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Start, every_of
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.model.travel import FreeTravel, Travel
from ropewalk.model.trolley import Trolley
from ropewalk.model.vehicle import Vehicle
from ropewalk.model.walker import Walker
from ropewalk.results.contract import doubts_of
from ropewalk.rigid_overhead_lines import forces_of_pantograph
from ropewalk.simulate import simulate
from ropewalk.solve.start import setting_of
from ropewalk.solve.vehicle_statics import resting_forces
from ropewalk.system.elements.profile import rows_of

if TYPE_CHECKING:
    import xarray as xr

TAUT = 5e4  # tension of ground over the weight on it: it yields by 5e-6 of its length
TAUTER = 3e7  # the same of ground with a profile, whose heights are of millimetres
STRETCH = 0.5  # strain of ground: its longitudinal waves, which set the step, are not much faster than the others
LINKS = 20  # of ground: many would cost steps, and a straight line needs none; but every wheel wants its own
# Mass of a link of ground over that of the load, at most and at least, and over that of a wheel. Half a link hangs on
# the contact: the force is wrong by half the first. As light as that, ground takes up what a wheel does when it is put
# down: waves run away from it, and drag and damping do away with them before they come back.
LIGHT, LIGHTEST, LIGHT_FOR_WHEEL = 0.01, 0.002, 0.5
DAMPED = 0.05  # of the fastest waves along it, over their critical damping
SAMPLES = 2000  # of a force history, at least
SOMEBODY = 100.0  # kg, of a model that does not say
HOP = 100.0  # m/s, a contact that moves faster has been put elsewhere


def without_feedback(scenario: Scenario) -> Scenario:
    """Replace every load that has a mass by the forces that it exerts on rigid ground, travelling as it does.

    A load of one contact keeps its name; others become one force for each wheel, or for each place where a foot
    stands, with names such as `bogie-front` and `walker-left-3`. Forces and footsteps stay as they are.

    Args:
        scenario: with a run in time; one that knows forces only is given back.

    Raises:
        ScenarioError: the run continues from a stored result, in which the loads are others.
        RopewalkError: a load does not come through its run on ground.
    """
    return cut(scenario)[0]


def cut(scenario: Scenario) -> tuple[Scenario, dict[str, tuple[str, ...]]]:
    """Do as `without_feedback`, and tell the names of the forces that replace each wheel."""
    run = scenario.run
    if not isinstance(run, Dynamic | Linear):
        return scenario, {}
    check_without_feedback(scenario)
    if isinstance(run, Dynamic) and run.start.kind == "result":
        wrong, remedy = "a stored result has other loads than a run without feedback", "start from rest"
        raise ScenarioError([Problem("run.start.kind", wrong, "result", remedy)])
    heavy = {name: load for name, load in scenario.loads.items() if not is_force(load)}
    if not heavy:
        return scenario, {}
    taken, names = set(scenario.loads), dict[str, tuple[str, ...]]()
    resting = [name for name, load in heavy.items() if presses_evenly(scenario, load)]
    static = _static_forces(scenario, resting)
    moving = [name for name in heavy if name not in resting]
    grounds = {name: _Ground.run(scenario, name) for name in moving if not isinstance(heavy[name], Pantograph)}
    made: dict[str, dict[str, AnyLoad]] = {name: {} for name in heavy}
    for name, load in heavy.items():
        if isinstance(load, Pantograph):
            for contact, force in forces_of_pantograph(scenario, name).items():
                own = _names(name, contact.removeprefix(name).replace(".", "-").removeprefix("-"), 1, taken)
                made[name][own[0]], names[contact] = force, tuple(own)
    rolling = {name: load for name, load in scenario.loads.items() if not isinstance(load, Pantograph)}
    for wheel in wheels_of(scenario.model_copy(update={"loads": rolling})):
        if wheel.load not in heavy:
            continue
        load = heavy[wheel.load]
        if wheel.load not in moving:
            forces = [standing_force(load, wheel, static[wheel.name])]
        else:
            forces = grounds[wheel.load].forces(load, wheel)
        own = _names(wheel.load, wheel.part, len(forces), taken)
        made[wheel.load].update(zip(own, forces, strict=True))
        names[wheel.name] = tuple(own)
    given = {name: made.get(name, {name: load}) for name, load in scenario.loads.items()}
    loads = {name: load for own in given.values() for name, load in own.items()}
    title = f"{scenario.title}, without feedback"
    kept = {key: getattr(scenario, key) for key in Scenario.model_fields}
    return Scenario(**{**kept, "title": title, "loads": loads}), names


def is_force(load: AnyLoad) -> bool:
    """Whether a load is nothing but given forces."""
    return isinstance(load, GivenForces) or (isinstance(load, Footsteps) and load.balance is None)


def presses_evenly(scenario: Scenario, load: AnyLoad) -> bool:
    """Whether the force of a load on ground, with the profile of its line, does not change."""
    line = scenario.lines.get(load.on)
    return rests_within_itself(load) and (line is None or line.profile is None)


def rests_within_itself(load: AnyLoad) -> bool:
    """Whether a load on ground moves along evenly, and nothing in it moves against the rest."""
    if not isinstance(load, MovingMass | Oscillator | Vehicle | Matrices):
        return False
    travel = load.travel
    if isinstance(travel, FreeTravel) or not isinstance(travel.speed, float | int):
        return False
    return not (getattr(load, "air_drag", 0.0) or (load.lift_off and load.side == "below"))


def _names(load: str, part: str, forces: int, taken: set[str]) -> list[str]:
    """Names of the forces that replace a part of a load: that of the load where there is only one."""
    if not part and forces == 1:
        return [load]
    stem = f"{load}-{part}" if part else load
    own = []
    for number in range(1, forces + 1):
        name = stem if forces == 1 else f"{stem}-{number}"
        if name in taken:
            name = next(other for n in count(2) if (other := f"{name}_{n}") not in taken)
        taken.add(name)
        own.append(name)
    return own


def _static_forces(scenario: Scenario, names: list[str]) -> dict[str, tuple[float, ...]]:
    """Forces [Fx, Fz] or [Fx, Fy, Fz] in N of loads at rest, by wheel."""
    if not names:
        return {}
    engine = engine_of(scenario)
    if engine in (SYSTEM, WIRES):
        grounds = {name: _ground_of(scenario, name, 0.0) for name in names}
        lines, loads = ({name: pair[i] for name, pair in grounds.items()} for i in (0, 1))
        scenario = Scenario(gravity=scenario.gravity, lines=lines, loads=loads, run=Equilibrium())
    setting = setting_of(scenario, 0.0)
    forces = resting_forces(setting.loading)
    if engine is WIRES:  # whose contacts press vertically; the rest is rounding
        forces[:-1] = 0.0
    return {wheel.name: tuple(forces[:, k].tolist()) for k, wheel in enumerate(setting.wheels) if wheel.load in names}


def standing_force(load: AnyLoad, wheel: ContactPoint, force: tuple[float, ...]) -> MovingForce:
    """The force of a wheel that presses evenly, with what else is given; before the line, it waits for its turn."""
    assert isinstance(load, Travelling)
    assert isinstance(load.travel, Travel)
    total: Any = _sum(load.force, force) if isinstance(load, MovingMass) else force
    travel, start = load.travel, wheel.start
    history: Any = travel.speed
    if start < 0.0:
        speed = float(history)
        arrival = -start / speed if speed > 0.0 else math.inf
        none = tuple(0.0 for _ in force)
        if math.isinf(arrival):
            total, history = none, 0.0
        else:
            total = ForceTable(time=(0.0, arrival, arrival), value=(none, none, force))
            history = SpeedTable(time=(0.0, arrival, arrival), value=(0.0, 0.0, speed))
        start = -1e-9 * start  # on the support, and yet not at the same place as others that wait
    moved = travel.model_copy(update={"speed": history, "start": start, "margin": None})
    contact = load.contact if isinstance(load, MovingMass) else "clamped"
    return MovingForce(on=load.on, force=total, travel=moved, contact=contact)


def _sum(given: Any, force: tuple[float, ...]) -> Any:
    """A history of forces plus a constant one, N."""

    def added(value: tuple[float, ...]) -> tuple[float, ...]:
        value = value if len(value) == len(force) else ((value[0], 0.0, value[1]) if len(force) == 3 else value)
        return tuple(a + b for a, b in zip(value, force, strict=True))

    if callable(given):
        return lambda t: added(tuple(given(t)))
    if isinstance(given, ForceTable):
        return ForceTable(time=given.time, value=tuple(added(value) for value in given.value))
    return added(given)


@dataclass(frozen=True)
class _Ground:
    """The run of a load on rigid ground."""

    result: xr.Dataset
    contacts: tuple[str, ...]  # names of the wheels, in order of the result
    scale: float  # m of ground for each m of its material coordinate
    upright: bool  # whether the line feels vertical forces only

    @classmethod
    def run(cls, scenario: Scenario, name: str) -> _Ground:
        """Run the load of that name, for as long as the scenario does.

        Raises:
            RopewalkError: it does not come to the end of the run.
        """
        run, load = scenario.run, scenario.loads[name]
        assert isinstance(run, Dynamic)
        ground, load = _ground_of(scenario, name, run.until)
        with tempfile.TemporaryDirectory() as folder:
            ground = _with_profile(scenario, name, ground, load, Path(folder) / "profile.csv")
            return cls._run(scenario, name, ground, load)

    @classmethod
    def _run(cls, scenario: Scenario, name: str, ground: Line, load: AnyLoad) -> _Ground:
        run = scenario.run
        assert isinstance(run, Dynamic)
        every = min(every_of(run), run.until / SAMPLES)
        falls = isinstance(load, Trolley) and load.payload.at is not None
        start = Start(with_loads=not (falls or isinstance(load, ExternalModel | Footsteps)))
        dynamic = Dynamic(until=run.until, every=every, accuracy=run.accuracy, start=start)
        alone = Scenario(gravity=scenario.gravity, lines={name: ground}, loads={name: load}, run=dynamic)
        result = simulate(alone)
        if result.attrs["outcome"] != "completed":
            text = f"{result.attrs['outcome']}: {'; '.join(doubts_of(result)) or result.attrs['advice']}"
            raise RopewalkError(f"the run of {name} on rigid ground stopped early ({text})")
        scale = ground.distance / float(result["xi"].values.max())
        upright = engine_of(scenario) is WIRES
        return cls(result, tuple(wheel.name for wheel in wheels_of(alone)), scale, upright)

    def forces(self, load: AnyLoad, wheel: ContactPoint) -> list[MovingForce]:
        """The forces that replace a wheel: one, or for a contact that is put down here and there one for each place."""
        k = self.contacts.index(wheel.name)
        time = self.result["time"].values
        force = np.nan_to_num(self.result["contact_force"].values[:, k])
        if self.upright:
            force[:, :-1] = 0.0
        place = self.result["contact_xi"].values[:, k] * self.scale
        if not isinstance(load, Travelling):
            return _put_down(load, time, place, force)
        speed, table = self.result["contact_speed"].values[:, k], _force_table(time, force)
        if isinstance(load.travel, Travel):
            contact = load.contact if isinstance(load, MovingMass) else "clamped"
            if contact != "clamped":  # the hold force is found anew
                table = _force_table(time, force - np.nan_to_num(self.result["hold_force"].values[:, k]))
            travel = load.travel.model_copy(update={"start": wheel.start, "margin": None})
            return [MovingForce(on=load.on, force=table, travel=travel, contact=contact)]
        assert not isinstance(load, GivenForces)
        gone = np.flatnonzero(~np.isfinite(speed))
        if gone.size:  # it keeps its last speed, and so leaves the line, too
            speed[gone] = speed[gone[0] - 1] if gone[0] else 0.0
        at_end = "leave" if load.travel.at_end == "refuse" else load.travel.at_end
        travel = Travel(
            speed=SpeedTable(time=tuple(time.tolist()), value=tuple(speed.tolist())),
            start=load.travel.start, at_end=at_end,
        )  # fmt: skip
        return [MovingForce(on=load.on, force=table, travel=travel)]


def _ground_of(scenario: Scenario, name: str, until: float) -> tuple[Line, AnyLoad]:
    """The ground for the load of that name, as long as its line, and the load on it."""
    load = scenario.loads[name]
    line = scenario.lines.get(load.on)
    if line is None:  # a net: straight ahead, whichever way leads over it
        length = 1.0
        line = Line(start=(0.0, 0.0), end=(length, 0.0), length=length, mass=1.0, axial_stiffness=1.0)
    elif engine_of(scenario) in (SYSTEM, WIRES):
        length = line.length or line.distance
    else:
        setting = setting_of(scenario, 0.0)
        s = setting.lines.index(load.on)
        length = float(setting.strands.h[s] * setting.strands.links[s])
    return _on_ground(name, load, line, length, until, scenario.gravity)


def _with_profile(scenario: Scenario, name: str, ground: Line, load: AnyLoad, file: Path) -> Line:
    """Ground with the profile of the line of a load, written to a file, which goes along with it as it is stretched."""
    own, run = scenario.loads[name], scenario.run
    line = scenario.lines.get(own.on)
    if line is None or line.profile is None:
        return ground
    assert isinstance(run, Dynamic)
    s, z = rows_of(scenario, own.on, line.length or line.distance, run.until)
    if isinstance(own, Travelling) and isinstance(own.travel, Travel):  # it begins in the middle of its ground
        assert isinstance(load, Travelling)
        level = abs(ground.end[0] - ground.start[0]) / ground.distance if own.travel.measured == "horizontal" else 1.0
        s = s + (load.travel.start - own.travel.start) / max(level, 1e-9)
    np.savetxt(file, np.stack([s / (1.0 + STRETCH), z], axis=1), delimiter=",", fmt="%.17g")
    return ground.model_copy(update={"profile": Profile(file=str(file))})


def _on_ground(
    name: str, load: AnyLoad, line: Line, length: float, until: float, gravity: float
) -> tuple[Line, AnyLoad]:
    """A piece of ground, and the load on it.

    As long as the line (m, unstrained) for what knows its end; where the travel is prescribed, so long that no end is
    near.
    """
    own: dict[str, Any] = {"on": name}
    links, along = LINKS, np.subtract(spatial(line.end), spatial(line.start))
    along = along / line.distance if line.distance > 0.0 else np.array([1.0, 0.0, 0.0])
    if isinstance(load, Travelling) and isinstance(load.travel, Travel):
        places = sorted(place.start - load.travel.start for place in load.starts())
        extent = max(abs(places[0]), abs(places[-1]))
        length = 4.0 * (1.0 + extent + _fastest(load.travel.speed, until) * until)
        links = max([LINKS, *(math.ceil(3.0 * length / (b - a)) for a, b in pairwise(places))])
        level = load.travel.measured == "horizontal"
        start = 0.5 * length * (abs(float(along[0])) if level else 1.0)
        measured = "horizontal" if level else "slip"
        own["travel"] = load.travel.model_copy(
            update={"start": start, "measured": measured, "margin": None, "path": None}
        )
    elif isinstance(load, Travelling):
        travel = load.travel
        assert isinstance(travel, FreeTravel)
        margin = 0.25 * length / line.elements if travel.margin is None else travel.margin
        changes: dict[str, Any] = {"start": travel.start / (1.0 + STRETCH), "margin": margin / (1.0 + STRETCH)}
        if travel.brake is not None:
            within = travel.brake.within / (1.0 + STRETCH)
            changes["brake"] = travel.brake.model_copy(update={"within": within})
        changes["at_end"] = "leave" if travel.at_end == "refuse" else travel.at_end
        own["travel"] = travel.model_copy(update=changes)
    else:
        assert not isinstance(load, Pantograph | Crowd)
        links = max(LINKS, line.elements)
        if isinstance(load, Fmu):  # along x, ground may be stretched as it likes
            start = load.travel.start * (1.0 if load.travel.measured == "horizontal" else abs(float(along[0])))
            own["travel"] = load.travel.model_copy(update={"start": start, "measured": "horizontal"})
        else:
            own["start"] = load.start / (1.0 + STRETCH)
        if isinstance(load, Stepper):
            own["model"] = copy.deepcopy(load.model)  # what it remembers of one run is not for the other
    whole, wheel = _masses(load)
    tension = (TAUT if line.profile is None else TAUTER) * whole * max(gravity, 1.0)
    h = length / (1.0 + STRETCH) / links
    mass = whole * max(min(LIGHT, LIGHT_FOR_WHEEL * wheel / whole), LIGHTEST) / h
    stiffness, drag = tension / STRETCH, 4.0 * math.sqrt(tension / mass) / length
    end = np.add(spatial(line.start), length * along)
    ground = Line(
        start=spatial(line.start), end=tuple(end.tolist()), tension=tension, mass=mass,
        axial_stiffness=stiffness, axial_damping=DAMPED * h * math.sqrt(stiffness * mass), drag=drag, elements=links,
    )  # fmt: skip
    return ground, load.model_copy(update=own)


def _fastest(speed: Any, until: float) -> float:
    if callable(speed):
        return 1.1 * max(abs(float(speed(t))) for t in np.linspace(0.0, until, 1001).tolist())
    return max(abs(float(value)) for value in (speed.value if isinstance(speed, SpeedTable) else (speed,)))


def _masses(load: AnyLoad) -> tuple[float, float]:
    """About the mass of a load, and that of its lightest wheel, kg."""
    if isinstance(load, Trolley):
        return load.mass + load.payload.mass, load.mass
    if isinstance(load, Oscillator):
        return load.mass + load.wheel_mass, load.wheel_mass
    if isinstance(load, Vehicle):
        wheels = [wheel.mass for wheel in load.wheels.values()]
        return sum(wheels) + sum(body.mass for body in load.bodies.values()), min(wheels)
    if isinstance(load, Matrices):
        diagonal = np.diag(np.array(load.mass))
        return float(diagonal.sum()), min(
            float(diagonal[load.coordinates.index(wheel.coordinate)]) for wheel in load.wheels.values()
        )
    if isinstance(load, Walker):
        return load.mass, load.foot_mass
    if isinstance(load, Footsteps):
        return load.mass, 0.0
    return (load.mass, load.mass) if isinstance(load, MovingMass) else (SOMEBODY, 0.0)


def _force_table(time: Array, force: Array) -> Any:
    """A history of forces (time, axis) in N; a constant one as such."""
    if np.ptp(force, axis=0).max() <= 1e-6 * np.abs(force).max(initial=0.0):  # the rest of rounding errors of ground
        return tuple(force.mean(axis=0).tolist())
    return ForceTable(time=tuple(time.tolist()), value=tuple(map(tuple, force.tolist())))


def _put_down(load: AnyLoad, time: Array, place: Array, force: Array) -> list[MovingForce]:
    """One force for each stretch of time in which a contact stays on the line and is not put elsewhere.

    Args:
        load: a person or an external model.
        time: (time,) s.
        place: (time,) m, NaN while it is off the line.
        force: (time, axis) N.
    """
    assert isinstance(load, Walker | Footsteps | ExternalModel)
    at_end = load.travel.at_end if isinstance(load, Fmu) else load.at_end
    on = np.isfinite(place)
    breaks = np.flatnonzero(np.abs(np.diff(np.where(on, place, 0.0))) > HOP * np.diff(time)) + 1
    breaks = np.union1d(breaks, np.flatnonzero(np.diff(on)) + 1)
    found = []
    for first, last in pairwise([0, *breaks.tolist(), time.size]):
        if not on[first] or not force[first:last].any():
            continue
        own, t = np.zeros_like(force), time[first:last]
        own[first:last] = force[first:last]
        near = slice(max(first - 1, 0), min(last + 1, time.size))
        speeds = np.diff(place[first:last]) / np.diff(t)
        travel = Travel(speed=steps(t, speeds), start=max(float(place[first]), 0.0), at_end=at_end)
        found.append(MovingForce(on=load.on, force=_force_table(time[near], own[near]), travel=travel))
    return found


def steps(time: Array, speeds: Array) -> Any:
    """A speed that is constant between instants (one more than speeds), and zero before and after."""
    if not speeds.any():
        return 0.0
    knots = [(time[0], 0.0), *((t, v) for a, b, v in zip(time, time[1:], speeds, strict=False) for t in (a, b))]
    return SpeedTable(time=(*(float(t) for t, _ in knots), float(time[-1])), value=(*(float(v) for _, v in knots), 0.0))
