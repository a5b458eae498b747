"""What is known beside the simulation of the examples of overhead lines."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ropewalk.results.contact_statistics import contact_statistics, samples
from ropewalk.results.statistics import summary


def static_force(
    result: xr.Dataset, name: str, base: float = 50.0, springs: tuple[float, ...] = (4200.0, 50e3)
) -> float:
    """The force on the lowest mass that a mean contact force and a mean height take in equilibrium, N.

    That mass stands above the mean contact by what all springs over it give, and the spring of the base pulls it down
    by its height over the supports. The wire starts at z = 0. What is not said is that of EN 50318:2002.
    """
    found = contact_statistics(result)[name]
    flat = samples(result)
    k = flat["load"].values.tolist().index(name)
    station, height = (flat[key].values[:, k] for key in ("station", "height"))
    here = (station >= found.first) & (station <= found.last)
    lowest = float(height[here].mean()) + found.mean * sum(1.0 / k for k in springs)
    return found.mean + base * lowest


def failures(result: xr.Dataset, name: str) -> int:
    """How many limits a pantograph breaks."""
    checks = summary(result)["pantographs"][name]["limits"]["checks"]
    return sum(check["verdict"] == "FAIL" for check in checks)


def sag_without_a_dropper(result: xr.Dataset, begin: float, end: float) -> float:
    """How much lower than at two stations the contact wire hangs halfway between them at rest, m."""
    place = result.position.isel(time=0, node=np.flatnonzero(result.line.values == "line.contact")).values
    low, middle, high = np.interp([begin, 0.5 * (begin + end), end], place[:, 0], place[:, -1])
    return 0.5 * float(low + high) - float(middle)


def pull_after_failure(result: xr.Dataset) -> float:
    """The largest force of dropper line.6.5 from 4.5 s on, N; before it bears its wire."""
    force = result.tie_force.sel(tie="line.6.5")
    assert float(force.sel(time=slice(0.0, 4.45)).min()) >= 0.0
    assert float(force.sel(time=slice(0.0, 4.45)).mean()) > 0.8 * 6.5 * 1.35 * 9.81
    return float(abs(force.sel(time=slice(4.5, None))).max())


def roll_over_moment(result: xr.Dataset) -> float:
    """Moment k b^2/4 roll of the springs at the horns over F y of the wire, which presses down its side; from 100 m on.

    Staggers of 200 mm in spans of 50 m, on the left first, on a curve of 3000 m from the third span on.
    """
    bodies, frames = result["body"].values.tolist(), np.flatnonzero(result.time.values > 1.2)
    left, right = (
        result.body_position.values[frames, bodies.index(f"front.head.{side}"), -1] for side in ("left", "right")
    )
    x = result.body_position.values[frames, bodies.index("front.head"), 0]
    force = result.contact_force.values[frames, :, -1].sum(axis=1)
    along = x % 50.0
    y = np.interp(x, 50.0 * np.arange(7), [0.2, -0.2, 0.2, -0.2, 0.2, -0.2, 0.2]) + along * (50.0 - along) / 6000.0
    return float((4200.0 * 0.45**2 * (right - left) / 0.9 * y).sum() / (force * y**2).sum())


def messenger_over_a_support(result: xr.Dataset, place: float) -> float:
    """Tension along x of the messenger at the first instant where it is held, N."""
    r = result.position.isel(time=0).values[result.line.values == "line.messenger"]
    tension = result.tension.isel(time=0).values[result.link_line.values == "line.messenger"]
    link = int(np.searchsorted(r[:, 0], place)) - 1
    step = r[link + 1] - r[link]
    return float(tension[link] * step[0] / np.linalg.norm(step))


def lateral_pull(result: xr.Dataset, support: int) -> float:
    """What arm and mast of a support bear sideways at the first instant, N."""
    names = [f"line.arm.{support}", f"line.support.{support}"]
    return float(result.reaction.isel(time=0).sel(support=names, axis="y").sum())


def tension_at_first(result: xr.Dataset, line: str) -> float:
    """Tension of a wire in the middle at the first instant, N."""
    own = result.tension.isel(time=0).values[result.link_line.values == line]
    return float(own[own.size // 2])
