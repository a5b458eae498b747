"""Path following: smaller steps where a path turns or the next equilibrium is missing, and when a load is where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from ropewalk.errors import EquilibriumError
from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.solve.following import Mover, follow, quasistatic_motion, schedule, turns_less

# Taut enough for the stiff line's contact, whose own compliance goes by the tension without the load.
ROPE = {"start": [0, 0], "end": [10, 0], "length": 9.9, "mass": 0.1, "axial_stiffness": 5e4, "elements": 40}
KINDS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "rope": ({}, {}),
    "stiff line": ({"bending_stiffness": 1e-4}, {}),
    "network": ({}, {"wind": {"speed": 0.0, "direction": [1, 0]}}),
}


def path_of(kind: str, **run: Any) -> tuple[np.ndarray, np.ndarray]:
    """Load paths and places (position, axis) of a force that goes over a slack rope."""
    line, more = KINDS[kind]
    load = {"kind": "force", "on": "rope", "force": [0, -100.0], "travel": {"speed": 1.0, "from": 0.1}}
    tree = {"lines": {"rope": {**ROPE, **line}}, "loads": {"p": load}, "run": {"kind": "quasistatic", **run}, **more}
    found = simulate(Scenario.model_validate(tree))
    assert found.attrs["outcome"] == "completed", found.attrs["advice"]
    return found.load_path.values, found.contact_position.values[:, 0]


def angles(place: np.ndarray) -> np.ndarray:
    """By how much the way through places turns at each of the inner ones, rad."""
    way = np.diff(place, axis=0)
    return np.abs(np.diff(np.unwrap(np.arctan2(way[:, 1], way[:, 0]))))


@pytest.mark.parametrize("kind", KINDS)
def test_places_in_between_are_kept_where_the_path_turns(kind: str) -> None:
    coarse, fine = path_of(kind, positions=11), path_of(kind, positions=11, turn="0.02 rad")
    assert angles(coarse[1]).max() > 0.05
    assert angles(fine[1]).max() <= 0.02 + 1e-9
    assert 11 < fine[0].size < 80
    same = [int(np.argmin(np.abs(fine[0] - way))) for way in coarse[0]]
    np.testing.assert_allclose(fine[0][same], coarse[0], atol=1e-12)
    # What a rest is does not depend on where it was looked for from: to 1e-7 of a link of 0.25 m.
    np.testing.assert_allclose(fine[1][same], coarse[1], atol=3e-8)


def test_the_path_does_not_depend_on_the_structure() -> None:
    """A rope, in a wind of 0 m/s, and with next to no bending stiffness: one path, and one choice of places."""
    rope, network, stiff = (path_of(kind, positions=11, turn="0.02 rad") for kind in ("rope", "network", "stiff line"))
    np.testing.assert_allclose(network[0], rope[0], atol=1e-12)
    np.testing.assert_allclose(network[1], rope[1], atol=1e-8)
    there = np.stack([np.interp(stiff[0], rope[0], column) for column in rope[1].T], axis=1)
    # Straight between kept places, 1 m apart where it turns by 0.02 rad: 2.5 mm; the contact of the stiff line, 5 mm.
    np.testing.assert_allclose(stiff[1], there, atol=7e-3)


@dataclass(frozen=True)
class Somewhere:
    path: float


def test_it_comes_as_near_as_it_can_to_where_no_equilibrium_is() -> None:
    def step(here: Somewhere, before: Somewhere | None, path: float) -> Somewhere:
        if path > 4.3:
            raise EquilibriumError("no further")
        return Somewhere(path)

    found = []
    places = follow(Somewhere(0.0), step, lambda *_: True, np.linspace(0.0, 10.0, 11), between=False)
    with pytest.raises(EquilibriumError, match="no further"):
        found.extend(place.path for place in places)
    assert found[:-1] == [1.0, 2.0, 3.0, 4.0]
    assert 4.3 - 2.0 / 4096 < found[-1] <= 4.3  # steps end at a 4096th of the distance of positions


def test_rest_is_looked_for_next_to_the_last_one() -> None:
    asked = []

    def rest(t: float, near: float | None) -> float:
        asked.append((t, near))
        return t

    times, paths = np.array([0.0, 2.0]), np.array([0.0, 4.0])
    found = [(at.path, at.t) for at in quasistatic_motion(rest, lambda t: np.zeros((1, 2)), times, paths, 3, None)]
    assert found == [(0.0, 0.0), (2.0, 1.0), (4.0, 2.0)]
    assert asked == [(0.0, None), (1.0, 0.0), (2.0, 1.0)]


def test_who_stands_still_or_is_off_turns_nowhere() -> None:
    here = np.array([[0.0, 0.0], [np.nan, np.nan]])
    ahead, up = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    assert turns_less(0.1, here, here, here + up)
    assert turns_less(0.1, here, here + ahead, here + 2.0 * ahead)
    assert not turns_less(0.1, here, here + ahead, here + ahead + up)


def test_a_load_is_on_its_way_until_the_end_of_its_line() -> None:
    """At 3 m/s 10 m are over after 10/3 s; at t^2 - 4 t from 6 m it turns at 2 m and has gone 12 m at 10 m."""
    times, paths = schedule([Mover(lambda t: 3.0 * t, 0.0, 10.0)])
    assert (times[-1], paths[-1]) == pytest.approx((10.0 / 3.0, 10.0), rel=1e-11)
    times, paths = schedule([Mover(lambda t: t**2 - 4.0 * t, -6.0, 4.0, 9.0)])
    assert (times[-1], paths[-1]) == pytest.approx((2.0 + 8.0**0.5, 12.0), rel=1e-7)  # 20001 instants, straight between
    assert np.interp(2.0, times, paths) == pytest.approx(4.0, rel=1e-7)
    with pytest.raises(EquilibriumError, match="no load has a path"):
        schedule([Mover(lambda t: 0.0 * t, -10.0, 0.0)])


def test_the_load_path_follows_the_fastest_load_until_the_last_has_left() -> None:
    """9 m at 3 m/s, then the slow one alone: 10 m at 1 m/s are over after 10 s, 7 of which it goes alone."""
    fast, slow = Mover(lambda t: 3.0 * t, 0.0, 9.0), Mover(lambda t: -t, -10.0, 0.0)
    for movers in ([fast, slow], [slow, fast]):
        times, paths = schedule(movers)
        assert (times[-1], paths[-1]) == pytest.approx((10.0, 16.0), rel=1e-11)
        assert np.interp(3.0, times, paths) == pytest.approx(9.0, rel=1e-11)
    stops = Mover(lambda t: np.minimum(t, 4.0), -1.0, 10.0, 4.0)
    late = Mover(lambda t: np.maximum(t - 6.0, 0.0), 2.0, 5.0, 6.0)  # comes to its line 2 m on
    times, paths = schedule([stops, late])
    assert (times[-1], paths[-1]) == pytest.approx((11.0, 9.0), rel=1e-3)  # the pause is between two instants
