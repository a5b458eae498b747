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
  every: 5 ms
"""

LESSON: tuple[dict[str, Any], ...] = (
    {
        "title": "A taut string",
        "text": "Drag the load. The string is taut (8 kN) and the force small, so the line that you see and the dashed "
        "line of the linear theory lie on one another: the deflection is F a (L - a) / (T L). This is the world in "
        "which moving loads have been computed for a century.",
        "scenario": _ROPE.format(
            title="A taut string", span="20", how="tension: 8 kN", mass="0.5", force="200"
        ).replace("100 kN", "1 MN"),
        "do": "drag", "contact": "clamped",
    },
    {
        "title": "A slack rope",
        "text": "Now the rope is half a metre longer than its span. Drag the load again: the rope goes where two "
        "straight pieces fit, near an ellipse around the supports, and the linear theory is far off, for the tension "
        "at rest that it builds on is not the tension under the load.",
        "scenario": _ROPE.format(title="A slack rope", span="19.5", how="length: 20 m", mass="1", force="800"),
        "do": "drag", "contact": "clamped",
    },
    {
        "title": "The hold force",
        "text": "A load on a rope does not stay where it is by itself: without friction it slides to the lowest point. "
        "Drag it towards a support and watch the horizontal hold force that keeps it there, then change the contact to "
        "clamped and read how much friction the rope would need instead. Let go, and it swings.",
        "scenario": _ROPE.format(title="The hold force", span="19.5", how="length: 20 m", mass="1", force="800"),
        "do": "drag", "contact": "frictionless",
    },
    {
        "title": "Force against mass",
        "text": "Two runs over each other: a force of 98.1 N (faint), and a mass of 10 kg that weighs as much, both at "
        "half the speed of waves. The mass feels what the string does under it: its contact force is not its weight, "
        "and the paths part.",
        "scenario": _MOVING.format(title="A mass of 10 kg", kind="mass", what="mass: 10 kg"),
        "beside": _MOVING.format(title="A force of 98.1 N", kind="force", what="force: [0 N, -98.1 N]"),
        "do": "run",
    },
    {
        "title": "The far support",
        "text": "The mass again, and this time look at its contact force (below) as it comes to the far support: it "
        "grows steeply, for the mass has to rise to the support within an ever shorter way. Scrub through the last "
        "moments, and compare with the constant force of the step before.",
        "scenario": _MOVING.format(title="A mass comes to the support", kind="mass", what="mass: 10 kg").replace(
            "every: 5 ms", "every: 2 ms"
        ),
        "do": "run",
    },
)  # fmt: skip
