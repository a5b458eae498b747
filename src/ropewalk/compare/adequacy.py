"""The adequacy map: where in a plane of two parameters a simpler model is good enough."""

from __future__ import annotations

import hashlib
import math
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import ropewalk
from ropewalk.compare.axes import Axis
from ropewalk.compare.coverage import Coverage, coverage_of
from ropewalk.compare.points import Distances, MapPoints, Place, PointOutcome
from ropewalk.errors import Problem, RopewalkError, ScenarioError, did_you_mean
from ropewalk.mechanics.chain import Array
from ropewalk.model import Scenario
from ropewalk.renamed import with_old_arguments
from ropewalk.scenario import dump, loads
from ropewalk.sweeps.keys import overlap
from ropewalk.sweeps.pool import DIED, cores, each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Measure = Callable[[Scenario], Distances]
Progress = Callable[[int, int], None]

TOLERANCE = 0.05


@dataclass(frozen=True, eq=False)
class AdequacyMap:
    """How far each simpler model is from the full one, at each point of a plane."""

    title: str
    x: Axis
    y: Axis
    models: tuple[str, ...]
    quantities: tuple[str, ...]
    distances: Array  # (model, quantity, y, x): relative distance from the full model; NaN: none is known
    reasons: tuple[tuple[str, ...], ...]  # (y, x): why a point has failed; empty: it has not
    model: str  # what was asked
    quantity: str
    tolerance: float

    def of(self, model: str | None = None, quantity: str | None = None) -> Array:
        """Distances (y, x) of one model in one quantity.

        Raises:
            ScenarioError: there is no such model or quantity.
        """
        r = _index("model", model or self.model, self.models)
        return np.asarray(self.distances[r, _index("quantity", quantity or self.quantity, self.quantities)])

    def coverage(
        self, model: str | None = None, quantity: str | None = None, tolerance: float | None = None
    ) -> Coverage:
        """On how much of the plane a model is good enough, and where."""
        model, quantity = model or self.model, quantity or self.quantity
        return coverage_of(self.of(model, quantity), self.x, self.y, model, quantity, tolerance or self.tolerance)

    def figure(
        self, models: str | Sequence[str] | None = None, quantity: str | None = None, tolerance: float | None = None
    ) -> Figure:
        """Draw the map of one model, or of several side by side."""
        from ropewalk.compare.map_figure import map_figure

        chosen = (self.model,) if models is None else (models,) if isinstance(models, str) else tuple(models)
        return map_figure(self, chosen, quantity or self.quantity, tolerance or self.tolerance)

    def as_dict(self) -> dict[str, Any]:
        """The map as plain values that fit into JSON; None where no distance is known."""
        found = self.coverage()
        return {
            "title": self.title,
            "x": self.x.as_dict(),
            "y": self.y.as_dict(),
            "model": self.model,
            "quantity": self.quantity,
            "tolerance": self.tolerance,
            "adequate": found.adequate,
            "points": found.points,
            "verdict": str(found),
            "distances": {
                model: {
                    quantity: [[_plain(d) for d in row] for row in self.distances[r, q].tolist()]
                    for q, quantity in enumerate(self.quantities)
                }
                for r, model in enumerate(self.models)
            },
            "failed": [
                {"point": [i, j], "x": self.x.values[i], "y": self.y.values[j], "reason": reason}
                for j, row in enumerate(self.reasons)
                for i, reason in enumerate(row)
                if reason
            ],
        }


@with_old_arguments({"rung": "model"})
def adequacy(
    scenario: Scenario,
    x: Axis,
    y: Axis,
    *,
    model: str = "linear",
    quantity: str = "deflection",
    tolerance: float = TOLERANCE,
    store: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    retry: bool = False,
    measure: Measure | None = None,
) -> AdequacyMap:
    """Compute how far simpler models are from the full one over a plane of two parameters.

    All models and quantities are computed in one go and kept, so another one is a matter of drawing. A point that
    fails is kept with its reason and does not end the map. With several workers a script must call this under
    `if __name__ == "__main__":`, as for all processes in Python.

    Args:
        scenario: what the points are changes of.
        x: first parameter.
        y: second parameter.
        model: the simpler model that is asked about.
        quantity: in which it is compared with the full one.
        tolerance: relative distance up to which it is good enough.
        store: file of JSON lines for the finished points; a call with the same store continues where the last one was
            stopped.
        workers: processes, of one thread each (default: one for each core that may be used; 1: none but this).
        progress: called with the number of finished points and that of all.
        retry: compute points that have failed once more.
        measure: a scenario in, distances by model and quantity out (default: `ropewalk.compare.distances`).

    Raises:
        ScenarioError: an axis does not go with the scenario, both change the same thing, or there is no such model or
            quantity.
        ResultError: the store is something else, or belongs to another scenario or other axes.
        RopewalkError: no point could be computed.
        KeyboardInterrupt: its message says how many points are done and how to go on.
    """
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        _refuse("tolerance", "must be positive", f"{tolerance:g}", "write for example 0.05")
    workers = cores() if workers is None else workers
    if workers < 1:
        _refuse("workers", "must be at least 1", str(workers), "leave it out to use all cores")
    if measure is None:
        from ropewalk.compare import MODELS, QUANTITIES

        _index("model", model, MODELS)
        _index("quantity", quantity, (*QUANTITIES, "share beyond"))
    text = dump(scenario)
    x, y = x.resolved(scenario), y.resolved(scenario)
    _check_plane(text, x, y)
    compute = partial(_point, text, x, y, measure)
    head = {"ropewalk": ropewalk.__version__, "scenario": _hash(scenario), "title": scenario.title,
            "x": x.as_dict(), "y": y.as_dict()}  # fmt: skip
    total = len(x.values) * len(y.values)
    with MapPoints(None if store is None else Path(store), head, retry) as points:
        missing = [(i, j) for j in range(len(y.values)) for i in range(len(x.values)) if (i, j) not in points.done]
        if progress is not None:
            progress(total - len(missing), total)
        processes = min(workers, len(missing)) if workers > 1 else 0
        finished = each(missing, compute, processes, PointOutcome(reason=DIED))
        try:
            for place, outcome in finished:
                points.add(place, outcome)
                if progress is not None:
                    progress(len(points.done), total)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(_how_to_go_on(len(points.done), total, store)) from None
        finally:
            finished.close()
        return _map(scenario.title, x, y, points.done, model, quantity, tolerance)


