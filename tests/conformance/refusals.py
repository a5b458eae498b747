"""Why runs are refused: every message is known here, and is of one of two kinds. Nothing else knows messages."""

from __future__ import annotations

import re
from dataclasses import dataclass

NO_SENSE, MISSING = "no physical sense", "not implemented yet"

_NOT = "is not implemented for"
# Reason, as the page of capabilities has it, and a pattern of the messages that say so.
_PATTERNS = {
    NO_SENSE: {
        "a pantograph presses from below against an overhead line":
            r"a pantograph runs under an overhead|travel\.path: unknown key",
        "the load would pass the end of its line":
            r"the load passes the (start|end) of|would start (before|beyond) the (start|end) of",
        "a mass that follows the arc length is unstable": r"a mass that follows the arc length is unstable",
        "x means nothing on a line that runs along y, too":
            r"horizontal means along x, and the ends of|holds such a contact acts along x, and the ends",
        "two stiffnesses say nothing of the third direction": r"two values do not define the direction y",
        "without gravity nothing decides how a slack line hangs": r"without gravity the equilibrium of a line longer",
        "an overhead line hangs by its weight": r"an overhead line hangs by its weight",
        "the key belongs to the other geometry": r"is for (non)?linear(ised)? geometry only",
        "a slack rope has no transverse modes about its chord": r"deflected so far it would be pushed together",
        "a line without bending stiffness turns freely": r"a line without bending stiffness turns freely",
        "small motion is about a straight line, no buckled one": r"a line longer than its chord is a strut",
        "a train needs a line, and a net has none": r"a train needs a line, and a net has none",
        "a line of few links has no such mode": r"its nodes cannot show so many half waves",
        "without gravity hangers carry no load": r"without gravity hangers carry no load",
        "a net has no axis to whirl about": r"a net has no axis to whirl about",
        "what moves a line everywhere leaves nothing to stand still":
            r"moves (all of a line, not only what is near|its line far from) a load",
        "a line that does not stretch passes tension on at once, all along it": r"passes tension on at once",
        "a window is measured along lines, and a net has none": r"a window is measured along lines",
        "a net has no axis along which to be heavier": r"a net has no axis along which its inertia",
        "there are no loads to begin at rest with": r"run\.start\.with_loads: there are no loads",
        "two things set the tension": r"does not come to rest with its tension|both set its tension",
        "ropes that stretch differently are not at one place where so much of each is behind":
            r"lines that stretch differently do not have one x",
        "a crab begins within all of its lines": r"it would begin at x = .*, and .* runs from",
        "a driver acts along one line": r"a driver acts along one line",
        "what several lines carry leaves none of them, nor stays at the end of one":
            r"all of its lines carry it, and end at different|its drive would pull it over the ends",
        "a carriage rolls along a rope": r"a carriage rolls along a rope",
        "in small motion a line sticks where it would slip": r"a line (sticks|slips) [^;]* in small motion",
        "where loading turns into unloading, hysteresis has two stiffnesses":
            r"has no small motion: where loading turns",
        "lines that do not stretch have no waves along them": r"have no waves along them that could be slower",
        "a given force is no vehicle": r"of kind force is only a force; what can be exported",
        "what fails on the way has other modes afterwards": r"has other modes afterwards: nothing is superposed",
        "gusts without a mean wind push with the square of their speed":
            r"is linear only about a mean wind that is stronger",
        "a pantograph that goes over to another wire leaves the one behind":
            r"goes over from one contact wire to the next, and leaves",
    },
    MISSING: {
        "dry friction on saddles jumps from step to step, which no method of high order knows":
            rf"(rkn6|implicit) with dry friction .* {_NOT}",
        "loads that an engine does not know, pantographs with several contacts in comparisons":
            rf"pantographs with several contacts|(loads\.[^.:]*\.kind|lines\.[^:]*): {_NOT} (joined|beams)",
        "linear theory: no vehicle that starts on the line":
            rf"a vehicle that starts before its line {_NOT}|is not reached with \d+ modes|run\.modes",
    },
}  # fmt: skip


@dataclass(frozen=True)
class Refusal:
    """A reason for which runs are refused."""

    kind: str
    reason: str
    pattern: str


REFUSALS = tuple(
    Refusal(kind, reason, pattern) for kind, known in _PATTERNS.items() for reason, pattern in known.items()
)
"""What contradicts physics or itself before what is missing: where both are told, the first is the reason."""


def refusals_in(note: str) -> list[Refusal | None]:
    """What each line of the messages is; None: it is known to nobody."""
    return [next((r for r in REFUSALS if re.search(r.pattern, line)), None) for line in note.splitlines()]
