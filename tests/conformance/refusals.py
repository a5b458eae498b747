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
        "x does not define a position on a line that also extends along y":
            r"horizontal means along x, and the ends of|holds such a contact acts along x, and the ends",
        "two stiffnesses do not define the third direction": r"two values do not define the direction y",
        "without gravity the equilibrium of a slack line is not determined":
            r"without gravity the equilibrium of a line longer",
        "an overhead line hangs by its weight": r"an overhead line hangs by its weight",
        "the key belongs to the other geometry": r"is for (non)?linear(ised)? geometry only",
        "a slack rope has no transverse modes about its chord": r"deflected so far it would be pushed together",
        "a line without bending stiffness turns freely": r"a line without bending stiffness turns freely",
        "linearised motion is about a straight, unbuckled line": r"a line longer than its chord is a strut",
        "a train needs a line, and a net has none": r"a train needs a line, and a net has none",
        "a line with few links does not have this mode": r"its nodes cannot show so many half waves",
        "without gravity hangers carry no load": r"without gravity hangers carry no load",
        "a net has no axis to whirl about": r"a net has no axis to whirl about",
        "an excitation of the whole line needs the whole line, not a window":
            r"moves (the whole line, not only its part near|its line far from) a load",
        "an inextensible line transmits tension instantaneously along its whole length": r"passes tension on at once",
        "a window is measured along lines, not on nets": r"a window is measured along lines",
        "a net has no axis along which its inertia can be increased": r"a net has no axis along which its inertia",
        "a start in equilibrium with loads needs loads": r"run\.start\.with_loads: there are no loads",
        "two inputs determine the tension": r"has no equilibrium with its tension|both set its tension",
        "ropes that stretch differently do not have one position at equal arc lengths":
            r"lines that stretch differently do not have one x",
        "a crab begins within all of its lines": r"it would begin at x = .*, and .* runs from",
        "a driver acts along one line": r"a driver acts along one line",
        "a load on several lines can neither leave nor stop at the end of one of them":
            r"all of its lines carry it, and end at different|its drive would pull it over the ends",
        "a carriage rolls along a rope": r"a carriage rolls along a rope",
        "linearised motion cannot slip": r"a line (sticks|slips) [^;]* in small motion",
        "hysteresis has different stiffnesses for loading and unloading":
            r"has no linearised motion: the stiffness differs",
        "inextensible lines have no longitudinal waves": r"have no waves along them that could be slower",
        "a moving force is not a vehicle that can be exported": r"of kind force is only a force; what can be exported",
        "a structure has other modes after a failure": r"has other modes after a dropper fails",
        "the force of gusts without a mean wind is quadratic in their speed":
            r"is linear only about a mean wind that is stronger",
        "a pantograph that passes to another contact wire leaves the first":
            r"passes from one contact wire to the next, and leaves",
    },
    MISSING: {
        "dry friction on saddles is discontinuous, which methods of high order do not allow":
            rf"(rkn6|implicit) with dry friction .* {_NOT}",
        "loads that an engine does not support, pantographs with several contacts in comparisons":
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