def scenario_at(scenario: Scenario, x: Axis, y: Axis, at: tuple[float, float]) -> Scenario:
    """The scenario of one point of a plane.

    Args:
        scenario: what it is a change of.
        x: first parameter.
        y: second parameter.
        at: values of both.

    Raises:
        ScenarioError: the scenario cannot have these values.
        EquilibriumError: a line has no rest to find its tension from.
    """
    text = dump(scenario)
    return loads(text, "scenario", _settings(text, x, y, at))


def _settings(text: str, x: Axis, y: Axis, at: tuple[float, float]) -> list[str]:
    """Overrides of a point; keys come first, so that ratios are those of the changed scenario."""
    settings: list[str] = []
    for axis, value in sorted(zip((x, y), at, strict=True), key=lambda pair: pair[0].is_ratio):
        settings += axis.overrides(loads(text, "scenario", settings), value)
    return settings


def _point(text: str, x: Axis, y: Axis, measure: Measure | None, place: Place) -> PointOutcome:
    """Compute one point; whatever goes wrong is its outcome."""
    began = time.perf_counter()
    settings: list[str] = []
    try:
        settings = _settings(text, x, y, (x.values[place[0]], y.values[place[1]]))
        if measure is None:
            from ropewalk.compare import distances as compared

            measure = compared
        found = measure(loads(text, "scenario", settings))
        plain = {model: {name: _plain(value) for name, value in row.items()} for model, row in found.items()}
        return PointOutcome(plain, settings=tuple(settings), seconds=time.perf_counter() - began)
    except RopewalkError as error:
        reason = "; ".join(str(error).splitlines())
    except Exception as error:  # a fault at one point does not take the others with it
        reason = f"a fault of ropewalk: {type(error).__name__}: {error}"
    return PointOutcome(None, reason, tuple(settings), time.perf_counter() - began)


def _check_plane(text: str, x: Axis, y: Axis) -> None:
    """Refuse axes that change the same thing, or that no value of which goes with the scenario."""
    base = loads(text, "scenario")
    keys = [[override.partition("=")[0] for override in _first_possible(text, base, axis)] for axis in (x, y)]
    both = overlap(*keys)
    if both:
        remedy = "take axes that change different things, such as a key of the line for one of them"
        _refuse("axes", f"{x.name} and {y.name} both change {', '.join(both)}", "", remedy)


def _first_possible(text: str, base: Scenario, axis: Axis) -> list[str]:
    """Overrides of the first value that the scenario can have."""
    first: RopewalkError | None = None
    for value in axis.values:
        try:
            overrides = axis.overrides(base, value)
            loads(text, "scenario", overrides)
        except RopewalkError as error:
            first = first or error
        else:
            return overrides
    assert first is not None
    raise first


def _hash(scenario: Scenario) -> str:
    untitled = scenario.model_copy(update={"title": "", "sweep": None})
    return hashlib.sha256(dump(untitled).encode()).hexdigest()


def _how_to_go_on(done: int, total: int, store: str | os.PathLike[str] | None) -> str:
    if store is None:
        return f"interrupted; {done} of {total} points were done and are lost: with a store they would be kept"
    return f"interrupted; {done} of {total} points are done and kept in {os.fspath(store)}: the same call continues it"


def _map(
    title: str, x: Axis, y: Axis, done: dict[Place, PointOutcome], model: str, quantity: str, tolerance: float
) -> AdequacyMap:
    answers = [outcome.distances for _, outcome in sorted(done.items()) if outcome.distances is not None]
    if not answers:
        first = done[0, 0].reason
        raise RopewalkError(f"no point of the plane could be computed; the first one because: {first}")
    models = tuple(dict.fromkeys(r for found in answers for r in found))
    quantities = tuple(dict.fromkeys(q for found in answers for row in found.values() for q in row))
    _index("model", model, models)
    _index("quantity", quantity, quantities)
    distances = np.full((len(models), len(quantities), len(y.values), len(x.values)), np.nan)
    for (i, j), outcome in done.items():
        for r, q in np.ndindex(distances.shape[:2]):
            value = (outcome.distances or {}).get(models[r], {}).get(quantities[q])
            distances[r, q, j, i] = np.nan if value is None else abs(value)
    reasons = tuple(tuple(done[i, j].reason for i in range(len(x.values))) for j in range(len(y.values)))
    return AdequacyMap(title, x, y, models, quantities, distances, reasons, model, quantity, tolerance)


def _index(what: str, name: str, known: Sequence[str]) -> int:
    if name not in known:
        _refuse(what, f"there is no such {what}", repr(name), did_you_mean(name, known))
    return known.index(name)


def _plain(value: float | None) -> float | None:
    return float(value) if value is not None and math.isfinite(value) else None


def _refuse(key: str, wrong: str, given: str, remedy: str) -> None:
    raise ScenarioError([Problem(key, wrong, given, remedy)])
