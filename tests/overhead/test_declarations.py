"""Declarations of overhead lines and pantographs: defaults, what is written is read again, and what is refused."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from overhead_cases import EN_2002, SIMPLE_AC
from ropewalk.errors import Refused
from ropewalk.model.overhead import OverheadLine
from ropewalk.model.pantograph import Pantograph

PANTOGRAPH = {"on": "section", "model": "en50318-2002", "travel": {"speed": "250 km/h", "from": "10 m"}}
OWN = {"masses": [15, 7.2], "stiffness": [50, 4200], "damping": [90, 10], "static_force": "120 N"}


def test_who_reads_nothing_gets_a_whole_line() -> None:
    line = OverheadLine.model_validate({"spans": {"count": 10, "length": "60 m"}})
    assert line.length == 600.0
    assert line.dropper_places[9] == pytest.approx([60.0 / 9 * (i + 0.5) for i in range(9)])
    assert line.messenger_supports.swings
    assert line.analysed == (4, 7)
    assert (line.contact_wire.tension, line.messenger_wire.tension) == (20e3, 16e3)


@pytest.mark.parametrize(("count", "analysed"), [(1, (1, 1)), (2, (1, 2)), (3, (2, 2)), (10, (4, 7)), (20, (6, 15))])
def test_a_quarter_of_the_spans_is_left_out_at_either_end(count: int, analysed: tuple[int, int]) -> None:
    assert OverheadLine.model_validate({"spans": {"count": count, "length": 60}}).analysed == analysed


def test_one_pre_sag_is_a_parabola_through_the_outer_droppers() -> None:
    line = OverheadLine.model_validate(SIMPLE_AC | {"pre_sag": "55 mm"})
    # The published list of this line is that, in whole millimetres.
    assert line.sags[0] == pytest.approx([0, 0.024, 0.041, 0.052, 0.055, 0.052, 0.041, 0.024, 0], abs=5e-4)


def test_stagger_goes_from_side_to_side() -> None:
    line = OverheadLine.model_validate({"spans": [60, 60], "steady_arms": {"stagger": "20 cm"}})
    assert line.staggers == (0.2, -0.2, 0.2)


@pytest.mark.parametrize("line", [EN_2002, SIMPLE_AC, {"spans": [50, "60 m"], "stitch_wire": {}, "pre_sag": 0.02}])
def test_a_line_that_is_written_is_read_again(line: dict[str, Any]) -> None:
    declared = OverheadLine.model_validate(line)
    assert OverheadLine.model_validate(declared.model_dump(mode="json", by_alias=True)) == declared


@pytest.mark.parametrize("keys", [PANTOGRAPH, OWN | {"on": "s", "travel": {"speed": 70}, "irregularity": "wire.csv"}])
def test_a_pantograph_that_is_written_is_read_again(keys: dict[str, Any]) -> None:
    declared = Pantograph.model_validate(keys)
    assert Pantograph.model_validate(declared.model_dump(mode="json", by_alias=True)) == declared
    assert declared.starts()[0].measured == "horizontal"


def problems_of(model: type[OverheadLine] | type[Pantograph], keys: dict[str, Any]) -> list[tuple[str, str]]:
    with pytest.raises(ValidationError) as caught:
        model.model_validate(keys)
    found = []
    for error in caught.value.errors():
        cause = error.get("ctx", {}).get("error")
        assert isinstance(cause, Refused), error  # said in our own words
        assert cause.remedy, cause
        given = str(error["input"]) if cause.given is None else cause.given
        found.append((".".join(map(str, error["loc"])), f"{cause.wrong}, given {given}; {cause.remedy}"))
    return found


AT = EN_2002["droppers"]["at"]
LINES: list[tuple[dict[str, Any], str, str]] = [
    ({"spans": 3}, "spans", "write {count: 10, length: 60 m}, or a list of all lengths"),
    ({"spans": []}, "spans", "the list is empty"),
    ({"spans": {"count": 0, "length": 60}}, "spans.count", "is too small"),
    ({"spans": [60, "-1 m"]}, "spans.1", "must be positive"),
    ({"spans": [60, [60]]}, "spans.1", "a list among single values"),
    (
        {"spans": [60] * 10001, "analysed_spans": None},
        "spans",
        "too many spans, given 10001 spans; write at most 10000",
    ),
    ({"element": "5 m"}, "element", "the links are too long for the spans, given 5 m; write at most 3.75 m"),
    ({"analysed_spans": [5, 11]}, "analysed_spans", "not spans of this line, given [5, 11]; write the first and the"),
    ({"analysed_spans": [6, 5]}, "analysed_spans", "the first span is after the last"),
    ({"analysed_spans": 5}, "analysed_spans", "write [first, last], counted from 1"),
    (
        {"droppers": {"at": [5, 62]}},
        "droppers.at.1",
        "outside its span, given 62 m in span 1 of 60 m; write places",
    ),
    ({"droppers": {"at": [0, 30]}}, "droppers.at.0", "outside its span, given 0 m in span 1 of 60 m"),
    ({"droppers": {"at": [30, 20]}}, "droppers.at.1", "the dropper before it is at 30 m: sort the places"),
    ({"droppers": {"at": [30, 30.1]}}, "droppers.at.1", "at least an element (0.5 m) beyond the dropper before it"),
    ({"droppers": {"at": [[30]] * 9}}, "droppers.at", "does not go with the spans, given 9 lists for 10 spans"),
    ({"droppers": {"at": [[30]] * 9 + [[61]]}}, "droppers.at.9.0", "given 61 m in span 10 of 60 m"),
    ({"droppers": {"at": []}}, "droppers.at", "the list is empty, given []; write [1 m, 2 m] or a list of such lists"),
    ({"droppers": {"at": AT, "per_span": 9}}, "droppers.per_span", "at and per_span exclude each other"),
    ({"droppers": {"mass": 1, "mass_per_length": 1}}, "droppers.mass_per_length", "give one of them"),
    ({"droppers": {"pushes": "1 MN/m"}}, "droppers.pushes", "cannot push harder than it pulls, given 1e+06 N/m"),
    ({"droppers": {"at": AT, "lengths": [1, 1]}}, "droppers.lengths", "given 2 lengths for the 9 droppers of span 1"),
    ({"droppers": {"at": AT, "lengths": [[1] * 9] * 3}}, "droppers.lengths", "given 3 lists for 10 spans"),
    (
        {"droppers": {"at": AT, "lengths": [1] * 9}, "pre_sag": 0.01},
        "pre_sag",
        "write the lengths or pre_sag",
    ),
    ({"pre_sag": [0, 0.1, 0]}, "pre_sag", "given 3 values for the 9 droppers of span 1; give 9 values"),
    ({"pre_sag": "-3 cm"}, "pre_sag", "must not be negative"),
    ({"pre_sag": ["wide"] + [0] * 8}, "pre_sag.0", "given wide"),
    ({"system_height": 0}, "system_height", "must be positive"),
    ({"steady_arms": {"mass": 1, "mass_per_length": 1}}, "steady_arms.mass_per_length", "give one of them"),
    ({"steady_arms": {"stagger": 0}}, "steady_arms.stagger", "an arm without stagger has no direction"),
    ({"steady_arms": {"stagger": [0.2, -0.2]}}, "steady_arms.stagger", "given 2 values for 10 spans; give 11 values"),
    (
        {"messenger_supports": {"stiffness": [5e5, 5e5], "along": "swings"}},
        "messenger_supports.along",
        "a messenger with along: swings has no stiffness along the line, given 500000 N/m; write along: held, "
        "or one number",
    ),
    ({"messenger_supports": {"stagger": "straight"}}, "messenger_supports.stagger", "give steady_arms a stagger"),
    ({"stitch_wire": {"length": 60}}, "stitch_wire.length", "would overlap, given 60 m; write less than 60 m"),
    ({"stitch_wire": {"length": 2}}, "stitch_wire.length", "too short for the elements, given 2 m; write at least 8 m"),
    ({"stitch_wire": {"length": 10}}, "stitch_wire.length", "no dropper hangs from the stitch wire on one side"),
    ({"stitch_wire": {}, "spans": [60], "analysed_spans": None}, "stitch_wire", "there is no support between spans"),
    ({"contact_wire": {"tension": "20 kg"}}, "contact_wire.tension", "20 kg"),
    ({"contact_wire": {"retardation": "1 m"}}, "contact_wire.retardation", "1 m"),
]


@pytest.mark.parametrize(("changes", "key", "says"), LINES, ids=lambda value: value if isinstance(value, str) else "")
def test_a_line_that_makes_no_sense_is_refused_once(changes: dict[str, Any], key: str, says: str) -> None:
    (problem,) = problems_of(OverheadLine, EN_2002 | changes)
    assert problem[0] == key
    assert says in problem[1]


def without(*keys: str, **more: Any) -> dict[str, Any]:
    return {key: value for key, value in (OWN | {"on": "s", "travel": {"speed": 70}} | more).items() if key not in keys}


PANTOGRAPHS: list[tuple[dict[str, Any], str, str]] = [
    (PANTOGRAPH | {"model": "en50318"}, "model", "did you mean en50318-2002?"),
    (PANTOGRAPH | {"model": "dsa"}, "model", "choose from: en50318-2002, simple-ac"),
    (PANTOGRAPH | {"masses": [1, 2]}, "masses", "the published pantograph en50318-2002 has its own"),
    (
        without("masses", "stiffness", "damping"),
        "",
        "add model (en50318-2002 or simple-ac), or masses, stiffness and damping",
    ),
    (without("damping"), "damping", "add damping: one value for each mass, from the base to the head"),
    (without(masses=[1], stiffness=[1], damping=[1]), "masses", "must be two or three, given 1 mass"),
    (without(stiffness=[50, 1, 2]), "stiffness", "does not go with the masses, given 3 for 2 masses; give 2 values"),
    (without(stiffness=[50, 0]), "stiffness.1", "the mass has no support"),
    (without(masses=[15, 0]), "masses.1", "must be positive"),
    (without("static_force"), "static_force", "no force acts upwards on the pantograph"),
    (without(mean_force="ac"), "static_force", "mean_force takes its place, given 120"),
    (without("static_force", mean_force="AC"), "mean_force", "did you mean ac?"),
    (without("static_force", mean_force="150 kg"), "mean_force", "150 kg"),
    (without("static_force", mean_force=-1), "mean_force", "must be positive"),
    (PANTOGRAPH | {"model": "simple-ac", "aerodynamic": 0.01}, "aerodynamic", "pressed with the mean force ac"),
    (PANTOGRAPH | {"travel": {"speed": 70, "from": -1}}, "travel.from", "must not be negative"),
]


@pytest.mark.parametrize(("keys", "key", "says"), PANTOGRAPHS, ids=[says[:40] for _, _, says in PANTOGRAPHS])
def test_a_pantograph_that_makes_no_sense_is_refused_once(keys: dict[str, Any], key: str, says: str) -> None:
    (problem,) = problems_of(Pantograph, keys)
    assert problem[0] == key
    assert says in problem[1]
