"""Small motion of overhead lines under loads that move along and aside, or hang: the second-order expansion of rest.

Sources: a network of bars with lumped masses, static and by its modes with a pendulum below it (`stitch_network.py`,
nothing of the package); the engine of wires, which moves them vertically alone; the same motion with all geometry as
the load goes to nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from overhead_cases import EN_2002
from ropewalk.capabilities import SYSTEM, WIRES, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.system.elements.ties import Point
from ropewalk.system.equilibrium.rest import about_rest, at_rest
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.structures import structure_of
from ropewalk.system.loads.loaded_structure import LoadedStructure
from stitch_network import StitchedLine
from system_cases import computed, missed

G = 9.81
LINE: dict[str, Any] = {**EN_2002, "spans": {"count": 3, "length": "60 m"}, "analysed_spans": [2, 2]}
STITCHED: dict[str, Any] = LINE | {
    "system_height": 1.8, "stitch_wire": {"length": 18.0, "tension": 2800.0}, "steady_arms": {"mass": 0.0},
}  # fmt: skip
TRAVEL = {"speed": 30.0, "from": 70.0}


def scenario(line: dict[str, Any], load: dict[str, Any], **run: Any) -> Scenario:
    run = {"kind": "dynamic", "until": 0.6, "every": 0.02, "geometry": "linearised"} | run
    return Scenario.model_validate({
        "overhead_lines": {"section": line}, "loads": {"load": {**load, "on": "section"}}, "run": run,
    })  # fmt: skip


@pytest.mark.parametrize("place", [60.0, 93.0])
def test_it_yields_as_bars_whose_tensions_are_linked(place: float) -> None:
    """At a support by 4.5 % less than strings of constant tension do: small motion goes along the line, too."""
    asked = scenario({**STITCHED, "element": 0.5}, {"kind": "force", "force": [0.0, 0.0], "travel": TRAVEL})
    found = structure_of(asked, 0.0)
    structure, rest = at_rest(found.structure, np.array([0.0, -G]), found.near)
    small = about_rest(structure, rest)
    K = SystemPotential(small, LoadedStructure(small, rest), 180.0)
    stiffness = K.stiffness(rest.ravel())
    nodes, parts = (at := Point(0, 360, 0.5, place / 0.5, 20e3, 0.0)).parts
    push = np.asarray(K.free.T[:, rest.shape[1] + nodes] @ parts)
    soft = stiffness.toarray() + 1e-6 * np.eye(push.size)  # all wires may slide along together
    rise = float(push @ np.linalg.solve(soft, push)) + at.yields_across
    wanted = float(StitchedLine().elasticity(np.array([place]), 0.5)[0])
    assert rise == pytest.approx(wanted, rel=4e-3)  # 3e-3 away from supports: kinks at droppers, of the first order


def test_a_payload_swings_below_a_trolley_as_modes_have_it() -> None:
    """400 g on a rope of 2 m below 100 g: the network of bars, a mass at a node, and a pendulum below it."""
    trolley, payload, length, k, swing = 0.1, 0.4, 2.0, 400.0, np.deg2rad(2.0)
    load = {
        "kind": "trolley", "mass": trolley, "travel": {"speed": 0.0, "from": 90.0},
        "payload": {"mass": payload, "length": length, "stiffness": k, "swing": "2 deg"},
    }  # fmt: skip
    found = simulate(scenario({**STITCHED, "element": 0.5}, load, until=1.5, every=0.05))
    K, M, free, contact = StitchedLine().matrices(0.5)
    n, count, node = len(K), int(contact[0]), round(90.0 / 0.5)
    x, z = (int(np.searchsorted(free, dof)) for dof in (node, count + node))
    reach = length + payload * G * np.cos(swing) / k
    K, M = (np.pad(A, (0, 2)) for A in (K, M))
    for own, other, stiff in ((x, n, payload * G / reach), (z, n + 1, k)):
        K[np.ix_([own, other], [own, other])] += stiff * np.array([[1.0, -1.0], [-1.0, 1.0]])
        M[own, own] += trolley
        M[other, other] += payload
    start, weight = np.zeros(n + 2), np.zeros(n + 2)
    start[n], weight[z] = reach * np.sin(swing), -(trolley + payload) * G  # its rope bears its weight from the first
    square, modes = eigh(K, M)
    square = np.maximum(square, 0.0)  # all wires slide along together
    q0, f, t = modes.T @ M @ start, modes.T @ weight, found["time"].values
    w = np.sqrt(square)
    drift = 0.5 * t[:, None] ** 2 * np.sinc(w * t[:, None] / (2.0 * np.pi)) ** 2  # (1 - cos w t) / w^2
    y = (np.cos(w * t[:, None]) * q0 + drift * f) @ modes.T
    hung, wheel = found["body_position"].values[:, -1], found["contact_position"].values[:, 0]
    hung[:, 1] += np.sqrt(reach**2 - (hung - wheel)[:, 0] ** 2) - reach  # to the first order it does not rise
    off = {
        "swing": np.abs((hung - wheel)[:, 0] - (y[:, n] - y[:, x])).max() / start[n],
        "along": np.abs(wheel[:, 0] - wheel[0, 0] - y[:, x]).max() / np.abs(y[:, x]).max(),
        "sag": np.abs(wheel[:, 1] - wheel[0, 1] - y[:, z]).max() / np.abs(y[:, z]).max(),
        "payload": np.abs(hung[:, 1] - hung[0, 1] - y[:, n + 1]).max() / np.abs(y[:, n + 1]).max(),
    }
    print(off, "audit", missed(found))
    assert off["swing"] < 0.006
    assert off["along"] < 0.02
    assert max(off["sag"], off["payload"]) < 0.03  # lumped masses every half metre: three times as much every metre
    assert missed(found) < 1e-4


@pytest.mark.parametrize("kind", ["force", "mass", "oscillator"])
def test_motion_is_that_of_wires(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Which have nothing move along: without stitch wires that makes less than a per cent."""
    loads: dict[str, dict[str, Any]] = {
        "force": {"kind": "force", "force": [0.0, 200.0]},
        "mass": {"kind": "mass", "mass": 5.0},
        "oscillator": {"kind": "oscillator", "mass": 20.0, "wheel_mass": 0.0, "stiffness": 20e3},
    }
    travel = {"speed": 40.0, "from": 60.0, "measured": "horizontal"}
    asked = scenario(LINE, {**loads[kind], "travel": travel}, until=1.0, every=0.01)
    assert engine_of(asked) is WIRES
    one, other = (computed(asked, engine, monkeypatch) for engine in (WIRES, SYSTEM))
    assert set(one.variables) == set(other.variables)
    z, own = (found["contact_position"].values[:, 0, 1] for found in (one, other))
    away = float(np.abs(z - own).max() / np.ptp(z))
    tie, mine = (found["tie_force"].values for found in (one, other))
    print(kind, "height", away, "ties", float((tie - mine).std()), "audit", missed(one), missed(other))
    assert away < 0.015
    assert (tie - mine).std() < 6.0  # N, of some 120
    assert missed(other) < 1e-5


