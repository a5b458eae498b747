"""Lines with segments: steps of stiffness, mass and bed, against transfer matrices, Mohr and Hermite elements."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.errors import ScenarioError
from ropewalk.model.scenario import Scenario
from ropewalk.results.line_response import responses
from ropewalk.results.statistics import summary
from ropewalk.scenario import loads
from ropewalk.simulate import simulate, spectrum_of
from stepped_beams import HermiteBeam, Piece, frequencies, sag

LENGTH, EI, MASS = 20.0, 2e9, 1e4  # m, N m^2, kg/m
WEAK: dict[str, Any] = {"from": 8.0, "to": 13.0, "bending_stiffness": 0.5 * EI, "mass": 0.4 * MASS}
PIECES: list[Piece] = [(8.0, EI, MASS), (5.0, 0.5 * EI, 0.4 * MASS), (7.0, EI, MASS)]
AT_REST = {"kind": "equilibrium"}
SMALL = {"kind": "dynamic", "geometry": "linearised"}


def bridge(run: dict[str, Any], load: dict[str, Any] | None = None, gravity: float = 0.0, **keys: Any) -> Scenario:
    """A beam on a hinge and a roller with a weak and light part."""
    deck = {
        "start": [0.0, 0.0], "end": [LENGTH, 0.0], "length": LENGTH, "mass": MASS, "bending_stiffness": EI,
        "axial_stiffness": 1e10, "end_support": {"kind": "guided", "along": [1.0, 0.0]}, "elements": 40,
        "segments": {"weak": WEAK}, **keys,
    }  # fmt: skip
    found = {"load": {"on": "deck", **load}} if load is not None else {}
    return loads(json.dumps({"gravity": gravity, "lines": {"deck": deck}, "loads": found, "run": run}))


def lowest(scenario: Scenario, count: int) -> Any:
    """Frequencies of vertical modes, Hz: each comes twice, for sideways the beam is the same."""
    modes = spectrum_of(scenario, how_many=2 * count).modes
    return modes.frequency[: 2 * count : 2] / (2.0 * np.pi)


def along(x: Any) -> tuple[Any, Any, Any]:
    """Bending stiffness, mass and bed of `bridge`."""
    weak = (x > WEAK["from"]) & (x < WEAK["to"])
    return np.where(weak, WEAK["bending_stiffness"], EI), np.where(weak, WEAK["mass"], MASS), 0.0 * x


def sunk(result: xr.Dataset) -> Any:
    """Deflections in the middle, m, (frame,)."""
    return -result.position.values[:, result.sizes["node"] // 2, -1]


@pytest.mark.parametrize("between", [0.0, 0.1], ids=["at nodes", "between nodes"])
@pytest.mark.parametrize("clamped", [False, True], ids=["hinges", "clamped"])
def test_frequencies_are_those_of_transfer_matrices(clamped: bool, between: float) -> None:
    """Steps at nodes, or a fifth of a link beside them; to the second order of the mesh."""
    at = {**WEAK, "from": WEAK["from"] + between, "to": WEAK["to"] + 2.0 * between}
    pieces = [(at["from"], EI, MASS), (at["to"] - at["from"], 0.5 * EI, 0.4 * MASS), (LENGTH - at["to"], EI, MASS)]
    end = {"kind": "fixed", "clamped": clamped}
    keys = {"start_support": end, "end_support": end, "segments": {"weak": at}}
    exact = frequencies(pieces, 1, (clamped, clamped))
    missed = [float(np.abs(lowest(bridge(AT_REST, elements=n, **keys), 1) / exact - 1.0).max()) for n in (40, 80)]
    assert missed[-1] < 2e-4
    # Between nodes a step is nearer to its node on the finer mesh, 0.4 of a link and not 0.2, so that orders scatter.
    assert 1.9 < np.log2(missed[0] / missed[1]) < (2.5 if between else 2.2)


def test_it_sags_as_mohr_has_it() -> None:
    """A weight so small that it stays straight: large deflections take (w/L)^2, here 1e-8."""
    gravity = 0.0981
    missed = [
        sunk(simulate(bridge(AT_REST, gravity=gravity, elements=n)))[-1] / sag(PIECES, 0.5 * LENGTH, gravity) - 1.0
        for n in (20, 40, 80)
    ]
    assert abs(missed[-1]) < 1e-4
    assert np.log2(missed[0] / missed[1]) == pytest.approx(2.0, abs=0.2)
    assert np.log2(missed[1] / missed[2]) == pytest.approx(2.0, abs=0.15)


@pytest.fixture(scope="module")
def crossed() -> Any:
    """Deflection of the middle under a force of 200 kN at 25 m/s, by 14 modes of Hermite elements, every 20 ms."""
    times = np.arange(0.0, 0.79, 0.02)
    return HermiteBeam.of(LENGTH, 40, along=along).passage(times, 25.0, 2e5, 0.5 * LENGTH, modes=14)


@pytest.mark.parametrize("run", [SMALL, {"kind": "linear", "modes": 14}], ids=["linearised", "by modes"])
def test_a_force_crosses_as_over_hermite_elements(run: dict[str, Any], crossed: Any) -> None:
    load, exact = {"kind": "force", "force": [0.0, -2e5], "travel": {"speed": 25.0}}, crossed
    missed = [
        float(np.abs(sunk(simulate(bridge({**run, "until": 0.78, "every": 0.02}, load, elements=n))) - exact).max())
        for n in (20, 40)
    ]
    assert missed[1] < 1e-3 * float(exact.max())
    assert np.log2(missed[0] / missed[1]) == pytest.approx(2.2, abs=0.2)


def test_a_mass_crosses_as_over_hermite_elements() -> None:
    """A quarter of the mass of the bridge: it feels steps of mass and stiffness by what is near to it."""
    load = {"kind": "mass", "mass": 4e4, "force": [0.0, -4e5], "travel": {"speed": 25.0}}
    times = np.arange(0.0, 0.77, 0.02)
    exact = HermiteBeam.of(LENGTH, 40, along=along).passage(times, 25.0, 4e5, 0.5 * LENGTH, 4e4, modes=14)
    found = sunk(simulate(bridge({**SMALL, "until": 0.76, "every": 0.02}, load)))
    assert float(np.abs(found - exact).max()) < 4e-3 * float(exact.max())


def test_a_step_of_the_bed() -> None:
    """A stiffer bed behind the middle, under a force that stands at 21 places: to the second order."""
    stiff = {"behind": {"from": 10.0, "to": 20.0, "foundation": 5e6}}
    beam = HermiteBeam.of(LENGTH, 160, along=lambda x: (EI + 0 * x, MASS + 0 * x, np.where(x < 10.0, 1e6, 5e6)))
    load = {"kind": "force", "force": [0.0, -2e5], "travel": {"speed": 1.0}}
    missed = []
    for elements in (20, 40):
        keys = {"foundation": 1e6, "segments": stiff, "elements": elements}
        place = simulate(bridge({"kind": "quasistatic", "positions": 21}, load, **keys)).contact_position.values[:, 0]
        exact = np.array([beam.deflection(x, 2e5, x) for x in np.clip(place[:, 0], 0.0, LENGTH)])
        missed.append(float(np.abs(place[:, -1] + exact).max()) / float(exact.max()))
    assert missed[1] < 4e-4
    assert np.log2(missed[0] / missed[1]) == pytest.approx(2.0, abs=0.15)


@pytest.mark.parametrize("at", [5.0, 5.2])
@pytest.mark.parametrize("segments", [True, False], ids=["segments", "uniform"])
def test_moments_are_those_of_statics(segments: bool, at: float, tmp_path: Path) -> None:
    """The bridge is statically determinate: moments do not know stiffness, nor how nodes share the force.

    Before this was told of splines, 0.14 F h were missing under the force.
    """
    load = {"kind": "force", "force": [0.0, -2e5], "travel": {"speed": 0.0, "from": at}}
    (flat := tmp_path / "flat.csv").write_text("0, 0\n20, 0\n")
    part = {"weak": {"from": 8.0, "to": 13.0, "damage": 0.5}}
    keys = {"segments": part} if segments else {"segments": {}, "profile": {"file": str(flat)}}
    response = responses(simulate(bridge(AT_REST, load, **keys)))[0]["deck"]
    assert response.moment is not None
    x = response.xi
    exact = np.where(x < at, (1.0 - at / LENGTH) * 2e5 * x, at / LENGTH * 2e5 * (LENGTH - x))
    # The beam sags by 1e-5 of its length.
    np.testing.assert_allclose(response.moment[-1], exact, atol=1e-5 * float(exact.max()))


@pytest.mark.parametrize("at", [10.0, 5.2])
def test_moments_at_clamped_ends_are_those_of_statics(at: float, tmp_path: Path) -> None:
    """M = -F a b^2 / L^2 at the start. Without the turn of the first link a third of it was missing there."""
    load = {"kind": "force", "force": [0.0, -2e5], "travel": {"speed": 0.0, "from": at}}
    (flat := tmp_path / "flat.csv").write_text("0, 0\n20, 0\n")
    end = {"kind": "fixed", "clamped": True}
    keys = {"segments": {}, "profile": {"file": str(flat)}, "start_support": end, "end_support": end}
    response = responses(simulate(bridge(AT_REST, load, **keys)))[0]["deck"]
    assert response.moment is not None
    x, a, b = response.xi, at, LENGTH - at
    start, left = -2e5 * a * b**2 / LENGTH**2, 2e5 * b**2 * (3.0 * a + b) / LENGTH**3
    exact = start + left * x - 2e5 * np.maximum(x - at, 0.0)
    np.testing.assert_allclose(response.moment[-1], exact, atol=5e-5 * abs(start))


def test_a_segment_like_the_rest_changes_nothing(tmp_path: Path) -> None:
    load = {"kind": "force", "force": [0.0, -2e5], "travel": {"speed": 25.0}}
    run = {"kind": "dynamic", "until": 0.3, "every": 0.05, "method": "verlet"}
    like = {"same": {"from": 7.3, "to": 12.2, "mass": MASS, "bending_stiffness": EI}}
    (flat := tmp_path / "flat.csv").write_text("0, 0\n20, 0\n")  # so that the system moves it without segments, too
    one, other = (
        simulate(bridge(run, load, segments=segments, **keys))
        for segments, keys in ((like, {}), ({}, {"profile": {"file": str(flat)}}))
    )
    np.testing.assert_allclose(one.position.values, other.position.values, rtol=0.0, atol=1e-12)


def test_energy_is_kept_with_all_geometry() -> None:
    load = {"kind": "mass", "mass": 4e4, "travel": {"speed": 25.0}}
    run = {"kind": "dynamic", "until": 0.76, "every": 0.02}
    result = simulate(bridge(run, load, gravity=9.81, end_support={"kind": "fixed"}))
    energy = summary(result)["energy"]
    assert energy["largest_imbalance"]["value"] < 1e-5 * energy["turnover"]


MISTAKES = {
    "from": ({"from": 12.0, "to": 8.0, "mass": 1.0}, "segments.weak.to: is not behind from"),
    "nothing": ({"from": 8.0, "to": 12.0}, "segments.weak: the segment is like the rest of the line"),
    "both": ({"from": 8.0, "to": 12.0, "bending_stiffness": 1e9, "damage": 0.3}, "damage exclude each other"),
    "all": ({"from": 8.0, "to": 12.0, "damage": 1.0}, "nothing would be left"),
    "hinge": ({"from": 8.0, "to": 12.0, "bending_stiffness": 0.0}, "would be a hinge"),
    "beyond": ({"from": 8.0, "to": 22.0, "mass": 1.0}, "is beyond the end of the line"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_name_their_keys(name: str) -> None:
    segment, told = MISTAKES[name]
    with pytest.raises(ScenarioError, match=re.escape(told)):
        bridge(AT_REST, segments={"weak": segment})


@pytest.mark.parametrize("what", ["inextensible lines", "lines over sheaves"])
def test_where_one_mass_is_known_segments_are_refused(what: str) -> None:
    """Before they were, an inextensible rope with a light part diverged."""
    light = {"segments": {"light": {"from": 8.0, "to": 13.0, "mass": 0.1 * MASS}}, "bending_stiffness": 0.0}
    keys: dict[str, Any] = {"law": {"kind": "inextensible"}, "length": 21.0, "axial_stiffness": None}
    if what == "lines over sheaves":
        keys = {"sheaves": {"wheel": {"at": [12.0, 1.0]}}}
    run = {"kind": "dynamic", "until": 0.1, "every": 0.1}
    with pytest.raises(ScenarioError, match=rf"lines\.deck\.segments: is not implemented for {what}"):
        simulate(bridge(run, gravity=9.81, end_support={"kind": "fixed"}, **light, **keys))


def test_segments_do_not_overlap_and_ropes_do_not_bend() -> None:
    two = {"one": {"from": 2.0, "to": 9.0, "mass": 1.0}, "two": {"from": 8.0, "to": 12.0, "mass": 2.0}}
    with pytest.raises(ScenarioError, match=r"segments\.two\.from: begins within segment one"):
        bridge(AT_REST, segments=two)
    with pytest.raises(ScenarioError, match=r"segments\.weak\.bending_stiffness: the line has no bending stiffness"):
        bridge(AT_REST, bending_stiffness=0.0)
