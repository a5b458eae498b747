"""Overlaps: contact wires that rise out of reach, and heads that press on two of them at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pydantic import ValidationError

from overhead_cases import EN_2002, formed, rested
from ropewalk.model import Scenario
from ropewalk.overhead.pantograph_loads import Above, moving_load_of
from ropewalk.overhead.section import CONTACT, elasticity, section_of
from ropewalk.results.contact_statistics import contact_statistics, samples
from ropewalk.results.course import together
from ropewalk.results.frame import RunInfo
from ropewalk.results.slots import digests
from ropewalk.results.statistics import summary
from ropewalk.simulate import simulate
from ropewalk.wires.contact_location import location_at
from ropewalk.wires.frames import Wires
from ropewalk.wires.task import WireTask
from ropewalk.wiring import task_of

SECTION = EN_2002 | {
    "spans": {"count": 4, "length": "40 m"}, "droppers": {"per_span": 4, "stiffness": "100 kN/m"}, "element": "1 m",
    "analysed_spans": [2, 3],
}  # fmt: skip
OUT = [0.0, 0.0, 0.0, 0.12, 0.5]  # m: a wire that ends
LINES = {
    "first": SECTION | {"heights": OUT, "overlap": "second"},
    "second": SECTION | {"heights": OUT[::-1], "start": [40.0, 0.0]},
}
"""Both wires run beside each other from 40 to 160 m; they cross at 100 m, 60 mm above the level."""


def scenario(
    lines: dict[str, Any] = LINES, on: str = "first", speed: float = 50.0, start: float = 50.0, **run: Any
) -> Scenario:
    if run.get("kind") != "equilibrium":
        run = {"kind": "dynamic", "geometry": "linearised", "until": 1.6, "every": 0.1} | run
    load = {"kind": "pantograph", "on": on, "model": "en50318-2002", "travel": {"speed": speed, "from": start}}
    return Scenario.model_validate({"overhead_lines": lines, "loads": {"head": load}, "run": run})


def heads(result: xr.Dataset) -> xr.Dataset:
    return samples(result).isel(contact=0)


# --- form finding ---


def test_a_line_on_a_gradient_is_the_level_one() -> None:
    level, inclined = formed(SECTION), formed(SECTION, heights=[0.4 * i for i in range(5)])
    np.testing.assert_allclose(inclined.pull, level.pull, rtol=1e-9)
    np.testing.assert_allclose(inclined.lengths, level.lengths, rtol=1e-9)
    _, z = rested(inclined)
    stations = np.concatenate([inclined.stations, inclined.supports[1:-1]])
    np.testing.assert_allclose(z, 0.01 * stations, atol=1e-6)
    assert inclined.level == 0.0


def test_the_wire_of_an_overlap_hangs_at_its_heights_and_its_arms_bear_the_kinks() -> None:
    level, rising = formed(SECTION), formed(SECTION, heights=OUT)
    _, z = rested(rising)
    stations = np.concatenate([rising.stations, rising.supports[1:-1]])
    np.testing.assert_allclose(z, np.interp(stations, rising.supports, OUT), atol=1e-6)
    assert rising.pull.min() > 0.0
    # Between supports it rises evenly: droppers bear what they bear of a level wire. Arms bear the kinks, T (s2 - s1).
    np.testing.assert_allclose(rising.pull, level.pull, rtol=1e-9)
    for i in (1, 2, 3):
        arm, own = (part.plan.holds[part.holds[f"section.arm.{i}"]].force[2] for part in (rising, level))
        assert arm - own == pytest.approx(-20e3 * (OUT[i - 1] - 2.0 * OUT[i] + OUT[i + 1]) / 40.0, abs=1e-6)


# --- the head between two wires ---


def test_a_head_at_rest_presses_on_both_wires_as_their_springs_share_it() -> None:
    x, top = 97.0, []
    found = simulate(scenario(start=x, kind="equilibrium")).contact_force.isel(load_path=0)[:, -1].values
    assert found[0] > found[1] > 10.0
    for (name, line), force in zip(scenario().overhead_lines.items(), found, strict=True):
        section, station = section_of(name, line), x - line.start[0]
        rest = location_at(section.mesh(), CONTACT, station).value(section.rest.position[2])
        rise = float(force) * elasticity(section, float(force), stations=np.array([station]))[1][0]
        top.append(float(rest) + rise + float(force) / 50e3)
    # Of 63 mm. Elasticities are at constant tensions; the equilibrium has all geometry.
    assert top[0] == pytest.approx(top[1], abs=0.3e-3)


@pytest.mark.parametrize(("geometry", "close"), [("linearised", 1e-6), ("nonlinear", 1e-2)])
def test_the_run_the_other_way_is_the_mirrored_one(geometry: str, close: float) -> None:
    # 200 m in all; the nonlinear motion takes its wires one after the other in each step, from start to end.
    there = simulate(scenario(geometry=geometry))
    back = simulate(scenario(on="second", speed=-50.0, start=200.0 - 50.0 - 40.0, geometry=geometry))
    np.testing.assert_allclose(heads(back).force, heads(there).force, atol=close)
    np.testing.assert_allclose(heads(back).station, 160.0 - heads(there).station, atol=1e-9)
    passed = summary(there)["pantographs"]["head"]["overlaps"][0], summary(back)["pantographs"]["head"]["overlaps"][0]
    assert [(one["from_line"], one["to_line"]) for one in passed] == [("first", "second"), ("second", "first")]
    assert passed[0]["first"] == pytest.approx(160.0 - passed[1]["first"])
    assert passed[0]["together"] == pytest.approx(passed[1]["together"])
    assert 80.0 < passed[0]["first"] < passed[0]["last"] < 120.0


def test_a_head_begins_under_the_lower_wire() -> None:
    flat = samples(simulate(scenario(start=130.0, until=0.3)))
    # It touches that of the second line, 45 m from the end of the first one, which is 400 mm higher there.
    assert np.abs(flat.force.values[:3, 0]).max() < 5.0
    assert not flat.share.values[:, 0].any()
    assert flat.height.values[0, 0] == pytest.approx(0.0, abs=0.02)


def test_a_second_wire_out_of_reach_is_not_there() -> None:
    high = LINES | {"first": SECTION | {"heights": [0.0, 0.0, 0.0, 0.0, 1.5], "overlap": "second"},
                    "second": SECTION | {"heights": [1.0] * 5, "start": [40.0, 0.0]}}  # fmt: skip
    beside = simulate(scenario(high, step=5e-4, until=1.2))
    alone = {"first": {key: value for key, value in high["first"].items() if key != "overlap"}}
    plain = simulate(scenario(alone, step=5e-4, until=1.2))
    np.testing.assert_allclose(heads(beside).force, heads(plain).force, atol=1e-9)
    assert not np.nan_to_num(samples(beside).share.values[:, 1]).any()


def test_two_wires_of_half_a_line_side_by_side_are_one_line() -> None:
    half = SECTION | {
        "contact_wire": {"mass": 0.675, "tension": "10 kN", "bending_stiffness": 0},
        "messenger_wire": {"mass": 0.535, "tension": "8 kN", "bending_stiffness": 0},
        "droppers": {"per_span": 4, "stiffness": "50 kN/m"}, "steady_arms": {"mass": 1 / 6},
    }  # fmt: skip
    one = scenario({"first": SECTION})
    two = scenario({"first": half, "second": half})
    task = task_of(two)
    below = two.loads["head"].model_copy(update={"contact_stiffness": 25e3})
    moving_load = moving_load_of("head", below, {0: Above(), 2: Above()})
    task = replace(
        task, contacts=("head", "head.second"),
        prescribed_motions=(replace(task.prescribed_motions[0], moving_load=moving_load),),
    )  # fmt: skip

    def force(task: WireTask) -> np.ndarray[Any, Any]:
        engine = Wires(task, np.arange(0.0, 1.01, 0.1), RunInfo(), step=5e-4)
        notes = [engine.note() for i in range(11) if engine.advance(i) is None]
        return engine.frames(notes).of["sampled_force"][1:].reshape(-1, len(task.contacts))

    whole, halves = force(task_of(one)), force(task)
    np.testing.assert_allclose(halves[:, 0], halves[:, 1], atol=1e-9)
    np.testing.assert_allclose(halves.sum(axis=1), whole[:, 0], atol=1e-9)


# --- irregularities of both wires ---


def written(folder: Path, name: str, x: Sequence[float], z: Sequence[float]) -> str:
    (folder / name).write_text("".join(f"{a:.9g}, {b:.9g}\n" for a, b in zip(x, z, strict=True)), encoding="utf-8")
    return str(folder / name)


def irregular(tree: Scenario, **files: str) -> Scenario:
    load = tree.loads["head"].model_copy(update={"irregularity": files})
    return tree.model_copy(update={"loads": {"head": load}})


def test_a_head_at_rest_shares_its_force_as_the_irregularities_of_both_wires_ask_for(tmp_path: Path) -> None:
    x, rough = 97.0, {"first": 5e-3, "second": -4e-3}
    files = {key: written(tmp_path, f"{key}.csv", [0.0, 160.0], [z, z]) for key, z in rough.items()}
    tree = irregular(scenario(start=x, kind="equilibrium"), **files)
    found = simulate(tree).contact_force.isel(load_path=0)[:, -1].values
    assert found.min() > 10.0
    top = []
    for (name, line), force in zip(scenario().overhead_lines.items(), found, strict=True):
        section, station = section_of(name, line), x - line.start[0]
        rest = location_at(section.mesh(), CONTACT, station).value(section.rest.position[2])
        rise = float(force) * elasticity(section, float(force), stations=np.array([station]))[1][0]
        top.append(float(rest) + rise + float(force) / 50e3 + rough[name])
    assert top[0] == pytest.approx(top[1], abs=0.3e-3)  # as of smooth wires, above


def test_irregular_wires_the_other_way_are_the_mirrored_ones(tmp_path: Path) -> None:
    """Each file counts from the start of its own line, 160 m long; on the second one it is felt from 40 m on."""
    rng = np.random.default_rng(1)
    x = np.linspace(0.0, 160.0, 81)
    one, two = 3e-3 * rng.standard_normal((2, x.size))
    there = irregular(scenario(), first=written(tmp_path, "1", x, one), second=written(tmp_path, "2", x, two))
    back = irregular(
        scenario(on="second", speed=-50.0, start=200.0 - 50.0 - 40.0),
        second=written(tmp_path, "3", x, one[::-1]), first=written(tmp_path, "4", x, two[::-1]),
    )  # fmt: skip
    assert digests(there).keys() == {"loads.head.irregularity.first", "loads.head.irregularity.second"}
    forward, plain = heads(simulate(there)).force.values, samples(simulate(scenario()))
    smooth = plain.force.values[:, 0]
    np.testing.assert_allclose(heads(simulate(back)).force.values, forward, atol=1e-5)
    assert np.abs(forward - smooth).max() > 50.0
    only = irregular(scenario(), second=str(tmp_path / "2"))
    flat = samples(simulate(only))
    before = min(np.flatnonzero(each.share.values[:, 1])[0] for each in (plain, flat))
    np.testing.assert_array_equal(flat.force.values[:before, 0], smooth[:before])  # the head has not come to it
    assert np.abs(flat.force.values[before:, 0] - smooth[before:]).max() > 30.0


# --- what is told ---


def test_statistics_are_those_of_the_head_along_both_lines() -> None:
    result = simulate(scenario(start=20.0, until=3.0))
    found, flat = contact_statistics(result)["head"], samples(result)
    share, station, head = flat.share.values, flat.station.values[:, 0], flat.force.values[:, 0]
    np.testing.assert_allclose(head, np.nansum(share, axis=1), rtol=1e-12)
    np.testing.assert_allclose(np.diff(station), 0.05, rtol=1e-6)  # it goes on in one
    # From the first analysed span of the one, 2, to the last one of the other, 3.
    assert found.complete
    assert (found.first, found.last) == (pytest.approx(40.0, abs=0.1), pytest.approx(160.0, abs=0.1))
    here = (station >= 40.0 - 1e-6) & (station <= 160.0 + 1e-6)
    assert found.raw_maximum == head[here].max()
    assert found.raw_deviation == pytest.approx(head[here].std())
    uplift = [flat.uplift.sel(watched=f"{line}.support.{i}") for line, i in (("first", 1), ("second", 2))]
    assert found.uplift >= max(float(one.max()) for one in uplift)


def test_samples_of_several_wires_are_taken_together() -> None:
    nan = np.nan
    of = {
        "station": np.array([[10.0, nan], [50.0, 10.0], [51.0, 11.0], [nan, 60.0], [nan, nan]]),
        "force": np.array([[90.0, nan], [60.0, 40.0], [0.0, 0.0], [nan, 80.0], [nan, nan]]),
        "height": np.array([[0.01, nan], [0.05, 0.06], [0.09, 0.08], [nan, 0.02], [nan, nan]]),
    }
    found = together(scenario(), ["head", "head.second"], of)
    np.testing.assert_allclose(found["station"][:, 0], [10.0, 50.0, 51.0, 100.0, nan])
    np.testing.assert_allclose(found["force"][:, 0], [90.0, 100.0, 0.0, 80.0, nan])
    np.testing.assert_allclose(found["height"][:, 0], [0.01, 0.05, 0.08, 0.02, nan])
    np.testing.assert_allclose(found["share"], of["force"])
    assert together(scenario({"first": SECTION}), ["head"], of) == {}


# --- mistakes ---


@pytest.mark.parametrize(
    ("first", "second", "where", "message"),
    [
        ({"overlap": "secnd"}, {}, "first.overlap", "unknown overhead line; did you mean second"),
        ({"overlap": "first"}, {}, "first.overlap", "unknown overhead line; other .* here: second"),
        ({}, {"start": [170.0, 0.0]}, "first.overlap", "does not overlap with second at its end; let second start"),
        ({"heights": [0.0] * 5}, {}, "first.heights", "ends at x = 160 m within reach of pantographs; raise its last"),
        ({}, {"heights": [0.1, 0, 0, 0, 0]}, "second.heights", "ends at x = 40 m within reach .*; raise its first"),
        ({"heights": [0.0, 0.5]}, {}, "first.heights", "do not go with the supports; give 5 values"),
        ({"heights": [0, 0, 0, 0, 5]}, {}, "first.heights", "steeper than 1 : 20; write heights that differ less"),
        ({}, {"overlap": "second"}, "second.overlap", "unknown overhead line"),
    ],
)
def test_what_cannot_overlap_is_refused(
    first: dict[str, Any], second: dict[str, Any], where: str, message: str
) -> None:
    with pytest.raises(ValidationError, match=message) as caught:
        scenario({"first": LINES["first"] | first, "second": LINES["second"] | second})
    assert where in str(caught.value)


def test_no_two_lines_go_on_as_the_same_one() -> None:
    other = SECTION | {"overlap": "second", "heights": OUT}
    with pytest.raises(ValidationError, match="first overlaps with it, too"):
        scenario(LINES | {"other": other})


def test_a_pantograph_passes_the_end_of_the_last_line() -> None:
    with pytest.raises(ValidationError, match=r"passes the end of first at 3 s and the run ends at 4 s"):
        scenario(until=4.0)
    with pytest.raises(ValidationError, match=r"passes the start of second at 2 s"):
        scenario(on="second", speed=-50.0, start=60.0, until=3.0)


def test_irregularities_are_those_of_wires_that_are_named() -> None:
    tree = scenario().model_dump(mode="json")
    for given, message in (
        ("rough.csv", r"the contact wire is ambiguous.*first, second.*\{first: rough.csv, second: rough.csv\}"),
        ({"frist": "rough.csv"}, "does not reach this line.*did you mean first"),
        ({"first": 3}, "expected the name of a file"),
        ({}, "expected the name of a file"),
    ):
        tree["loads"]["head"]["irregularity"] = given
        with pytest.raises(ValidationError, match=message):
            Scenario.model_validate(tree)
