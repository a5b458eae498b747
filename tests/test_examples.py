"""Every example loads, runs to its end, and gives the physical number that it is known for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from ropewalk.scenario import load
from ropewalk.simulate import simulate

FOLDER = Path(__file__).parent.parent / "examples"


@dataclass(frozen=True)
class Known:
    """What is known of an example: a number of its result, why it may be off by how much, and how it is shortened."""

    what: str
    number: Callable[[xr.Dataset], float]
    value: float
    tolerance: float
    settings: tuple[str, ...] = ()


def lowest_point_of_the_path(result: xr.Dataset) -> float:
    return -float(result.contact_position.sel(axis="z", contact=0).min())


def time_of_the_lowest_point(result: xr.Dataset) -> float:
    return float(result.time[result.contact_position.sel(axis="z", contact=0).argmin("time")])


KNOWN = {
    "moving-force.yaml": [
        # 3.061, 3.072, 3.082, 3.087, 3.090 m with 50, 100, 200, 400, 800 links: first order, towards 3.092 m. The
        # tolerance is one and a half times what 100 links miss.
        Known("depth of the path, m", lowest_point_of_the_path, 3.092, 0.03),
        # A flat minimum, looked at every 10 ms.
        Known("when the load is lowest, s", time_of_the_lowest_point, 0.88, 0.015),
    ],
}


@pytest.mark.parametrize("name", sorted(path.name for path in FOLDER.iterdir()))
def test_an_example_runs_and_gives_its_number(name: str) -> None:
    assert name in KNOWN, f"examples/{name} has no number here: every example asserts one"
    settings = {known.settings for known in KNOWN[name]}
    results = {s: simulate(load(FOLDER / name, s)) for s in settings}
    for result in results.values():
        assert result.attrs["outcome"] == "completed", result.attrs["advice"]
        assert np.isfinite(result.position.values).all()
    for known in KNOWN[name]:
        found = known.number(results[known.settings])
        print(f"{name}: {known.what}: {found:.6g}, known {known.value:g}")
        assert found == pytest.approx(known.value, abs=known.tolerance), known.what


def test_every_known_example_is_there() -> None:
    assert set(KNOWN) <= {path.name for path in FOLDER.iterdir()}
