"""Ropes between two anchors: `catenary`, alone, and `span`, with a load."""

from __future__ import annotations

from math import hypot

from ropewalk.calc.answer import CalcValue
from ropewalk.calc.calculator import Calculator, Rule
from ropewalk.calc.common import AXIAL_STIFFNESS, GRAVITY, LENGTH, ROPE_MASS, SPAN, angle, depth, force, height
from ropewalk.calc.hanging import Hanging, fall, hang


def bare(
    span: float, height: float, length: float, mass: float, axial_stiffness: float, gravity: float
) -> Hanging:  # fmt: skip
    """The rope under its own weight."""
    return hang(span, height, length, mass * gravity, axial_stiffness, 0.5, 0.0)


def loaded(
    span: float, height: float, length: float, mass: float, axial_stiffness: float, gravity: float, load: float,
    place: float,
) -> Hanging:  # fmt: skip
    """The rope under its own weight and a load."""
    return hang(span, height, length, mass * gravity, axial_stiffness, place, load * gravity)


HEIGHT = height("of the second anchor above the first")
_ENDS: dict[str, Rule] = {
    "horizontal_tension": lambda rope: rope.start[0],
    "largest_tension": lambda rope: rope.largest_tension,
    "start_tension": lambda rope: hypot(*rope.start),
    "end_tension": lambda rope: hypot(*rope.end),
    "start_angle": lambda rope: fall(rope.start),
    "end_angle": lambda rope: -fall(rope.end),
}
"""What both tell of how the rope pulls at its anchors."""

catenary = Calculator(
    "catenary",
    "Rope or cable that hangs between two anchors under its own weight.",
    (SPAN, HEIGHT, LENGTH, ROPE_MASS, AXIAL_STIFFNESS, GRAVITY),
    (
        depth("sag", "largest depth below the straight line between the anchors"),
        force("horizontal_tension", "level part of the tension, the same everywhere"),
        force("largest_tension", "at the higher anchor"),
        force("start_tension", "at the first anchor"),
        force("end_tension", "at the second anchor"),
        angle("start_angle", "by which the rope falls from the first anchor"),
        angle("end_angle", "by which it falls from the second anchor"),
        force("weight", "of the whole rope"),
    ),
    {
        "rope": bare,
        "sag": lambda rope: rope.sag,
        **_ENDS,
        "weight": lambda length, mass, gravity: length * mass * gravity,
    },
)
"""Elastic or inextensible catenary (Irvine, Cable Structures)."""

span = Calculator(
    "span",
    "Rope between two anchors with one load clamped to it, as of a cable crane or a tyrolean traverse.",
    (
        SPAN, HEIGHT, LENGTH, ROPE_MASS, AXIAL_STIFFNESS,
        CalcValue("load", "kg", "mass of the load", search=(1e-3, 1e7), typical=100.0),
        CalcValue(
            "place", "dimensionless", "part of the rope's length behind the load", high=1.0, default=0.5, share=True,
            search=(1e-3, 1.0), typical=0.5,
        ),
        GRAVITY,
    ),
    (
        depth("sag", "largest depth below the straight line between the anchors"),
        depth("load_x", "level distance of the load from the first anchor"),
        depth("load_depth", "of the load below the first anchor"),
        force("horizontal_tension", "level part of the tension, the same everywhere"),
        force("largest_tension", "anywhere on the rope"),
        force("start_tension", "at the first anchor"),
        force("end_tension", "at the second anchor"),
        angle("start_angle", "by which the rope falls from the first anchor"),
        angle("end_angle", "by which it falls from the second anchor"),
        depth("bare_sag", "sag without the load, the rope being anchored at both ends"),
        force("bare_tension", "level part of the tension without the load, likewise"),
    ),
    {
        "bare": bare,
        "rope": loaded,
        "sag": lambda rope: rope.sag,
        "load_x": lambda rope: rope.place[0],
        "load_depth": lambda rope: -rope.place[1],
        **_ENDS,
        "bare_sag": lambda bare: bare.sag,
        "bare_tension": lambda bare: bare.start[0],
    },
)  # fmt: skip
"""Elastic catenary with a point load."""
