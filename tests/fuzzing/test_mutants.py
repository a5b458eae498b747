"""Spoilt files are read or refused: a part of what `make fuzz` looks at for as long as one likes."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from fuzzing.mutants import EXAMPLES, extreme, mutant, originals
from fuzzing.reading import READ, REFUSED, checked, outcome
from ropewalk.cli import console

EACH, CHECKED = 800, 60
FAILED_IN_CHECK = {  # an original, a value in it, the value that made `check` fail or last, and its outcome today
    "a step that rounds to 0": ("zip-line-brake.yaml", "500 N*s/m", "1e12 N*s/m", READ),
    "a membrane of a million vertices": ("base awning", "[4.0, 3.0, 0.0]", "[4.0, 100000, 0.0]", READ),
    "a stagger in the wrong unit": ("overhead-line-stitch-wire.yaml", "-100 mm]", "1e12 mm]", REFUSED),
    "retardation of centuries": ("simple-ac-275.yaml", "retardation: 0.1 ms", "retardation: 1e12 ms", REFUSED),
    "retardation of days": ("simple-ac-275.yaml", "retardation: 0.1 ms", "retardation: 1e5 s", REFUSED),
    "a deck without stiffness": ("footbridge-crowd.yaml", "500 MN", "1e-9 MN", REFUSED),
    "a track rope of light years": ("ropeway-tramway.yaml", "162.9 m", "1e30 m", REFUSED),
    "hundred million instants": ("base walker", "0.9", "1e6", REFUSED),
    "a bridge without length": ("bridge-ballasted-track.yaml", "[50.4 m, 0 m]", "[-0.0 m, 0 m]", REFUSED),
    "people of no height": ("footbridge-lock-in.yaml", "height: 1.17 m", "height: 1e-9 m", REFUSED),
    "a profile of a million kilometres": ("base rough", "start: [0.0, 0.0]", "start: [1e9, 0.0]", REFUSED),
    "a sheave with a million turns": ("base carriage", "wrap: 6.0", "wrap: 1e6", READ),
    "a stitch wire too stiff": ("overhead-line-stitch-wire.yaml", "stiffness: 3.8 MN", "stiffness: 1e15 MN", REFUSED),
    "a window of a light year": ("base bed", "window: 8.0", "window: 1e15", REFUSED),
    "a window of a hundred kilometres": ("base bed", "window: 8.0", "window: 1e5", READ),
    "a hanger of a nanometre": ("base carriage", "hanger: 2.0", "hanger: 1e-9", REFUSED),
    "a million cases": ("base sweep drawn", "count: 8", "count: 1e6", READ),
}
WAS_WRONG = {
    "a line from a place to itself, in small motion": """
gravity: 0
lines: {b: {start: [0, 0], end: [0, 0], length: 1, mass: 1, bending_stiffness: 1e6, axial_stiffness: 1e9}}
loads: {m: {kind: oscillator, on: b, mass: 1, stiffness: 1, travel: {speed: 1}}}
run: {kind: dynamic, until: 0.1, geometry: linearised}
""",
    "hangers from a line that goes straight up": """
lines:
  cable: {start: [0, 5], end: [0, 9], length: 5, mass: 1, axial_stiffness: 1e6}
  deck: {start: [0, 0], end: [9, 0], length: 9, mass: 1, bending_stiffness: 1e6, axial_stiffness: 1e8}
hangers: {row: {from: cable, to: deck, count: 2, mass: 1, axial_stiffness: 1e6}}
run: {kind: dynamic, until: 0.1}
""",
    "ends that are as good as one place": """
lines: {r: {start: [0, 0], end: [4e-11, 0], tension: 1 kN, mass: 1, axial_stiffness: 1e5}}
run: {kind: dynamic, until: 0.1}
""",
}


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_spoilt_files_are_read_or_refused_with_place_and_remedy(seed: int) -> None:
    found = {number: outcome(mutant(seed, number)[1]) for number in range(EACH)}
    wrong = {number: what for number, what in found.items() if what not in (READ, REFUSED)}
    assert not wrong, "\n".join(f"mutant {seed} {number}: {what}" for number, what in wrong.items())
    assert {READ, REFUSED} == set(found.values())


@pytest.mark.parametrize("made", [mutant, extreme])
def test_spoilt_files_are_checked_without_failing(
    made: Callable[[int, int], tuple[str, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the command does: files, the sweep, and how the run would begin; `python -m fuzzing SECONDS SEED check`."""
    monkeypatch.chdir(EXAMPLES)
    monkeypatch.setattr(console, "PATIENCE", 1.0)
    found = {number: outcome(made(4, number)[1], read=checked) for number in range(CHECKED)}
    wrong = {number: what for number, what in found.items() if what not in (READ, REFUSED)}
    assert not wrong, "\n".join(f"{made.__name__} 4 {number}: {what}" for number, what in wrong.items())


@pytest.mark.parametrize("text", WAS_WRONG.values(), ids=WAS_WRONG)
def test_what_was_wrong_is_refused(text: str) -> None:
    assert outcome(text) == REFUSED


@pytest.mark.parametrize(("name", "before", "after", "right"), FAILED_IN_CHECK.values(), ids=FAILED_IN_CHECK)
def test_absurd_values_are_checked_without_failing(
    name: str, before: str, after: str, right: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(EXAMPLES)
    text = dict(originals())[name]
    assert before in text
    assert outcome(text.replace(before, after, 1), read=checked) == right


def test_what_is_spoilt_is_sound() -> None:
    assert {outcome(text) for _, text in originals()} == {READ}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("lines: " + "[" * 3000 + "]" * 3000, "mutant.yaml:1: the blocks are nested too deeply"),
        ("a:\n" + "".join(" " * i + "a:\n" for i in range(1, 3000)), "mutant.yaml:3000: the blocks are nested too"),
        ("lines:\n" + "  l: {a: 1}\n" * 300_000, "300001 entries in 3.6 MB of YAML take too long to read"),
        ("#" + "x" * 63_000_000 + "\nlines: {}\n", "2 entries in 63.0 MB of YAML take too long to read"),
    ],
    ids=["brackets", "indented", "keys", "comment"],
)
def test_what_would_take_long_is_refused_at_once(text: str, message: str) -> None:
    from ropewalk.errors import ScenarioError
    from ropewalk.scenario import loads

    assert outcome(text) == REFUSED
    with pytest.raises(ScenarioError, match=message.replace(".", r"\.")):
        loads(text, "mutant.yaml")
