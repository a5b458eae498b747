"""Gradients of quantities with respect to keys, each derivative with an estimate of its error."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.capabilities import ROPES, WIRES, engine_of
from ropewalk.designs.evaluation import Evaluation
from ropewalk.designs.variables import Space, Variable
from ropewalk.errors import Refused, RopewalkError, ScenarioError, did_you_mean
from ropewalk.mechanics.chain import Array
from ropewalk.model import Dynamic, Linear, Quasistatic, Scenario
from ropewalk.model.load import MovingForce
from ropewalk.model.mesh import is_asked_for
from ropewalk.scenario import tree_of
from ropewalk.solve.sensitivity import NotBesideError, Rests
from ropewalk.sweeps.case import FINE, Case, check_record, run
from ropewalk.sweeps.keys import leaves, short_names, unit_at
from ropewalk.sweeps.parameters import refuse
from ropewalk.sweeps.quantities import Measured
from ropewalk.sweeps.store import Store
from ropewalk.units import to_si

if TYPE_CHECKING:
    import xarray as xr

STILL, MOVING = 1e-3, 1e-2
"""Steps of rest and linear theory, and of motions, whose extremes jump from one output instant to another."""
DIRECT = (1e-4, 1e-3, 1e-5, 1e-6)
"""Steps of what is differentiated directly, or follows from closed forms, where there is no error of solving: the first
one, a larger one where rounding is felt, smaller ones where equilibria change too much with that."""
CLOSE = 1e-8
"""Error over the derivative that is close enough."""
_HALVED = {"direct": 2, "differences": 1}  # times: a second time where that costs little, for a close error
_ROUNDING = 64.0 * np.finfo(np.float64).eps  # of a quantity


@dataclass(frozen=True)
class _Found:
    """Derivatives (quantity, key), and what the runs that they come of say."""

    slopes: Array
    errors: Array
    units: list[str]  # of the quantities
    doubts: list[str]


def gradient(
    scenario: Scenario,
    of: str | Sequence[str],
    to: str | Sequence[str],
    *,
    step: float | None = None,
    store: str | os.PathLike[str] | None = None,
    workers: int | None = None,
) -> xr.Dataset:
    """Differentiate quantities of a run with respect to numbers of its scenario.

    Equilibria, and what is quasi-static, are solved once. Next to them they follow from the residual of the changed
    equations and the factorised stiffness, one substitution for each (direct differentiation, see
    `solve/sensitivity.py`): the route is "direct". Motions, and rests that do not follow (links that do not pull, loads
    that slip or whose places are searched for on their way, wind, tensions of joined lines), need additional runs:
    "differences". Both are differenced over a step and over half of it, and what both together say of a step of zero
    (L. F. Richardson, 1911) is told.

    Args:
        scenario: where.
        of: quantities, as `record` of a sweep has them.
        to: keys, with a number other than 0 at each.
        step: as a part of the value at each key, of differences (default: 0.001, of motions 0.01).
        store: file of JSON lines for finished cases of differences, shared with sweeps.
        workers: processes for differences (default: one for each core).

    Returns:
        `gradient` and `error` over `quantity` and `key`, in SI units: d(quantity)/d(key). The error is what half the
        step has changed (of the direct route, half of both) and rounding: it also feels roundness and roughness, and is
        no bound. The attribute `route` is "direct" or "differences", and `why` says why it is not direct.

    Raises:
        ScenarioError: a quantity or a key is unknown, or a key has no number.
        RopewalkError: an additional run has no value; it says why.
    """
    import xarray as xr

    names = [part.strip() for part in of.split(",")] if isinstance(of, str) else list(of)
    keys = [to] if isinstance(to, str) else list(to)
    wanted = (MOVING if isinstance(scenario.run, Dynamic) else STILL) if step is None else step
    if not 0.0 < wanted < 0.5:
        refuse("step", "is a part of the value at each key", f"{wanted:g}", "write for example 0.001")
    route, why = "direct", hinders(scenario) if step is None else "a step is given"
    if not why:
        try:
            found = _direct(scenario, keys, names)
        except NotBesideError as error:
            why = str(error)
    if why:
        route, found = "differences", _by_runs(scenario, keys, wanted, names, store, workers)
    units = [unit_at(tree_of(scenario), key) for key in keys]
    coordinates: dict[str, Any] = {
        "quantity": names, "key": keys, "quantity_units": ("quantity", found.units), "key_units": ("key", units),
    }  # fmt: skip
    dims = ("quantity", "key")
    about = {"route": route, "why": why, "doubts": found.doubts} | ({"step": wanted} if why else {})
    return xr.Dataset({"gradient": (dims, found.slopes), "error": (dims, found.errors)}, coordinates, about)


def hinders(scenario: Scenario) -> str:
    """Why a run is not differentiated directly, as far as its scenario tells; empty if nothing does."""
    run, engine = scenario.run, engine_of(scenario)
    if isinstance(run, Dynamic):
        return "a motion"
    if is_asked_for(scenario.parts):
        return "a mesh that is chosen"
    if any(getattr(load, "contact", "clamped") != "clamped" for load in scenario.loads.values()):
        return "loads that slip"
    ways = (load.travel.measured for load in scenario.loads.values() if isinstance(load, MovingForce))
    if isinstance(run, Quasistatic) and engine is ROPES and any(way != "material" for way in ways):
        return "positions that are determined during the run"
    if engine is ROPES or isinstance(run, Linear):
        return ""
    if scenario.wind is not None and not scenario.wind.is_calm:
        return "wind"
    if engine is not WIRES and any(line.length is None for line in scenario.lines.values()):
        return "tensions of joined lines"
    return ""


def _direct(scenario: Scenario, keys: Sequence[str], names: Sequence[str]) -> _Found:
    """The derivatives where equilibria follow from those of the scenario.

    Raises:
        NotBesideError: they do not.
        ScenarioError: a quantity is unknown.
        RopewalkError: a run has no value.
    """
    spaces, rests = {step: _beside(scenario, keys, step) for step in DIRECT}, Rests()
    slopes, errors = np.zeros((len(names), len(keys))), np.full((len(names), len(keys)), np.inf)
    doubts = set[str]()
    with Store(None) as nothing:
        evaluations = {step: Evaluation(scenario, space, {}, names, nothing) for step, space in spaces.items()}
        case = Case.of(evaluations[DIRECT[0]].scenario_at(()), tuple(names))
        check_record(case)

        def look(case: Case, settings: Sequence[str]) -> Measured:
            try:
                with rests.running(again=bool(settings)):
                    found = run(case)
            except ScenarioError:
                raise
            except RopewalkError as error:
                raise _none(settings, str(error)) from None
            if found.outcome not in FINE:
                raise _none(settings, found.reason)
            doubts.update(found.doubts)
            return found.values

        def beside(k: int, step: float) -> list[Measured]:
            out = []
            for part in _parts("direct"):
                settings = evaluations[step].settings(_point(spaces[step], k, part))
                out.append(look(Case.of(evaluations[step].scenario_at(settings), case.record), settings))
            return out

        own = look(case, ())
        for k in range(len(keys)):
            too_much: NotBesideError | None = None
            for step in DIRECT:
                if too_much is None and (errors[:, k] <= CLOSE * np.abs(slopes[:, k])).all():
                    break
                try:
                    found = beside(k, step)
                except NotBesideError as problem:
                    too_much = too_much or problem
                    continue
                for j, name in enumerate(names):
                    slope, error = _extrapolated(found, name, spaces[step].variables[k], "direct")
                    if error < errors[j, k] or not np.isfinite(slope):
                        slopes[j, k], errors[j, k] = slope, error
            if too_much is not None and not np.isfinite(errors[:, k]).all():
                raise too_much
    return _Found(slopes, errors, [own[name][1] for name in names], sorted(doubts))


def _by_runs(
    scenario: Scenario, keys: Sequence[str], step: float, names: Sequence[str],
    store: str | os.PathLike[str] | None, workers: int | None,
) -> _Found:  # fmt: skip
    """The derivatives by additional runs.

    Raises:
        ScenarioError: a quantity is unknown.
        RopewalkError: a run has no value.
    """
    space, parts = _beside(scenario, keys, step), _parts("differences")
    points = [_point(space, k, part) for k in range(len(keys)) for part in parts]
    with Store(None if store is None else Path(store)) as kept:
        runs = Evaluation(scenario, space, {}, names, kept, workers).together(points)
    for one in runs:
        if one.outcome.outcome not in FINE:
            raise _none(one.settings, one.outcome.reason)
    values = [one.outcome.values for one in runs]
    found = np.array([
        [_extrapolated(values[len(parts) * k :][: len(parts)], name, variable, "differences") for name in names]
        for k, variable in enumerate(space.variables)
    ])  # fmt: skip
    units = [next((one[name][1] for one in values), "") for name in names]
    doubts = sorted({doubt for one in runs for doubt in one.outcome.doubts})
    return _Found(found[:, :, 0].T, found[:, :, 1].T, units, doubts)


def _parts(route: str) -> list[float]:
    """Parts of the way between the ends of the whole step, below and above, for each of its halves."""
    return [0.5 + side * 0.5**k for k in range(_HALVED[route] + 1) for side in (-0.5, 0.5)]


def _extrapolated(found: Sequence[Measured], name: str, variable: Variable, route: str) -> tuple[float, float]:
    """A derivative from quantities at `_parts`, and its error."""
    values = np.array([_number(one, name) for one in found]).reshape(-1, 2)
    width = variable.high - variable.low
    quotients = (values[:, 1] - values[:, 0]) / (width * 0.5 ** np.arange(len(values)))
    without = (4.0 * quotients[1:] - quotients[:-1]) / 3.0  # the second order in the step
    better = without if route == "direct" else quotients
    rounding = _ROUNDING * float(np.abs(values).max()) / width
    return float(without[0]), abs(float(better[1] - better[0])) + rounding


def _point(space: Space, k: int, part: float) -> Array:
    point = space.own.copy()
    point[k] = part
    return point


def _none(settings: Sequence[str], reason: str) -> RopewalkError:
    beside = f"with {', '.join(settings)} " if settings else ""
    return RopewalkError(f"there is no gradient: {beside}{reason}")


def _number(values: Measured, name: str) -> float:
    value = values[name][0]
    return float("nan") if value is None else value


def _beside(scenario: Scenario, keys: Sequence[str], step: float) -> Space:
    """The space around the values of the scenario.

    Raises:
        ScenarioError: a key is unknown or has no number.
    """
    tree = tree_of(scenario)
    stands = dict(leaves(tree))
    variables, units = [], []
    for key in keys:
        if key not in stands:
            refuse(key, "the scenario has no value there", "", did_you_mean(key, stands, "write it into the scenario"))
        unit = unit_at(tree, key)
        try:
            value = to_si(stands[key], unit or "dimensionless")
        except Refused:
            value = 0.0
        if value == 0.0:
            refuse(key, "only numbers other than 0 have a step", str(stands[key]), "leave it out")
        low, high = sorted((value * (1.0 - step), value * (1.0 + step)))
        variables.append(Variable(key, low, high, unit))
        units.append(unit)
    return Space(tuple(variables), tuple(short_names(keys)), tuple(units), np.full(len(keys), 0.5))
