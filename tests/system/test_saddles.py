"""Lines on saddles: tension by height, Euler and Eytelwein's friction, and a bead that goes over one by its energy."""

from __future__ import annotations

import json
import re
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.errors import ScenarioError
from ropewalk.model.scenario import Scenario
from ropewalk.results.statistics import summary
from ropewalk.scenario import loads
from ropewalk.simulate import simulate, spectrum_of

EA, MASS, RADIUS, CROWN, G = 1e6, 2.0, 2.0, 3.0, 9.81
TOWER: dict[str, Any] = {"at": [10.0, CROWN], "radius": RADIUS}
AT_REST = {"kind": "equilibrium"}
BEAD = {"kind": "mass", "mass": 0.1, "travel": {"kind": "free", "speed": 9.0, "from": 3.0}}


def tramway(
    run: dict[str, Any], load: dict[str, Any] | None = None, *, tower: dict[str, Any] = TOWER, gravity: float = G,
    **keys: Any,
) -> Scenario:  # fmt: skip
    """A taut rope over a saddle in its middle."""
    rope = {
        "start": [0.0, 0.0], "end": [20.0, 0.0], "length": 20.6, "mass": MASS, "axial_stiffness": EA, "elements": 100,
        "saddles": {"tower": tower}, **keys,
    }  # fmt: skip
    found = {"load": {"on": "rope", **load}} if load is not None else {}
    return loads(json.dumps({"gravity": gravity, "lines": {"rope": rope}, "loads": found, "run": run}))


def imbalance(result: xr.Dataset) -> float:
    """Largest, over the energy turned over."""
    energy = summary(result)["energy"]
    return float(energy["largest_imbalance"]["value"] / energy["turnover"])


def test_tension_goes_with_the_height_where_nothing_rubs() -> None:
    """T + T^2/(2 EA) - w z is the same all along a rope that rests on smooth round things (w for unstrained lengths).

    A slider takes 10 kN at the end. Where the rope leaves the saddle lies between nodes, and orders scatter about two.
    """
    pulled = {"kind": "guided", "along": [1.0, 0.0], "force": 1e4}
    missed = []
    for elements in (50, 100, 200):
        result = simulate(tramway(AT_REST, length=20.72, end=[20.0, 1.0], end_support=pulled, elements=elements))
        T, z = result.tension.values[-1], result.position.values[-1, :, -1]
        same = T + T**2 / (2.0 * EA) - MASS * G * 0.5 * (z[1:] + z[:-1])
        missed.append(float(np.ptp(same)))
        reaction = result.reaction.values[-1]
        np.testing.assert_allclose(reaction.sum(axis=0), [0.0, MASS * G * 20.72], atol=1e-5)
    assert missed[-1] < 5e-4 * 1e4
    assert 1.5 < 0.5 * np.log2(missed[0] / missed[-1]) < 2.5


def test_it_lies_on_the_saddle_and_leaves_it_along_tangents() -> None:
    """Without weight: two straight tangents of a circle; the rope sinks in by less than eps h^2 / R."""
    result = simulate(tramway(AT_REST, gravity=0.0))
    place, T = result.position.values[-1], float(result.tension.values[-1].mean())
    centre = np.array([10.0, CROWN - RADIUS])
    away = np.linalg.norm(place - centre, axis=1)
    h = 20.6 / 100
    assert -2.0 * T / EA * h**2 / RADIUS < float(away.min()) - RADIUS < 0.0
    d = np.linalg.norm(centre)
    steep = np.arctan2(centre[1], centre[0]) + np.arcsin(RADIUS / d)
    measured = np.arctan2(*(place[20] - place[0])[::-1])
    assert measured == pytest.approx(steep, abs=2e-4)  # the tangent point lies within a link, of 0.1 rad along the arc
    whole = 2.0 * (np.sqrt(d**2 - RADIUS**2) + RADIUS * steep)
    assert pytest.approx(EA * (whole / 20.6 - 1.0), rel=2e-3) == T


def test_friction_is_that_of_euler_and_eytelwein() -> None:
    """One end is pulled: T2/T1 = exp(mu angle). Drag of 2/s along both spans, 1 m/s, adds up to 0.5 % of ln(T2/T1)."""
    mu, until = 0.3, 1.2
    moved = {"kind": "moving", "displacement": {"time": [0.0, until], "value": [[0.0, 0.0], [0.3, 0.0]]}}
    result = simulate(tramway(
        {"kind": "dynamic", "until": until, "every": 0.02}, tower={**TOWER, "friction": mu}, gravity=0.0,
        end_support=moved, drag=2.0, axial_damping=300.0,
    ))  # fmt: skip
    late, place = result.tension.values[30:], result.position.values[-1]
    (x, z), (u, w) = place[5] - place[0], place[-1] - place[-6]
    angle = np.arctan2(z, x) - np.arctan2(w, u)
    assert np.log((late[:, -3] / late[:, 2]).mean()) / angle == pytest.approx(mu, rel=0.015)
    assert imbalance(result) < 2e-4


