"""The relations, with their weights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from random import Random

import numpy as np

from . import geometry, physics, tools, wording
from .compare import Difference, Sides, difference
from .running import Fields
from .trees import Tree, refined

SHRINKS = 0.7
"""A difference is one of the mesh if a mesh of half or a quarter of the size leaves less than this part of it."""


@dataclass(frozen=True)
class Relation:
    """What mechanics guarantees of two scenarios, one made from the other."""

    name: str
    weight: float
    applies: Callable[[Tree], bool]
    sides: Callable[[Tree, Random], Sides | None]  # None: it turns out not to apply

    def violation(self, tree: Tree, seed: str) -> Difference | None:
        """Return the difference of both sides, if it is more than rounding and does not shrink with mesh and step.

        None where the relation does not apply.
        """
        found = self.compared(tree, seed)
        if found is None or found.size <= 1.0 or np.isinf(found.size):
            return found
        for factor in (2, 4):  # where a load stands within a link differs from mesh to mesh
            finer = self.compared(refined(tree, factor), seed)
            if finer is None or finer.size <= max(1.0, SHRINKS * found.size):
                return Difference(0.0, "shrinks with the mesh")
        return found

    def compared(self, tree: Tree, seed: str) -> Difference | None:
        """Return the difference of both sides in units of the tolerance."""
        sides = self.sides(tree, Random(seed))
        return None if sides is None else difference(_about_one_end(sides) if "overhead_lines" in tree else sides)


def _about_one_end(sides: Sides) -> Sides:
    """Return sides with the places of an overhead line counted from the first point of its contact wire in x.

    Weights pull at both ends, and nothing else holds the wires along x: where they are as a whole, rounding decides.
    """

    def counted(fields: Fields) -> Fields:
        if ("position", "section.contact") not in fields:
            return fields  # of a relation between numbers
        start = fields["position", "section.contact"][0, 0] * [1.0, 0.0, 0.0]
        loads_or_wires = ("contact_position", "body_position", "position")
        return {
            (name, owner): values - start if name in loads_or_wires and owner != "far" else values
            for (name, owner), values in fields.items()
        }

    return replace(sides, left=geometry.with_fields(sides.left, counted),
                   right=geometry.with_fields(sides.right, counted))  # fmt: skip


def _is(*kinds: str) -> Callable[[Tree], bool]:
    """Whether the run is of some kinds."""
    return lambda tree: tree["run"]["kind"] in kinds


def _anything(tree: Tree) -> bool:
    return True


def _in_plan(tree: Tree) -> bool:
    return "overhead_lines" not in tree


RELATIONS = (
    Relation("mirror", 3, geometry.mirrors, geometry.mirror),
    Relation("reversal of a line", 3, geometry.reverses, geometry.reversal),
    Relation("translation", 2, _in_plan, geometry.translation),
    Relation("rotation about the vertical", 3, geometry.turns, geometry.rotation),
    Relation("overhead line from the other end", 6, lambda tree: not _in_plan(tree) and bool(tree["loads"]),
             geometry.overhead_from_the_other_end),
    Relation("units", 2, _anything, geometry.units),
    Relation("scaling", 3, geometry.scales, geometry.scaling),
    Relation("names and order", 3, _anything, geometry.names_and_order),
    Relation("two halves", 2, lambda tree: bool(wording.plain_forces(tree)), wording.halves),
    Relation("joined lines", 5, wording.splits, wording.joined_lines),
    Relation("nothing added", 3, _anything, wording.nothing_added),
    Relation("the same body", 5, wording.has_body, wording.other_body),
    Relation("superposition", 6, physics.superposes, physics.superposition),
    Relation("reciprocity", 4, physics.reciprocates, physics.reciprocity),
    Relation("slow motion", 8, physics.moves_slowly, physics.slow_motion),
    Relation("equilibria", 8, physics.is_quasistatic, physics.equilibria),
    Relation("small amplitude", 8, physics.is_small, physics.small_amplitude),
    Relation("energy", 1, _is("dynamic"), physics.energy),
    Relation("support forces", 4, physics.is_static, physics.support_forces),
    Relation("momentum", 3, physics.has_momentum, physics.momentum),
    Relation("resumed", 3, _is("dynamic"), tools.resumed),
    Relation("output interval", 2, _is("dynamic", "linear"), tools.more_output),
    Relation("command line", 1, _anything, tools.command_line),
    Relation("sweep of one", 1, _is("dynamic", "linear", "equilibrium"), tools.sweep_of_one),
)  # fmt: skip
BY_NAME = {relation.name: relation for relation in RELATIONS}
