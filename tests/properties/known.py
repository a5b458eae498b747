"""Expected failures: relations that are violated today, with case, scenarios concerned, and stage that mends them.

A stage is one of the plan for one engine: 2 lines, forces, equilibria of lines, linear kinds; 3 bodies; 4 nets,
sheaves, saddles; 5 overhead lines. An entry that no run meets any more is to be struck out.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .compare import DOUBTFUL, TWO_ENGINES, Difference
from .trees import Tree

ASK_FOR_MORE = ("nothing added", "joined lines", "rotation about the vertical", "the same body", "two halves",
                "small amplitude", "slow motion", "equilibria", "reciprocity")  # fmt: skip
"""Relations whose other side has more, or another run, so that another engine may compute it."""


@dataclass(frozen=True)
class Known:
    """A fault by the pairs of scenarios that show it."""

    case: str
    stage: int
    reason: str
    concerns: Callable[[Tree, str, Difference], bool]  # scenario, relation, difference


def _is_refused(found: Difference) -> bool:
    """Whether one side is refused as not implemented."""
    ends = ("done and refused", "refused and done")  # a refusal after the check has passed is a fault of its own
    return found.what.startswith(ends) and "is not implemented" in found.what


def _changes_engine(tree: Tree, relation: str, found: Difference) -> bool:
    """Something far away, a joint, another body, kind or dimension lets an engine compute the lines that has less."""
    return relation in ASK_FOR_MORE and _is_refused(found)


def _differs_by_engine(found: Difference) -> bool:
    """Whether other engines compute both sides: up to a tenth of the sag, of which 2 % were measured in 1500 pairs."""
    return "engines differ" in found.what and found.size <= 0.1 / TWO_ENGINES


def _has_two_engines(tree: Tree, relation: str, found: Difference) -> bool:
    """Another engine computes the lines, with other nodes and contacts."""
    return relation in ("nothing added", "joined lines", "two halves") and _differs_by_engine(found)


def _runs_aside(tree: Tree, relation: str, found: Difference) -> bool:
    """Beams that do not run along x are computed by another engine, in which loads that are set down ring longer."""
    return relation == "rotation about the vertical" and _has_beams(tree) and _differs_by_engine(found)


def _rides_on_a_slope(tree: Tree, relation: str, found: Difference) -> bool:
    """One engine leaves out the inertia of loads along beams, and doubts itself on slopes."""
    said = "engines differ" in found.what and DOUBTFUL in found.what
    return said and _has_beams(tree) and np.isfinite(found.size)


def _has_beams(tree: Tree) -> bool:
    return any(line.get("bending_stiffness") for line in tree.get("lines", {}).values())


def _ends_the_path(tree: Tree, relation: str, found: Difference) -> bool:
    """A load that comes to an end of a rope ends its quasi-static path; in the other engine the others go on."""
    several = tree["run"]["kind"] == "quasistatic" and len(tree["loads"]) > 1
    return several and "engines differ" in found.what and found.what.startswith("load_path")


def _searches_on_the_way(tree: Tree, relation: str, found: Difference) -> bool:
    """A quasi-static search for where loads stand or slide ends or does not, as rounding has it."""
    quasistatic = tree["run"]["kind"] == "quasistatic"
    twins = relation == "two halves" and "the loads hinder each other" in found.what  # two that slip at one place
    sliding = any(load.get("contact") == "frictionless" for load in tree["loads"].values())
    lost = sliding and "no equilibrium was found" in found.what
    return quasistatic and (twins or lost or "the positions of the loads have not converged" in found.what)


def _takes_coarse_steps(tree: Tree, relation: str, found: Difference) -> bool:
    """Forces of linear and linearised runs depend on the interval of output."""
    linear = tree["run"]["kind"] == "linear" or "geometry" in tree["run"]
    return relation == "output interval" and linear and found.what.startswith(("reaction", "contact_force", "tension"))


def _leaves_damping_out(tree: Tree, relation: str, found: Difference) -> bool:
    """The linear theory of strings leaves their damping out, with a warning; modes of joined lines have it."""
    strings = [line for line in tree.get("lines", {}).values() if not line.get("bending_stiffness")]
    damped = any({"drag", "axial_damping"} & set(line) for line in strings)
    return relation == "nothing added" and tree["run"]["kind"] == "linear" and damped


def _counts_along_the_chord(tree: Tree, relation: str, found: Difference) -> bool:
    """One engine counts from and speed along the chord of lines given by a tension, without their strain."""
    sides = "engines differ" in found.what and "wires" in found.what.partition("engines differ")[2]
    numbers = re.search(r"(?:_position|load_path).* differs by (\S+) of (\S+)", found.what)
    given = [line for line in tree.get("lines", {}).values() if "tension" in line]
    along = max((np.linalg.norm(np.subtract(line["end"], line["start"])) * line["tension"] / line["axial_stiffness"]
                 for line in given), default=0.0)  # fmt: skip
    return sides and numbers is not None and float(numbers[1]) * float(numbers[2]) <= 1.05 * along


def _stays_at_an_end(tree: Tree, relation: str, found: Difference) -> bool:
    """A quasi-static force that stays at the end of a beam loses up to a thousandth, by rounding of its place."""
    stays = any(load.get("travel", {}).get("at_end") == "stay" for load in tree["loads"].values())
    forces = found.what.startswith(("reaction", "contact_force")) and found.size <= 100.0
    return stays and forces and tree["run"]["kind"] == "quasistatic" and _has_beams(tree)


def _slides_to_an_end(tree: Tree, relation: str, found: Difference) -> bool:
    """A frictionless force that stays at an end is normal to the line at its end, and vertical at its start."""
    stays = any(
        load.get("contact") == "frictionless" and load["travel"].get("at_end") == "stay"
        for load in tree["loads"].values()
    )
    quasistatic = tree["run"]["kind"] == "quasistatic" and relation == "reversal of a line"
    return stays and quasistatic and found.what.startswith("contact_force")


def _joins_inextensible(tree: Tree, relation: str, found: Difference) -> bool:
    """Two inextensible lines that are joined find no equilibrium, where one line does."""
    return relation == "joined lines" and "inextensible lines find no rest" in found.what


def _passes_a_support(tree: Tree, relation: str, found: Difference) -> bool:
    """Bodies on modes are handed over from span to span: contact forces ring after an inner support."""
    added = relation == "nothing added" and "spring without stiffness" in found.what
    bodies = any(load["kind"] not in ("force", "axles") for load in tree["loads"].values())
    return added and bodies and tree["run"]["kind"] == "linear" and found.size <= 50.0


def _halves_on_inextensible(tree: Tree, relation: str, found: Difference) -> bool:
    """Two loads within a link of an inextensible line are doubtful; up to half a per cent of the sag was measured."""
    rigid = any(line.get("law", {}).get("kind") == "inextensible" for line in tree.get("lines", {}).values())
    return rigid and relation == "two halves" and DOUBTFUL in found.what and found.size <= 5.0


def _measures_modes_at_instants(tree: Tree, relation: str, found: Difference) -> bool:
    """Whether enough modes are taken is judged at output instants, and not where a support is added: one side stops."""
    return relation in ("output interval", "nothing added") and "does not converge by adding modes" in found.what


def _strikes_the_end(tree: Tree, relation: str, found: Difference) -> bool:
    """What stays at an end stops with a blow: an oscillator with the mass of its wheel, a vehicle with all of it."""
    stays = any(load.get("travel", {}).get("at_end") == "stay" for load in tree["loads"].values())
    return stays and tree["run"]["kind"] == "dynamic" and relation == "the same body"


def _sets_feet_down(tree: Tree, relation: str, found: Difference) -> bool:
    """The foot that a walker sets down comes with its potential energy above z = 0, which a drive gives it."""
    walks = any(load["kind"] == "walker" for load in tree["loads"].values())
    return walks and found.what.startswith(("energy load_potential", "energy drive_work"))


def _halves_its_steps(tree: Tree, relation: str, found: Difference) -> bool:
    """Bodies on the modes of a mesh take minutes, of which `check` warns."""
    bodies = any(load["kind"] not in ("force", "axles", "footsteps") for load in tree["loads"].values())
    return bodies and tree["run"]["kind"] == "linear" and found.what.startswith("no answer within")


def _has_left(tree: Tree, relation: str, found: Difference) -> bool:
    """A vehicle that has left the line moves on in one engine, and stands beyond the end in another."""
    leaves = any(load.get("travel", {}).get("at_end") == "leave" for load in tree["loads"].values())
    return leaves and "engines differ" in found.what and found.what.startswith("body_position")


KNOWN: tuple[Known, ...] = (
    Known("not-implemented-elsewhere", 2, "engines differ in what they support", _changes_engine),
    Known(
        "c-p3-17", 2, "loads meet in one engine, and pass each other in another", lambda t, r, d: "loads met" in d.what
    ),
    Known("a-03", 3, "bodies on modes take 70 times as long as direct integration", _halves_its_steps),
    Known("blow-at-the-end", 3, "bodies differ in the mass that stops at an end", _strikes_the_end),
    Known("feet-set-down", 3, "the work of a walker's drive counts heights of feet from z = 0", _sets_feet_down),
    Known("vehicle-beyond-the-end", 3, "engines differ in where a vehicle is that has left its line", _has_left),
    Known("mass-over-support", 3, "bodies on modes change span at inner supports", _passes_a_support),
    Known("beams-on-slopes", 3, "an engine leaves out inertia along beams", _rides_on_a_slope),
    Known("strain-of-wires", 2, "an engine counts along chords, not unstrained lengths", _counts_along_the_chord),
    Known("modes-at-instants", 2, "convergence with modes is judged at output instants", _measures_modes_at_instants),
    Known("end-of-path", 2, "engines differ in when a quasi-static path ends", _ends_the_path),
    Known("stay-at-the-end", 2, "a quasi-static force at an end is not all borne", _stays_at_an_end),
    Known("frictionless-at-an-end", 2, "the direction of a quasi-static force differs by the end", _slides_to_an_end),
    Known("inextensible-joined", 4, "joined inextensible lines find no equilibrium", _joins_inextensible),
    Known("t-08", 4, "two loads within a link of an inextensible line", _halves_on_inextensible),
    Known("quasi-static-search", 2, "places of loads that stand or slide are not always found", _searches_on_the_way),
    Known("undamped-strings", 2, "the closed form of a string has no damping", _leaves_damping_out),
    Known("coarse-steps", 2, "forces follow the last step, whose length depends on the output", _takes_coarse_steps),
    Known("beams-aside", 2, "beams that do not run along x are computed by another engine", _runs_aside),
    Known("two-engines", 2, "an addition without effect changes the engine, and its mesh", _has_two_engines),
)
"""The first that concerns a violation names it: narrow ones first."""


def known(tree: Tree, relation: str, found: Difference) -> str:
    """Return the case that a violation belongs to, empty if it is none of the expected failures."""
    return next((one.case for one in KNOWN if one.concerns(tree, relation, found)), "")