def test_what_friction_holds_stays() -> None:
    """Tensions that differ by less than friction bears do not even out: nodes on the saddle do not creep."""
    run = {"kind": "dynamic", "until": 1.0, "every": 0.1}
    push = {"kind": "force", "force": [0.0, -50.0], "travel": {"speed": 0.5, "from": 4.0}}
    result = simulate(tramway(run, push, tower={**TOWER, "friction": 2.0}, gravity=0.0, drag=2.0))
    middle = result.position.values[:, 50]
    assert float(np.abs(middle - middle[0]).max()) < 1e-7


def test_a_bead_goes_over_it_by_its_energy() -> None:
    """A light bead slides up to the crown and down again; the rope takes 1e-4 of its energy as it is set down."""
    result = simulate(tramway({"kind": "dynamic", "until": 1.6, "every": 0.01}, BEAD))
    place = result.contact_position.values[:, 0]
    speed = np.gradient(place, result.time.values, axis=0)
    energy = (0.5 * (speed**2).sum(axis=1) + G * place[:, 1])[2:-2]
    assert float(place[:, 1].max()) == pytest.approx(CROWN, abs=1e-3)
    assert float(place[-1, 0]) > 13.0
    assert float(np.ptp(energy)) < 3e-4 * float(energy.mean())
    assert imbalance(result) < 1e-6


def test_a_tower_gives_way_and_energy_is_kept() -> None:
    """A mass crosses an elastic tower top. What is missed goes with the step, 1e-5 with one of 25 us."""
    top = {"kind": "elastic", "stiffness": [2e5, 1e7], "mass": 50.0}
    mass = {"kind": "mass", "mass": 20.0, "travel": {"speed": 8.0, "from": 6.0}}
    run = {"kind": "dynamic", "until": 0.9, "every": 0.02, "start": {"with_loads": True}}
    result = simulate(tramway(run, mass, tower={**TOWER, "support": top}, end=[20.0, 1.0]))
    names = result.support.values.tolist()
    assert names == ["rope.start", "rope.end", "rope.tower"]
    assert float(np.ptp(result.reaction.values[:, 2, 0])) > 100.0
    assert imbalance(result) < 1.5e-3


def test_turned_in_space_it_is_the_same() -> None:
    c, s = float(np.cos(0.7)), float(np.sin(0.7))
    mass = {"kind": "mass", "mass": 20.0, "travel": {"speed": 8.0, "from": 6.0}}
    run = {"kind": "dynamic", "until": 0.3, "every": 0.1}
    tower = {**TOWER, "friction": 0.1}
    plane = simulate(tramway(run, mass, tower=tower))
    space = simulate(tramway(
        run, mass, tower={**tower, "at": [10.0 * c, 10.0 * s, CROWN]}, start=[0.0, 0.0, 0.0],
        end=[20.0 * c, 20.0 * s, 0.0],
    ))  # fmt: skip
    found, exact = space.position.values, plane.position.values
    np.testing.assert_allclose(found[..., 0] * c + found[..., 1] * s, exact[..., 0], atol=1e-8)
    np.testing.assert_allclose(found[..., 2], exact[..., 1], atol=1e-8)


def test_a_saddle_that_is_not_touched_does_nothing() -> None:
    below = {**TOWER, "at": [10.0, -3.0], "radius": 1.0}
    mass = {"kind": "mass", "mass": 5.0, "travel": {"speed": 8.0, "from": 6.0}}
    run = {"kind": "dynamic", "until": 0.3, "every": 0.1, "method": "verlet"}
    far = {**TOWER, "at": [10.0, -50.0], "radius": 1.0}
    one, other = (simulate(tramway(run, mass, tower=tower, length=19.9)) for tower in (below, far))
    np.testing.assert_allclose(one.position.values, other.position.values, rtol=0.0, atol=1e-9)


def test_frequencies_are_those_of_both_spans() -> None:
    """A taut rope without weight swings in spans from anchors to tangent points, as strings by themselves.

    Its tension stretches along as it does across; the nodes next to the tangent point make spans longer by half a link.
    """
    T = float(simulate(tramway(AT_REST, gravity=0.0)).tension.values.mean())
    span = float(np.sqrt(10.0**2 + (CROWN - RADIUS) ** 2 - RADIUS**2))
    exact = np.sqrt(T * (1.0 + T / EA) / MASS) / (2.0 * span)
    modes = spectrum_of(tramway(AT_REST, gravity=0.0, elements=200), how_many=4).modes
    upright = np.abs(modes.shape[..., 2]).max(axis=1) > 0.5  # to the side it rolls in the groove
    assert modes.frequency[upright] / (2.0 * np.pi) == pytest.approx([exact, exact], rel=0.01)