def test_a_trolley_is_the_oscillator_that_wires_know(monkeypatch: pytest.MonkeyPatch) -> None:
    """A payload that does not swing, on a rope that stays taut: a mass on a spring above a wheel."""
    travel = {"speed": 40.0, "from": 60.0, "measured": "horizontal"}
    hung = {"kind": "trolley", "mass": 2.0, "payload": {"mass": 8.0, "length": 3.0, "stiffness": 4e3}}
    stands = {"kind": "oscillator", "mass": 8.0, "wheel_mass": 2.0, "stiffness": 4e3}
    asked = scenario(LINE, {**hung, "travel": travel}, until=1.0, every=0.01)
    assert engine_of(asked) is SYSTEM
    found = simulate(asked)
    wanted = computed(scenario(LINE, {**stands, "travel": travel}, until=1.0, every=0.01), WIRES, monkeypatch)
    for name, at in (("contact_position", 0), ("body_position", -1)):
        z, own = (result[name].values[:, at, 1] for result in (wanted, found))
        away = float(np.abs((z - z[0]) - (own - own[0])).max() / np.ptp(z))
        print(name, away)
        assert away < 0.02


@pytest.mark.parametrize(
    "load",
    [
        {"kind": "trolley", "mass": 2.0, "payload": {"mass": 4.0, "length": 1.0, "swing": "5 deg"}, "travel": TRAVEL},
        {"kind": "footsteps", "mass": 6.0, "from": 70.0, "lateral": "setra"},
        {"kind": "mass", "mass": 6.0, "travel": {"kind": "free", "speed": 20.0, "from": 70.0, "friction": 0.01}},
        {"kind": "mass", "mass": 6.0, "travel": {**TRAVEL, "measured": "slip"}},
        {"kind": "mass", "mass": 6.0, "air_drag": 0.1, "travel": TRAVEL},
        {"kind": "force", "force": [20.0, 10.0, -40.0], "travel": TRAVEL},
    ],
    ids=["trolley", "footsteps", "free", "slip", "air", "aside"],
)
def test_it_is_the_limit_of_small_loads(load: dict[str, Any]) -> None:
    """What all geometry makes of twice the load differs about twice as much, over the load; ways along come in, too."""

    def sized(part: float) -> dict[str, Any]:
        tree = {**load}
        for key in ("mass", "air_drag"):
            if key in tree:
                tree[key] *= part
        if "force" in tree:
            tree["force"] = [part * each for each in tree["force"]]
        if "payload" in tree:
            tree["payload"] = {**tree["payload"], "mass": part * tree["payload"]["mass"], "stiffness": part * 4e3}
        return tree

    off = []
    for part in (2.0, 1.0):
        asked = scenario(LINE, sized(part))
        assert engine_of(asked) is SYSTEM
        small, large = simulate(asked), simulate(scenario(LINE, sized(part), geometry="nonlinear"))
        assert small.attrs["outcome"] == large.attrs["outcome"] == "completed"
        assert missed(small) < 0.02
        z, own = (found["position"].values[..., -1] for found in (large, small))
        off.append(float(np.abs(z - own).max() / np.abs(z - z[0]).max()))
    print(load["kind"], off)
    assert off[0] < 4e-3
    assert off[0] / off[1] > 1.4
