"""Simpler models: the same scenario with less and less in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.compare.constant import ConstantForces, contacts_in, without_refusal
from ropewalk.compare.pressing import pressing_task
from ropewalk.decouple import cut, is_force, presses_evenly
from ropewalk.errors import Problem, RopewalkError, ScenarioError
from ropewalk.model.crowd import Crowd
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.history import SpeedTable
from ropewalk.model.load import GivenForces
from ropewalk.model.mass import MovingMass
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Quasistatic, every_of
from ropewalk.model.scenario import Scenario
from ropewalk.model.train import Train
from ropewalk.model.travel import Course, Travel
from ropewalk.solve.load_schedule import horizon
from ropewalk.solve.quasistatic import walk
from ropewalk.solve.start import setting_of

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.compare.trace import Trace
    from ropewalk.wires.task import WireTask

LINEAR, QUASISTATIC, FORCE, MASS, FULL, CUT = (
    "linear", "quasi-static", "moving force", "moving mass", "full", "feedback cut",
)  # fmt: skip
MODELS = (LINEAR, QUASISTATIC, FORCE, MASS, FULL, CUT)
"""From the bottom to the top, and the top with its feedback cut."""
SIMPLEST_FIRST = (LINEAR, QUASISTATIC, FORCE, CUT, MASS, FULL)
FRAMES = 200  # of a run, at least: what is between two of them is compared by straight lines
POSITIONS = 201  # of a quasi-static motion
FEW_SEGMENTS = 24  # of constant speed, of a free travel in the linear theory: it looks for waves from every one of them


@dataclass(frozen=True)
class SimplerModel:
    """What is run for a model, or why nothing is."""

    name: str
    scenario: Scenario | None = None
    task: WireTask | None = None  # on wires, where no scenario can say it; with the run of the scenario
    wheels: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # contacts that stand for each wheel
    same_as: str = ""  # the model that it coincides with
    remark: str = ""
    reason: str = ""  # why it cannot be had


def top_of(scenario: Scenario) -> SimplerModel:
    """The full model: the scenario itself, in time and with nonlinear geometry where the package can do that.

    Raises:
        ScenarioError: there is nothing to compare.
    """
    for name, load in scenario.loads.items():
        if isinstance(load, Crowd):
            wrong = "compare supports single people; crowds are not implemented"
            remedy = "write its people as footsteps"
            raise ScenarioError([Problem(f"loads.{name}.kind", wrong, load.kind, remedy)])
    if not scenario.loads:
        raise ScenarioError([Problem("loads", "no load travels: there is nothing to compare", remedy="add a load")])
    for name, load in scenario.loads.items():
        if isinstance(load, Train):
            wrong, remedy = "compare supports single vehicles; trains of them are not implemented", "write kind: axles"
            raise ScenarioError([Problem(f"loads.{name}.kind", wrong, load.kind, remedy)])
    run = scenario.run
    if isinstance(run, Equilibrium):
        wrong, remedy = "compare needs a load that moves", "ask for kind: dynamic, linear or quasistatic"
        raise ScenarioError([Problem("run.kind", wrong, run.kind, remedy)])
    if isinstance(run, Dynamic):
        return _complete(scenario.model_copy(update={"run": _finely(run)}))
    try:
        until = run.until if isinstance(run, Linear) else _duration(scenario)
        every = (run.every if isinstance(run, Linear) else None) or until / 100.0
        moving = Dynamic(until=until, every=every)
        loads = {name: without_refusal(load) for name, load in scenario.loads.items()}
        return _complete(
            remade(scenario, loads=loads, run=_finely(moving)),
            f"the scenario has kind: {run.kind}; the full model is dynamic and geometrically nonlinear",
        )
    except RopewalkError as error:
        text = f"kind: {run.kind} is the fullest model that is supported here: {error}"
        return _complete(scenario, text)


def _complete(scenario: Scenario, remark: str = "") -> SimplerModel:
    return SimplerModel(FULL, scenario, remark=remark)


def _finely(run: Dynamic) -> Dynamic:
    """A run with enough frames."""
    return run.model_copy(update={"every": min(every_of(run), run.until / FRAMES)})


def _duration(scenario: Scenario) -> float:
    """Time in s that a quasi-static motion stands for: until the last load has left its line or has stopped."""
    *_, last = walk(setting_of(scenario, horizon(scenario)), 2)
    return float(last.t)


def remade(scenario: Scenario, **changes: Any) -> Scenario:
    """A scenario with changes, checked anew."""
    own = {name: getattr(scenario, name) for name in type(scenario).model_fields}
    return Scenario(**(own | changes))


@dataclass(frozen=True)
class FullModel:
    """The full model with its result, from which the others are made.

    Args:
        asked: the scenario as given.
        full: the model at the top.
        result: of it.
        found: what its wheels do.
    """

    asked: Scenario
    full: SimplerModel
    result: xr.Dataset
    found: Mapping[str, Trace]

    @property
    def top(self) -> Scenario:
        """The full scenario."""
        assert self.full.scenario is not None
        return self.full.scenario

    def simpler_model(self, name: str) -> SimplerModel:
        """Make a model, or say why it cannot be had."""
        makers: dict[str, Callable[[], SimplerModel]] = {
            LINEAR: self._linear, QUASISTATIC: self._quasistatic, FORCE: self._force, MASS: self._mass, CUT: self._cut,
        }  # fmt: skip
        if name == FULL:
            return self.full
        try:
            return makers[name]()
        except RopewalkError as error:
            return SimplerModel(name, reason=" ".join(str(error).split()))

    @property
    def _constant(self) -> ConstantForces:
        return ConstantForces(self.top, self.found)

    @property
    def _is_pantograph(self) -> bool:
        return any(isinstance(load, Pantograph) for load in self.top.loads.values())

    def _all(self, *kinds: Any) -> bool:
        return all(isinstance(load, kinds) for load in self.top.loads.values())

    def _linear(self) -> SimplerModel:
        top = self.top
        if self._is_pantograph:
            run = top.run
            assert isinstance(run, Dynamic)
            if run.geometry == "linearised":
                return SimplerModel(LINEAR, same_as=FORCE, remark="the scenario has linearised geometry")
            small = remade(top, run=Dynamic(until=run.until, every=run.every, geometry="linearised"))
            return SimplerModel(LINEAR, small, pressing_task(small, self.found), contacts_in(self.found))
        loads, wheels = ConstantForces(top, self.found, FEW_SEGMENTS).forces()
        until, every = self._clock()
        modes = self.asked.run.modes if isinstance(self.asked.run, Linear) else None
        run_linear = Linear(until=until, every=every, modes=modes)
        return SimplerModel(LINEAR, remade(top, title=self._title(LINEAR), loads=loads, run=run_linear), wheels=wheels)

    def _quasistatic(self) -> SimplerModel:
        if isinstance(self.top.run, Quasistatic):
            return SimplerModel(QUASISTATIC, same_as=FULL)
        if self._is_pantograph:
            raise RopewalkError(
                "the quasi-static model is left out under overhead lines: their equilibria take longer than the run; "
                "ask for kind: quasistatic"
            )
        loads, wheels = self._constant.forces()
        until, _ = self._clock()
        ended = {name: load.model_copy(update={"travel": _ended(load.travel, until)}) for name, load in loads.items()}
        run = Quasistatic(positions=POSITIONS)
        return SimplerModel(
            QUASISTATIC, remade(self.top, title=self._title(QUASISTATIC), loads=ended, run=run), wheels=wheels
        )

    def _force(self) -> SimplerModel:
        if self._all(GivenForces):
            return SimplerModel(FORCE, same_as=FULL)
        if self._is_pantograph:
            return SimplerModel(FORCE, self.top, pressing_task(self.top, self.found), contacts_in(self.found))
        loads, wheels = self._constant.forces()
        return SimplerModel(FORCE, remade(self.top, title=self._title(FORCE), loads=loads), wheels=wheels)

    def _mass(self) -> SimplerModel:
        if self._all(GivenForces, MovingMass):
            return SimplerModel(MASS, same_as=FULL)
        loads, wheels = self._constant.masses()
        return SimplerModel(MASS, remade(self.top, title=self._title(MASS), loads=loads), wheels=wheels)

    def _cut(self) -> SimplerModel:
        if self._all(GivenForces, Footsteps):
            return SimplerModel(CUT, same_as=FULL)
        if all(isinstance(load, GivenForces) or presses_evenly(self.top, load) for load in self.top.loads.values()):
            return SimplerModel(CUT, same_as=FORCE)
        if self._all(Pantograph):
            return SimplerModel(CUT, same_as=FORCE, remark="under a level, rigid wire a pantograph presses evenly")
        scenario, names = cut(self.top)
        loads = {name: without_refusal(load) for name, load in scenario.loads.items()}
        wheels: dict[str, tuple[str, ...]] = {}
        for wheel in self.found:
            parts = [part for part in names if part == wheel or part.startswith(f"{wheel}.")]
            wheels[wheel] = tuple(name for part in parts for name in names[part]) or (wheel,)
        return SimplerModel(CUT, remade(scenario, loads=loads), wheels=wheels)

    def _title(self, name: str) -> str:
        return f"{self.top.title}, {name}"

    def _clock(self) -> tuple[float, float]:
        """End of the runs in time and interval of their output, s."""
        run = self.top.run
        if isinstance(run, Dynamic | Linear):
            return run.until, min(every_of(run), run.until / FRAMES)
        until = _duration(self.top)
        return until, until / FRAMES

    def finds_speed(self, simpler_model: SimplerModel) -> bool:
        """Whether loads of a model find their speeds by themselves, as some do in full."""
        free = [name for name, load in self.top.loads.items() if not isinstance(getattr(load, "travel", None), Travel)]
        speeding = [n for n in free if not (is_force(self.top.loads[n]) or isinstance(self.top.loads[n], Pantograph))]
        return bool(speeding) and simpler_model.name in (MASS, FULL, CUT)


def _ended(travel: Course, until: float) -> Course:
    """A travel that ends where it is at a time in s, however far its line continues."""
    speed = travel.speed
    if callable(speed):
        return travel
    if isinstance(speed, SpeedTable):
        at = np.searchsorted(speed.time, until, side="left")
        time, value = list(speed.time[:at]), list(speed.value[:at])
        last = float(np.interp(until, speed.time, speed.value))
        table = SpeedTable(time=(*time, until, until), value=(*value, last, 0.0))
    elif speed == 0.0:
        return travel
    else:
        table = SpeedTable(time=(0.0, until, until), value=(speed, speed, 0.0))
    return travel.model_copy(update={"speed": table})