MISTAKES = {
    "sheaves": ({"sheaves": {"wheel": {"at": [4.0, 1.0]}}}, AT_REST, "saddles: a line over sheaves has no saddles"),
    "supports": (
        {"supports": {"pier": {"at": 4.0, "kind": "fixed", "position": [4.0, 1.0]}}}, AT_REST,
        "supports: a line over saddles has no inner supports",
    ),
    "implicit": (
        {"tower": {**TOWER, "friction": 0.2}}, {"kind": "dynamic", "until": 1.0, "every": 0.1, "method": "implicit"},
        "run.method",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_what_it_cannot_be_is_refused_by_its_key(name: str) -> None:
    keys, run, told = MISTAKES[name]
    load = {"kind": "force", "force": [0.0, -10.0], "travel": {"speed": 1.0, "from": 2.0}}
    with pytest.raises(ScenarioError, match=re.escape(told)):
        simulate(tramway(run, load, **keys))


def pulled(elements: int, mu: float, way: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Slow motion of a rope without weight, one end of which is pulled by way in m: ln(T2/T1) / angle, and places."""
    time = np.arange(len(way), dtype=float)
    moved = {"kind": "moving", "displacement": {"time": time.tolist(), "value": [[float(x), 0.0] for x in way]}}
    nothing = {"kind": "force", "force": [0.0, -1e-6], "travel": {"speed": 4.0, "from": 2.0}}  # it tells the time
    result = simulate(tramway(
        {"kind": "quasistatic", "positions": 19}, nothing, tower={**TOWER, "friction": mu}, gravity=0.0,
        end_support=moved, elements=elements,
    ))  # fmt: skip
    T, place = result.tension.values, result.position.values
    (x, z), (u, w) = (place[:, 5] - place[:, 0]).T, (place[:, -1] - place[:, -6]).T
    return np.log(T[:, -3] / T[:, 2]) / (np.arctan2(z, x) - np.arctan2(w, u)), place


def test_slow_friction_is_that_of_euler_and_eytelwein_to_and_fro() -> None:
    """T2/T1 = exp(mu angle) while it slips to one side, exp(-mu angle) while it slips back, and less in between."""
    mu = 0.3
    for elements, most in ((50, 0.04), (100, 0.02)):  # to the first order of the links on the saddle
        ratio, _ = pulled(elements, mu, [0.0, 0.2, 0.2, 0.0, 0.0])
        print(elements, ratio)
        assert ratio[0] == pytest.approx(0.0, abs=1e-8)
        assert ratio.max() == pytest.approx(mu, rel=most)
        assert ratio.min() == pytest.approx(-mu, rel=most)
        assert np.abs(ratio).max() < mu * (1.0 + most)


def test_slowly_what_friction_holds_stays() -> None:
    """It is pulled by less than friction bears, and comes back: nodes on the saddle do not creep."""
    _, place = pulled(50, 0.5, [0.0, 0.002, 0.0, 0.002, 0.0])
    middle = place[:, 24:27]  # held by springs that give way as those that bear them do
    assert float(np.abs(middle - middle[0])[..., 0].max()) < 6e-5
    assert float(np.abs(place[:, 45] - place[0, 45]).max()) > 1e-3
    assert place[-1] == pytest.approx(place[0], abs=1e-7)


def test_friction_on_saddles_bears_what_a_load_pulls_with() -> None:
    """Masses that stand on one span pull at the other one by less than friction lets them, and by all without."""
    load = {"kind": "mass", "mass": 200.0, "travel": {"speed": 1.0, "from": 2.0}}
    tensions = {}
    for mu in (0.0, 0.05, 1.0):
        run = {"kind": "quasistatic", "positions": 5}
        T = simulate(tramway(run, load, tower={**TOWER, "friction": mu}, elements=50)).tension.values
        tensions[mu] = float(T[1, -2] - T[0, -2])
    print(tensions)
    assert tensions[0.0] > 290.0
    assert 10.0 < tensions[0.05] < 0.95 * tensions[0.0]
    assert abs(tensions[1.0]) < 1.0


@pytest.mark.parametrize("factor", [1.0, 4.0])
def test_an_axial_inertia_leaves_friction_as_it_is(factor: float) -> None:
    """T2/T1 = exp(mu angle) as above; what slips there is heavier, and its drag with it."""
    mu, until = 0.3, 0.6
    moved = {"kind": "moving", "displacement": {"time": [0.0, until], "value": [[0.0, 0.0], [0.15, 0.0]]}}
    run = {"kind": "dynamic", "until": until, "every": 0.02, "axial_inertia": factor}
    result = simulate(tramway(
        run, tower={**TOWER, "friction": mu}, gravity=0.0, end_support=moved, drag=2.0, axial_damping=300.0,
        elements=50,
    ))  # fmt: skip
    late, place = result.tension.values[15:], result.position.values[-1]
    (x, z), (u, w) = place[3] - place[0], place[-1] - place[-4]
    angle = np.arctan2(z, x) - np.arctan2(w, u)
    print(np.log((late[:, -3] / late[:, 2]).mean()) / angle, imbalance(result))
    assert np.log((late[:, -3] / late[:, 2]).mean()) / angle == pytest.approx(mu, rel=0.06)
    assert imbalance(result) < 1e-3
