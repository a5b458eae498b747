"""What matters: points at which a sweep is computed to find it, and the effects of the parameters, by SALib.

`morris`: elementary effects (Morris, Technometrics 33, 1991; Campolongo, Cariboni and Saltelli, Environmental Modelling
and Software 22, 2007): where to look closer, from few cases. `saltelli`: Sobol indices, the parts of the variance that
parameters have alone and with others (Sobol', Mathematics and Computers in Simulation 55, 2001; Saltelli et al.,
Computer Physics Communications 181, 2010).
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array

LEVELS = 4  # of the grid of Morris, between the lowest and the highest value
_LEVEL, _RESAMPLES = 0.95, 1000  # of intervals

EFFECTS: dict[str, dict[str, tuple[str, str]]] = {
    "morris": {
        "mean_effect": ("mu", "mean change of a quantity over the range of a parameter"),
        "mean_absolute_effect": ("mu_star", "mean size of these changes"),
        "mean_absolute_effect_interval": ("mu_star_conf", "half width of its interval of 95 %"),
        "deviation_of_effects": ("sigma", "standard deviation of these changes: curved, or with others"),
    },
    "saltelli": {
        "first_order": ("S1", "part of the variance that a parameter has alone"),
        "first_order_interval": ("S1_conf", "half width of its interval of 95 %"),
        "total": ("ST", "part of the variance that a parameter has alone and with others"),
        "total_interval": ("ST_conf", "half width of its interval of 95 %"),
    },
}
"""Names of what is told, by the way of drawing, with what SALib calls it, in a sentence."""


def points(size: int, how: str, count: int, seed: int) -> Array:
    """Points (case, parameter) of the unit cube: of `count` trajectories, or of a Sobol sequence `count` long.

    Raises:
        RopewalkError: SALib is not installed.
    """
    if how == "morris":
        drawn = _salib("sample.morris").sample(_problem(size), count, num_levels=LEVELS, seed=seed)
    else:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of counts that are no power of two: docs/sweep.md says so
            drawn = _salib("sample.sobol").sample(_problem(size), count, calc_second_order=False, seed=seed)
    return np.asarray(drawn, dtype=np.float64)


def effects(how: str, at: Array, values: Mapping[str, Array], seed: int) -> dict[str, Array]:
    """The effects (quantity, parameter) by their names; NaN of quantities that a case lacks, or that do not vary.

    Args:
        how: morris or saltelli.
        at: (case, parameter) as `points` gives them.
        values: (case,) by quantity.
        seed: of resampling for intervals.
    """
    problem = _problem(at.shape[1])
    out = {name: np.full((len(values), at.shape[1]), np.nan) for name in EFFECTS[how]}
    for i, given in enumerate(values.values()):
        if not np.isfinite(given).all() or not np.ptp(given) > 0.0:
            continue
        more: dict[str, Any] = {"num_resamples": _RESAMPLES, "conf_level": _LEVEL, "seed": seed}
        if how == "morris":
            found = _salib("analyze.morris").analyze(problem, at, given, num_levels=LEVELS, **more)
        else:
            found = _salib("analyze.sobol").analyze(problem, given, calc_second_order=False, **more)
        for name, (theirs, _) in EFFECTS[how].items():
            out[name][i] = np.asarray(found[theirs], dtype=np.float64)
    return out


def _problem(size: int) -> dict[str, Any]:
    return {"num_vars": size, "names": [str(k) for k in range(size)], "bounds": [[0.0, 1.0]] * size}


def _salib(part: str) -> Any:
    try:
        return import_module(f"SALib.{part}")
    except ImportError:
        raise RopewalkError(
            "SALib is not installed: pip install 'ropewalk[sensitivity]', or write combine: sobol and look at the cases"
        ) from None
