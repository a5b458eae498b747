"""How the values of parameters are combined to cases."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from types import MappingProxyType
from typing import Any

import numpy as np

from ropewalk.model.sweep import DRAWN, FOR_EFFECTS, ONE_AT_A_TIME
from ropewalk.sweeps.parameters import Parameter, refuse

MOST = 1_000_000
"""The most cases of a sweep."""


def combined(
    parameters: Sequence[Parameter],
    how: str,
    count: int | None,
    seed: int,
    written: Mapping[str, Any] = MappingProxyType({}),
) -> list[tuple[Any, ...]]:
    """The values of all parameters, case by case; of a grid the last parameter changes first.

    Args:
        parameters: with values, or distributions to draw from.
        how: grid, zip, one_at_a_time, latin_hypercube, sobol, random, or as `sensitivity.py` needs it. A Latin
            hypercube (McKay, Beckman and Conover, Technometrics 21, 1979) has one value in each of `count` equally
            likely intervals of every parameter, a scrambled Sobol sequence (Owen, Journal of Complexity 14, 1998) is
            even in all of them together, best for a power of two. Of random and Sobol cases the first ones stay where
            there are to be more.
        count: of cases that are drawn.
        seed: of drawing.
        written: single values of the scenario, by key, from which one_at_a_time goes out.

    Raises:
        ScenarioError: a distribution stands in a grid, lists that go together differ in length, or there are too many.
    """
    if how in DRAWN:
        assert count is not None
        if how in FOR_EFFECTS:
            parts = _for_effects(parameters, how, count, seed)
        else:
            parts = _parts(len(parameters), how, count, seed)
        return [tuple(p.at(float(part)) for p, part in zip(parameters, row, strict=True)) for row in parts]
    for parameter in parameters:
        if parameter.drawn is not None:
            remedy = f"write combine: {' | '.join(DRAWN)} with a count, or give values"
            refuse(parameter.key, f"values are drawn from a distribution, which combine: {how} does not", "", remedy)
    levels = [parameter.levels for parameter in parameters]
    if how == "zip":
        sizes = {len(values) for values in levels}
        if len(sizes) > 1:
            report = ", ".join(f"{p.key}: {len(p.levels)}" for p in parameters)
            refuse(
                "sweep.combine",
                "lists that go together have the same length",
                report,
                "change the lists, or write grid",
            )
        return list(zip(*levels, strict=True))
    if how == ONE_AT_A_TIME:
        return _one_at_a_time(parameters, written)
    total = math.prod(len(values) for values in levels)
    if total > MOST:
        refuse("sweep.over", f"the grid has more than {MOST} cases", str(total), "take fewer values, or draw cases")
    return list(product(*levels))


def _one_at_a_time(parameters: Sequence[Parameter], written: Mapping[str, Any]) -> list[tuple[Any, ...]]:
    """The scenario as it is, and with each value of each parameter in it.

    Raises:
        ScenarioError: a parameter is no single value of the scenario.
    """
    for parameter in parameters:
        if parameter.key not in written:
            wrong = "has no single value in the scenario, which one_at_a_time requires"
            refuse(parameter.key, wrong, "", "write the value into the scenario, or combine: grid")
    usual = tuple(written[parameter.key] for parameter in parameters)
    return [usual, *((*usual[:k], value, *usual[k + 1 :]) for k, p in enumerate(parameters) for value in p.levels)]


def _for_effects(parameters: Sequence[Parameter], how: str, count: int, seed: int) -> np.ndarray[Any, Any]:
    """Points (case, parameter) of the unit cube from which effects follow.

    Raises:
        ScenarioError: a parameter has no lowest and highest value.
    """
    from ropewalk.sweeps.sensitivity import points  # lazy: its library takes seconds to import

    for parameter in parameters:
        endless = parameter.drawn is not None and parameter.drawn.kind in ("normal", "lognormal")
        if how == "morris" and endless:
            remedy = "write uniform(LOW, HIGH), or combine: saltelli"
            refuse(parameter.key, "morris requires a lowest and a highest value, and this has none", "", remedy)
    return points(len(parameters), how, count, seed)


def _parts(size: int, how: str, count: int, seed: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Points (case, parameter) of the unit cube."""
    chance = np.random.default_rng(seed)
    if how == "random":
        return chance.random((count, size))
    if how == "latin_hypercube":
        order = chance.permuted(np.tile(np.arange(count), (size, 1)), axis=1).T
        return (order + chance.random((count, size))) / count
    from scipy.stats import qmc

    points: np.ndarray[Any, np.dtype[np.float64]] = qmc.Sobol(size, scramble=True, rng=chance).random_base2(
        math.ceil(math.log2(count))
    )
    return points[:count]
