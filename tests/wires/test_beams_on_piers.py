"""Lines with bending stiffness on inner supports, as scenarios declare them: rest, slow motion, small motion, spectrum.

Sources: see `continuous_beams.py`. Bending is right to the second order of the mesh, in small motion to the fourth.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from continuous_beams import EI, MASS, SPANS, Array, influence, over_unlike_spans, sunk, three_moments
from ropewalk.capabilities import SYSTEM, WIRES, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate, spectrum_of

GRAVITY = 1e-3  # m/s^2: so little that beams between fixed ends do not stretch
BEARING = {"kind": "guided", "along": [1, 0]}
EQUILIBRIUM = {"kind": "equilibrium"}


def deck(spans: tuple[float, ...], per_metre: int, bearing: dict[str, Any] = BEARING, **more: Any) -> dict[str, Any]:
    """A beam on bearings of one kind."""
    at, whole = np.cumsum(spans)[:-1], sum(spans)
    line = {"start": [0, 0], "end": [whole, 0], "length": whole, "mass": MASS, "axial_stiffness": 1e10}
    line |= {"bending_stiffness": EI, "elements": round(per_metre * whole)}
    return line | {"supports": {f"pier{i}": {"at": float(s), **bearing} for i, s in enumerate(at)}} | more


def scenario(line: dict[str, Any], run: dict[str, Any] = EQUILIBRIUM, **more: Any) -> Scenario:
    return Scenario.model_validate({"gravity": GRAVITY, "lines": {"deck": line}, "run": run} | more)


def computed(line: dict[str, Any], run: dict[str, Any] = EQUILIBRIUM, **more: Any) -> xr.Dataset:
    result = simulate(scenario(line, run, **more))
    assert result.attrs["outcome"] == "completed", result.attrs["doubts"]
    return result


def upwards(result: xr.Dataset) -> Array:
    """Forces of all supports upwards from start to end, (frame, support) N."""
    names = [name.removeprefix("deck.") for name in result.support.values.tolist()]
    order = ["start", *(name for name in names if name not in ("start", "end")), "end"]
    return np.asarray(result.reaction.sel(axis="z").values[:, [names.index(name) for name in order]])


def orders(errors: list[float]) -> Array:
    found = np.log2(np.divide(errors[:-1], errors[1:]))
    print("errors", errors, "orders", found)
    return np.asarray(found)


@pytest.mark.parametrize("run", [EQUILIBRIUM, {"kind": "dynamic", "until": 1e-3, "geometry": "linearised"}],
                         ids=["rest", "small motion"])  # fmt: skip
@pytest.mark.parametrize("spans", SPANS, ids=str)
def test_piers_share_a_weight_as_the_three_moment_equation_says(spans: tuple[float, ...], run: dict[str, Any]) -> None:
    assert engine_of(scenario(deck(spans, 2), run)) is WIRES
    exact = three_moments(spans, GRAVITY * MASS)
    errors = [float(np.abs(upwards(computed(deck(spans, n), run))[-1] / exact - 1.0).max()) for n in (2, 4, 8)]
    order = 4.0 if run["kind"] == "dynamic" else 2.0
    assert errors[-1] < 1e-3 ** (0.5 * order)
    assert orders(errors) == pytest.approx([order, order], abs=0.1)


@pytest.mark.parametrize("stiffness", [None, 2e5], ids=["rigid", "elastic"])
def test_piers_bear_a_load_that_moves_slowly_as_their_influence_lines_say(stiffness: float | None) -> None:
    spans = SPANS[1]
    bearing = BEARING if stiffness is None else {"kind": "elastic", "stiffness": [0.0, stiffness]}
    load = {"kind": "force", "on": "deck", "force": [0, -1.0], "travel": {"speed": 1.0}}
    errors = []
    for n in (2, 4, 8):
        run = {"kind": "quasistatic", "positions": 13}
        found = computed(deck(spans, n, bearing), run, gravity=0.0, loads={"load": load})
        exact = influence(spans, found.load_path.values, stiffness or np.inf)
        errors.append(float(np.abs(upwards(found)[:, 1:-1] - exact).max()))
    assert errors[-1] < 1e-3
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.13)


@pytest.mark.parametrize("settled", ["moving", "position"])
def test_a_pier_that_settles_hangs_on_the_beam(settled: str) -> None:
    """By s: -s / f beside the weight, f the deflection of the beam without that pier under a unit force there."""
    spans, s, errors = SPANS[0], 1e-4, []
    bearing = {"kind": "moving", "displacement": [0.0, -s]}
    if settled == "position":
        bearing = BEARING | {"position": [spans[0], -s]}
    exact = three_moments(spans, GRAVITY * MASS)[1] - s / sunk(spans[0], spans[0], sum(spans))
    assert exact < 0.0
    for n in (2, 4, 8):
        soft = deck(spans, n, bearing, axial_stiffness=1e6)  # what the way down stretches pulls by 1e-4 N
        found = upwards(computed(soft))[0]
        assert found.sum() == pytest.approx(GRAVITY * MASS * sum(spans))
        errors.append(abs(float(found[1] / exact - 1.0)))
    assert errors[-1] < 1e-3
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.06)


@pytest.mark.parametrize("spans", SPANS, ids=str)
def test_beams_on_piers_swing_as_the_three_moment_equation_of_vibrating_spans_says(spans: tuple[float, ...]) -> None:
    exact, errors = over_unlike_spans(spans, 4), []
    for n in (2, 4, 8):
        modes = spectrum_of(scenario(deck(spans, n), gravity=0.0), how_many=10).modes
        assert modes is not None
        errors.append(float(np.abs(modes.frequency[:8:2] / exact - 1.0).max()))  # each comes twice, up and sideways
    assert errors[-1] < 1e-3
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.15)


def test_a_pier_that_yields_to_all_is_none_and_one_that_hardly_yields_is_rigid() -> None:
    spans = SPANS[0]

    def shape(**bearing: Any) -> Array:
        return np.asarray(computed(deck(spans, 2, bearing)).position.values[0, :, 1])

    plain = computed(deck(spans, 2, supports={})).position.values[0, :, 1]
    soft, stiff = shape(kind="elastic", stiffness=[0.0, 1e-3]), shape(kind="elastic", stiffness=[0.0, 1e10])
    # What a spring changes is of the part k f of the deflection, or 1 / k f.
    f = sunk(spans[0], spans[0], sum(spans))
    assert np.abs(soft - plain).max() < 2.0 * 1e-3 * f * np.abs(plain).max()
    assert np.abs(stiff - shape(**BEARING)).max() < 2.0 / (1e10 * f) * np.abs(plain).max()


def test_a_line_has_as_many_more_links_as_bring_nodes_to_its_piers() -> None:
    line = deck((7.2, 12.8), 1)
    at_rest = computed(line | {"elements": 24})
    assert at_rest.sizes["node"] == 26  # 9 of 25 links
    assert np.abs(at_rest.xi.values - 7.2).min() < 1e-12
    moving = scenario(line | {"elements": 24}, {"kind": "dynamic", "until": 1e-3})
    assert engine_of(moving) is SYSTEM
    assert simulate(moving).sizes["node"] == 26


def test_reactions_of_piers_are_in_the_summary_by_name() -> None:
    found = computed(deck(SPANS[0], 2))
    assert found.support.values.tolist() == ["deck.start", "deck.end", "deck.pier0"]


def test_a_beam_at_rest_on_its_piers_stays_at_rest() -> None:
    """What holds fast gives way to no force when the rest is found, by 1e-12 m/N or at all."""
    line = deck((10.0, 10.0), 1) | {"mass": 2000.0, "bending_stiffness": 2e9}
    run = {"kind": "dynamic", "until": 0.1, "every": 0.01, "axial_inertia": 4.0}
    asked = scenario(line, run, gravity=9.81)
    assert engine_of(asked) is WIRES
    found = simulate(asked)
    assert found.attrs["outcome"] == "completed", found.attrs["doubts"]
    assert np.abs(found.position.values - found.position.values[0]).max() < 1e-14 * 20.0
