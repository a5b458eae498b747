"""Droppers that fail while only what is near the pantographs moves.

Source: the same motion of the whole line, EN 50318:2002 at 300 km/h, with links of 0.5 m.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

from overhead_cases import DAMPED, EN_2002, long_line, off, runs_that_go_on
from ropewalk.errors import EquilibriumError
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

GEOMETRIES = ("linearised", "nonlinear")
CUTS = {  # where and when, with the pantograph at
    "below the pantograph": ([4, 5], 2.2),  # 193 m, 17 m before it
    "ahead of the window": ([8, 5], 1.0),  # 93 m: 357 m before it
    "behind the window": ([1, 5], 3.6),  # 310 m: 280 m after it
}


def asked(geometry: str, window: float | None, *, spans: int = 10, **droppers: Any) -> Scenario:
    found = {**EN_2002["droppers"], **droppers}
    return long_line(spans, window, DAMPED, run={"geometry": geometry}, droppers=found)


def cut(dropper: list[int], time: float) -> dict[str, Any]:
    return {"cut": {"droppers": [dropper], "time": time}}


@cache
def ran(geometry: str, window: float | None, which: str = "") -> xr.Dataset:
    found = simulate(asked(geometry, window, **(cut(*CUTS[which]) if which else {})))
    assert found.attrs["outcome"] == "completed"
    return found


def failures(result: xr.Dataset) -> list[tuple[str, float, float]]:
    """Which failed at which s under how much N."""
    words = [line.split() for line in result.attrs["warnings"].splitlines() if " failed under " in line]
    return [(each[5], float(each[3]), float(each[-2])) for each in words]


@pytest.mark.parametrize("which", CUTS)
@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_dropper_that_is_cut_is_felt_as_in_the_whole_line(geometry: str, which: str) -> None:
    """What a window misses is what it misses where none is cut; up to 17 N of that are at its last instants."""
    usual = off(ran(geometry, 120.0), ran(geometry, None), 120.0, 520.0)
    found = off(ran(geometry, 120.0, which), ran(geometry, None, which), 120.0, 520.0)
    assert found["rms"] < 1.25 * usual["rms"]
    assert found["sigma"] < 1.25 * usual["sigma"]
    assert found["mean"] < 0.1
    felt = off(ran(geometry, None, which), ran(geometry, None), 120.0, 520.0)
    if which != "behind the window":
        assert felt["rms"] > 2.0 * found["rms"]
    (name, time, force), (_, _, wanted) = (failures(ran(geometry, each, which))[0] for each in (120.0, None))
    (span, number), given = CUTS[which]
    assert (name, time) == (f"line.{span}.{number}", given)
    assert force == pytest.approx(wanted, abs=0.3) if which != "behind the window" else force > 0.0
    pull = ran(geometry, 120.0, which).tie_force.sel(tie=name)
    assert (pull.where(pull.time > given, drop=True) == 0.0).all()  # wherever the window is
    assert (pull.where(pull.time < given, drop=True) > 0.0).all()


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_droppers_tear_in_the_window_as_in_the_whole_line(geometry: str) -> None:
    """With 225 N the first one tears at 131 m, and others as the pantograph goes on."""
    results = [simulate(asked(geometry, each, spans=6, strength=225.0)) for each in (None, 120.0)]
    whole, near = (failures(result)[:6] for result in results)
    print(whole, near)
    for (name, time, force), (same, at, pull) in zip(whole, near, strict=True):
        assert name == same
        assert at == pytest.approx(time, abs=2e-3)
        assert pull == pytest.approx(force, rel=0.01)
        later = results[1].tie_force.sel(tie=name).where(results[1].time > at, drop=True)
        assert later.size > 30
        assert (later == 0.0).all()  # where the window has left it, too: the pantograph is 120 m on at the end


def test_what_tears_near_the_border_makes_the_run_doubtful() -> None:
    """A line that unzips goes on beyond the window, where nothing is torn."""
    whole, near = (simulate(asked("linearised", each, spans=6, strength=225.0)) for each in (None, 60.0))
    assert len(failures(near)) < len(failures(whole))
    assert "beyond the window none is torn" in near.attrs["doubts"]


def test_what_bears_more_than_its_strength_at_rest_is_refused() -> None:
    """Droppers bear 70 to 86 N at rest."""
    for geometry in GEOMETRIES:
        with pytest.raises(EquilibriumError, match=r"run\.window: 5. droppers bear more than their strength of 80 N"):
            simulate(asked(geometry, 120.0, strength=80.0))


def test_a_window_without_loads_is_around_what_is_cut() -> None:
    tree = asked("nonlinear", 90.0, spans=8, **cut([4, 5], 0.2)).model_dump(exclude_unset=True, mode="json")
    tree |= {"loads": {}}
    tree["run"] |= {"until": 0.6}
    near = simulate(Scenario.model_validate(tree))
    tree["run"].pop("window")
    whole = simulate(Scenario.model_validate(tree))
    z, wanted = (each.position.sel(axis="z").values for each in (near, whole))
    x, moved = whole.position.sel(axis="x").values[0], np.abs(wanted - wanted[0])
    inside = np.abs(x - 210.0) < 0.6 * 90.0  # within the layers
    print(np.abs(z - wanted)[:, inside].max(), moved.max())
    assert np.abs(z - wanted)[:, inside].max() < 0.02 * moved.max()
    assert (z[:, np.abs(x - 210.0) > 150.0] == z[0, np.abs(x - 210.0) > 150.0]).all()


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_run_goes_on_after_a_dropper_has_failed(geometry: str) -> None:
    line = long_line(6, 60.0, run={"until": 2.0, "geometry": geometry},
                     droppers={**EN_2002["droppers"], **cut([5, 5], 0.7)})  # fmt: skip
    first, second = runs_that_go_on(line)
    assert (first.motion.failed[:, 0] < np.inf).sum() == 1
    np.testing.assert_array_equal(first.motion.position, second.motion.position)
