"""Why runs are refused: every message is known here, and is of one of two kinds. Nothing else knows messages."""

from __future__ import annotations

import re
from dataclasses import dataclass

NO_SENSE, MISSING = "no physical sense", "not implemented yet"

# Reason, as the page of capabilities has it, and a pattern of the messages that say so.
_PATTERNS = {
    NO_SENSE: {
        "a pantograph presses from below against an overhead line": r"a pantograph runs under an overhead",
        "the load would pass the end of its line":
            r"the load passes the (start|end) of|would start (before|beyond) the (start|end) of",
        "a mass that follows the arc length is unstable": r"a mass that follows the arc length is unstable",
        "x means nothing on a line that runs along y, too":
            r"horizontal means along x, and the ends of|holds such a contact acts along x, and the ends",
        "two stiffnesses say nothing of the third direction": r"two values say nothing of the direction y",
        "without gravity nothing decides how a slack line hangs": r"without gravity the rest shape of a line longer",
        "an overhead line hangs by its weight": r"an overhead line hangs by its weight",
        "the key belongs to the other geometry": r"goes with (non)?linear(ised)? geometry only",
        "a slack rope has no transverse modes about its chord": r"deflected so far it would be pushed together",
        "a line without bending stiffness turns freely": r"a line without bending stiffness turns freely",
        "small motion is about a straight line, no buckled one": r"a line longer than its chord is a strut",
        "in small motion nothing changes a tension": r"in small motion tensions are constant",
        "there are no loads to begin at rest with": r"run\.start\.with_loads: there are no loads",
        "two things set the tension": r"does not come to rest with its tension|both set its tension",
        "a given force is no vehicle": r"of kind force is only a force; what can be exported",
    },
    MISSING: {
        "loads on networks, nets and in wind: forces, masses, footsteps":
            r"joined lines and nets know forces, masses|kind: \w+ supports on joined lines",
        "loads on stiff lines: no trolleys and walkers": r"stiff lines know forces, masses, oscillators, vehicles",
        "overhead lines bear pantographs and foreign models": r"only pantographs run under overhead lines",
        "inextensible lines do not move": r"an inextensible line cannot move in time",
        "no free travel": r"loads travel as prescribed",
        "travel measured as material or horizontal only": r"travel is measured as material",
        "no load stays at the end of a stiff line": r"on stiff lines loads run over the line",
        "only vertical forces": r"on stiff lines forces are vertical|contacts press vertically",
        "no air drag of loads there": r"drag of the air (on loads )?is not known",
        "only clamped contacts in networks": r"loads are clamped to their place along the line",
        "masses on networks do not lift off": r"in webs masses stay in contact",
        "no lateral footsteps on nets": r"on nets feet press downwards only",
        "stiff lines and networks do not whirl": r"do not whirl|lie in the x-z plane",
        "results do not hold the slip over sheaves": r"how far lines have run over their sheaves",
        "stiff lines and networks move explicitly": r"(stiff lines and overhead lines|webs) move explicitly",
        "friction of prescribed travel on ropes alone": r"is looked at on ropes alone",
        "friction of prescribed travel only in slow motion": r"friction of a prescribed travel is for slow motion",
        "no linear theory of networks, nets, overhead lines": r"the linear theory does not know|linear does not know",
        "linear theory knows few loads with a mass": r"kind: linear knows",
        "no way to travel freely over a net": r"travel\.path: unknown key",
        "ropes, networks and nets do not move linearised": r"linearised motion is for lines with bending stiffness",
        "axial inertia of stiff lines only": r"axial_inertia: is for lines with bending stiffness",
        "sixth order for ropes under forces only": r"rkn6 is of sixth order without",
        "feedback on single ropes only":
            r"(overhead lines in motion|sheaves, nets and wind) are not known here",
        "no implicit method with masses": r"implicit cannot do a load with a mass",
        "linear theory: forces that enter at an end": r"constant force that enters at an end",
        "no linear theory to compare with": r"^no distances$",
        "no comparison with a full run that is doubtful": r"the full scenario is doubtful",
        "no export of networks and nets":
            r"joined lines and nets cannot be moved from outside|there is no such line or load",
        "no comparison on nets": r"compare knows lines, no nets and membranes",
        "linear theory: no vehicle that starts on the line":
            r"a vehicle that comes onto the line from before|is not reached with \d+ modes|run\.modes",
        "stiff lines beside other lines: some keys": r"beside stiff lines",
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
