"""The implicit method: its order, its linear algebra, and that it agrees with the explicit one and with SciPy."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from motion_cases import order, slack_rope
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import CONTACT, LINE_DAMPING, LOAD_WORK, OFF, ChainBuffers, ChainState
from ropewalk.model import Scenario
from ropewalk.solve.banded import factorise, substitute
from ropewalk.solve.collocation import REJECTIONS, E, balance
from ropewalk.solve.composition import VERLET
from ropewalk.solve.jacobian import linearise
from ropewalk.solve.radau import NO_CONVERGENCE, advance_implicit, workspace_for
from ropewalk.solve.radau_iia import A, C
from ropewalk.solve.splitting import END_OF_LINE, NOT_FINITE, RUNNING, TOO_MANY_STEPS
from ropewalk.solve.start import PreparedRun, setting_of, start_state
from ropewalk.solve.stops import Stops, advance

TAUT = {"length": 19.1, "axial_stiffness": 2e4}


def ready(scenario: Scenario, until: float = 2.0) -> tuple[PreparedRun, ChainState]:
    setting = setting_of(scenario, until)
    return setting, start_state(setting, False)


def implicit(
    setting: PreparedRun,
    start: ChainState,
    until: float,
    tolerance: float = np.inf,
    longest: float = np.inf,
    calls: int = 1,
) -> ChainState:
    state = start.copy()
    space = workspace_for(setting.loads, state)
    for time in np.linspace(start.t[0], until, calls + 1)[1:]:
        status, _ = advance_implicit(setting.strands, setting.loads, state, space, time, tolerance, longest, 1_000_000)
        assert status == RUNNING
    assert state.t[0] == pytest.approx(until, abs=1e-11)
    return state


def explicit(setting: PreparedRun, start: ChainState, until: float, step: float) -> ChainState:
    state = start.copy()
    status, _ = advance(
        setting.strands, setting.loads, state, ChainBuffers.for_state(state), *VERLET, Stops.to(until), step, 10_000_000
    )
    assert status == RUNNING
    return state


def swinging(elements: int, damping: float, line: dict[str, Any]) -> tuple[PreparedRun, ChainState]:
    """A line without loads that begins with a smooth velocity, along and across."""
    scenario = slack_rope(elements, damping, line=line).model_copy(update={"loads": {}})
    setting, state = ready(scenario)
    s = np.linspace(0.0, np.pi, elements + 1)
    state.w[0], state.w[1] = 2.0 * np.sin(2.0 * s), 10.0 * np.sin(s) + 5.0 * np.sin(3.0 * s)
    state.w[:, [0, -1]] = 0.0
    return setting, state


def energy(setting: PreparedRun, state: ChainState) -> float:
    strands = setting.strands
    rest, d = np.diff(state.X), np.diff(state.r, axis=1)
    lam = np.sqrt((d * d).sum(axis=0)) / rest
    m = strands.rho[0] * strands.h[0]
    stored = sum(length * law.stored(strands.law[0], x - 1.0) for length, x in zip(rest, lam, strict=True))
    inner = slice(1, -1)
    weight = setting.strands.rho[0] * 0.5 * (rest[1:] + rest[:-1])  # of half the links that a node really has
    high = weight * (strands.gravity @ state.r[:, inner])
    return float(stored + 0.5 * m * (state.w[:, inner] ** 2).sum() - high.sum())


def distance(one: ChainState, other: ChainState) -> float:
    return float(np.abs(one.r - other.r).max())


def test_the_coefficients_are_those_of_radau_iia() -> None:
    for power in range(1, 4):  # stage order 3
        np.testing.assert_allclose(A @ C ** (power - 1), C**power / power, atol=1e-15)
    for power in range(1, 6):  # quadrature order 5
        assert A[2] @ C ** (power - 1) == pytest.approx(1.0 / power, abs=1e-15)
    # The estimate compares with a formula of order 3 that also uses the start: nothing is left of t, t^2, t^3.
    for power in range(1, 4):
        assert (1.0 if power == 1 else 0.0) + E @ C**power == pytest.approx(0.0, abs=1e-14)


def test_the_order_in_time_is_five() -> None:
    setting, start = swinging(16, 20.0, {**TAUT, "drag": 0.5})
    until, steps = 0.4, [1 / 32, 1 / 48, 1 / 64]
    reference = implicit(setting, start, until, longest=until / 400)
    # An independent one: Verlet's error is of order two, 1e-6 m here.
    assert distance(reference, explicit(setting, start, until, until / 40_000)) < 5e-7
    errors = [distance(implicit(setting, start, until, longest=until * h), reference) for h in steps]
    assert order(steps, errors) == pytest.approx(5.0, abs=0.4)


@pytest.mark.parametrize("measured", ["material", "slip"])
def test_a_slack_rope_under_a_travelling_force_agrees_with_small_explicit_steps(measured: str) -> None:
    setting, start = ready(slack_rope(40, 50.0, travel={"measured": measured}))
    reference = explicit(setting, start, 1.2, 2e-5)
    state = implicit(setting, start, 1.2, tolerance=1e-4, calls=3)
    assert state.moving_load[0] == reference.moving_load[0] >= 0
    assert distance(state, reference) < 1e-4
    for run_info in (LINE_DAMPING, LOAD_WORK, CONTACT):
        assert state.work[run_info] == pytest.approx(reference.work[run_info], rel=1e-3)


def test_the_error_falls_with_the_tolerance_and_keeps_it() -> None:
    setting, start = ready(slack_rope(40, 50.0))
    reference = implicit(setting, start, 1.0, tolerance=1e-8)
    tolerances = [1e-2, 1e-3, 1e-4, 1e-5]
    errors = [distance(implicit(setting, start, 1.0, tolerance=tol), reference) for tol in tolerances]
    print(f"errors {errors} at tolerances {tolerances}")
    assert all(error < tol for error, tol in zip(errors, tolerances, strict=True))
    assert all(small < 0.6 * large for large, small in pairwise(errors))


def test_a_stiff_line_agrees_with_scipy() -> None:
    """Damping for which Verlet would need more than a million steps, against an independent right-hand side."""
    n, damping, until = 12, 1e6, 1.0
    setting, start = swinging(n, damping, {})
    h, m = setting.strands.h[0], setting.strands.rho[0] * setting.strands.h[0]
    assert until * 4.0 * damping / (setting.strands.rho[0] * h * h) > 1e6

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        r, w = start.r.astype(y.dtype), np.zeros_like(start.w, dtype=y.dtype)
        r[:, 1:-1], w[:, 1:-1] = y.reshape(2, 2, n - 1)
        d = np.diff(r, axis=1)
        length = np.sqrt((d * d).sum(axis=0))
        strain_rate = (d * np.diff(w, axis=1)).sum(axis=0) / length / h
        pull = np.diff((1e5 * (length / h - 1.0) + damping * strain_rate) / length * d, axis=1)
        return np.concatenate([w[:, 1:-1].ravel(), (pull / m + setting.strands.gravity[:, None]).ravel()])

    def jacobian(t: float, y: np.ndarray) -> np.ndarray:  # by complex steps: differences are too coarse for SciPy here
        return np.array([rates(t, y + 1e-30j * unit).imag / 1e-30 for unit in np.eye(y.size)]).T

    y = np.concatenate([start.r[:, 1:-1].ravel(), start.w[:, 1:-1].ravel()])
    solution = solve_ivp(rates, (0.0, until), y, method="BDF", rtol=1e-7, atol=1e-8, jac=jacobian)
    wanted = solution.y[: 2 * n - 2, -1].reshape(2, n - 1)
    state = implicit(setting, start, until, tolerance=1e-5)
    # SciPy's own error is 4e-6 m: with rtol=1e-8 it moves by so much.
    np.testing.assert_allclose(state.r[:, 1:-1], wanted, atol=2e-5)


def test_a_stiff_line_under_a_travelling_force_needs_few_steps() -> None:
    setting, start = ready(slack_rope(40, 1e6, line=TAUT))
    assert 4.0 * 1e6 / 0.5**2 > 1e6  # explicit steps for one second
    reference = implicit(setting, start, 1.0, tolerance=1e-6)
    state = start.copy()
    status, steps = advance_implicit(
        setting.strands, setting.loads, state, workspace_for(setting.loads, state), 1.0, 1e-3, np.inf, 10_000
    )
    assert status == RUNNING
    assert steps < 1000
    assert distance(state, reference) < 1e-3


def test_the_energy_audit_closes_to_the_tolerance() -> None:
    """A force that stays where it is and changes in time: exact but for the error in time."""
    scenario = slack_rope(
        30,
        50.0,
        line={**TAUT, "drag": 0.5},
        load={"force": {"time": [0.0, 0.4, 0.8], "value": [[0.0, -100.0], [200.0, -800.0], [0.0, 0.0]]}},
        travel={"speed": 0.0, "from": 7.0},
    )
    setting, start = ready(scenario)
    misses = []
    for tolerance in (1e-3, 1e-5):
        state = start.copy()
        space = workspace_for(setting.loads, state)
        for until in (0.4, 0.8):
            assert advance_implicit(
                setting.strands, setting.loads, state, space, until, tolerance, np.inf, 100_000
            )[0] == RUNNING  # fmt: skip
        assert state.moving_load[0] > 0
        gained = energy(setting, state) - energy(setting, start)
        lost = state.work[LINE_DAMPING] + state.work[CONTACT]
        assert lost > 10.0  # J: there is something to account for
        misses.append(abs(gained + lost - state.work[LOAD_WORK]) / state.work[LOAD_WORK])
    assert misses[0] < 1e-3
    assert misses[1] < 1e-5


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("dtype", [float, complex])
def test_block_elimination_agrees_with_a_dense_solve(d: int, dtype: type) -> None:
    rng, n = np.random.default_rng(d), 7

    def blocks(count: int) -> np.ndarray:
        out = rng.normal(size=(count, d, d)).astype(dtype)
        return out + 1j * rng.normal(size=out.shape) if dtype is complex else out

    diagonal, upper, lower = blocks(n) + 4.0 * np.eye(d), blocks(n - 1), blocks(n - 1)
    dense = np.zeros((n * d, n * d), dtype=dtype)
    for i in range(n):
        here = slice(i * d, i * d + d)
        dense[here, here] = diagonal[i]
        if i < n - 1:
            there = slice(i * d + d, i * d + 2 * d)
            dense[here, there], dense[there, here] = upper[i], lower[i]
    x = rng.normal(size=(n, d)).astype(dtype)
    wanted = np.linalg.solve(dense, x.ravel())
    inverse, ratio = np.zeros_like(diagonal), np.zeros_like(upper)
    assert factorise(diagonal, upper, lower, inverse, ratio)
    substitute(upper, inverse, ratio, x)
    np.testing.assert_allclose(x.ravel(), wanted, atol=1e-11)


def test_the_jacobian_agrees_with_finite_differences() -> None:
    """Also beside a rider, where the material moves past the node: its flux enters once for r', once for w'."""
    setting, state = ready(slack_rope(6, 300.0, line=TAUT, travel={"from": 9.0}))
    strands, loads, n, b = setting.strands, setting.loads, 6, int(state.moving_load[0])
    assert 1 < b < n - 1
    rng = np.random.default_rng(1)
    state.speed[0], state.X[b] = 10.0, 9.3
    state.r[:, 1:-1] += 0.1 * rng.normal(size=(2, n - 1))
    v = np.zeros((2, n + 1))
    v[:, 1:-1] = rng.normal(size=(2, n - 1))
    q, flux = np.zeros(n + 1), state.speed[0] / (state.X[b + 1] - state.X[b - 1])

    def force(r: np.ndarray, v: np.ndarray) -> np.ndarray:
        w, out = v.copy(), np.zeros((2, n + 1))
        w[:, b] -= flux * (r[:, b + 1] - r[:, b - 1])
        balance(strands, loads, state._replace(r=r, w=w), q, 0, out)
        return out[:, 1:-1].T.ravel()

    def difference(which: int) -> np.ndarray:
        columns, step = [], 1e-6
        for node in range(1, n):
            for axis in range(2):
                both = []
                for sign in (1.0, -1.0):
                    arrays = [state.r.copy(), v.copy()]
                    arrays[which][axis, node] += sign * step
                    both.append(force(*arrays))
                columns.append((both[0] - both[1]) / (2.0 * step))
        return -np.array(columns).T

    def dense(blocks: np.ndarray) -> np.ndarray:
        out = np.zeros((n - 1, 2, n - 1, 2))
        for i in range(n - 1):
            out[i, :, i, :] = blocks[0, i + 1]
            if i < n - 2:
                out[i, :, i + 1, :], out[i + 1, :, i, :] = blocks[1, i + 1], blocks[2, i + 1]
        return out.reshape(2 * n - 2, 2 * n - 2)

    stiff, damp = np.zeros((3, n + 1, 2, 2)), np.zeros((3, n + 1, 2, 2))
    linearise(strands, state, v, 0, stiff, damp)
    np.testing.assert_allclose(dense(stiff), difference(0), atol=1e-5 * np.abs(stiff).max())
    inertia = np.zeros((n - 1, 2, n - 1, 2))
    m = strands.rho[0] * strands.h[0]
    for axis in range(2):
        inertia[b - 1, axis, b, axis], inertia[b - 1, axis, b - 2, axis] = -m * flux, m * flux
    expected = difference(1) + inertia.reshape(2 * n - 2, 2 * n - 2)
    np.testing.assert_allclose(dense(damp), expected, atol=1e-7 * np.abs(damp).max())


def test_two_lines_move_as_each_does_alone() -> None:
    one, other = slack_rope(20, 50.0), slack_rope(20, 50.0, line=TAUT, travel={"speed": 7.0})
    both = one.model_copy(
        update={
            "lines": {"rope": one.lines["rope"], "wire": other.lines["rope"]},
            "loads": {
                "walker": one.loads["walker"],
                "other": other.loads["walker"].model_copy(update={"on": "wire"}),
            },
        }
    )
    pair = implicit(*ready(both), 0.5, tolerance=1e-6)
    for s, scenario in enumerate((one, other)):
        alone = implicit(*ready(scenario), 0.5, tolerance=1e-6)
        assert np.abs(pair.r[:, 21 * s : 21 * s + 21] - alone.r).max() < 2e-6


def test_what_ends_a_run_early_is_told() -> None:
    setting, start = ready(slack_rope(20, 50.0, travel={"from": 19.0}, run={"until": 0.1, "every": 0.1}))

    def status(state: ChainState, until: float, most: int) -> int:
        space = workspace_for(setting.loads, state)
        return int(advance_implicit(setting.strands, setting.loads, state, space, until, 1e-3, np.inf, most)[0])

    assert status(start.copy(), 0.5, 100_000) == END_OF_LINE
    assert status(start.copy(), 0.05, 2) == TOO_MANY_STEPS
    broken = start.copy()
    broken.w[0, 3] = np.nan
    assert status(broken, 0.05, 1000) == NOT_FINITE
    assert status(start.copy(), 0.05, 100_000) == RUNNING
    # A tolerance of nothing cannot be kept: the run ends, with the state that it has come to.
    space, state = workspace_for(setting.loads, start), start.copy()
    assert advance_implicit(setting.strands, setting.loads, state, space, 0.05, 0.0, np.inf, 1000)[0] == NO_CONVERGENCE
    assert np.all(np.isfinite(state.r))


def test_a_load_may_leave_its_line() -> None:
    setting, start = ready(slack_rope(20, 50.0, travel={"from": 19.0, "at_end": "leave"}))
    assert implicit(setting, start, 0.3, tolerance=1e-3).moving_load[0] == OFF


def test_the_frictionless_contact_is_refused() -> None:
    setting, start = ready(slack_rope(20, 50.0, load={"contact": "frictionless"}))
    with pytest.raises(ValueError, match="frictionless contact needs an explicit method"):
        workspace_for(setting.loads, start)


def test_the_loop_allocates_nothing() -> None:
    nrt = pytest.importorskip("numba.core.runtime._nrt_python")
    if hasattr(advance_implicit, "py_func") is False:
        pytest.skip("not compiled")
    setting, start = ready(slack_rope(20, 50.0, travel={"measured": "slip"}))
    state = start.copy()
    space = workspace_for(setting.loads, state)
    advance_implicit(setting.strands, setting.loads, state, space, 0.1, 1e-3, np.inf, 10_000)
    nrt.memsys_enable_stats()
    try:
        counts = []
        for until in (0.11, 0.6):
            before = nrt.memsys_get_stats_alloc()
            _, steps = advance_implicit(setting.strands, setting.loads, state, space, until, 1e-3, np.inf, 10_000)
            counts.append((steps, nrt.memsys_get_stats_alloc() - before))
    finally:
        nrt.memsys_disable_stats()
    assert counts[1][0] > counts[0][0] + 20
    assert counts[1][1] == counts[0][1]
    assert space.counts[REJECTIONS] > 0  # also where steps are taken back
