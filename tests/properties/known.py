"""Expected failures: relations that are violated today, with case, scenarios concerned, and stage that mends them.

A stage is one of the plan for one engine: 2 lines, forces, equilibria of lines, linear kinds; 3 bodies; 4 nets,
sheaves, saddles; 5 overhead lines. An entry that no run meets any more is to be struck out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .compare import TWO_ENGINES, Difference
from .trees import Tree


@dataclass(frozen=True)
class Known:
    """A fault by the pairs of scenarios that show it."""

    case: str
    stage: int
    reason: str
    concerns: Callable[[Tree, str, Difference], bool]  # scenario, relation, difference


def _is_refused(found: Difference) -> bool:
    """Whether one side is refused as not implemented."""
    ends = tuple(f"{a} and {b}" for a, b in (("done", "refused"), ("refused", "done"), ("done", "stopped")))
    return found.what.startswith(ends) and "is not implemented" in found.what


def _changes_engine(tree: Tree, relation: str, found: Difference) -> bool:
    """Something far away, a joint, a direction or a third dimension lets an engine compute the lines that has less."""
    return _is_refused(found)


def _has_two_engines(tree: Tree, relation: str, found: Difference) -> bool:
    """Another engine computes the lines, with other nodes and contacts: up to half of the sag right after a start."""
    return relation in ("nothing added", "joined lines") and found.size <= 0.5 / TWO_ENGINES


def _runs_aside(tree: Tree, relation: str, found: Difference) -> bool:
    """Beams that do not run along x are computed by another engine, in which loads that are set down ring longer."""
    beams = any(line.get("bending_stiffness") for line in tree.get("lines", {}).values())
    return relation == "rotation about the vertical" and beams and np.isfinite(found.size)


def _ends_the_path(tree: Tree, relation: str, found: Difference) -> bool:
    """A load that comes to an end of a rope ends its quasi-static path; on joined lines the others go on."""
    return relation == "joined lines" and tree["run"]["kind"] == "quasistatic"


def _searches_on_the_way(tree: Tree, relation: str, found: Difference) -> bool:
    """A quasi-static search for where loads stand on a slack line ends or does not, as rounding has it."""
    return "the positions of the loads have not converged" in found.what


def _takes_coarse_steps(tree: Tree, relation: str, found: Difference) -> bool:
    """Forces of linear and linearised runs depend on the interval of output."""
    linear = tree["run"]["kind"] == "linear" or "geometry" in tree["run"]
    return relation == "output interval" and linear and found.what.startswith(("reaction", "contact_force", "tension"))


def _leaves_damping_out(tree: Tree, relation: str, found: Difference) -> bool:
    """The linear theory of strings leaves their damping out, with a warning; modes of joined lines have it."""
    strings = [line for line in tree.get("lines", {}).values() if not line.get("bending_stiffness")]
    damped = any({"drag", "axial_damping"} & set(line) for line in strings)
    return relation == "nothing added" and tree["run"]["kind"] == "linear" and damped


def _has_left(tree: Tree, relation: str, found: Difference) -> bool:
    """A vehicle that has left the line moves on in one engine, and stands beyond the end in another."""
    leaves = any(load.get("travel", {}).get("at_end") == "leave" for load in tree["loads"].values())
    return leaves and found.what.startswith("body_position")


KNOWN: tuple[Known, ...] = (
    Known("not-implemented-elsewhere", 2, "engines differ in what they support", _changes_engine),
    Known(
        "c-p3-17", 2, "loads meet in one engine, and pass each other in another", lambda t, r, d: "loads met" in d.what
    ),
    Known("vehicle-beyond-the-end", 3, "engines differ in where a vehicle is that has left its line", _has_left),
    Known("two-engines", 2, "an addition without effect changes the engine, and its mesh", _has_two_engines),
    Known("beams-aside", 2, "beams that do not run along x are computed by another engine", _runs_aside),
    Known("end-of-path", 2, "engines differ in when a quasi-static path ends", _ends_the_path),
    Known("quasi-static-search", 2, "places of loads on slack lines are not always found", _searches_on_the_way),
    Known("undamped-strings", 2, "the closed form of a string has no damping", _leaves_damping_out),
    Known("coarse-steps", 2, "forces follow the last step, whose length depends on the output", _takes_coarse_steps),
)


def known(tree: Tree, relation: str, found: Difference) -> str:
    """Return the case that a violation belongs to, empty if it is none of the expected failures."""
    return next((one.case for one in KNOWN if one.concerns(tree, relation, found)), "")
