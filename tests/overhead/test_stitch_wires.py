"""Stitch wires with all geometry and without, beside a network of strings and bars of its own (`stitch_network.py`)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from pydantic import ValidationError

from overhead_cases import EN_2002, formed
from ropewalk.model import Scenario
from ropewalk.overhead.plan_view import MESSENGER, PlanView
from ropewalk.overhead.section import elasticity
from ropewalk.results.contact_statistics import contact_statistics
from ropewalk.simulate import simulate, spectrum_of
from stitch_network import StitchedLine

NETWORK = StitchedLine()
LINE: dict[str, Any] = EN_2002 | {
    "spans": [60, 60, 60], "system_height": 1.8, "stitch_wire": {"length": 18.0, "tension": 2800.0},
    "steady_arms": {"mass": 0.0}, "analysed_spans": [2, 2],
}  # fmt: skip
BARE = StitchedLine(reach=0.0)
SUPPORT, MIDDLE = 60.0, 93.0


def scenario(geometry: str = "nonlinear", until: float = 0.5, load: bool = False, **keys: Any) -> Scenario:
    head = {"kind": "pantograph", "on": "section", "model": "en50318-2002", "travel": {"speed": 60.0, "from": 10.0}}
    return Scenario.model_validate(
        {
            "overhead_lines": {"section": LINE | keys}, "loads": {"head": head} if load else {},
            "run": {"kind": "dynamic", "geometry": geometry, "until": until, "every": 0.05},
        }
    )  # fmt: skip


def tension_along(result: xr.Dataset, line: str) -> tuple[np.ndarray, np.ndarray]:
    """Middles of the links of a wire at the first instant, m, and the part of their tension along x, N."""
    step = np.diff(result["position"].values[0][result["line"].values == line], axis=0)
    x = result["position"].values[0][result["line"].values == line][:-1, 0] + 0.5 * step[:, 0]
    tension = result["tension"].values[0][result["link_line"].values == line]
    return x, tension * step[:, 0] / np.linalg.norm(step, axis=1)


def test_droppers_are_as_long_as_strings_ask_for_with_less_tension_between_clamps() -> None:
    wanted = NETWORK.rest(0.5)[2]
    missed = [np.abs(formed(LINE, element=h).lengths - wanted).max() for h in (1.0, 0.5, 0.25)]
    orders = np.log2(np.divide(missed[:-1], missed[1:]))
    print("off by", missed, "m, orders", orders)
    # The mass of the last piece of a stitch wire, an element long, stands at its clamp: that is of the second order.
    np.testing.assert_allclose(orders, 2.0, atol=0.1)
    assert missed[1] < 2e-4
    np.testing.assert_allclose(formed(LINE).pull, NETWORK.pulls, rtol=1e-9)


def test_static_rise_is_that_of_strings_of_constant_tension_in_small_motion() -> None:
    found = elasticity(formed(LINE), force=1.0, stations=np.array([SUPPORT, MIDDLE]))[1]
    wanted = NETWORK.elasticity(np.array([SUPPORT, MIDDLE]), 0.5, along=False)
    np.testing.assert_allclose(found, wanted, rtol=1e-3)  # 5e-4: a point of a spline beside a node of strings
    without = elasticity(formed(LINE, stitch_wire=None), force=1.0, stations=np.array([SUPPORT]))[1]
    assert found[0] / without[0] == pytest.approx(1.88, abs=0.01)  # what stitch wires are for


def rise(place: float, force: float, **keys: Any) -> float:
    """How much the contact wire rises under a force with all geometry, over the force, m/N."""

    def height(F: float) -> float:
        load = {"kind": "force", "on": "section", "force": [0.0, F], "travel": {"speed": 0.0, "from": place}}
        run = {"kind": "equilibrium"}
        tree = {"overhead_lines": {"section": LINE | keys}, "loads": {"push": load}, "run": run}
        return float(simulate(Scenario.model_validate(tree))["contact_position"].values.ravel()[-1])

    return (height(force) - height(1e-9)) / force


def test_static_rise_with_all_geometry_is_that_of_bars_whose_tensions_are_linked() -> None:
    for place in (SUPPORT, MIDDLE):
        wanted = float(NETWORK.elasticity(np.array([place]), 0.5)[0])
        assert rise(place, 10.0) == pytest.approx(wanted, rel=1e-3)
    # The piece of the messenger between the clamps is as long as the stitch wire allows: 4 to 5 % less at the support.
    apart = NETWORK.elasticity(np.array([SUPPORT]), 0.5) / NETWORK.elasticity(np.array([SUPPORT]), 0.5, along=False)
    assert apart[0] == pytest.approx(0.955, abs=0.002)
    alone = BARE.elasticity(np.array([SUPPORT]), 0.5) / BARE.elasticity(np.array([SUPPORT]), 0.5, along=False)
    assert alone[0] == pytest.approx(1.0, abs=2e-3)  # without stitch wires nothing of the kind


def test_small_loads_lift_the_line_in_proportion() -> None:
    limit = 2.0 * rise(SUPPORT, 10.0) - rise(SUPPORT, 20.0)
    off = [rise(SUPPORT, force) - limit for force in (20.0, 40.0, 80.0)]
    orders = np.log2(np.divide(off[1:], off[:-1]))
    print("off by", off, "orders", orders)
    np.testing.assert_allclose(orders, 1.0, atol=0.1)


def test_natural_frequencies_are_those_of_the_network() -> None:
    wanted = NETWORK.frequencies(6, 0.25)
    missed = []
    for h in (1.0, 0.5):
        modes = spectrum_of(scenario(element=h), how_many=20).modes
        upright = np.abs(modes.shape[:, :, 1]).max(axis=1) < 0.5
        missed.append(np.abs(np.array(modes.frequency)[upright][:6] / (2.0 * np.pi) / wanted - 1.0).max())
    print("off by", missed)
    assert missed[1] < 5e-4
    assert missed[1] < 0.4 * missed[0]


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"messenger_wire": {"bending_stiffness": 131.7}, "contact_wire": {"bending_stiffness": 195.0}},
        {"spans": [60, 53.3, 61.7], "droppers": {"per_span": 8}},
        {"ends": "anchored", "messenger_supports": {"along": "held"}},
        {"steady_arms": {"stagger": 0.2}},
        {"steady_arms": {"stagger": 0.2}, "messenger_supports": {"stagger": "straight"}},
    ],
    ids=["strings", "stiff", "clamps between nodes", "anchored", "staggered", "messenger straight"],
)
def test_a_line_with_stitch_wires_that_nothing_touches_stays_where_it_was_formed(keys: dict[str, Any]) -> None:
    still = simulate(scenario(**keys))
    place = still["position"].values
    # Equilibrium is found to 1e-9 m at worst, where wires may move sideways; explicit steps hold it.
    assert np.abs(place - place[0]).max() < 1e-8
    assert float(still["energy"].sel(form="kinetic").max()) < 1e-9
    section = formed(LINE | keys)
    if "stagger" not in keys.get("steady_arms", {}):
        np.testing.assert_allclose(place[0][:, -1], section.rest.position[2], atol=1e-8)
        slack = 1e-6 if len(keys) != 2 or "contact_wire" not in keys else 2e-4  # what bends pulls a little, too
    else:
        slack = 5e-3  # droppers and stitch wires that lean stretch them a little
    x, T = tension_along(still, "section.messenger")
    end = section.supports[1]
    inside, outside = np.abs(x - end) < 6.0, (np.abs(x - end) > 12.0) & (x < 0.5 * (end + section.supports[2]))
    np.testing.assert_allclose(T[inside], 16e3 - 2.8e3, rtol=slack)
    np.testing.assert_allclose(T[outside], 16e3, rtol=slack)
    np.testing.assert_allclose(tension_along(still, "section.stitch.1")[1], 2.8e3, rtol=slack)


def test_a_pantograph_feels_both_motions_alike_but_for_the_linked_tensions() -> None:
    keys = {"spans": [60] * 4, "analysed_spans": [2, 3], "element": 0.5, "steady_arms": {"mass": 1 / 3}}
    found = {}
    for geometry in ("nonlinear", "linearised"):
        result = simulate(scenario(geometry, 3.2, load=True, **keys))
        found[geometry] = contact_statistics(result)["head"]
        energy = result["energy"]
        turned = 0.5 * float(
            np.abs(energy.diff("time")).sum() - np.abs(energy.sel(form="imbalance").diff("time")).sum()
        )
        assert float(np.abs(energy.sel(form="imbalance")).max()) < 0.01 * turned
        stitch = result["tension"].values[:, result["link_line"].values == "section.stitch.2"]
        swing = float(np.ptp(stitch))
        # Up and down by hundreds of N as a pantograph passes; small motion has constant tensions.
        assert (swing > 300.0) if geometry == "nonlinear" else (swing == 0.0)
    full, small = found["nonlinear"], found["linearised"]
    print(full.deviation, small.deviation, full.uplift, small.uplift)
    assert full.mean == pytest.approx(small.mean, abs=1.0)
    assert full.deviation == pytest.approx(small.deviation, abs=1.5)
    # As the static rise at the supports: 4 to 5 % less.
    assert full.uplift / small.uplift == pytest.approx(0.955, abs=0.02)


def test_a_messenger_in_plan_view_runs_to_the_inside_of_its_kinks_as_strings_do() -> None:
    T, t, L, c, b = 16e3, 2.8e3, 60.0, 9.0, 0.2
    supports, stagger = np.arange(13) * L, b * (-1.0) ** np.arange(13)
    view = PlanView(supports, stagger, np.zeros(11), T, t, c, 0.5)
    clamp = float(view.aside(MESSENGER, np.array([6.0 * L + c]))[0])
    # A zigzag is as far aside at both clamps, so stitch wires do not pull aside; in the middle of a span it is zero.
    assert clamp == pytest.approx(b * (T - t) / c / ((T - t) / c + T / (0.5 * L - c)))
    bare = PlanView(supports, stagger, np.zeros(11), T)
    np.testing.assert_allclose(bare.aside(MESSENGER, supports), stagger)


def test_a_messenger_that_stitch_wires_would_make_slack_is_refused() -> None:
    with pytest.raises(
        ValidationError, match="takes over all of the messenger's tension between its clamps; write less"
    ):
        scenario(stitch_wire={"length": 18.0, "tension": 16e3})
