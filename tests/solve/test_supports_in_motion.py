"""Supports in motion: springs, dashpots, masses and rails at the ends of a line, and ends that move as prescribed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from motion_cases import order
from ropewalk.capabilities import ROPES, SUPERPOSED, SYSTEM, engine_of
from ropewalk.chains.spectrum import state_at
from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import ChainState
from ropewalk.model import (
    DisplacementTable,
    Dynamic,
    Elastic,
    Equilibrium,
    Guided,
    Line,
    Moving,
    MovingForce,
    Scenario,
    Start,
    Travel,
)
from ropewalk.model.run import Linear
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.solve.choice import bounds, choose
from ropewalk.solve.motion import Progress, move
from ropewalk.solve.splitting import RUNNING
from ropewalk.solve.start import PreparedRun, setting_of, start_state

# A string of unit span, tension 1 N and 1 kg/m; small motions across are those of a linear string in the material
# coordinate, with the wave speed C, the length LENGTH and the tension 1/LAM.
LAM = 1.001
LENGTH, C = 1.0 / LAM, np.sqrt(1.0 / LAM)
SMALL = 1e-6  # m: nonlinear terms are below 1e-9 of what is looked at
UP = (0.0, 1.0)


def string(elements: int, **changed: Any) -> Line:
    given = {"start": (0.0, 0.0), "end": (1.0, 0.0), "length": LENGTH, "mass": 1.0, "axial_stiffness": 1e3}
    return Line(**(given | {"elements": elements} | changed))


def rope(elements: int = 40, **changed: Any) -> Line:
    """A rope with a prestrain of 2 %."""
    given = {"start": (0.0, 0.0), "end": (19.5, 0.0), "length": 19.1, "mass": 1.0, "axial_stiffness": 2e4}
    return Line(**(given | {"elements": elements} | changed))


def scenario(line: Line, *loads: MovingForce, until: float, gravity: float = 0.0, **run: Any) -> Scenario:
    on = {f"load {k}": one for k, one in enumerate(loads)}
    return Scenario(gravity=gravity, lines={"rope": line}, loads=on, run=Dynamic(until=until, **run))


def force(size: float, xi: float, speed: float = 0.0, **travel: Any) -> MovingForce:
    travel = {"speed": speed, "measured": "material", "from": xi, **travel}
    return MovingForce(on="rope", force=(0.0, -size), travel=Travel.model_validate(travel))


def ready(line: Line, gravity: float = 0.0) -> tuple[PreparedRun, ChainState]:
    setting = setting_of(scenario(line, until=1.0, gravity=gravity), 100.0)
    return setting, start_state(setting, False)


def moved(
    setting: PreparedRun, state: ChainState, times: np.ndarray, method: str = "rkn6", step: float | None = None
) -> list:
    """Copies of the state at the times."""
    choice = choose(
        setting.strands, setting.loads, state, method=method, step=step, accuracy=1e-9, duration=float(times[-1]),
        supports=setting.supports,
    )  # fmt: skip
    assert choice.method == method
    progress = Progress()
    steps = move(setting.strands, setting.loads, state, choice, 1e-9, times, progress, setting.supports)
    out = [now.copy() for now in steps]
    assert progress.status == RUNNING
    return out


def table(function: Any, until: float, entries: int = 150) -> DisplacementTable:
    time = np.linspace(0.0, until, entries)
    return DisplacementTable(time=tuple(time), value=tuple(function(t) for t in time))


# -- One mass ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("damping", [0.0, (60.0, 300.0), 1e5])
def test_a_mass_on_springs_answers_a_ramp_as_an_oscillator(damping: Any) -> None:
    """m x'' + c (x' - u') + k (x - u) = 0 in each direction; the slack line weighs nothing."""
    line = rope(
        4, length=25.0, mass=1e-7, axial_stiffness=1e-4,
        end_support=Elastic(
            stiffness=(1000.0, 4000.0), damping=damping, mass=10.0,
            displacement=DisplacementTable(time=(0.1, 0.6), value=((0.0, 0.0), (0.3, -0.2))),
        ),
    )  # fmt: skip
    result = simulate(scenario(line, until=1.5, every=0.05, gravity=9.81, method="verlet", step=1e-3))
    both = damping if isinstance(damping, tuple) else (damping, damping)
    for axis, (k, c, size) in enumerate(zip((1000.0, 4000.0), both, (0.3, -0.2), strict=True)):
        u = lambda t, size=size: size * np.clip((t - 0.1) / 0.5, 0.0, 1.0)  # noqa: E731
        rate = lambda t, size=size: 2.0 * size * (0.1 <= t < 0.6)  # noqa: E731
        exact = solve_ivp(
            lambda t, y, k=k, c=c, u=u, rate=rate: (y[1], (k * (u(t) - y[0]) + c * (rate(t) - y[1])) / 10.0),
            (0.0, 1.5), (0.0, 0.0), t_eval=result.time.values, method="Radau", rtol=1e-8, atol=1e-10, max_step=0.01,
        )  # fmt: skip
        x = result.position.values[:, -1, axis] - result.position.values[0, -1, axis]
        # (omega dt)^2 / 24 of 0.3 m; the strong dashpot lets the mass lag by m u'/c = 6e-5 m within less than a step
        assert x == pytest.approx(exact.y[0], abs=1e-4 if c == 1e5 else 2e-5)
        # At a corner under the strong dashpot the velocity jumps within 1e-3 s: not looked at there.
        calm = np.abs(result.time.values[:, None] - [0.1, 0.6]).min(axis=1) > 0.01
        assert result.velocity.values[calm, -1, axis] == pytest.approx(exact.y[1][calm], abs=5e-4)


def test_the_reaction_of_a_support_without_mass_is_spring_and_dashpot() -> None:
    line = rope(
        end_support=Elastic(stiffness=2e4, damping=100.0), start_support=Guided(along=(1.0, 1.0), stiffness=3e4)
    )
    result = simulate(
        scenario(line, force(500.0, 3.0), until=0.5, every=0.01, gravity=9.81, method="verlet", step=1e-4)
    )
    r, w, R = result.position.values, result.velocity.values, result.reaction.values
    far = -2e4 * (r[:, -1] - [19.5, 0.0]) - 100.0 * w[:, -1]
    assert np.abs(w[:, -1]).max() > 0.1
    assert R[:, 1] == pytest.approx(far, abs=1e-9 * np.abs(far).max())
    along = np.array([1.0, 1.0]) / np.sqrt(2.0)
    assert R[:, 0] @ along == pytest.approx(-3e4 * (r[:, 0] @ along), abs=1e-9 * np.abs(R).max())
    assert r[:, 0, 0] == pytest.approx(r[:, 0, 1], abs=1e-12)  # it stays on its rail


@pytest.mark.parametrize("size", [1e3, 1e6, 1e10])
def test_dashpots_of_any_size_are_stable_at_the_step_without_them(size: float) -> None:
    line = rope(20, end_support=Elastic(stiffness=1e4, damping=size, mass=0.1))
    result = simulate(scenario(line, force(300.0, 5.0), until=3.0, every=0.05, gravity=9.81, method="verlet"))
    bare = simulate(scenario(rope(20, end_support=Elastic(stiffness=1e4, mass=0.1)), until=0.1, gravity=9.81))
    assert result.attrs["outcome"] == "completed"
    assert result.attrs["step"] > 0.4 * bare.attrs["step"]  # Verlet's step over that of the sixth order
    energy = result.energy.sel(form=["kinetic", "elastic"]).sum("form").values
    assert np.all(np.isfinite(energy))
    assert energy[-20:].max() < 1.05 * energy[:40].max()
    if size == 1e10:
        assert np.ptp(result.position.values[:, -1], axis=0) == pytest.approx(0.0, abs=1e-6)


# -- Strings -------------------------------------------------------------------------------------------------------


def _eigenvalue(k: float, mass: float, number: int) -> float:
    """The kappa for which sin(kappa x) fits a spring and a mass at LENGTH: tan = - P kappa / (k - m c^2 kappa^2)."""
    P = 1.0 / LAM
    gap = lambda q: P * q * np.cos(q * LENGTH) + (k - mass * C * C * q * q) * np.sin(q * LENGTH)  # noqa: E731
    grid = np.linspace(1e-3, 20.0, 4001)
    signs = np.flatnonzero(np.diff(np.sign([gap(q) for q in grid])))
    return float(brentq(gap, grid[signs[number]], grid[signs[number] + 1]))


@pytest.mark.parametrize(("k", "mass"), [(0.0, 0.0), (3.0, 0.0), (0.0, 0.4), (5.0, 0.3)])
@pytest.mark.parametrize("number", [0, 2])
def test_a_string_on_a_spring_swings_as_the_transcendental_equation_says(k: float, mass: float, number: int) -> None:
    kappa = _eigenvalue(k, mass, number)
    setting, state = ready(string(100, end_support=Guided(along=UP, stiffness=k, mass=mass)))
    shape = SMALL * np.sin(kappa * state.X)
    state.r[1] = shape
    times = np.linspace(0.1, 1.0, 7) * 2.0 * np.pi / (kappa * C)
    for now in moved(setting, state, times):
        # Chains are slow by (kappa h)^2 / 24, 2e-4 of a period here: 1e-3 after one.
        assert now.r[1] == pytest.approx(shape * np.cos(kappa * C * now.t[0]), abs=2e-3 * SMALL)


@pytest.mark.parametrize("part", [0.0, 0.5, 1.0, 3.0])
def test_a_dashpot_reflects_by_its_impedance(part: float) -> None:
    """Amplitude (Z - c)/(Z + c) with Z = sqrt(P rho): nothing comes back from c = Z."""
    impedance = np.sqrt(1.0 / LAM)
    setting, state = ready(string(400, end_support=Guided(along=UP, damping=part * impedance)))
    x = state.X
    pulse = lambda s: SMALL * np.exp(-(((s - 0.5) / 0.06) ** 2))  # noqa: E731
    state.r[1] = pulse(x)
    state.w[1] = C * 2.0 * (x - 0.5) / 0.06**2 * pulse(x)  # -c u': all of it runs ahead
    # A fourth of the largest step: steps that miss 1e-9 m over all would be nine million.
    after = moved(setting, state, np.array([LENGTH / C]), "verlet" if part else "rkn6", 2e-5 if part else None)[0]
    reflected = (1.0 - part) / (1.0 + part) * pulse(2.0 * LENGTH - (x + LENGTH))
    # What is left is the dispersion of the chain, (h / width)^2; nothing comes back from c = Z but 1e-4.
    assert after.r[1] == pytest.approx(reflected, abs=(2e-4 if part == 1.0 else 6e-3) * SMALL)


def test_an_end_that_moves_sends_a_wave_of_d_alembert() -> None:
    rise = lambda t: SMALL * np.sin(np.pi * min(t / 0.4, 1.0)) ** 2  # noqa: E731
    line = string(400, start_support=Moving(displacement=lambda t: (0.0, rise(t))))
    for until in (0.3, 0.85):
        at = state_at(scenario(line, until=until, method="verlet"), until)[1]
        exact = [rise(max(until - xi / C, 0.0)) for xi in at.X]
        assert at.r[1] == pytest.approx(np.array(exact), abs=4e-3 * SMALL)  # dispersion, h^2
        assert at.r[1, 0] == pytest.approx(rise(until), abs=1e-5 * SMALL)  # as exact as the callable's table
        assert at.w[1, 0] == pytest.approx((rise(until) - rise(until - 1e-7)) / 1e-7, abs=0.02 * SMALL)


@pytest.mark.parametrize("kind", ["elastic", "guided", "moving"])
def test_three_dimensions_are_the_plane_turned(kind: str) -> None:
    """The same motion in the vertical plane at 30 degrees to x."""
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turned = lambda v: (c * v[0], s * v[0], v[1])  # noqa: E731
    history = DisplacementTable(time=(0.0, 0.1, 0.3), value=((0.0, 0.0), (0.1, 0.05), (0.02, 0.2)))
    inside = DisplacementTable(time=history.time, value=tuple(turned(v) for v in history.value))
    plane = {
        "elastic": Elastic(stiffness=1e4, damping=30.0, mass=2.0, displacement=history),
        "guided": Guided(along=(1.0, 0.3), stiffness=1e4, damping=30.0, mass=2.0, force=50.0),
        "moving": Moving(displacement=history),
    }[kind]
    space = {
        "elastic": Elastic(stiffness=1e4, damping=30.0, mass=2.0, displacement=inside),
        "guided": Guided(along=turned((1.0, 0.3)), stiffness=1e4, damping=30.0, mass=2.0, force=50.0),
        "moving": Moving(displacement=inside),
    }[kind]
    run = {"until": 0.4, "every": 0.1, "gravity": 9.81, "method": "verlet"}
    flat = simulate(scenario(rope(20, end_support=plane, drag=0.3), force(300.0, 18.8, 2.0, at_end="stay"), **run))
    line = rope(20, end=turned((19.5, 0.0)), end_support=space, drag=0.3)
    full = simulate(scenario(line, force(300.0, 18.8, 2.0, at_end="stay"), **run))
    for name in ("position", "reaction"):
        values = flat[name].values
        wanted = np.stack([c * values[..., 0], s * values[..., 0], values[..., 1]], axis=-1)
        assert full[name].values == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    assert full.energy.values == pytest.approx(flat.energy.values, abs=1e-8 * np.abs(flat.energy.values).max())


# -- Limits --------------------------------------------------------------------------------------------------------


def _end(**support: Any) -> np.ndarray:
    line = rope(20, **support)
    return state_at(scenario(line, force(500.0, 2.0, 20.0), until=0.4, method="rkn6", accuracy=1e-6), 0.4)[1].r


def test_stiff_springs_and_heavy_masses_are_fixed_supports_in_the_limit() -> None:
    fixed = _end()
    springs = [np.abs(_end(end_support=Elastic(stiffness=k)) - fixed).max() for k in (1e7, 1e8)]
    assert springs[0] / springs[1] == pytest.approx(10.0, rel=0.2)
    masses = [np.abs(_end(end_support=Guided(along=UP, mass=m)) - fixed).max() for m in (1e4, 1e5)]
    assert masses[0] / masses[1] == pytest.approx(10.0, rel=0.2)


@pytest.mark.parametrize("xi", [5.73, 18.97, 19.1])
def test_a_damped_motion_comes_to_rest_where_statics_says(xi: float) -> None:
    """Also with the load on the last half link, and on the support itself."""
    line = rope(
        20, drag=3.0, axial_damping=60.0,
        start_support=Guided(along=(1.0, 0.2), stiffness=5e3, damping=500.0, mass=4.0, force=-200.0),
        end_support=Elastic(stiffness=(3e4, 1e4), damping=300.0, mass=5.0, displacement=(0.1, 0.05)),
    )  # fmt: skip
    load = force(400.0, xi, 0.0, at_end="stay")
    motion = scenario(line, load, until=12.0, every=4.0, gravity=9.81, method="verlet")
    last = simulate(motion).isel(time=-1)
    rest = simulate(motion.model_copy(update={"run": Equilibrium()})).isel(load_path=0)
    # In motion a load on the last half link is shared by its nodes, at rest it bends the link: that takes up slack.
    near = {5.73: 1e-7, 18.97: 3e-2, 19.1: 1e-7}[xi]
    assert last.position.values == pytest.approx(rest.position.values, abs=near)
    assert last.reaction.values == pytest.approx(rest.reaction.values, abs=2e3 * near)
    begun = motion.model_copy(update={"run": Dynamic(until=0.05, start=Start(with_loads=True), method="verlet")})
    first = simulate(begun)
    assert np.abs(first.velocity.values).max() < 1e-6  # what begins with its loads stays
    assert first.position.values[0] == pytest.approx(last.position.values, abs=1e-5)


def test_a_load_of_no_force_does_not_stir_the_end_beside_it() -> None:
    """It rides with the first node, so that the end carries half of a link that is shorter than the others."""
    line = rope(16, start_support=Elastic(stiffness=1e3))
    result = simulate(scenario(line, force(0.0, 0.6 * 19.1 / 16), until=0.5, gravity=9.81, method="rkn6"))
    assert np.abs(result.velocity.values).max() < 1e-9  # rounding
    assert result.reaction.values[-1, 0] == pytest.approx(-1e3 * result.position.values[-1, 0], rel=1e-9)


def test_a_counterweight_keeps_the_tension_of_a_line_that_is_crossed_slowly() -> None:
    line = rope(30, axial_damping=100.0, drag=1.0, end_support=Guided(along=(1.0, 0.0), force=2000.0, damping=300.0))
    load = force(300.0, 0.0, 1.9)
    result = simulate(scenario(line, load, until=10.0, every=0.05, gravity=9.81, method="verlet"))
    late = result.isel(time=slice(40, None))
    assert late.reaction.values[:, 1, 0] == pytest.approx(np.full(late.sizes["time"], 2000.0), rel=0.02)
    drawn_in = result.position.values[:, -1, 0] - result.position.values[0, -1, 0]
    assert drawn_in.min() < -0.05


# -- Accounts ------------------------------------------------------------------------------------------------------

_PATH = table(
    lambda t: (0.02 * np.sin(9.0 * t), 0.05 * (1.0 - np.cos(7.0 * t))), 0.5, 24
)  # corners are no instants of output


def _supports(dashpots: float) -> dict[str, Any]:
    return {
        "start_support": Elastic(
            stiffness=(2e4, 8e3), damping=(0.6 * dashpots, dashpots), mass=0.3, displacement=_PATH
        ),
        "end_support": Guided(along=(1.0, 0.4), stiffness=4e3, damping=dashpots, mass=0.5, force=60.0),
    }


_CASES = {
    "springs": ("rkn6", _supports(0.0)),
    "dashpots": ("verlet", _supports(80.0)),
    "an end that moves": ("rkn6", {"start_support": Moving(displacement=_PATH)}),
    "an end that moves, damped": ("verlet", {"start_support": Moving(displacement=_PATH), "axial_damping": 60.0}),
    "drag": ("verlet", _supports(80.0) | {"drag": 2.0}),
    "an end that moves in drag": ("verlet", {"start_support": Moving(displacement=_PATH), "drag": 2.0}),
    "all": ("verlet", _supports(80.0) | {"drag": 2.0, "axial_damping": 60.0}),
}


@pytest.mark.parametrize("case", _CASES)
def test_the_audit_closes_at_the_order_of_the_method(case: str) -> None:
    """One load stands on the last half link, shared with the support (but where drag is: it is counted without it)."""
    method, changed = _CASES[case]
    loads = [] if changed.get("drag") else [force(40.0, 18.9)]
    steps, misses = ([5e-3, 2.5e-3] if method == "rkn6" else [1e-3, 5e-4]), []
    for step in steps:
        motion = scenario(rope(16, **changed), *loads, until=0.5, every=0.02, gravity=9.81, method=method, step=step)
        energy = simulate(motion).energy
        misses.append(float(np.abs(energy.sel(form="imbalance")).max() / np.abs(energy - energy[0]).max()))
    assert misses[-1] < (1e-7 if method == "rkn6" else 1e-3)
    # The work of a force is found to the fourth order by the sixth-order method.
    assert order(steps, misses) > (3.8 if method == "rkn6" else 1.9)


@pytest.mark.parametrize("case", _CASES)
def test_methods_keep_their_order(case: str) -> None:
    """Also while a load rides from an end that yields or moves."""
    method, changed = _CASES[case]
    half = 0.5 * 19.1 / 16 / 10.0  # seats change at odd multiples of it
    until = 7 * half

    def end(name: str, parts: float) -> np.ndarray:
        line = rope(16, **changed)
        if case.startswith("an end that moves") or method == "rkn6":  # few corners, one of them between seats
            path = DisplacementTable(time=(0.0, 2.43 * half, until), value=((0.0, 0.0), (0.02, 0.05), (0.01, -0.02)))
            line = line.model_copy(
                update={"start_support": line.start_support.model_copy(update={"displacement": path})}
            )
        run = {"until": until, "gravity": 9.81, "method": name, "step": half / parts}
        return state_at(scenario(line, force(300.0, 0.0, 10.0), **run), until)[1].r

    parts = [32, 64, 128] if method == "verlet" else [7, 9, 12]
    reference = end(method, 1024 if method == "verlet" else 60)
    errors = [float(np.abs(end(method, n) - reference).max()) for n in parts]
    wanted = 2.0 if method == "verlet" else 6.0
    assert order([1.0 / n for n in parts], errors) == pytest.approx(wanted, abs=0.1 if wanted == 2.0 else 0.9)


@pytest.mark.parametrize("case", ["springs", "dashpots", "drag", "an end that moves in drag"])
def test_reactions_weight_and_contacts_are_the_rate_of_momentum_of_the_line(case: str) -> None:
    changed = _CASES[case][1]
    line = rope(16, **changed)
    # Corners are blows, which no reaction shows: one velocity for all time.
    path = DisplacementTable(time=(0.0, 0.5), value=((0.0, 0.0), (0.1, 0.4)))
    line = line.model_copy(update={"start_support": line.start_support.model_copy(update={"displacement": path})})
    every = 2e-4
    result = simulate(scenario(line, force(40.0, 18.9), until=0.2, every=every, gravity=9.81, method="verlet"))
    share = np.full(17, 19.1 / 16)
    share[[0, -1]] *= 0.5
    momentum = np.einsum("tna,n->ta", result.velocity.values, share)
    forces = result.reaction.values.sum(axis=1) + result.contact_force.values.sum(axis=1)
    forces = forces + 19.1 * np.array([0.0, -9.81]) - line.drag * momentum
    gained = momentum[2:] - momentum[:-2]
    given = every * (forces[2:] + 4.0 * forces[1:-1] + forces[:-2]) / 3.0  # Simpson
    size = np.abs(given).max()
    assert gained == pytest.approx(given, abs=1e-4 * size)


def test_a_corner_is_a_blow_of_the_support() -> None:
    """The half link that an end carries takes the velocity of the table at once, and the audit knows it."""
    path = DisplacementTable(time=(0.105, 0.4), value=((0.0, 0.0), (0.0, 1.0)))
    line = rope(4, start_support=Moving(displacement=path))
    result = simulate(scenario(line, until=0.3, every=0.01, gravity=9.81, method="rkn6", step=5e-3))
    energy = result.energy
    assert float(np.abs(energy.sel(form="imbalance")).max()) < 1e-6 * float(energy.sel(form="support_work")[-1])
    blow = 0.5 * 0.5 * 19.1 / 4 * (1.0 / 0.295) ** 2
    assert blow > 1e-2 * float(energy.sel(form="support_work")[-1])  # it is no small part


# -- Choice, start and what is refused -----------------------------------------------------------------------------


@settings(max_examples=25, deadline=None)
@given(
    k=st.floats(1.0, 1e7),
    mass=st.integers(0, 100).map(lambda m: 0.1 * m),
    links=st.integers(1, 12),
    xi=st.floats(0.0, 1.0),
)
def test_the_bound_of_the_spectrum_holds_and_is_not_far_off(k: float, mass: float, links: int, xi: float) -> None:
    setting, state = ready(rope(links, end_support=Elastic(stiffness=k, mass=mass)))
    X = state.X.copy()
    moving_with = links > 1 and xi > 0.0
    if moving_with:  # a load in the last seat but one, as close to the end as it may come
        X[-2] += (xi - 0.5) * 19.1 / links
    ell, EA = np.diff(X), 2e4
    K, m = np.zeros((links + 1, links + 1)), np.full(links + 1, 19.1 / links)
    for i, length in enumerate(ell):
        K[i : i + 2, i : i + 2] += EA / length * np.array([[1.0, -1.0], [-1.0, 1.0]])
    K[-1, -1] += k
    m[-1] = 0.5 * m[-1] + mass
    true = np.sqrt(np.linalg.eigvalsh((K / np.sqrt(np.outer(m, m)))[1:, 1:])[-1])
    bound = bounds(setting.strands, state.r, state.X, moving_with, setting.supports).frequency
    assert true <= bound * (1.0 + 1e-9)
    assert bound < 2.0 * true or links < 4


@pytest.mark.parametrize(
    ("support", "damping", "method", "why"),
    [
        (Guided(along=UP, stiffness=10.0), 0.0, "rkn6", "undamped"),
        (Guided(along=UP, stiffness=10.0, damping=1.0), 0.0, "verlet", "dampers at supports"),
        (Guided(along=UP, stiffness=10.0), 1e6, "verlet", "required for a support that yields or moves"),
        (Moving(displacement=_PATH), 1e6, "verlet", "required for a support that yields or moves"),
    ],
)
def test_auto_takes_an_explicit_method_and_says_why(support: Any, damping: float, method: str, why: str) -> None:
    setting, state = ready(rope(200, end_support=support, axial_damping=damping))
    choice = choose(
        setting.strands, setting.loads, state, method="auto", step=None, accuracy=1e-3, duration=10.0,
        supports=setting.supports,
    )  # fmt: skip
    assert choice.method == method
    assert why in choice.reason


@pytest.mark.parametrize(
    "support", [Elastic(stiffness=1e4), Guided(along=UP, stiffness=10.0), Moving(displacement=_PATH)]
)
def test_what_does_not_know_them_refuses_them(support: Any) -> None:
    line = rope(20, end_support=support, axial_damping=50.0)
    asked = scenario(line, until=0.1, method="implicit")
    refused = "implicit with a support that yields or moves is not implemented"
    assert any(refused in found.wrong for found in ROPES.motion.unsupported(asked.parts))
    assert engine_of(asked) is SYSTEM  # which knows them
    if isinstance(support, Moving):
        with pytest.raises(ValueError, match="a support that yields or moves is not implemented for kind: linear"):
            Scenario(lines={"rope": line}, run=Linear(until=0.1))
    else:  # modes of the system have them
        assert engine_of(Scenario(lines={"rope": line}, run=Linear(until=0.1))) is SUPERPOSED
    # The spectrum does: inner nodes out of the plane, too, and an end that yields in its directions.
    moves = {"elastic": 3, "guided": 1, "moving": 0}[support.kind]
    assert spectrum_of(scenario(line, until=0.1)).unknowns == 2 * (3 * 19 + moves)


def test_a_motion_is_taken_up_with_the_velocities_of_its_ends(tmp_path: Path) -> None:
    file, slider = tmp_path / "first.nc", Guided(along=UP, stiffness=500.0, mass=3.0)
    shaken = DisplacementTable(time=(0.0, 0.05, 0.1), value=((0.0, 0.0), (0.1, 0.4), (0.0, 0.0)))
    spring = Elastic(stiffness=(2e4, 900.0), mass=2.0)
    calm = rope(16, start_support=slider, end_support=spring)
    line = rope(16, start_support=slider, end_support=spring.model_copy(update={"displacement": shaken}))
    run = {"every": 0.05, "gravity": 9.81, "method": "rkn6", "step": 2e-3}
    stored = simulate(scenario(line, until=0.2, **run), file=file)
    assert np.abs(stored.velocity.values[-1, [0, -1]]).max(axis=1).min() > 0.05
    again = simulate(scenario(calm, until=0.1, start=Start(kind="result", file=str(file)), **run))
    whole = simulate(scenario(line, until=0.3, **run))
    assert whole.position.values[-1] == pytest.approx(again.position.values[-1], abs=1e-9)
    assert whole.velocity.values[-1] == pytest.approx(again.velocity.values[-1], abs=1e-7)


def test_a_motion_is_not_taken_up_where_a_moving_support_is_elsewhere(tmp_path: Path) -> None:
    file = tmp_path / "first.nc"
    line = rope(8, end_support=Moving(displacement=DisplacementTable(time=(0.0, 0.1), value=((0.0, 0.0), (0.2, 0.0)))))
    simulate(scenario(line, until=0.1, gravity=9.81), file=file)
    with pytest.raises(RopewalkError, match=r"end_support stands 0\.2 m elsewhere"):
        simulate(scenario(line, until=0.1, gravity=9.81, start=Start(kind="result", file=str(file))))
