"""Verdicts: thresholds, and what they mean in words."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ropewalk.compare.quantities import JUDGED, QUANTITIES
from ropewalk.compare.simpler_models import FULL, LINEAR, SIMPLEST_FIRST
from ropewalk.compare.stretches import Reach
from ropewalk.coupling import percent
from ropewalk.errors import Problem, ScenarioError, did_you_mean

TOLERANCE = 0.05
"""Relative distance that is allowed where nothing is said: loads and stiffnesses are rarely known better."""

Errors = dict[str, float | None]


def thresholds(tolerance: float = TOLERANCE, tolerances: Mapping[str, float] | None = None) -> dict[str, float]:
    """The allowed distance of each quantity that is judged.

    Args:
        tolerance: of all quantities but hold forces.
        tolerances: of single quantities, by name; out of QUANTITIES.

    Raises:
        ScenarioError: a tolerance is none, or a quantity is not known.
    """
    given = {"tolerance": tolerance, **{f"tolerances.{name}": value for name, value in (tolerances or {}).items()}}
    problems = [
        Problem(key, "a tolerance is a positive part", str(value), "write for example 0.05 for 5 %")
        for key, value in given.items()
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < math.inf
    ]
    for name in tolerances or {}:
        if name not in QUANTITIES:
            remedy = did_you_mean(str(name), QUANTITIES)
            problems.append(Problem("tolerances", "no such quantity", repr(name), remedy))
    if problems:
        raise ScenarioError(problems)
    wanted = dict.fromkeys(JUDGED, float(tolerance)) | {name: float(v) for name, v in (tolerances or {}).items()}
    return {name: wanted[name] for name in QUANTITIES if name in wanted}


def is_adequate(errors: Errors, allowed: Mapping[str, float]) -> bool:
    """Whether all that is known of a model is within the tolerance, and something is known."""
    known = {name: errors[name] for name in allowed if errors.get(name) is not None}
    return bool(known) and all(value is not None and value <= allowed[name] for name, value in known.items())


def sentence(name: str, errors: Errors, allowed: Mapping[str, float]) -> str:
    """What is to be said of a model that was run."""
    known = {quantity: errors[quantity] for quantity in allowed if errors.get(quantity) is not None}
    off = {quantity: value for quantity, value in known.items() if value is not None and value > allowed[quantity]}
    fine = {quantity: value for quantity, value in known.items() if quantity not in off}
    if not known:
        return f"{name}: nothing to compare"
    if not off:
        worst = max(fine, key=lambda quantity: fine[quantity] or 0.0)
        return f"{name}: adequate; {_called(worst)} is off most, by {percent(fine[worst])}"
    text = ", ".join(f"{_called(quantity)} {percent(value)} off" for quantity, value in off.items())
    rest = f"; adequate for {_listed([_called(quantity) for quantity in fine])}" if fine else ""
    return f"{name}: not adequate: {text}{rest}"


def recommendation(adequate: Mapping[str, bool], same_as: Mapping[str, str], *, feedback: bool) -> str:
    """Which model to take: the simplest one that is adequate.

    Args:
        adequate: of each model that was run.
        same_as: of a model that coincides with another one, which.
        feedback: whether there is any in the full scenario.
    """
    simplest = next((n for n in SIMPLEST_FIRST if adequate.get(n) and same_as.get(n) != FULL and n != FULL), None)
    if simplest is not None:
        return f"The simplest model that is adequate is {_MODELS[simplest]}."
    if feedback:
        return "Nothing simpler is adequate: use the full scenario, with its feedback."
    return "Nothing simpler is adequate: use the full scenario, a moving force with nonlinear geometry and inertia."


_MODELS = {
    LINEAR: "the linear theory with constant forces", "quasi-static": "the quasi-static one with constant forces",
    "moving force": "the nonlinear one with constant moving forces",
    "feedback cut": "the nonlinear one with the forces that the loads exert on rigid ground",
    "moving mass": "the nonlinear one with rigid masses",
}  # fmt: skip


def places(reach: Mapping[str, Reach]) -> list[str]:
    """Where the linear theory holds, a sentence for each wheel; of several the worst."""
    if not reach:
        return []
    wheel = max(reach, key=lambda name: (reach[name].share, reach[name].worst))
    of = f" of {wheel}" if len(reach) > 1 else ""
    text = reach[wheel].text("the linear theory")
    return [f"Of the deflection under the load{of} in each place: {text}."]


def _called(quantity: str) -> str:
    return {
        "deflection": "the largest deflection", "path": "the deflection under the load along its path",
        "tension": "the largest tension", "support force": "the largest support force",
        "contact force": "the largest contact force", "speed": "the last speed",
        "hold force": "the largest hold force",
    }[quantity]  # fmt: skip


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
