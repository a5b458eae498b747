"""Why runs are refused: every message is known here, and is of one of two kinds. Nothing else knows messages."""

from __future__ import annotations

import re
from dataclasses import dataclass

NO_SENSE, MISSING = "no physical sense", "not implemented yet"


@dataclass(frozen=True)
class Refusal:
    """A reason for which runs are refused."""

    kind: str
    reason: str  # short, for the table of capabilities
    pattern: str  # of the message


REFUSALS = (
    # What has no physical sense, or contradicts itself.
    Refusal(NO_SENSE, "a pantograph presses from below against an overhead line", r"a pantograph runs under an overhead"),
    Refusal(NO_SENSE, "the load would pass the end of its line", r"the load passes the (start|end) of"),
    Refusal(NO_SENSE, "the load would pass the end of its line", r"would start (before|beyond) the (start|end) of"),
    Refusal(NO_SENSE, "no load moves", r"no load moves along a path|a load that stands still has no path"),
    Refusal(NO_SENSE, "a mass that follows the arc length is unstable", r"a mass that follows the arc length is unstable"),
    Refusal(NO_SENSE, "x means nothing on a line that runs along y, too", r"horizontal means along x, and the ends of"),
    Refusal(NO_SENSE, "x means nothing on a line that runs along y, too", r"holds such a contact acts along x, and the ends"),
    Refusal(NO_SENSE, "two stiffnesses say nothing of the third direction", r"two values say nothing of the direction y"),
    Refusal(NO_SENSE, "without gravity nothing decides how a slack line hangs", r"without gravity the rest shape of a line longer"),
    Refusal(NO_SENSE, "an overhead line hangs by its weight", r"an overhead line hangs by its weight"),
    Refusal(NO_SENSE, "the mode has no part across the line", r"the direction has no part across"),
    Refusal(NO_SENSE, "the key belongs to the other geometry", r"goes with (non)?linear(ised)? geometry only"),
    Refusal(NO_SENSE, "a slack rope has no transverse modes about its chord", r"deflected so far it would be pushed together"),
    Refusal(NO_SENSE, "a given force is no vehicle", r"of kind force is only a force; what can be exported"),
    # What would have sense, and is not there yet.
    Refusal(MISSING, "loads on networks, nets and in wind: forces, masses, footsteps", r"joined lines and nets know forces, masses"),
    Refusal(MISSING, "loads on stiff lines: no trolleys and walkers", r"stiff lines know forces, masses, oscillators, vehicles"),
    Refusal(MISSING, "overhead lines bear pantographs and foreign models", r"only pantographs run under overhead lines"),
    Refusal(MISSING, "inextensible lines do not move", r"an inextensible line cannot move in time"),
    Refusal(MISSING, "no free travel", r"loads travel as prescribed"),
    Refusal(MISSING, "travel measured as material or horizontal only", r"travel is measured as material"),
    Refusal(MISSING, "no load stays at the end of a stiff line", r"on stiff lines loads run over the line"),
    Refusal(MISSING, "only vertical forces on stiff lines", r"on stiff lines forces are vertical|contacts press vertically"),
    Refusal(MISSING, "no air drag of loads there", r"drag of the air (on loads )?is not known"),
    Refusal(MISSING, "supports of stiff lines: fixed, clamped, counterweight", r"fixed ends, clamped or not, and ends guided along x"),
    Refusal(MISSING, "no moving supports in networks", r"supports do not move as prescribed"),
    Refusal(MISSING, "only clamped contacts in networks", r"loads are clamped to their place along the line"),
    Refusal(MISSING, "masses on networks do not lift off", r"in webs masses stay in contact"),
    Refusal(MISSING, "no lateral footsteps on nets", r"on nets feet press downwards only"),
    Refusal(MISSING, "loads in slow motion and at rest: forces", r"kind: (quasistatic|equilibrium) knows forces only"),
    Refusal(MISSING, "no slow motion of stiff and overhead lines", r"stiff lines and overhead lines do not know slow motion"),
    Refusal(MISSING, "no rest of stiff lines with loads", r"the rest of stiff lines is known without loads only"),
    Refusal(MISSING, "stiff lines start at rest, without loads", r"stiff lines and overhead lines start at rest"),
    Refusal(MISSING, "networks start at rest", r"webs start at rest"),
    Refusal(MISSING, "stiff lines and networks move explicitly", r"stiff lines and overhead lines move explicitly|webs move explicitly"),
    Refusal(MISSING, "friction of prescribed travel only in slow motion", r"friction of a prescribed travel is for slow motion"),
    Refusal(MISSING, "no linear theory of networks, nets, overhead lines", r"the linear theory does not know|linear does not know"),
    Refusal(MISSING, "linear theory knows few loads with a mass", r"kind: linear knows"),
    Refusal(MISSING, "networks keep the positions asked for", r"webs keep the positions asked for, no others"),
    Refusal(MISSING, "overhead lines and pantographs only in motion", r"kind: \w+ does not know (pantographs|overhead)"),
    Refusal(MISSING, "output intervals of stiff lines need a common part", r"stiff lines need intervals with a common part"),
    Refusal(MISSING, "no way to travel freely over a net", r"travel\.path: unknown key"),
    Refusal(MISSING, "no spectrum of stiff and overhead lines", r"the spectrum knows lines without bending stiffness"),
    Refusal(MISSING, "no spectrum with masses on the line", r"the spectrum with loads in their places knows forces only"),
    Refusal(MISSING, "no spectrum of networks in motion", r"the spectrum of joined lines and nets is known at rest only"),
    Refusal(MISSING, "no spectrum with supports that yield", r"the spectrum knows only fixed"),
    Refusal(MISSING, "feedback on single ropes only", r"stiff lines and overhead lines in motion are not known here"),
    Refusal(MISSING, "no implicit method with masses", r"implicit cannot do a load with a mass"),
    Refusal(MISSING, "linear theory: forces that enter at an end", r"constant force that enters at an end"),
    Refusal(MISSING, "linear theory: fixed supports", r"linear knows only fixed|kind: linear knows"),
    Refusal(MISSING, "no linear theory to compare with", r"^no distances$"),
    Refusal(MISSING, "feedback on single ropes only", r"joined lines, sheaves, nets and wind are not known here"),
    Refusal(MISSING, "no export of networks and nets", r"joined lines and nets cannot be moved from outside|there is no such line or load"),
    Refusal(MISSING, "no comparison on nets", r"compare knows lines, no nets and membranes"),
    Refusal(MISSING, "linear theory: no vehicle that starts on the line", r"a vehicle that comes onto the line from before its start"),
    Refusal(MISSING, "stiff lines beside other lines: some keys", r"beside stiff lines"),
)  # fmt: skip


def refusals_in(note: str) -> list[Refusal | None]:
    """What each line of the messages is; None: it is known to nobody."""
    return [next((r for r in REFUSALS if re.search(r.pattern, line)), None) for line in note.splitlines()]
