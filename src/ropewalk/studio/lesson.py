"""The story of "Walking the line" in five steps, each a scenario with something to do."""

from __future__ import annotations

from typing import Any

_ROPE = """\
title: {title}
lines:
  rope:
    start: [0 m, 0 m]
    end: [{span} m, 0 m]
    {how}
    mass: {mass} kg/m
    axial_stiffness: 100 kN
    axial_damping: 50 N*s
    elements: 100
loads:
  walker:
    kind: force
    on: rope
    force: [0 N, -{force} N]
    travel: {{speed: 10 m/s, measured: slip, from: 6 m}}
run:
  kind: dynamic
  until: 1 s
  every: 10 ms
"""
_MOVING = """\
title: {title}
lines:
  string:
    start: [0 m, 0 m]
    end: [20 m, 0 m]
    tension: 2 kN
    mass: 1 kg/m
    axial_stiffness: 1 MN
    axial_damping: 20 N*s
    elements: 400
loads:
  walker:
    kind: {kind}
    on: string
    {what}
    travel: {{speed: 22 m/s, at_end: leave}}
run:
  kind: dynamic
  until: 0.88 s
  every: 2 ms
"""

LESSON: tuple[dict[str, Any], ...] = (
    {
        "title": "A taut string",
        "text": "Drag the load to the middle of the span, by the pointer in the picture or with the arrow keys. The "
        "string is taut, T = 8 kN over L = 20 m, and the force F = 200 N small, so the line and the dashed "
        "one of the linear theory lie on one another. By hand: F a (L - a) / (T L) at the place a, and the "
        "string's own sag. The numbers below follow the load; try it near a support, and with more weight "
        "(tab Values): where does the theory begin to fail?",
        "scenario": _ROPE.format(
            title="A taut string", span="20", how="tension: 8 kN", mass="0.5", force="200"
        ).replace("100 kN", "1 MN"),
        "do": "drag", "contact": "clamped",
        "expect": (
            ("load in the middle, below the supports", "0.153 m"),
            ("the same by the linear theory: 0.125 m + 0.031 m", "0.156 m"),
        ),
    },
    {
        "title": "A slack rope",
        "text": "The rope is 20 m long, half a metre more than its span. Drag the load of 800 N to the middle again:"
        " the rope goes where two straight pieces fit, near an ellipse around the supports. The linear "
        "theory is far off, for the tension at rest that it builds on is not the tension under the load. A "
        "hand calculation that fits is that of two catenaries: ropewalk calc span.",
        "scenario": _ROPE.format(title="A slack rope", span="19.5", how="length: 20 m", mass="1", force="800"),
        "do": "drag", "contact": "clamped",
        "expect": (
            ("load in the middle, below the supports", "2.852 m"),
            ("tension beside it", "1.586 kN"),
        ),
    },
    {
        "title": "The hold force",
        "text": "A load on a rope does not stay where it is by itself: without friction it slides to the lowest "
        "point. Drag it to x = 3 m and read the horizontal force that holds it there. Then open the tab "
        "Values, choose clamped in place of frictionless, and read how much friction the rope would need "
        "instead. Let go (in Values): it slides, and swings. Step 3 again brings it back.",
        "scenario": _ROPE.format(title="The hold force", span="19.5", how="length: 20 m", mass="1", force="800"),
        "do": "drag", "contact": "frictionless",
        "expect": (
            ("hold force at x = 3 m, frictionless; to the left: negative", "214.5 N"),
            ("friction needed there, clamped", "0.279"),
        ),
    },
    {
        "title": "Force against mass",
        "text": "Two runs over each other: a force of 98.1 N (faint), and a mass of 10 kg that weighs as much, both "
        "at half the speed of waves, shown ten times slower and five times deeper than they are. The mass "
        "feels what the string does under it: its contact force is not its weight, and the paths part. Play "
        "again, or drag the slider, and read the contact force.",
        "scenario": _MOVING.format(title="A mass of 10 kg", kind="mass", what="mass: 10 kg"),
        "beside": _MOVING.format(title="A force of 98.1 N", kind="force", what="force: [0 N, -98.1 N]"),
        "do": "run", "pace": 0.1, "larger": 5,
        "expect": (
            ("contact force just after it has come on: the string gives way", "1.22 N"),
            ("at two fifths of the way", "163 N"),
        ),
    },
    {
        "title": "The far support",
        "text": "The same mass. Its wave has run ahead to the far support and comes back: drag the slider to about "
        "0.56 s and step with the arrow keys. There the contact force leaps, a little before the 2 L / (c + "
        "v) = 0.600 s of the linear theory, for the mass has stretched the string. From then on waves go "
        "back and forth on an ever shorter way; peaks just before the support depend on the mesh.",
        "scenario": _MOVING.format(title="A mass comes to the support", kind="mass", what="mass: 10 kg"),
        "do": "run", "pace": 0.1, "larger": 5,
        "expect": (
            ("the wave is back at", "0.56 s"),
            ("contact force, up to", "307 N"),
        ),
    },
)  # fmt: skip
