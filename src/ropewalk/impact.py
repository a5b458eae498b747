"""The static part of a crossing: the same loads without inertia, with which impact factors are made."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from ropewalk.model.axles import Axles
from ropewalk.model.outputs import Outputs
from ropewalk.model.run import Quasistatic
from ropewalk.model.scenario import Scenario
from ropewalk.model.train import Train

if TYPE_CHECKING:
    import xarray as xr

STEPS = 50
"""Positions in the length of the shortest line: a largest deflection is missed by 0.05 %, a moment by 2 % at most."""
_MOST = 20_000

Static = dict[str, dict[str, float]]
"""Largest values in SI units, by line or place and quantity."""


def static_part(scenario: Scenario, simulate: Callable[[Scenario], xr.Dataset]) -> Static:
    """Largest static deflection, moment and shear of a crossing, by line and place.

    Args:
        scenario: of a motion, whose outputs ask for it.
        simulate: runs a scenario.

    Raises:
        RopewalkError: the loads find no rest somewhere on their way.
    """
    named, loads = list(scenario.loads.items()), list(scenario.loads.values())
    speeds: list[Any] = [getattr(getattr(load, "travel", None), "speed", None) for load in loads]
    fastest = max((abs(speed) for speed in speeds if isinstance(speed, float)), default=0.0)
    if fastest and all(isinstance(speed, float) for speed in speeds):  # how fast makes no difference
        slow = {name: _at_speed(load, speed / fastest) for (name, load), speed in zip(named, speeds, strict=True)}
        scenario = scenario.model_copy(update={"loads": slow})
    shortest = min(line.distance for line in scenario.lines.values())
    way = longest = max(line.distance for line in scenario.lines.values())
    for load in loads:
        if isinstance(load, Axles | Train):
            start = load.travel.start
            way = max(way, longest + load.length + max(-start, start - longest, 0.0))
    paces = len(
        {abs(speed) if isinstance(speed, float) else name for (name, _), speed in zip(named, speeds, strict=True)}
    )
    positions = min(2 + round(STEPS * way * paces / shortest), _MOST)  # unlike loads may move one after the other
    outputs = Outputs(**{**dict(scenario.outputs), "impact": False})
    asked = scenario.model_copy(
        update={"title": "", "sweep": None, "run": Quasistatic(positions=positions), "outputs": outputs}
    )
    return _found(asked.model_dump_json(by_alias=True, exclude_none=True), simulate)


def _at_speed(load: Any, speed: float) -> Any:
    """The same load at another speed in m/s."""
    return load.model_copy(update={"travel": load.travel.model_copy(update={"speed": speed})})


@lru_cache(maxsize=32)
def _found(text: str, simulate: Callable[[Scenario], xr.Dataset]) -> Static:
    from ropewalk.results.line_response import UNITS, response_summary

    with simulate(Scenario.model_validate_json(text)) as result:
        found = response_summary(result)
    return {
        owner: {key: entry[key]["largest"]["value"] for key in UNITS if key in entry and entry[key]["largest"]}
        for owner, entry in found.items()
    }
