"""Values set from outside, before the scenario is checked."""

from __future__ import annotations

import pytest

from ropewalk.errors import ScenarioError
from ropewalk.model import Dynamic, Quasistatic, TensionOnly
from ropewalk.scenario import loads


def test_a_value_is_set(example: str) -> None:
    run = loads(example, overrides=["run.until=1.2 s"]).run
    assert isinstance(run, Dynamic)
    assert run.until == 1.2


def test_an_entry_of_a_list_is_set(example: str) -> None:
    assert loads(example, overrides=["loads.walker.force.1=-900 N"]).loads["walker"].force == (0.0, -900.0)


def test_a_list_is_set(example: str) -> None:
    scenario = loads(example, overrides=["loads.walker.force=[1, 2 kN]"])
    assert scenario.loads["walker"].force == (1.0, 2000.0)


def test_values_are_typed_as_in_yaml(example: str) -> None:
    scenario = loads(example, overrides=["lines.rope.elements=1e2", "title='5'", "gravity=1.62"])
    assert (scenario.lines["rope"].elements, scenario.title, scenario.gravity) == (100, "5", 1.62)


def test_a_key_that_the_file_leaves_out_is_set(example: str) -> None:
    scenario = loads(example, overrides=["lines.rope.law.kind=tension_only", "run.start.with_loads=true"])
    assert isinstance(scenario.lines["rope"].law, TensionOnly)
    assert isinstance(scenario.run, Dynamic)
    assert scenario.run.start.with_loads


def test_a_whole_block_is_replaced(example: str) -> None:
    scenario = loads(example, overrides=["run={kind: quasistatic, positions: 11}"])
    assert scenario.run == Quasistatic(positions=11)


def test_null_takes_a_key_out(example: str) -> None:
    line = loads(example, overrides=["lines.rope.length=null", "lines.rope.tension=2 kN"]).lines["rope"]
    assert (line.length, line.tension) == (None, 2000.0)


def test_the_last_of_two_counts(example: str) -> None:
    assert loads(example, overrides=["gravity=1", "gravity=2"]).gravity == 2.0


def test_an_override_replaces_a_mistake_of_the_file(example: str) -> None:
    text = example.replace("1 kg/m", "!x 1 kg")
    assert loads(text, overrides=["lines.rope.mass=2 kg/m"]).lines["rope"].mass == 2.0


def test_a_new_load_is_added_by_name(example: str) -> None:
    load = "{kind: force, on: rope, force: [0, -1], travel: {speed: 10, measured: slip, from: 2}}"
    assert set(loads(example, overrides=[f"loads.second={load}"]).loads) == {"walker", "second"}


REFUSED = {
    "an unknown key suggests": ("run.untill=1", "--set run.untill: unknown key untill; did you mean until?"),
    "an unknown block suggests": ("rn.until=1", "--set rn.until: unknown key rn; did you mean run?"),
    "an unknown line suggests": (
        "lines.rop.length=1",
        "--set lines.rop.length: unknown key rop in lines; did you mean rope?",
    ),
    "a value of another dimension is refused": (
        "loads.walker.force.1=9 kg",
        "--set loads.walker.force.1: kg does not fit: expected a force, given '9 kg'; write it in N",
    ),
    "an index out of range is refused": (
        "loads.walker.force.2=1",
        "--set loads.walker.force.2: the index is out of range, given 2; loads.walker.force has the entries 0 to 1",
    ),
    "an index that is a word is refused": ("loads.walker.force.z=1", "--set loads.walker.force.z: the index"),
    "an entry cannot be taken out": ("loads.walker.force.1=null", "--set loads.walker.force.1: an entry of a list"),
    "a value is not a block": ("run.until.x=1", "--set run.until.x: run.until is a value, not a block"),
    "a sign is needed": ("run.until", "--set run.until: this is not key=value, given run.until"),
    "a key is needed": ("=1", "--set : this is not key=value"),
    "an empty part is refused": ("run..until=1", "--set run..until: this is not key=value"),
    "an empty value is refused": ("run.until=", "--set run.until: no value is given; write a value, or null"),
    "broken YAML is refused": ("run.until=[1", "--set run.until: this is not YAML"),
    "a tag is refused": ("title=!x y", "--set title: tags are not used in scenarios, given !x"),
    "an unknown kind suggests": ("run.kind=dinamic", "--set run.kind: unknown kind of run, given 'dinamic'; did you"),
    "a key inside of a block set is located": (
        "run={kind: dynamic, until: x}",
        "--set run: run.until: cannot be read as a time",
    ),
    "a missing key of a block set is located": ("run={kind: dynamic}", "--set run: run.until: is required"),
    "what does not fit together is located": ("run.every=9 s", "--set run.every: longer than the run, given 9 s"),
}


@pytest.mark.parametrize(("override", "message"), REFUSED.values(), ids=REFUSED)
def test_refused(example: str, override: str, message: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        loads(example, "case.yaml", [override])
    assert str(caught.value).startswith(message)
    assert len(caught.value.problems) == 1


def test_a_kind_changed_from_outside_leaves_the_keys_of_the_file_in_their_place(example: str) -> None:
    with pytest.raises(ScenarioError, match=r"case.yaml:20: run.until: unknown key"):
        loads(example, "case.yaml", ["run.kind=quasistatic"])


def test_mistakes_of_the_file_come_before_those_of_overrides(example: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        loads(example.replace("1 kg/m", "1 kg"), "case.yaml", ["gravity=x"])
    assert [problem.file for problem in caught.value.problems] == ["case.yaml", "--set gravity"]
