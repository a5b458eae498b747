"""Searches for the smallest value of a function that limits hold back, each value a run."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array

Judge = Callable[[Array], tuple[float, Array]]
"""Of a point the function, NaN if it has no value, and by how much each limit is exceeded."""
Judges = Callable[[Sequence[Array]], list[tuple[float, Array]]]
FEW = 8
"""Variables up to which models of second order, which ask for a multiple of them of runs, are the better choice."""
BATCH = 8
"""Points that Optuna proposes together; one number, so that the search does not depend on the number of processes."""
FIRST_RADIUS = 0.15
"""Of the trust region, as a part of the way between the bounds."""


def sobol(count: int, size: int, seed: int) -> list[Array]:
    """Even points (count) of the unit cube, a scrambled Sobol sequence."""
    if count < 1:
        return []
    from scipy.stats import qmc

    points = qmc.Sobol(size, scramble=True, rng=np.random.default_rng(seed)).random_base2(int(np.ceil(np.log2(count))))
    return list(points[:count])


def by_models(judge: Judge, start: Array, scale: float, limits: int, tolerance: float, most: int) -> None:
    """COBYQA (T. M. Ragonneau, thesis, The Hong Kong Polytechnic University 2022): quadratic models in a trust region.

    It asks for no gradients, and looks at differences over the trust region only: what is rough on a smaller scale,
    as statistics of a short motion are, does not lead it astray. Bounds are kept by every point, limits at the end.

    Args:
        judge: the function.
        start: (variable,) parts of the ways between the bounds.
        scale: a usual size of the function.
        limits: how many there are.
        tolerance: radius of the trust region at the end, as a part of the ways.
        most: values of the function.
    """
    from scipy.optimize import Bounds, NonlinearConstraint, minimize

    kept = NonlinearConstraint(lambda x: judge(x)[1], -np.inf, 0.0)
    options = {
        "initial_tr_radius": FIRST_RADIUS, "final_tr_radius": min(tolerance, FIRST_RADIUS), "maxfev": most,
        "scale": False,
    }  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        minimize(
            lambda x: judge(x)[0] / scale, start, method="COBYQA", bounds=Bounds(0.0 * start, 0.0 * start + 1.0),
            constraints=[kept] if limits else (), options=options,
        )  # fmt: skip


def by_optuna(judge: Judges, start: Array, limits: int, most: int, seed: int) -> None:
    """Optuna's tree-structured Parzen estimator (Bergstra and others, NeurIPS 2011), in batches.

    Args:
        judge: the function, of several points at once.
        start: (variable,) a point that is looked at first.
        limits: how many there are.
        most: values of the function.
        seed: of the search.

    Raises:
        RopewalkError: Optuna is not installed.
    """
    try:
        import optuna
    except ImportError:
        raise RopewalkError(
            "Optuna is not installed: pip install 'ropewalk[design]', or choose --method models"
        ) from None
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    names = [f"x{k}" for k in range(start.size)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of what is experimental there
        sampler = optuna.samplers.TPESampler(
            seed=seed, multivariate=start.size > 1, constant_liar=True, n_startup_trials=max(10, 2 * start.size),
            constraints_func=(lambda trial: trial.user_attrs["excess"]) if limits else None,
        )  # fmt: skip
        study = optuna.create_study(sampler=sampler)
        study.enqueue_trial(dict(zip(names, map(float, start), strict=True)))
        for begin in range(0, most, BATCH):
            trials = [study.ask() for _ in range(min(BATCH, most - begin))]
            points = [np.array([trial.suggest_float(name, 0.0, 1.0) for name in names]) for trial in trials]
            for trial, (value, excess) in zip(trials, judge(points), strict=True):
                fine = bool(np.isfinite(value) and np.isfinite(excess).all())
                trial.set_user_attr("excess", [float(one) for one in excess] if fine else [1e9] * limits)
                study.tell(trial, value if fine else None, None if fine else optuna.trial.TrialState.FAIL)
