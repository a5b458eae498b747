"""Droppers that fail at rest and in slow motion, against lines that never had them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from overhead_cases import EN_2002
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

REST: dict[str, Any] = {"kind": "equilibrium"}
SLOWLY: dict[str, Any] = {"kind": "quasistatic", "positions": 18}  # one every 10 m
KINK = 0.01  # of forces with links of 1 m: what a dropper bent stays a little bent, an error of first order


def simulated(run: dict[str, Any], force: float, place: float, *, element: float = 1.0, **line: Any) -> xr.Dataset:
    """Three spans of the reference model under a force in N, with keys of the line; those of its droppers are added."""
    droppers = {**EN_2002["droppers"], **line.pop("droppers", {})}
    own = {"spans": {"count": 3, "length": "60 m"}, "analysed_spans": [2, 2], "element": element, "droppers": droppers}
    load = {"kind": "force", "on": "line", "force": [0, force], "travel": {"speed": 20.0, "from": place}}
    tree = {"overhead_lines": {"line": {**EN_2002, **own, **line}}, "loads": {"push": load}, "run": run}
    found = simulate(Scenario.model_validate(tree))
    assert found.attrs["outcome"] == "completed"
    return found


def failures(result: xr.Dataset) -> list[tuple[str, float]]:
    """Which failed under how much N, in order."""
    words = [line.split() for line in result.attrs["warnings"].splitlines() if " failed under " in line]
    return [(each[-5], float(each[-2])) for each in words]


def without(names: list[str]) -> dict[str, Any]:
    pairs = [[int(part) for part in name.split(".")[1:]] for name in names]
    return {"condition": {"missing_droppers": pairs}} if pairs else {}


def pulls(result: xr.Dataset, at: int = 0) -> dict[str, float]:
    return dict(zip(result.tie.values.tolist(), result.tie_force.values[at].tolist(), strict=True))


@pytest.mark.parametrize(("place", "force", "strength", "most"), [(88.0, -300.0, 150.0, 5), (64.0, -300.0, 250.0, 2)])
def test_droppers_tear_one_after_the_other_as_lines_without_those_before_say(
    place: float, force: float, strength: float, most: int
) -> None:
    """The first line unzips from end to end, the second one loses one dropper."""
    found = failures(simulated(REST, force, place, droppers={"strength": strength}))
    wanted: list[tuple[str, float]] = []
    while len(wanted) < most:
        bears = pulls(simulated(REST, force, place, **without([name for name, _ in wanted])))
        worst = max(bears, key=lambda name: bears[name])
        if bears[worst] <= strength:
            break
        wanted.append((worst, bears[worst]))
    print(found, wanted)
    assert len(found) == (27 if most == 5 else 1)
    assert [name for name, _ in found[:most]] == [name for name, _ in wanted]
    assert [pull for _, pull in found[:most]] == pytest.approx([pull for _, pull in wanted], rel=KINK)


def test_a_line_whose_dropper_tore_at_rest_rests_as_one_that_never_had_it() -> None:
    missed = []
    for element in (2.0, 1.0, 0.5):
        torn = simulated(REST, -300.0, 64.0, element=element, droppers={"strength": 250.0})
        lacks = simulated(REST, -300.0, 64.0, element=element, **without(["line.2.1"]))
        whole = simulated(REST, -300.0, 64.0, element=element)
        z = [each.position.sel(axis="z").values[0] for each in (torn, lacks, whole)]
        assert pulls(torn)["line.2.1"] == 0.0
        reaction = [float(each.reaction.sel(axis="z").values[0].sum()) for each in (torn, whole)]
        assert reaction[0] == pytest.approx(reaction[1], abs=1e-2)  # N: all weight, and the force
        missed.append(np.abs(z[0] - z[1]).max())
        assert missed[-1] < 0.05 * element * np.abs(z[2] - z[1]).max()
    print(missed, "m")


def test_droppers_that_are_alike_tear_together() -> None:
    """A force in the middle of the line: rounding does not choose one of a pair."""
    whole = pulls(simulated(REST, -400.0, 90.0))
    assert whole["line.2.4"] == pytest.approx(whole["line.2.6"], rel=1e-7)
    found = failures(simulated(REST, -400.0, 90.0, droppers={"strength": 200.0}))
    names = [name for name, _ in found]
    assert names[0] == "line.2.5"
    for i in range(1, 9, 2):
        (one, two), (a, b) = (n.split(".")[1:] for n in names[i : i + 2]), (f for _, f in found[i : i + 2])
        assert (int(one[0]) + int(two[0]), int(one[1]) + int(two[1])) == (4, 10)
        assert a == pytest.approx(b, rel=1e-6)


@pytest.mark.parametrize("turn", [{}, {"turn": "5 deg"}])
def test_a_dropper_that_is_cut_pulls_until_the_load_has_come_to_its_time(turn: dict[str, Any]) -> None:
    """From 10 m at 20 m/s: at 2.9 s it is at 68 m, a path of 58 m."""
    cut = {"cut": {"droppers": [[2, 5]], "time": 2.9}}
    run = {**SLOWLY, **turn}
    found = simulated(run, -100.0, 10.0, droppers=cut)
    whole, lacks = simulated(SLOWLY, -100.0, 10.0), simulated(SLOWLY, -100.0, 10.0, **without(["line.2.5"]))
    path = found.load_path.values
    early = path < 58.0
    pull = found.tie_force.sel(tie="line.2.5").values
    assert (pull[~early] == 0.0).all()
    for each, at in ((whole, early), (lacks, ~early)):
        regular = [i for i in np.flatnonzero(at) if np.isclose(path[i] % 10.0, 0.0)]
        there = np.searchsorted(each.load_path.values, path[regular] - 1e-6)
        assert len(regular) > 4
        height, wanted = (r.contact_position.sel(axis="z").values[:, 0] for r in (found, each))
        lifted = np.abs(lacks.contact_position - whole.contact_position).sel(axis="z").values.max()
        assert np.abs(height[regular] - wanted[there]).max() < (1e-9 if each is whole else 0.06 * lifted)
    ((name, force),) = failures(found)
    assert name == "line.2.5"
    assert force == pytest.approx(86.1, abs=0.6)
    assert "with kind: dynamic it is redistributed suddenly" in found.attrs["warnings"]


def test_what_tore_on_the_way_stays_torn() -> None:
    found = simulated(SLOWLY, -300.0, 64.0, droppers={"strength": 258.0})
    whole = simulated(SLOWLY, -300.0, 64.0)
    torn = failures(found)
    bears = whole.tie_force.values
    first = np.argwhere((bears > 258.0).any(axis=1)).ravel()[0]
    assert torn[0][0] == str(whole.tie.values[bears[first].argmax()])
    assert torn[0][1] == pytest.approx(bears[first].max(), rel=2e-4)  # what 4 digits tell
    assert [name for name, _ in torn] == ["line.3.1"]
    for name, _ in torn:
        pull = found.tie_force.sel(tie=name).values
        gone = int((pull == 0.0).argmax())
        assert (pull[gone:] == 0.0).all()
        assert (pull[:gone] > 0.0).all()
    last = simulated(SLOWLY, -300.0, 64.0, **without([name for name, _ in torn])).isel(load_path=-1)
    kept = [name for name in found.tie.values.tolist() if name not in dict(torn)]
    pull, wanted = (each.tie_force.sel(tie=kept).values for each in (found.isel(load_path=-1), last))
    assert np.abs(pull - wanted).max() < KINK * wanted.max()


def test_what_is_cut_later_has_not_failed_at_rest_and_the_result_says_so() -> None:
    cut = {"cut": {"droppers": [[2, 5]], "time": 0.5}}
    found, whole = simulated(REST, -100.0, 30.0, droppers=cut), simulated(REST, -100.0, 30.0)
    np.testing.assert_array_equal(found.tie_force.values, whole.tie_force.values)
    assert "line.2.5 is cut at t = 0.5 s, and is intact here: this equilibrium is at t = 0" in found.attrs["warnings"]
    late = simulated(SLOWLY, -100.0, 30.0, droppers={"cut": {"droppers": [[2, 5]], "time": 60.0}})
    assert "line.2.5 is cut at t = 60 s, and is intact here: the load ends at 7.5" in late.attrs["warnings"]
