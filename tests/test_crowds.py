"""Crowds: who is in them, what is wrong with them, and that they are the people that they are made of."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.errors import ScenarioError
from ropewalk.mechanics.footfall import Footfall, footfalls
from ropewalk.model import Crowd, Dynamic, Footsteps, Line, Scenario
from ropewalk.scenario import loads as read
from ropewalk.simulate import simulate
from ropewalk.theory import lateral_balance

GRAVITY = 9.81
# A beam of 1.15 Hz in both directions.
BEAM = {
    "start": (0, 0), "end": (30, 0), "length": 30.0, "mass": 300.0, "axial_stiffness": 1e8,
    "bending_stiffness": 300.0 * (2.0 * np.pi * 1.15) ** 2 * (30.0 / np.pi) ** 4, "elements": 10,
}  # fmt: skip


# Who is in them ------------------------------------------------------------------------------------------------------


def test_the_same_seed_gives_the_same_people_everywhere() -> None:
    one, two, *_ = Crowd(on="deck", number=5).people(60.0)
    # Written down once: the Mersenne twister is the same on all machines, the inverse of the normal distribution but
    # for rounding.
    assert one.frequency == pytest.approx(2.0600025675289464, rel=1e-12)
    assert one.mass == pytest.approx(58.47831612953704, rel=1e-12)
    assert one.start == pytest.approx(15.3041415443653, rel=1e-12)
    assert (one.first_foot, one.phase) == ("left", pytest.approx(0.49543508709194095, rel=1e-12))
    assert Crowd(on="deck", number=2).people(60.0) == [one, two]  # more people are those and further ones
    assert Crowd(on="deck", number=1, seed=2).people(60.0) != [one]


def test_people_are_as_different_as_it_says() -> None:
    people = Crowd(on="deck", number=1000).people(60.0)
    for key, mean, deviation in (("mass", 75.0, 15.0), ("frequency", 1.87, 0.186), ("step_length", 0.71, 0.071)):
        values = np.array([getattr(person, key) for person in people])
        # Four standard errors of a mean and of a deviation of 1000; the cut at three deviations takes 1.3 % of these.
        assert values.mean() == pytest.approx(mean, abs=4.0 * deviation / 1000.0**0.5)
        assert values.std() == pytest.approx(0.987 * deviation, rel=4.0 / 2000.0**0.5)
        assert np.abs(values - mean).max() <= 3.0 * deviation
    feet = [person.first_foot == "left" for person in people]
    assert abs(np.mean(feet) - 0.5) < 0.064  # four standard errors
    for values in ([person.phase for person in people], [person.start / 60.0 for person in people]):
        low, high = min(values), max(values)
        assert 0.0 <= low < 0.02 < 0.98 < high < 1.0
    pair = np.array([(person.frequency, person.step_length, person.mass) for person in people]).T
    assert np.abs(np.corrcoef(pair) - np.eye(3)).max() < 4.0 / 1000.0**0.5


def test_they_stand_evenly_and_walk_both_ways() -> None:
    people = Crowd(on="deck", number=40, spread="even", towards="both").people(20.0)
    assert [person.start for person in people] == pytest.approx(np.arange(0.25, 20.0, 0.5))
    assert 10 < sum(person.towards == "start" for person in people) < 30
    assert {person.at_end for person in people} == {"again"}


@pytest.mark.parametrize("towards", ["end", "start"])
def test_they_come_at_a_rate(towards: str) -> None:
    people = Crowd(on="deck", number=400, rate=0.5, towards=towards).people(20.0)
    before = [(-p.start if towards == "end" else p.start - 20.0) / (p.frequency * p.step_length) for p in people]
    waits = np.diff([0.0, *before])
    assert (waits > 0.0).all()
    assert waits.mean() == pytest.approx(2.0, rel=0.2)  # four standard errors of an exponential distribution
    assert waits.std() == pytest.approx(2.0, rel=0.3)
    assert {person.at_end for person in people} == {"leave"}
    evenly = Crowd(on="deck", number=3, rate=0.5, spread="even").people(20.0)
    assert [-p.start / (p.frequency * p.step_length) for p in evenly] == pytest.approx([2.0, 4.0, 6.0])


# What is wrong with them ---------------------------------------------------------------------------------------------

FILE = """
lines: {{deck: {{start: [0, 0], end: [20, 0], tension: 160 kN, mass: 100 kg/m, axial_stiffness: 100 MN}}}}
{more}
loads: {{people: {{kind: crowd, {keys}}}}}
run: {{kind: {run}}}
"""


@pytest.mark.parametrize(
    ("keys", "key", "words"),
    [
        ("on: deck", "loads.people.number", "add number"),
        ("on: deck, number: 0", "loads.people.number", "too small"),
        ("on: dek, number: 5", "loads.people.on", "deck"),
        ("on: deck, number: 5, balance: {}, lateral: setra", "loads.people.balance", "exclude each other"),
        ("on: deck, number: 5, rate: 1 Hz, at_end: again", "loads.people.at_end", "leave rate out"),
        ("on: deck, number: 5, frequency: {mean: 2.5 Hz, deviation: 0.2 Hz}", "loads.people.frequency", "bachmann"),
        ("on: deck, number: 5, mass: {mean: 75 kg, deviation: 30 kg}", "loads.people.mass.deviation", "less than 25"),
        ("on: deck, number: 5, spred: even", "loads.people.spred", "spread"),
        ("on: deck, number: 5, at_end: stay", "loads.people.at_end", "again"),
    ],
)
def test_a_mistake_is_told_with_its_key_and_a_remedy(keys: str, key: str, words: str) -> None:
    with pytest.raises(ScenarioError) as told:
        read(FILE.format(keys=keys, more="", run="dynamic, until: 1 s"))
    assert [problem.key for problem in told.value.problems] == [key]
    assert words in str(told.value)


def test_what_is_wrong_with_all_of_them_is_told_once() -> None:
    with pytest.raises(ScenarioError) as told:
        read(FILE.format(keys="on: deck, number: 50", more="gravity: 0", run="dynamic, until: 1 s"))
    assert [problem.key for problem in told.value.problems] == ["loads.people.kind"]
    with pytest.raises(ScenarioError, match=r"loads\.people\.kind: .*not implemented"):
        read(FILE.format(keys="on: deck, number: 50", more="", run="quasistatic"))


NET = (
    "nets: {net: {kind: net, corner: [0, 0, 0], sides: [[4, 0, 0], [0, 3, 0]], cells: [8, 6], mesh: 0.1, "
    "mass: 20 g/m, axial_stiffness: 10 kN, tension: 100 N}}"
)


def test_a_crowd_on_a_net_goes_along_its_path() -> None:
    """Each of them presses with m g (1 + sum of a_i sin 2 pi i f t), t from her first foot on; feet are on the path."""
    keys = "on: net, number: 4, mass: {mean: 2 kg, deviation: 0.2 kg}, path: [[0.5, 1.5], [2, 1.5], [2, 2.5]]"
    scenario = read(FILE.format(keys=keys, more=NET, run="dynamic, until: 0.5 s, every: 0.05 s"))
    crowd = scenario.loads["people"]
    assert isinstance(crowd, Crowd)
    result, people = simulate(scenario), crowd.people(2.5)
    times, wanted = result.time.to_numpy(), np.zeros(result.time.size)
    for one in people:
        t = times + one.phase / one.frequency
        first = 0.41 * (one.frequency - 0.95)
        higher = [0.069 + 0.0112 * one.frequency, 0.033 + 0.0192 * one.frequency, 0.013 + 0.026 * one.frequency]
        terms = [a * np.sin(2.0 * np.pi * (i + 1) * one.frequency * t) for i, a in enumerate([first, *higher])]
        wanted += 9.81 * one.mass * (1.0 + np.sum(terms, axis=0))
    pressing = -np.nansum(result.contact_force.sel(axis="z").to_numpy(), axis=1)
    assert pressing == pytest.approx(wanted, rel=2e-4)  # tables in time
    place = result.contact_position.to_numpy()
    assert np.nanmax(np.abs(np.where(place[..., 0] < 1.9, place[..., 1] - 1.5, place[..., 0] - 2.0))) < 0.02


def test_a_crowd_on_a_net_needs_a_path() -> None:
    with pytest.raises(ScenarioError, match=r"loads\.people\.path: .*required for a load on a net"):
        read(FILE.format(keys="on: net, number: 5", more=NET, run="dynamic, until: 1 s"))


# Steps ---------------------------------------------------------------------------------------------------------------


def walks(**keys: Any) -> Footsteps:
    return Footsteps(on="deck", mass=70.0, frequency=2.0, step_length=0.6, **keys)


@pytest.mark.parametrize("foot", [0, 1])
def test_who_is_within_a_step_at_first_is_ahead_in_time(foot: int) -> None:
    later, early = Footfall(walks(), foot, GRAVITY), Footfall(walks(phase=0.4), foot, GRAVITY)
    t = np.linspace(0.0, 2.0, 401)
    assert early(t) == pytest.approx(later(t + 0.2), abs=1e-9)
    instants = early.instants(1.0)
    assert instants[0] == 0.0
    assert (np.diff(instants) > 0.0).all()
    times, places = footfalls(walks(phase=0.4, **{"from": 1.0}), foot, 20.0, 2.0)
    assert (times[:4], places[:4:2][foot:]) == (
        (pytest.approx([0.0, 0.4, 0.8, 1.4]), pytest.approx([1.0, 2.2])) if foot == 0
        else (pytest.approx([0.0, 0.3, 0.9, 1.3]), pytest.approx([np.nan], nan_ok=True))
    )  # fmt: skip


def test_who_comes_to_the_end_is_followed_by_another_one() -> None:
    _, places = footfalls(walks(at_end="again", **{"from": 1.5}), 0, 2.0, 3.0)
    assert places[::2][:4] == pytest.approx([1.5, 0.7, 1.9, 1.1])
    _, back = footfalls(walks(at_end="again", towards="start", **{"from": 0.5}), 0, 2.0, 3.0)
    assert back[::2][:4] == pytest.approx([0.5, 1.3, 0.1, 0.9])


def test_who_leaves_may_come_late() -> None:
    times, places = footfalls(walks(at_end="leave", **{"from": -0.7}), 0, 2.0, 6.0)
    on = np.isfinite(places)
    assert places[on] == pytest.approx([0.5, 1.7])
    assert times[on] == pytest.approx([1.0, 2.0])
    assert times[-1] == pytest.approx(2.5)  # the other foot would stand beyond the end
    times, places = footfalls(walks(at_end="leave", towards="start", **{"from": 2.5}), 1, 2.0, 6.0)
    assert places[np.isfinite(places)] == pytest.approx([1.9, 0.7])
    line = {"deck": {"start": (0, 0), "end": (20, 0), "tension": 1e5, "mass": 100.0, "axial_stiffness": 1e8}}
    for keys in ({"from": -1.0}, {"from": 21.0}, {"from": -1.0, "towards": "start", "at_end": "leave"}):
        with pytest.raises(ScenarioError, match=r"loads\.her\.from"):
            Scenario(lines=line, loads={"her": walks(**keys)}, run=Dynamic(until=1.0))


# They are the people that they are made of ---------------------------------------------------------------------------


def test_a_crowd_is_its_people() -> None:
    crowd = Crowd(on="deck", number=3, seed=4, towards="both")
    run = Dynamic(until=0.5, every=0.1, geometry="linearised")
    deck = Line.model_validate(BEAM)
    people = {f"one-{i}": person for i, person in enumerate(crowd.people(30.0))}
    here, there = (simulate(Scenario(lines={"deck": deck}, loads=loads, run=run)) for loads in ({"all": crowd}, people))
    assert here.position.values == pytest.approx(there.position.values, abs=0.0)
    assert here["load"].values.tolist()[:2] == ["all.1.left", "all.1.right"]
    weight = sum(person.mass for person in people.values()) * GRAVITY
    assert np.nanmax(-here.contact_force.values[:, :, -1]) < weight
    assert here.attrs["doubts"] == ""


# Lock-in -------------------------------------------------------------------------------------------------------------

OMEGA, DRAG = 2.0 * np.pi * 1.15, 0.15  # rad/s of the lateral mode, 1/s: 1 % of critical


def growth(number: int) -> tuple[float, float]:
    """Growth rate of the lateral mode of the beam under a crowd in 1/s, and what it should be.

    All is linear in how far the beam is at first: of two runs that differ in that alone, the difference has none of
    the forces of the gait in it.
    """
    crowd = Crowd(on="deck", number=number, seed=3, balance={}, spread="even")
    deck = Line.model_validate({**BEAM, "drag": DRAG})
    until, mode = 12.0, {"kind": "mode", "number": 1, "direction": (0.0, 1.0, 0.0)}
    lateral = []
    for amplitude in (0.01, 0.02):
        start = {**mode, "amplitude": amplitude}
        run = Dynamic.model_validate({"until": until, "every": 0.02, "geometry": "linearised", "start": start})
        result = simulate(Scenario(lines={"deck": deck}, loads={"all": crowd}, run=run))
        assert result.attrs["outcome"] == "completed"
        lateral.append(result.sel(axis="y"))
    t, shape = lateral[0].time.values, np.sin(np.pi * lateral[0].xi.values / 30.0)
    q, v = ((two - one) @ shape for one, two in ((r[key].values for r in lateral) for key in ("position", "velocity")))
    seen = np.polyfit(t, 0.5 * np.log(q**2 + (v / OMEGA) ** 2), 1)[0]
    people = crowd.people(30.0)  # who go along half a mode and more: the mean of its square is a half
    root = lateral_balance.sway_growth(
        OMEGA / (2.0 * np.pi), damping_rate=DRAG, modal_mass=0.5 * 300.0 * 30.0, leg_length=1.17,
        mass=[person.mass for person in people], step_time=[1.0 / person.frequency for person in people],
    )  # fmt: skip
    return float(seen), root.real


def test_a_crowd_beyond_the_critical_number_makes_the_sway_grow() -> None:
    """Seven people undo the damping (Macdonald's pendulum; Dallard et al. 2001 for the number)."""
    rates = np.array([growth(number) for number in (2, 7, 16)])
    print(rates)
    # Who walks for 12 s is not everywhere on the mode alike: 4 % of what 16 people drive.
    assert rates[:, 0] == pytest.approx(rates[:, 1], abs=0.006)
    assert rates[0, 0] < -0.04
    assert rates[2, 0] > 0.08
    drive = np.mean([
        lateral_balance.self_excited_force(1.15, mass=p.mass, step_time=1.0 / p.frequency, leg_length=1.17)[0]
        for p in Crowd(on="deck", number=100, seed=3).people(30.0)
    ])  # fmt: skip
    number = lateral_balance.critical_number(1.15, 0.5 * DRAG / OMEGA, 4500.0, float(drive))
    seen = np.interp(0.0, rates[:, 0], [2.0, 7.0, 16.0])
    print(number, seen)
    assert seen == pytest.approx(number, abs=1.0)
