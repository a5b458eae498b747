"""Runs of kind linear in wind: small motion about the rest in the mean wind.

Sources: differences of the forces on lines; the matrix exponential; quasi-steady aerodynamic damping of a taut string
(Holmes, Wind Loading of Structures, 3rd ed., 5.5.1: rho d U / (2 m w) along the wind, half of it across) and the
series of its sine modes; the rest in the wind; the same small motion step by step; motion with all geometry, as what
moves goes to nothing.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg as linalg
import scipy.sparse as sparse
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.model.mean_speed import MeanSpeed
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import simulate
from ropewalk.solve.modal import ModalBasis, ModalStep
from ropewalk.solve.radau_iia import C as STAGES
from ropewalk.system.elements.air import damping_by_wind, stiffness_by_wind
from ropewalk.system.elements.structure import Buffers
from ropewalk.system.equilibrium.rest import _add_wind_forces
from ropewalk.system.equilibrium.still import SystemStatics

AIR, DRAG, MASS, PULL, LONG = 1.225, 0.03, 0.5, 2e3, 20.0
STRING: dict[str, Any] = {
    "start": [0, 0, 0], "end": [LONG, 0, 0], "mass": MASS, "wind_drag": DRAG, "length": LONG, "elements": 40,
    "end_support": {"kind": "guided", "along": [1, 0, 0], "force": PULL}, "axial_stiffness": 1e9,
}  # fmt: skip
ROPE: dict[str, Any] = {
    "start": [0, 0, 0], "end": [40, 0, 3], "length": 40.4, "mass": 0.8, "axial_stiffness": 5e5, "wind_drag": 0.04,
    "elements": 20,
}  # fmt: skip
ASKEW = {"direction": [0.8, 1.0, 0.2], "speed": 18.0}


def blown(
    line: dict[str, Any], wind: dict[str, Any], run: dict[str, Any], file: Path | None = None, **more: Any
) -> xr.Dataset:
    given = {"lines": {"line": line}, "wind": wind, "run": run, **more}
    return simulate(Scenario.model_validate(given), file=file)


def linear(until: float, every: float, **more: Any) -> dict[str, Any]:
    return {"kind": "linear", "until": until, "every": every, **more}


def moved(result: xr.Dataset, since: xr.Dataset | None = None) -> np.ndarray:
    position = result.position.values
    return np.asarray(position - (position[:1] if since is None else since.position.values))


@pytest.mark.parametrize("over", [False, True])
def test_what_wind_changes_by_is_the_difference_of_its_forces(over: bool) -> None:
    """With places, where lines sag and slope, and with velocities; next to a sheave, too."""
    line = {**ROPE, "sheaves": {"tower": {"at": [18.0, 2.0]}}} if over else ROPE
    scenario = Scenario.model_validate({"lines": {"line": line}, "wind": ASKEW, "run": {"kind": "equilibrium"}})
    still = SystemStatics(scenario, RunInfo(), 0.0, space=True)
    structure = still.potential.structure
    r = still.potential.put(still.at_rest_with_loads())[0].copy()
    buffers = Buffers.of(structure, 3)

    def force(r: np.ndarray, v: np.ndarray) -> np.ndarray:
        buffers.force[:] = 0.0
        _add_wind_forces(structure.for_kernels, buffers.for_kernels(structure), r, v, 0.0)
        return buffers.air.ravel().copy()

    rng, none = np.random.default_rng(2), np.zeros_like(r)
    way = rng.normal(size=r.shape)
    for matrix, step, change in (
        (stiffness_by_wind(structure, r, 0.0), 1e-6, lambda e: force(r + e * way, none)),
        (damping_by_wind(structure, r, 0.0), 1e-4, lambda e: force(r, e * way)),
    ):
        exact = -(change(step) - change(-step)) / (2.0 * step)
        assert matrix @ way.ravel() == pytest.approx(exact, abs=1e-7 * np.abs(exact).max())  # roundings


@pytest.mark.parametrize("uneven", [False, True])
@pytest.mark.parametrize("damping", ["none", "drag", "overdamped", "coupled"])
def test_modes_that_are_let_go_move_as_the_equations_of_motion_do(damping: str, uneven: bool) -> None:
    """Against the exponential of the first-order equations, with a stiffness that is not symmetric and a force."""
    rng = np.random.default_rng(1)
    n, h = 4, 0.7
    B, D, S = rng.normal(size=(3, n, n))
    K, M = B @ B.T + 3.0 * np.eye(n), np.diag(rng.uniform(1.0, 2.0, n))
    C = {"none": 0.0 * M, "drag": 0.3 * M, "overdamped": 9.0 * M, "coupled": D @ D.T}[damping]
    more, force, start = 0.2 * S if uneven else 0.0 * S, rng.normal(size=n), rng.normal(size=n)
    free = sparse.identity(n, format="csr")
    given = sparse.csc_matrix(more) if uneven else None
    modes = ModalBasis.of(*map(sparse.csc_matrix, (K, M, C)), free, uneven=given, begin=start)
    A = np.zeros((2 * n + 1, 2 * n + 1))
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n] = np.linalg.inv(M) @ np.hstack([-K - more, -C, force[:, None]])
    exact = linalg.expm(h * A) @ np.concatenate([start, np.zeros(n), [1.0]])
    assert (modes.shape @ modes.begin).real == pytest.approx(start, rel=1e-9)
    assert (modes.shape @ (modes.rate * modes.begin)).real == pytest.approx(np.zeros(n), abs=1e-9)
    step = ModalStep(modes.rate, h)
    z = step.decay[2] * modes.begin + sum(step.weight[2, k] * (force @ modes.driven) for k in range(STAGES.size))
    assert (modes.shape @ z).real == pytest.approx(exact[:n], rel=1e-9, abs=1e-11)  # roundings
    assert (modes.shape @ (modes.rate * z)).real == pytest.approx(exact[n : 2 * n], rel=1e-9, abs=1e-11)


def rise(t: np.ndarray, k: int, damping: float, begin: float = 0.0) -> np.ndarray:
    """Mode k of the string under a constant load from an instant on, over its deflection; damped by N s/m^2."""
    since, d = np.maximum(t - begin, 0.0), damping / (2.0 * MASS)
    nu = np.sqrt((k * np.pi / LONG) ** 2 * PULL / MASS - d**2)
    return 1.0 - np.exp(-d * since) * (np.cos(nu * since) + d / nu * np.sin(nu * since))


def in_side_wind(x: np.ndarray, t: np.ndarray, load: float, damping: float, begin: float = 0.0) -> np.ndarray:
    """Deflection (instant, place) in m under a load in N/m from an instant on: the series of sine modes."""
    found = np.zeros((t.size, x.size))
    for k in range(1, 400, 2):
        deep = 4.0 * load * LONG**2 / ((k * np.pi) ** 3 * PULL)
        found += deep * rise(t, k, damping, begin)[:, None] * np.sin(k * np.pi * x / LONG)
    return found


def first_sine(deflection: np.ndarray) -> np.ndarray:
    """Of a deflection (instant, node) of the string, m."""
    n = deflection.shape[1] - 1
    return np.asarray(2.0 / n * (deflection @ np.sin(np.pi * np.arange(n + 1) / n)))


def test_a_taut_string_in_a_side_wind_is_damped_as_holmes_says() -> None:
    """By rho d U per length along the wind, whose load sets in at once, and by half of it across, under a force."""
    U, missed = 4.0, []
    load = {"p": {"kind": "force", "on": "line", "force": [0, 0, -0.2], "travel": {"speed": 0.0, "from": 0.5 * LONG}}}
    for n in (20, 40, 80):
        wind = {"direction": [0, 1, 0], "speed": U}
        found = blown({**STRING, "elements": n}, wind, linear(4.0, 0.05), gravity=0.0, loads=load)
        x, t, own = found.position.values[0, :, 0], found.time.values, moved(found)
        exact = in_side_wind(x, t, 0.5 * AIR * DRAG * U**2, AIR * DRAG * U)
        aside = np.abs(first_sine(own[:, :, 1] - exact)).max() / exact.max()
        deep = -2.0 * 0.2 * LONG / (np.pi**2 * PULL)
        across = np.abs(first_sine(own[:, :, 2]) - deep * rise(t, 1, 0.5 * AIR * DRAG * U)).max() / abs(deep)
        missed.append((np.abs(own[:, :, 1] - exact).max() / exact.max(), aside, across))
    orders = np.log2(np.array(missed[1]) / missed[2])
    print("missed", missed, "orders", orders)
    assert max(missed[2]) < 1e-3
    assert max(missed[2][1:]) < 1.5e-4
    assert orders[1:] == pytest.approx([2.0, 2.0], abs=0.2)


@pytest.mark.parametrize("modes", [None, 6])
def test_a_gust_pushes_twice_as_much_as_its_part_of_the_mean_wind(modes: int | None) -> None:
    """F (1 + 2 u/U), by the series of the string: 3.5 m/s, and 4.5 m/s from the middle of the run on."""
    wind = {"direction": [0, 1, 0], "speed": {"time": [0.5, 0.5], "value": [3.5, 4.5]}}
    found = blown(STRING, wind, linear(1.0, 0.02, modes=modes), gravity=0.0)
    x, t, U = found.position.values[0, :, 0], found.time.values, 4.0
    F, c = 0.5 * AIR * DRAG * U**2, AIR * DRAG * U
    exact = in_side_wind(x, t, (1.0 - 2.0 * 0.5 / U) * F, c) + in_side_wind(x, t, 4.0 * 0.5 / U * F, c, 0.5)
    missed = np.abs(first_sine(moved(found)[:, :, 1] - exact)).max() / exact.max()
    print("missed", missed)
    assert found.attrs["doubts"] == ""
    assert missed < 3e-4  # the mesh


def test_what_gusts_do_to_what_no_mode_has_is_their_slow_effect() -> None:
    """Speeds that rise slowly, with two modes and with all: they lean as a parabola does."""
    wind = {"direction": [0, 1, 0], "speed": {"time": [0.0, 40.0], "value": [3.6, 4.4]}}
    few, whole = (
        moved(blown({**STRING, "drag": 1.0}, wind, linear(40.0, 4.0, modes=m), gravity=0.0))[-3:, :, 1]
        for m in (2, None)
    )
    change = np.ptp(whole, axis=0).max()
    assert np.abs((few - few[:1]) - (whole - whole[:1])).max() < 1e-4 * change
    assert np.abs(few - whole).max() > 1e-3 * change  # the mean wind itself is in what begins with them


def test_motion_ends_in_the_rest_in_the_wind() -> None:
    """Places, tensions and forces of supports of an equilibrium, and the wind in what these bear."""
    for line in (ROPE, {**ROPE, "law": {"kind": "inextensible"}, "axial_stiffness": None}):
        swung = blown({**line, "drag": 4.0}, ASKEW, linear(60.0, 10.0))
        still = blown(line, ASKEW, {"kind": "equilibrium"})
        assert swung.position.values[-1] == pytest.approx(still.position.values[0], abs=1e-6)
        assert np.abs(swung.position.values[0] - still.position.values[0]).max() > 0.5
        assert swung.tension.values[-1] == pytest.approx(still.tension.values[0], rel=1e-4)
        assert swung.reaction.values[-1] == pytest.approx(still.reaction.values[0], rel=1e-4, abs=1e-3)


STEPS = {"kind": "dynamic", "geometry": "linearised", "until": 0.8, "every": 0.02, "step": 2e-5}
LIGHT: dict[str, dict[str, Any]] = {
    "force": {"kind": "force", "force": [0, 0, -0.05]}, "mass": {"kind": "mass", "mass": 0.05},
}  # fmt: skip


def under(kind: str, speed: Any, run: dict[str, Any]) -> xr.Dataset:
    """The string under a light load, in wind of a speed."""
    loads = {"a": {**LIGHT[kind], "on": "line", "travel": {"speed": 15.0, "from": 1.0}}}
    line = {**STRING, "axial_stiffness": 1e6, "elements": 20}
    return blown(line, {"direction": [0, 1, 0.1], "speed": speed}, run, loads=loads, gravity=1.0)


@pytest.mark.parametrize("kind", LIGHT)
def test_it_is_what_steps_of_small_motion_find_in_a_light_wind(kind: str) -> None:
    """Steps by geometry: linearised about the rest in calm air, and drag as it is: squares apart in the speed."""
    apart = []
    for U in (4.0, 2.0):
        one, other = (under(kind, U, run) for run in (linear(0.8, 0.02), STEPS))
        across = (one.position.values - other.position.values)[:, :, 1:]
        apart.append(np.abs(across).max() / np.abs(moved(other)[:, :, 1]).max())
    print("apart", apart)
    assert apart[1] < 5e-5
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.3)


def test_wind_does_not_shift_what_friction_holds_on_a_saddle() -> None:
    """As in steps; where it slips there until it rests in the wind, it is off by a quarter of the deflection."""
    line = {**STRING, "length": 19.95, "axial_stiffness": 1e6, "end_support": {"kind": "fixed"}}
    line |= {"saddles": {"tower": {"at": [12.0, 0.0, 0.5], "radius": 2.0, "friction": 0.1}}}
    wind = {"direction": [0, 1, 0], "speed": 4.0}
    one, other = (blown(line, wind, run) for run in (linear(0.4, 0.02), {**STEPS, "until": 0.4}))
    missed = np.abs(one.position.values - other.position.values).max() / np.abs(moved(other)).max()
    print("missed", missed)
    assert missed < 1e-3  # squares of the speed


@pytest.mark.parametrize("kind", LIGHT)
def test_what_gusts_change_is_what_steps_of_small_motion_find(kind: str) -> None:
    """Half of what gusts of +30 and -30 % differ by, in which their squares are not; with jumps, in a light wind."""

    def change(key: str, run: dict[str, Any]) -> np.ndarray:
        one, other = (
            under(kind, {"time": [0.0, 0.41, 0.41, 0.8], "value": [2.0 * (1 + part * u) for u in (-1, 1, -1, 1)]}, run)
            for part in (0.3, -0.3)
        )
        return np.asarray(0.5 * (one[key].values - other[key].values)[..., 1:])

    for key in ("position", "velocity", "reaction"):
        by_modes, steps = (change(key, run) for run in (linear(0.8, 0.02), STEPS))
        missed = np.abs(by_modes - steps).max() / np.abs(steps).max()
        print(key, missed)
        assert missed < 8e-3  # gusts damp more and less, by the speed of the string over that of the wind


@pytest.mark.parametrize("speed", [18.0, 9.0])
def test_with_all_geometry_it_comes_out_as_loads_go_to_nothing(speed: float, tmp_path: Path) -> None:
    """What a force does to a rope that rests in a wind askew: under a fourth of it, linear theory misses a fourth part.

    Did it not know that lines turn in the wind, it would miss 1.6 and 3.2 % of each.
    """
    wind, file, missed = {**ASKEW, "speed": speed}, tmp_path / "rest.nc", []
    blown({**ROPE, "drag": 4.0}, wind, {"kind": "dynamic", "until": 20.0, "every": 20.0}, file)
    alone = blown(ROPE, wind, linear(3.0, 0.1))
    start = {"kind": "result", "file": str(file)}
    for size in (0.1, 0.025):
        push = {"kind": "force", "on": "line", "force": [0.0, 4.0 * size, -8.0 * size]}
        loads = {"p": {**push, "travel": {"speed": 6.0, "from": 10.0}}}
        by_modes = moved(blown(ROPE, wind, linear(3.0, 0.1), loads=loads), alone)
        run = {"kind": "dynamic", "until": 3.0, "every": 0.1, "start": start, "step": 2e-4}
        steps = moved(blown(ROPE, wind, run, loads=loads))
        missed.append(np.abs(by_modes - steps).max() / np.abs(steps).max())
    print("missed", missed)
    assert missed[1] < 4e-3
    assert missed[0] / missed[1] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("speed", [12.0, 30.0])
def test_it_is_doubted_where_wind_leans_lines_far(speed: float) -> None:
    """A rope that turns about its supports in a side wind, to half a right angle and more in the stronger one."""
    found = blown(ROPE, {"direction": [0, 1, 0], "speed": speed}, linear(0.5, 0.1))
    assert ("the mean wind moves lines by up to" in found.attrs["doubts"]) == (speed == 30.0)


def test_a_mean_speed_is_that_of_its_table() -> None:
    """By hand; jumps, ramps, and constants beyond the table."""
    table = {"time": [1.0, 2.0, 2.0, 9.0], "value": [2.0, 4.0, 10.0, 3.0]}
    wind = {"direction": [0, 1, 0], "speed": table}
    given = {"lines": {"line": STRING}, "wind": wind, "run": {"kind": "dynamic", "until": 4.0}}
    speed = Scenario.model_validate(given).wind.speed
    assert MeanSpeed.of(speed, 4.0).mean == pytest.approx((2.0 + 3.0 + 2 * 9.0) / 4.0)
    assert MeanSpeed.of(speed, 4.0).most == pytest.approx(10.0 - 5.75)
    assert MeanSpeed.of(lambda t: 3.0 + t, 2.0) == pytest.approx((4.0, 1.0 / np.sqrt(3.0), 1.0), rel=1e-4)
    assert MeanSpeed.of(7.0, 2.0) == (7.0, 0.0, 0.0)


def test_gusts_without_a_mean_wind_are_refused_and_strong_ones_doubted() -> None:
    gusty = {"direction": [0, 1, 0], "speed": {"time": [0.0, 1.0], "value": [-5.0, 6.0]}}
    with pytest.raises(ValueError, match=r"linear only about a mean wind that is stronger; give the wind a larger"):
        blown(STRING, gusty, linear(1.0, 0.1))
    strong = {"direction": [0, 1, 0], "speed": {"time": [0.0, 1.0], "value": [2.0, 8.0]}}
    found = blown(STRING, strong, linear(1.0, 0.1), gravity=0.0)
    assert "gusts change the wind by up to 3 m/s about its mean of 5 m/s" in found.attrs["doubts"]
