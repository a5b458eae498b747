"""What the system of cable runs, joints and bodies supports."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.capabilities import Capabilities, missing
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.parts import Parts
from ropewalk.model.vehicle import Vehicle

_LINES = "joined lines and lines in wind"


def _without(parts: Parts) -> Iterator[Finding]:
    """What other engines compute, which does not go together with this one."""
    for block, members in (("overhead_lines", parts.overhead), ("nets", parts.nets)):
        if members:
            yield missing((block,), _LINES, remedy="compute them in a scenario of their own")
    for name, line in parts.lines.items():
        if line is not None and line.sheaves:
            yield missing(("lines", name, "sheaves"), _LINES, remedy="leave them out")


def _soft_contacts(parts: Parts) -> Iterator[Finding]:
    for name, load in parts.loads.items():
        wheels = load.wheels.items() if isinstance(load, Vehicle) else ()
        soft = [("contact_stiffness",)] if isinstance(load, Oscillator) and load.contact_stiffness is not None else []
        soft += [("wheels", part, "contact_stiffness") for part, wheel in wheels if wheel.contact_stiffness is not None]
        for key in soft:
            yield missing(("loads", name, *key), _LINES, remedy="leave it out")


MOTION = Capabilities(
    _LINES,
    only={
        "run.kind": ("dynamic",),
        "run.method": ("auto", "explicit", "verlet"),
        "run.start.kind": ("rest",),
        "run.start.with_loads": (False,),
        "run.accuracy": (None,),
        "run.geometry": ("nonlinear",),
        "run.sample": (None,),
        "run.window": (None,),
        "run.axial_inertia": (1.0,),
        "lines.law.kind": ("hooke", "tension_only", "second_piola_kirchhoff", "polynomial", "table"),
        "loads.kind": ("force", "mass", "oscillator", "vehicle", "matrices"),
        "loads.travel.kind": ("prescribed",),
        "loads.travel.measured": ("material",),
        "loads.travel.at_end": ("leave", "refuse"),
        "loads.travel.margin": (None,),
        "loads.contact": ("clamped",),
        "loads.friction": (None,),
        "loads.friction_model": ("capstan",),
        "loads.lift_off": (False,),
        "loads.air_drag": (0.0,),
    },
    instead={
        "run.accuracy": "write step, or leave accuracy out",
        "run.sample": "write every, which is the interval of all output",
        "lines.law.kind": "give an axial_stiffness with law hooke",
        "loads.travel.kind": "give a speed",
    },
    more=(_without, _soft_contacts),
)
