"""Linearised motion by steps over sheaves and saddles.

Sources: the same by modes (kind: linear); the same with all geometry under a small load; derivatives of its energy;
strings that end where friction holds them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as linalg

from motion_cases import order
from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import spectrum_of
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.elements.sheaves import LITTLE
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import LoadedStructure
from system_cases import changes, frames_of, imbalance, superposed, with_steps_of

TAUT = {"start": [0, 0], "end": [20, 0], "length": 19.95, "mass": 1.0, "axial_stiffness": 1e5, "elements": 40}
OVER = {"at": [12.0, 1.0]}
SHOE = {"at": [12.0, 0.5], "radius": 2.0}
YIELDING = {"kind": "elastic", "stiffness": [2e4, 1e5], "damping": 50.0, "mass": 2.0}
BLOCK = {"kind": "elastic", "stiffness": 5e4, "mass": 2.0}
LINES: dict[str, dict[str, Any]] = {
    "sheave": {**TAUT, "sheaves": {"tower": OVER}},
    "sheave that holds": {**TAUT, "sheaves": {"tower": {**OVER, "friction": 0.3}}},
    "both": {**TAUT, "length": 19.9,
             "sheaves": {"one": {"at": [8.0, 0.6], "friction": 0.3}, "other": {"at": [14.0, 0.6]}}},
    "damped": {**TAUT, "axial_damping": 400.0, "sheaves": {"tower": OVER}},
    "saddle": {**TAUT, "saddles": {"tower": SHOE}},
    "saddle that holds": {**TAUT, "saddles": {"tower": {**SHOE, "friction": 0.3}}},
    "tower that yields": {**TAUT, "saddles": {"tower": {**SHOE, "friction": 0.3, "support": YIELDING}}},
}  # fmt: skip


def motion(line: dict[str, Any], size: float = 1.0, *, geometry: str = "linearised", until: float = 0.3) -> Scenario:
    load = {"kind": "mass", "mass": size / 9.81, "on": "rope", "travel": {"speed": 6.0, "from": 4.0}}
    run = {"kind": "dynamic", "until": until, "every": until / 6.0, "geometry": geometry}
    tree = {"gravity": 9.81, "lines": {"rope": line}, "loads": {"a": load}, "run": run}
    return Scenario.model_validate(tree)


@pytest.mark.parametrize("line", LINES)
def test_steps_are_what_modes_superpose(line: str) -> None:
    """But for what contacts give way in a step. Bounds: twice what was seen."""
    scenario = motion({**LINES[line], "elements": 24}, until=0.03)
    modes, steps = superposed(scenario), frames_of(with_steps_of(scenario, 0.5))
    for of, most in (("position", 0.006), ("tension", 0.015), ("reaction", 0.03)):
        one, other = changes(modes, of), changes(steps, of)
        away = float(np.abs(one - other).max() / np.abs(one).max())
        print(line, of, away)
        assert away < most
    assert imbalance(steps) < 1e-4


@pytest.mark.parametrize("line", ["sheave", "sheave that holds", "saddle", "saddle that holds"])
def test_all_geometry_tends_to_it_as_the_load_vanishes(line: str) -> None:
    away = []
    for size in (8.0, 2.0):
        own = {**LINES[line], "elements": 24}
        given = [motion(own, size, geometry=kind, until=0.1) for kind in ("linearised", "nonlinear")]
        small, full = (frames_of(with_steps_of(one, 0.5)) for one in given)
        one, other = (changes(frames, "position") for frames in (small, full))
        away.append(float(np.abs(one - other).max() / np.abs(one).max()))
    print(line, away)
    assert away[1] < 0.003
    assert away[1] < 0.5 * away[0]  # not a quarter: what contacts give way in a step differs, whatever the load


def potentials(line: str) -> tuple[SystemPotential, SystemPotential, np.ndarray]:
    """Of small motion and of all geometry, where friction holds what rests; and the rest, (axis, node) m."""
    moving = SystemMotion(motion({**LINES[line], "elements": 20}), RunInfo(), np.array([0.0, 0.1]))
    structure, rest = moving.structure, moving.rest
    full = structure._replace(about=structure.about.nothing(2))
    if structure.sheaves is not None:
        sheaves, none = structure.sheaves, type(structure.sheaves).nothing(2)
        full = full._replace(sheaves=sheaves._replace(about=none.about, rest=none.rest, changes=none.changes))
    if structure.saddles is not None:
        saddles, nowhere = structure.saddles, type(structure.saddles).nothing(2)
        full = full._replace(saddles=saddles._replace(about=nowhere.about))
    small, whole = (SystemPotential(one, LoadedStructure(one, rest), 20.0) for one in (structure, full))
    whole.forces(rest.ravel())
    whole.stick(rest.ravel())
    assert whole.how == LITTLE
    return small, whole, rest


@pytest.mark.parametrize("line", LINES)
def test_its_energy_has_the_forces_and_the_stiffness_of_rest(line: str) -> None:
    """Central differences of a quadratic are exact."""
    small, whole, rest = potentials(line)
    K = whole.stiffness(rest.ravel()).toarray()
    scale = float(np.abs(K).max())
    pull = whole.forces(rest.ravel())
    assert small.forces(rest.ravel()) == pytest.approx(pull, abs=1e-9 * float(whole.buffers.tension.max()))
    assert small.energy(rest.ravel()) == pytest.approx(whole.energy(rest.ravel()), rel=1e-12)
    r = (rest + 0.1 * np.random.default_rng(1).standard_normal(rest.shape)).ravel()
    assert small.stiffness(r).toarray() == pytest.approx(K, rel=1e-9, abs=1e-9 * scale)
    C = whole.damping(rest.ravel()).toarray()
    assert small.damping(r).toarray() == pytest.approx(C, rel=1e-9, abs=1e-9 * max(np.abs(C).max(), 1.0))
    for i in range(0, small.free.shape[1], 3):
        way = np.zeros(small.free.shape[1])
        way[i] = 0.1
        ahead, behind = small.moved(r, way), small.moved(r, -way)
        slope = (small.energy(ahead) - small.energy(behind)) / 0.2
        assert small.out_of_balance(r)[i] == pytest.approx(-slope, rel=1e-8, abs=1e-9 * scale)


@pytest.mark.parametrize("line", ["sheave", "sheave that holds", "both"])
def test_what_is_seen_at_sheaves_changes_as_with_all_geometry(line: str) -> None:
    """Both tensions, slip, mean strain and mean tension: central differences, whose error is of the second order."""
    small, whole, rest = potentials(line)
    way = np.random.default_rng(2).standard_normal(rest.size)

    def seen(potential: SystemPotential, far: float) -> list[np.ndarray]:
        """What is seen at a way from rest, in m."""
        potential.forces(rest.ravel() + far * way)
        sheaves, buffers = potential.structure.sheaves, potential.buffers
        assert sheaves is not None
        e = small.structure.sheaves.about.node[:, 0]
        return [one.copy() for one in (sheaves.tension, sheaves.ahead, buffers.strain[e], buffers.tension[e])]

    def slopes(potential: SystemPotential, far: float) -> list[np.ndarray]:
        both = zip(seen(potential, far), seen(potential, -far), strict=True)
        return [(ahead - behind) / (2.0 * far) for ahead, behind in both]

    exact = slopes(small, 1e-4)
    coarse, fine = (slopes(whole, far) for far in (2e-4, 1e-4))
    for what, k in zip(("tensions", "slip", "strain", "tension"), range(4), strict=True):
        scale = max(float(np.abs(exact[k]).max()), 1e-9)
        found = (4.0 * fine[k] - coarse[k]) / 3.0
        print(line, what, scale, np.abs(found - exact[k]).max() / scale)
        assert found == pytest.approx(exact[k], abs=1e-6 * scale)


def test_it_swings_in_a_mode_of_the_spectrum() -> None:
    """Where friction holds the rope at one sheave, and not at another; Verlet's error is of the second order."""
    given = motion(LINES["both"]).model_copy(update={"loads": {}})

    def missed(part: float) -> float:
        times = np.linspace(0.0, 0.2, 11)
        moving = SystemMotion(with_steps_of(given, part), RunInfo(), times)
        potential = SystemPotential(moving.structure, LoadedStructure(moving.structure, moving.rest), 20.0)
        K, M = (A.toarray() for A in (potential.stiffness(moving.rest.ravel()), potential.masses()))
        squares, modes = linalg.eigh(K, M)
        w, shape = float(np.sqrt(squares[12])), (potential.free @ modes[:, 12]).reshape(moving.rest.shape)
        moving.state.r[:] += shape
        seen = []
        for k in range(times.size):
            assert moving.advance(k) is None
            seen.append(float((shape * (moving.state.r - moving.rest)).sum() / (shape**2).sum()))
        return float(np.abs(seen - np.cos(w * times)).max())

    errors = [missed(part) for part in (1.0, 0.5)]
    print(errors)
    assert errors[-1] < 0.02
    assert 1.9 < order([2.0, 1.0], errors) < 2.1


def test_spectra_hold_a_rope_at_its_sheave_as_kind_linear_does() -> None:
    """Waves along each of its spans stay there, sqrt(EA/rho) / (2 L) of the unstrained L, where friction holds it."""
    rope = {**TAUT, "length": 19.0, "elements": 60, "sheaves": {"tower": {"at": [12.0, 0.5], "friction": 0.3}}}
    tree = {"gravity": 0.01, "lines": {"rope": rope}, "run": {"kind": "equilibrium"}}
    modes = spectrum_of(Scenario.model_validate(tree), how_many=40).modes
    assert modes is not None
    along = (np.abs(modes.shape[..., 0]) ** 2).sum(axis=1) / (np.abs(modes.shape) ** 2).sum(axis=(1, 2))
    spans = np.hypot([12.0, 8.0], 0.5)
    exact = float(np.sqrt(1e5)) / (2.0 * 19.0 * spans / spans.sum())
    found = np.sort(modes.frequency[along > 0.9] / (2.0 * np.pi))
    print(found, exact)
    assert found[:2] == pytest.approx(exact, rel=0.01)
