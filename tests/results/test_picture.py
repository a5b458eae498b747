"""Description of frames for renderers: factors, colours, diagrams, symbols."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.results.line_response import responses
from ropewalk.results.picture import Picture
from ropewalk.scenario import loads
from ropewalk.simulate import simulate
from ropewalk.studio.streams import stored

BRIDGE = """\
gravity: 0
lines:
  deck: {start: [0, 0], end: [15, SLOPE], length: DISTANCE, mass: 9e3, bending_stiffness: 7.8e9, axial_stiffness: 1e10,
         elements: 10}
loads:
  train: {kind: axles, on: deck, forces: FORCE, at: [0, 2.5, 19, 21.5], coaches: {count: 2, length: 26.4},
          travel: {speed: 57}}
outputs: {places: {midspan: {on: deck, at: 7.5}}}
run: {kind: dynamic, geometry: linearised, until: 1.4, every: 20 ms}
"""
ROPE = """\
lines:
  rope: {start: [0, 14], end: [150, 0], length: 151.1, mass: 0.55, axial_stiffness: 6e6, elements: 16,
         saddles: {tower: {at: [70, 9], radius: 2}}}
loads:
  person: {kind: mass, on: rope, mass: 75, travel: {speed: 5, from: 20}}
run: {kind: dynamic, until: 0.2, every: 20 ms}
"""


def bridge(force: str = "112e3", slope: float = 0.0) -> Any:
    text = BRIDGE.replace("FORCE", force).replace("SLOPE", str(slope)).replace("DISTANCE", str(np.hypot(15.0, slope)))
    return simulate(loads(text))


@pytest.fixture(scope="module")
def crossed() -> Any:
    return bridge()


@pytest.fixture(scope="module")
def rope() -> Any:
    return simulate(loads(ROPE))


def test_a_bridge_is_described_by_deflection_and_moment(crossed: Any) -> None:
    picture = Picture.of(crossed)
    arrays = Picture(crossed).add(crossed)
    found = responses(crossed)[0]["deck"]
    assert picture.colour is not None
    assert [picture.colour.name, *(q.name for q in picture.diagrams)] == ["deflection", "deflection", "moment"]
    np.testing.assert_allclose(arrays["deflection"], found.deflection)
    np.testing.assert_allclose(arrays["moment"], found.moment)
    shown = picture.range(picture.colour)
    assert shown is not None
    assert (shown["unit"], shown["high"]) == ("mm", pytest.approx(1e3 * float(found.deflection.max())))


@pytest.mark.parametrize(("force", "slope"), [("112e3", 0.0), ("11e3", 0.0), ("1e3", 1.5)])
def test_displacements_of_a_bridge_are_drawn_between_four_and_ten_percent_of_its_length(
    force: str, slope: float
) -> None:
    picture = Picture.of(crossed := bridge(force, slope))
    moved = float(np.abs(crossed["position"] - crossed["position"][0]).max())
    assert 0.038 <= picture.factor * moved / 15.0 <= 0.101  # steps of 2 and 2.5; the slope shortens displacements
    assert f"{picture.factor:e}"[0] in "125"
    assert picture.height_factor == 1.0


def test_a_rope_is_drawn_to_scale_and_coloured_by_its_tension(rope: Any) -> None:
    picture = Picture.of(rope)
    assert (picture.factor, picture.height_factor, picture.diagrams) == (1.0, 1.0, [])
    assert picture.colour is not None
    assert picture.state()["ranges"]["tension"]["unit"] == "kN"


def test_what_does_not_move_has_factor_one_and_no_range() -> None:
    picture = Picture.of(bridge("1 N").isel(time=[0]))
    assert picture.factor == 1.0
    assert picture.state()["ranges"] == {"deflection": None, "moment": None}


def test_frames_in_parts_give_the_same_description(crossed: Any) -> None:
    parts = [crossed.isel(time=slice(0, 1)), crossed.isel(time=slice(1, 30)), crossed.isel(time=slice(30, None))]
    whole, picture = Picture(crossed), Picture(parts[0])
    expected, found = whole.add(crossed), [picture.add(part) for part in parts]
    assert picture.state() == whole.state()
    assert picture.described() == whole.described()
    for name in ("position", "deflection", "moment", "contact_reference"):
        np.testing.assert_array_equal(np.concatenate([part[name] for part in found]), expected[name])


def test_contacts_are_on_the_exaggerated_line(crossed: Any) -> None:
    picture = Picture(crossed)
    arrays = picture.add(crossed)
    there = np.isfinite(arrays["contact_position"]).all(axis=-1)
    assert there.any()
    np.testing.assert_allclose(
        arrays["contact_reference"][there][:, 1], 0.0, atol=1e-4
    )  # of 5 mm: nodes lie on a curve


def test_wheels_of_a_train_keep_their_distances_before_and_behind_the_bridge(crossed: Any) -> None:
    arrays = Picture(crossed).add(crossed)
    x = arrays["wheel_position"][..., 0]
    begun = np.isfinite(arrays["contact_position"][..., 0]).any(axis=1).argmax()
    np.testing.assert_allclose(x[begun:, 0] - x[begun:, 7], 21.5 + 26.4, atol=0.02)  # the deck shortens by its bow
    off = ~np.isfinite(arrays["contact_position"][..., 0])
    assert ((x < 1e-6) | (x > 15.0 - 1e-6))[begun:][off[begun:]].all()


def test_symbols_name_coaches_places_towers_and_people(crossed: Any, rope: Any) -> None:
    of_bridge = [(symbol.kind, symbol.contacts or symbol.nodes) for symbol in Picture(crossed).symbols]
    assert of_bridge == [("place", (5,)), ("coach", (0, 1, 2, 3)), ("coach", (4, 5, 6, 7))]
    tower, person = Picture(rope).symbols
    assert (tower.kind, tower.at, tower.size) == ("saddle", (70.0, 9.0), 2.0)
    assert tower.foot is not None
    assert tower.foot <= 0.0  # the lowest point of the rope
    assert (person.kind, person.contacts) == ("person", (0,))


def test_the_page_receives_the_curves_of_named_places(crossed: Any) -> None:
    curves = stored(crossed)["curves"]
    groups = {group["quantity"]: group for group in curves["groups"]}
    found = responses(crossed)[0]["deck"]
    assert curves["path"] == crossed["time"].values.tolist()
    assert groups["deflection"]["unit"] == "mm"
    np.testing.assert_allclose(groups["deflection"]["curves"]["midspan"], 1e3 * found.at(7.5)["deflection"])
