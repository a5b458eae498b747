"""Starts of loads that are given in x: the place along the line that has this x in the state in which a run begins."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ropewalk.capabilities import LINEAR, engine_of
from ropewalk.errors import EquilibriumError
from ropewalk.model.position import PositionInX, begun_at, position_in_x
from ropewalk.model.run import Dynamic, Equilibrium, Linear, every_of
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Array, Frame, Layout

_ROUNDS, _NEAR = 30, 1e-7  # rounds with loads that move as their line yields, and the move over its length


class _Shape(NamedTuple):
    """A line in equilibrium."""

    xi: Array  # (knot,) m, rising
    place: Array  # (knot, axis) m


def located(scenario: Scenario, rest: Callable[[Scenario], tuple[Layout, Frame]]) -> Scenario:
    """Return a scenario whose loads begin at lengths along their lines.

    Args:
        scenario: with loads that begin at a given x, or without.
        rest: returns the equilibrium of a scenario.

    Raises:
        EquilibriumError: a line does not reach x, or no equilibrium was found.
    """
    wanted = {name: at for name, load in scenario.loads.items() if (at := position_in_x(load)) is not None}
    if not wanted:
        return scenario
    scenario = _begun(scenario, {name: float(at) for name, at in wanted.items()})
    run = scenario.run
    with_loads = not isinstance(run, Dynamic | Linear) or (isinstance(run, Dynamic) and run.start.with_loads)
    bare: dict[str, Any] = {"run": Equilibrium()} | ({} if with_loads else {"loads": {}})
    if isinstance(run, Dynamic) and not run.start.in_wind:
        bare["wind"] = None
    if isinstance(run, Linear) and engine_of(scenario) is LINEAR:  # about its chord
        bare["run"] = run.model_copy(update={"until": every_of(run)})
    for _ in range(_ROUNDS):
        layout, frame = rest(scenario.model_copy(update=bare))
        shapes = {name: _shape(scenario, layout, frame, scenario.loads[name].on) for name in wanted}
        found = {name: _start(name, scenario, at, shapes[name]) for name, at in wanted.items()}
        moved = max(
            abs(start - _position(scenario, name)) / float(shapes[name].xi[-1]) for name, start in found.items()
        )
        scenario = _begun(scenario, found)
        if not with_loads or moved <= _NEAR:
            return scenario
    raise EquilibriumError("no start was found at which the loads stand at their x: write from as a length in m")


def _position(scenario: Scenario, name: str) -> float:
    """Return where a load begins, as its travel measures it, m."""
    load: Any = scenario.loads[name]
    return float(getattr(load, "travel", load).start)


def _begun(scenario: Scenario, starts: dict[str, float]) -> Scenario:
    loads = {name: begun_at(load, starts[name]) if name in starts else load for name, load in scenario.loads.items()}
    return scenario.model_copy(update={"loads": loads})


def _shape(scenario: Scenario, layout: Layout, frame: Frame, line: str) -> _Shape:
    """Return nodes and contacts of a line, by their positions along it."""
    own = np.flatnonzero(np.array(layout.node_line) == line)
    loads = [scenario.loads.get(load.partition(".")[0]) for load in layout.contact_load]
    own_loads = [load is not None and load.on == line and not getattr(load, "also_on", ()) for load in loads]
    pressed = np.flatnonzero(np.array(own_loads, dtype=bool) & np.isfinite(frame.contact_xi))  # where it has kinks
    xi = np.concatenate([layout.node_xi[own], frame.contact_xi[pressed]])
    place = np.concatenate([frame.position[own], frame.contact_position[pressed]])
    order = np.argsort(xi, kind="stable")
    return _Shape(xi[order], place[order])


def _start(name: str, scenario: Scenario, at: PositionInX, shape: _Shape) -> float:
    """Return where along a line a load begins, as its travel measures it, m."""
    level = shape.place[:, :-1] - shape.place[0, :-1]
    if at.x is None:
        along, target = level @ level[-1], 0.5 * float(level[-1] @ level[-1])
    else:
        along, target = shape.place[:, 0], at.x
    away = along - target
    crossed = np.flatnonzero(away[:-1] * away[1:] <= 0.0)
    if not crossed.size:
        low, high = float(along.min()), float(along.max())
        raise EquilibriumError(
            f"loads.{name}: in equilibrium {scenario.loads[name].on} reaches from x = {low:.6g} m to {high:.6g} m and "
            f"not to {target:.6g} m; write another x, or the length along the line in m"
        )
    i = int(crossed[0])
    part = float(away[i] / (away[i] - away[i + 1])) if away[i] != away[i + 1] else 0.0
    measured = getattr(getattr(scenario.loads[name], "travel", None), "measured", "material")
    if measured == "horizontal":
        return abs(float(np.interp(i + part, range(along.size), shape.place[:, 0])) - float(shape.place[0, 0]))
    lengths = np.linalg.norm(np.diff(shape.place, axis=0), axis=1)
    knots = shape.xi if measured == "material" else np.concatenate([[0.0], np.cumsum(lengths)])
    return float(knots[i] + part * (knots[i + 1] - knots[i]))
