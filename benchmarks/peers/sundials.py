"""SUNDIALS CVODE through scikit-sundae: BDF with the banded solver, and Adams for the undamped rope.

The unknowns are interleaved node by node, so the Jacobian has seven diagonals below and three (damped: five)
above the main one; CVODE finds it by 11 (13) evaluations of the compiled right-hand side, which is cheaper
here than to fill the dense template that the wrapper asks of an analytic one. The wrapper offers no
fixed-point iteration, so Adams solves the same banded Newton systems. ``aligned`` settings restart CVODE at
every passage of a node, at order one each time. BDF of order 3 to 5 is unstable near the imaginary axis,
where the undamped rope has its spectrum: loose tolerances give nonsense there.
"""

from __future__ import annotations

from time import process_time

import numpy as np

from .interface import Failed, Setting, missing, piecewise
from .problem import (
    BAND_ABOVE,
    BAND_BELOW,
    Array,
    Rope,
    initial_state,
    numba_fill,
    passage_times,
    positions_of,
)

name = "SUNDIALS CVODE"
distribution = "scikit-sundae"

_TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
settings = (
    *(Setting("BDF band", size) for size in _TOLERANCES),
    *(Setting("Adams band", size) for size in _TOLERANCES),
    *(Setting("Adams band", size, aligned=True) for size in _TOLERANCES[4:]),
)


def available() -> str | None:
    """None if scikit-sundae can be used, else the reason."""
    return missing("sksundae", distribution)


def suits(rope: Rope, setting: Setting) -> str | None:
    """Adams is meant for the undamped rope, whose spectrum is imaginary."""
    return "for the undamped rope only" if rope.damping and setting.method.startswith("Adams") else None


def chain(rope: Rope) -> Rope:
    """The peer solves the rope as it stands."""
    return rope


def run(rope: Rope, times: Array, setting: Setting) -> tuple[Array, float]:
    """Positions at ``times`` and the CPU seconds of the solve (the set-up of the solver included, the
    compilation not).
    """
    from sksundae.cvode import CVODE

    fill = numba_fill(rope)
    state = initial_state(rope)

    def solver() -> CVODE:
        return CVODE(
            fill,
            method=setting.method.split()[0],
            rtol=setting.size,
            atol=setting.size,
            linsolver="band",
            lband=BAND_BELOW,
            uband=BAND_ABOVE if rope.damping else 3,
            max_num_steps=1_000_000,
        )

    solver().solve(np.array([0.0, 1e-9]), state)

    def solve(start: float, stops: Array, state: Array) -> Array:
        # three times or more, because with two the wrapper returns every internal step
        span = (
            np.concatenate(([start], stops)) if len(stops) > 1 else np.array([start, (start + stops[0]) / 2, stops[0]])
        )
        solution = solver().solve(span, state)
        if not solution.success:
            raise Failed(str(solution.message))
        return solution.y[-len(stops) :]

    breaks = passage_times(rope, times[0], times[-1]) if setting.aligned else np.empty(0)
    begin = process_time()
    states = piecewise(times, breaks, solve, state)
    return positions_of(rope, states), process_time() - begin
