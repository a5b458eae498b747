"""Pairs of a scenario and a relation, numbered; what becomes of each."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

from .compare import Difference
from .draw import draw
from .known import known
from .relations import BY_NAME, RELATIONS, Relation
from .running import read
from .trees import Tree

PER_SCENARIO = 4
"""Relations of a scenario: they share its run."""

REFUSED_SHARE = 0.05
"""Of the scenarios that may be refused: both sides of a relation must be."""


@dataclass(frozen=True)
class Verdict:
    """A pair, and what became of it."""

    pair: str  # seed-number relation
    relation: str
    kind: str  # of the run
    size: float  # difference in units of the tolerance; above 1 it is a violation
    what: str
    case: str  # expected failure that it belongs to
    cpu: float

    @property
    def is_violated(self) -> bool:
        """Whether the relation does not hold."""
        return self.size > 1.0


def scenario(seed: int, number: int) -> Tree:
    """Return a drawn scenario; few of them are refused."""
    rng = Random(f"{seed}-{number}")
    while True:
        tree = draw(rng)
        try:
            read(tree)
        except Exception:
            if rng.random() > REFUSED_SHARE:
                continue
        return tree


def relations(tree: Tree, seed: int, number: int) -> list[Relation]:
    """Return the relations that are asked of a drawn scenario."""
    rng = Random(f"{seed}-{number} relations")
    rest = [relation for relation in RELATIONS if relation.applies(tree)]
    chosen = []
    while rest and len(chosen) < PER_SCENARIO:
        (one,) = rng.choices(rest, [relation.weight for relation in rest])
        rest.remove(one)
        chosen.append(one)
    return chosen


def kind_of(tree: Tree) -> str:
    """Return the kind of a run; linearised motions are a kind of their own."""
    return "linearised" if "geometry" in tree["run"] else str(tree["run"]["kind"])


def examine(tree: Tree, relation: Relation, pair: str) -> Verdict | None:
    """Return what became of a pair, None where the relation turned out not to apply."""
    begin = time.process_time()
    try:
        found = relation.violation(tree, pair)
    except Exception as error:
        found = Difference(float("inf"), f"the test has failed: {type(error).__name__}: {error}")
    if found is None:
        return None
    case = known(tree, relation.name, found) if found.size > 1.0 else ""
    return Verdict(pair, relation.name, kind_of(tree), found.size, found.what, case, time.process_time() - begin)


def verdicts(seed: int, number: int) -> Iterator[tuple[str, Verdict | None]]:
    """Examine the relations of a scenario: the name of a pair before, None as its verdict, and its verdict after."""
    tree = scenario(seed, number)
    for relation in relations(tree, seed, number):
        pair = f"{seed}-{number} {relation.name}"
        yield pair, None
        yield pair, examine(tree, relation, pair)


def scenario_of(pair: str) -> Tree:
    """Return the scenario of a pair by its name, such as "1-7 mirror"."""
    seed, _, number = pair.partition(" ")[0].partition("-")
    return scenario(int(seed), int(number))


def again(pair: str) -> tuple[Tree, Verdict | None]:
    """Return the scenario and the verdict of a pair by its name."""
    tree = scenario_of(pair)
    return tree, examine(tree, BY_NAME[pair.partition(" ")[2]], pair)
