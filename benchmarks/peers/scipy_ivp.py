"""SciPy's `solve_ivp`: Radau and BDF with an analytic sparse Jacobian, DOP853 with a compiled or a plain
NumPy right-hand side.

Relative tolerance and absolute tolerance (m, m/s) are equal. Plain usage lets the step control find the
passages of nodes, where the second derivative of the motion has a kink; ``aligned`` settings restart the
integrator there.
"""

from __future__ import annotations

from time import process_time

import numpy as np
from scipy.integrate import solve_ivp

from .interface import Failed, Setting, missing, piecewise
from .problem import (
    Array,
    Rope,
    initial_state,
    numba_rhs,
    numpy_rhs,
    passage_times,
    positions_of,
    sparse_jacobian,
)

name = "SciPy solve_ivp"
distribution = "scipy"

_TOLERANCES = (1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
settings = (
    *(Setting("DOP853 compiled rhs", size) for size in _TOLERANCES),
    *(Setting("DOP853 compiled rhs", size, aligned=True) for size in _TOLERANCES),
    *(Setting("DOP853 NumPy rhs", size) for size in _TOLERANCES),
    *(Setting("Radau sparse", size) for size in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)),
    *(Setting("BDF sparse", size) for size in (1e-3, 1e-5, 1e-7, 1e-8)),
)


def available() -> str | None:
    """None if SciPy can be used, else the reason."""
    return missing("scipy", distribution)


def suits(rope: Rope, setting: Setting) -> str | None:
    """Every method can in principle solve every rope."""
    return None


def chain(rope: Rope) -> Rope:
    """The peer solves the rope as it stands."""
    return rope


def run(rope: Rope, times: Array, setting: Setting) -> tuple[Array, float]:
    """Positions at ``times`` and the CPU seconds of the solve."""
    method = setting.method.split()[0]
    f = numpy_rhs(rope) if "NumPy" in setting.method else numba_rhs(rope)
    options = {"jac": sparse_jacobian(rope)} if "sparse" in setting.method else {}
    state = initial_state(rope)
    f(0.0, state)
    if options:
        options["jac"](0.0, state)

    def solve(start: float, stops: Array, state: Array) -> Array:
        solution = solve_ivp(
            f,
            (start, stops[-1]),
            state,
            method=method,
            t_eval=stops,
            rtol=setting.size,
            atol=setting.size,
            **options,
        )
        if not solution.success:
            raise Failed(solution.message)
        return solution.y.T

    breaks = passage_times(rope, times[0], times[-1]) if setting.aligned else np.empty(0)
    begin = process_time()
    states = piecewise(times, breaks, solve, state)
    return positions_of(rope, states), process_time() - begin


def reference(rope: Rope, times: Array, tolerance: float = 1e-11) -> Array:
    """Positions against which peers are measured: DOP853 restarted at every passage, atol a tenth of rtol."""
    f = numba_rhs(rope)

    def solve(start: float, stops: Array, state: Array) -> Array:
        solution = solve_ivp(f, (start, stops[-1]), state, "DOP853", stops, rtol=tolerance, atol=tolerance / 10)
        if not solution.success:
            raise Failed(solution.message)
        return solution.y.T

    return positions_of(rope, piecewise(times, passage_times(rope, times[0], times[-1]), solve, initial_state(rope)))
