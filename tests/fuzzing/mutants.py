"""Mutants: examples, and the scenarios in which every key of the vocabulary occurs, spoilt at random as text."""

from __future__ import annotations

import io
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from ruamel.yaml import YAML

from conformance.bases import BASES, TAUT, load, moves, way

EXAMPLES = Path(__file__).parents[2] / "examples"
JUNK = (
    "", "-1", "0", "1e400", "-1e-320", ".nan", "-.inf", "null", "~", "true", "[]", "{}", "[[[]]]", "'", '"',
    "1 furlong", "1e30 m", "12:30:45", "0x1F", "1_000", "2024-01-01", "*a", "&a 1", "!!python/object:os.system x",
    "!!binary aGk=", "<<: {a: 1}", "? x", "|", ">-", "%YAML 9.9", "---", "...", "\t", "\u00a0", "\u202e", "\ufeff",
    "\x07", "é" * 40, "9" * 5000, "x" * 300, "rope", "start", "end", "dynamic", "hooke", "linearised",
    "{kind: mass}", "[0, 0, 0, 0]",
)  # fmt: skip
NUMBERS = (
    "0", "-1", "1e-30", "1e30", "3.7", "100000", "nan", "1e309", "-0.0", "7 kN", "1e-12", "1e-9", "1e-6", "1e6", "1e9",
    "1e12", "1e15", "1e18", "1e-18",
)  # fmt: skip
SWEPT = {"lines": {"rope": TAUT}, "loads": {"w": load("force", way())}, "run": moves()}
SWEEPS: dict[str, dict[str, Any]] = {
    "of values": {
        "over": {"lines.rope.tension": "5:20:5 kN", "loads.w.travel.speed": ["5 m/s", "10 m/s"]},
        "derived": {"run.until": "2 * rope.elements / speed * 1 m"}, "record": ["max tension", "largest_sag"],
    },
    "of whole loads": {
        "over": {"loads.w": ["{kind: mass, mass: 5, on: rope, travel: {speed: 3, from: 2}}"], "run.every": "10 ms"},
        "combine": "zip",
    },
    "drawn": {
        "over": {"lines.rope.mass": "uniform(0.5 kg/m, 2 kg/m)", "lines.rope.drag": "loguniform(0.1 1/s, 1 1/s)"},
        "combine": "sobol", "count": 8, "seed": 1,
    },
    "of effects": {
        "over": {"lines.rope.mass": "uniform(1 kg/m, 2 kg/m)", "loads.w.travel.from": "uniform(1 m, 9 m)"},
        "combine": "morris", "count": 3,
    },
}  # fmt: skip
Change = Callable[[str, np.random.Generator], str]


@cache
def originals() -> tuple[tuple[str, str], ...]:
    """Names and texts of what is spoilt."""
    files = [(path.name, path.read_text(encoding="utf-8")) for path in sorted(EXAMPLES.glob("*.yaml"))]
    sweeps = {f"sweep {name}": SWEPT | {"sweep": tree} for name, tree in SWEEPS.items()}
    for name, tree in {**BASES, **sweeps}.items():
        stream = io.StringIO()
        YAML(typ="safe", pure=True).dump(tree, stream)
        files.append((f"base {name}", stream.getvalue()))
    return tuple(files)


def _cut(text: str, chance: np.random.Generator) -> str:
    a, b = sorted(chance.integers(0, len(text) + 1, 2))
    return text[:a] + text[min(b, a + int(chance.integers(1, 40))) :]


def _insert(text: str, chance: np.random.Generator) -> str:
    at = int(chance.integers(0, len(text) + 1))
    return text[:at] + str(chance.choice(JUNK)) + text[at:]


def _letter(text: str, chance: np.random.Generator) -> str:
    at = int(chance.integers(0, len(text)))
    return text[:at] + chr(int(chance.choice([*range(9, 127), 0x2028, 0x1F600]))) + text[at + 1 :]


def _value(text: str, chance: np.random.Generator) -> str:
    lines = text.splitlines()
    at = [i for i, line in enumerate(lines) if ":" in line]
    if not at:
        return text
    i = int(chance.choice(at))
    key, _, _ = lines[i].partition(":")
    lines[i] = f"{key}: {chance.choice(JUNK)}"
    return "\n".join(lines)


def _lines(text: str, chance: np.random.Generator) -> str:
    """Double one, leave one out, exchange two, or indent one elsewise."""
    lines = text.splitlines()
    i, j = chance.integers(0, len(lines), 2)
    what = chance.integers(0, 4)
    if what == 0:
        lines.insert(int(j), lines[i])
    elif what == 1:
        del lines[i]
    elif what == 2:
        lines[i], lines[j] = lines[j], lines[i]
    else:
        lines[i] = " " * int(chance.integers(0, 9)) + lines[i].lstrip()
    return "\n".join(lines)


def _other(text: str, chance: np.random.Generator) -> str:
    """Some lines of another scenario."""
    lines, others = text.splitlines(), originals()[int(chance.integers(0, len(originals())))][1].splitlines()
    i, j = int(chance.integers(0, len(lines) + 1)), int(chance.integers(0, len(others)))
    return "\n".join([*lines[:i], *others[j : j + int(chance.integers(1, 12))], *lines[i:]])


def _number(text: str, chance: np.random.Generator) -> str:
    """Another number in place of one."""
    import re

    found = list(re.finditer(r"(?<![\w.])-?\d+(\.\d+)?", text))
    if not found:
        return text
    one = found[int(chance.integers(0, len(found)))]
    new = chance.choice(NUMBERS)
    return text[: one.start()] + str(new) + text[one.end() :]


def extreme(seed: int, number: int) -> tuple[str, str]:
    """What a mutant is made of, and its text: an original with one number, or two, of another magnitude."""
    chance = np.random.default_rng([seed, number, 1])
    name, text = originals()[int(chance.integers(0, len(originals())))]
    for _ in range(int(chance.choice([1, 1, 2]))):
        text = _number(text, chance)
    return name, text


CHANGES: tuple[Change, ...] = (_cut, _insert, _letter, _value, _lines, _other, _number)


def mutant(seed: int, number: int) -> tuple[str, str]:
    """What a mutant is made of, and its text: one to four changes of an original."""
    chance = np.random.default_rng([seed, number])
    name, text = originals()[int(chance.integers(0, len(originals())))]
    for _ in range(int(chance.choice([1, 1, 1, 2, 3, 4]))):
        text = CHANGES[int(chance.integers(0, len(CHANGES)))](text, chance) or "x"
    return name, text
