"""Curves with all geometry: chords laid out straight turn at the supports, where wires are pulled to the inside."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.results.contact_statistics import contact_statistics
from ropewalk.simulate import simulate

L, SPANS = 50.0, 4
LINE: dict[str, Any] = {
    "spans": [L] * SPANS, "droppers": {"per_span": 6}, "element": 0.5, "system_height": 1.8, "analysed_spans": [2, 3],
}  # fmt: skip
STITCH = {"length": 14.0, "tension": 2500.0}
SAME = {"stagger": [0.2] * (SPANS + 1)}
HEAD = {"kind": "pantograph", "on": "line", "model": "en50318-2002", "travel": {"speed": 55.0, "from": 10.0}}


def ran(until: float = 2.0, load: dict[str, Any] | None = HEAD, start: Any = None, **keys: Any) -> xr.Dataset:
    run = {"kind": "dynamic", "until": until, "every": 0.05, "geometry": keys.pop("geometry", "nonlinear")}
    tree = {
        "overhead_lines": {"line": LINE | keys}, "loads": {"head": load} if load else {},
        "run": run | ({"start": start} if start else {}),
    }  # fmt: skip
    return simulate(Scenario.model_validate(tree))


def as_polygon(radius: float) -> dict[str, Any]:
    """Staggers of a straight track whose wires run through the same points: those of a circle, from the first chord."""
    s = L * np.arange(SPANS + 1)
    return {"stagger": (0.2 + 0.5 * s * (s - s[-1]) / radius).tolist()}


@pytest.mark.parametrize("stitch", [None, STITCH], ids=["plain", "stitch wires"])
def test_a_line_on_a_curve_is_the_same_line_on_a_straight_track_that_goes_through_its_points(stitch: Any) -> None:
    off = {}
    for radius in (5000.0, 2500.0):
        curve = ran(radius=radius, steady_arms=SAME, stitch_wire=stitch)
        straight = ran(steady_arms=as_polygon(radius), stitch_wire=stitch)
        forces = [result["sampled_force"].values[1:].ravel() for result in (curve, straight)]
        off[radius] = float(np.sqrt(np.nanmean((forces[0] - forces[1]) ** 2)))
        names = [f"line.arm.{i}" for i in (1, 2, 3)]
        aside = [result["reaction"].sel(support=names).values[0, :, 1] for result in (curve, straight)]
        np.testing.assert_allclose(*aside, rtol=2e-3)
    print("rms", off)
    # Of a force that varies by 23 N: a wire through the points is longer by half the square of its slope, up to 0.03.
    assert off[5000.0] < 0.1
    assert off[2500.0] < 0.3


@pytest.mark.parametrize("radius", [600.0, -600.0])
def test_wires_rest_on_a_curve_as_arms_hold_them(radius: float) -> None:
    still = ran(until=0.3, load=None, radius=radius, steady_arms=SAME)
    place = still["position"].values
    assert np.abs(place - place[0]).max() < 1e-8
    assert float(still["energy"].sel(form="kinetic").max()) < 1e-9
    # T L / R: lateral pull per length, times a span.
    arms = still["reaction"].sel(support=[f"line.arm.{i}" for i in (1, 2, 3)]).values[0, :, 1]
    np.testing.assert_allclose(arms, -20e3 * L / radius, rtol=1e-3)
    masts = still["reaction"].sel(support=[f"line.support.{i}" for i in (1, 2, 3)]).values[0, :, 1]
    np.testing.assert_allclose(masts, -16e3 * L / radius, rtol=1e-3)
    # Straight from support to support, seen from the middle of the track: b + x (L - x) / 2 R.
    x, y = place[0][still["line"].values == "line.contact"][:, :2].T
    along = x % L
    np.testing.assert_allclose(y, 0.2 + 0.5 * along * (L - along) / radius, atol=1.5e-3)
    for name, T in (("line.contact", 20e3), ("line.messenger", 16e3)):
        np.testing.assert_allclose(still["tension"].values[0][still["link_line"].values == name], T, rtol=1e-3)


def test_a_curve_to_the_other_side_is_the_mirrored_one() -> None:
    left = ran(radius=900.0, steady_arms={"stagger": 0.2}, stitch_wire=STITCH)
    right = ran(radius=-900.0, steady_arms={"stagger": -0.2}, stitch_wire=STITCH)
    forces = [result["sampled_force"].values[1:].ravel() for result in (left, right)]
    np.testing.assert_allclose(*forces, atol=1e-4)
    y = [result["contact_position"].values[1:, 0, 1] for result in (left, right)]
    np.testing.assert_allclose(y[0], -y[1], atol=1e-6)


def test_the_wire_sweeps_a_head_on_a_curve_and_turns_it_as_in_small_motion() -> None:
    found, roll = {}, {}
    head = {
        "kind": "pantograph", "on": "line", "masses": [15.0, 7.2], "stiffness": [50.0, 4200.0], "damping": [90.0, 10.0],
        "static_force": 100.0, "travel": {"speed": 55.0, "from": 10.0},
        "head": {"strips": 1, "roll": {"inertia": 1.0, "spring_spacing": 0.9}},
    }  # fmt: skip
    for geometry in ("nonlinear", "linearised"):
        result = ran(radius=800.0, steady_arms={"stagger": [-0.25] * 5}, geometry=geometry, load=head)
        found[geometry] = contact_statistics(result)["head"]
        bodies = result["body"].values.tolist()
        left, right = (
            result["body_position"].values[10:, bodies.index(f"head.head.{s}"), -1] for s in ("left", "right")
        )
        roll[geometry] = (left - right) / 0.9
        if geometry == "nonlinear":
            x, y = result["contact_position"].values[1:, 0, :2].T
            along = x % L
            # Swings sideways by some millimetres, as on a straight track.
            np.testing.assert_allclose(y, -0.25 + 0.5 * along * (L - along) / 800.0, atol=0.02)
    assert found["nonlinear"].mean == pytest.approx(found["linearised"].mean, abs=1.0)
    assert found["nonlinear"].deviation == pytest.approx(found["linearised"].deviation, rel=0.05)
    print(np.ptp(roll["linearised"]), np.abs(roll["nonlinear"] - roll["linearised"]).max())
    np.testing.assert_allclose(roll["nonlinear"], roll["linearised"], atol=0.01 * np.ptp(roll["linearised"]))


def test_a_motion_on_a_curve_begins_with_what_was_stored(tmp_path: Path) -> None:
    still = ran(until=0.1, load=None, radius=800.0, steady_arms=SAME, stitch_wire=STITCH)
    file = tmp_path / "still.nc"
    still.to_netcdf(file)
    again = ran(until=0.1, load=None, radius=800.0, steady_arms=SAME, stitch_wire=STITCH,
                start={"kind": "result", "file": str(file)})  # fmt: skip
    np.testing.assert_allclose(again["position"].values[-1], still["position"].values[0], atol=1e-7)
    assert float(again["energy"].sel(form="kinetic").max()) < 1e-9
