"""What the engine of joined lines, sheaves, nets, membranes and lines in wind supports."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ropewalk.model._base import Finding
from ropewalk.model.capabilities import Capabilities, missing
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic

_NETWORKS = "joined lines, sheaves, nets, ropes on inner supports and lines in wind"


def _beside_others(parts: Parts) -> Iterator[Finding]:
    if parts.overhead:
        yield missing(("overhead_lines",), _NETWORKS, remedy="compute them in a scenario of their own")


def _over_sheaves(parts: Parts) -> Iterator[Finding]:
    """Results do not hold how far lines have run over their sheaves."""
    if parts.runs_over_sheaves and isinstance(parts.run, Dynamic) and parts.run.start.kind == "result":
        yield missing(("run", "start", "kind"), "lines over sheaves", "result", "start at rest, or from a mode")


def _on_nets(parts: Parts) -> Iterator[Finding]:
    for name, load in parts.loads.items():
        if load is not None and load.on in parts.nets:
            remedy = "compute the lines over sheaves in a scenario of their own"
            feature, path = "a load on a net", ("loads", name, "on")
            yield missing(path, "nets beside lines over sheaves", load.on, remedy, feature=feature)


MOTION = Capabilities(
    _NETWORKS,
    only={
        "run.kind": ("dynamic", "quasistatic", "equilibrium"),
        "run.method": ("auto", "explicit", "verlet"),
        "run.start.whirl": (False,),
        "run.accuracy": (None,),
        "run.geometry": ("nonlinear",),
        "run.sample": (None,),
        "run.axial_inertia": (1.0,),
        "lines.law.kind": ("hooke", "tension_only", "second_piola_kirchhoff", "polynomial", "table"),
        "lines.bending_stiffness": (0.0,),
        "lines.foundation": (0.0,),
        "loads.kind": ("force", "mass", "footsteps"),
        "loads.travel.kind": ("prescribed",),
        "loads.travel.measured": ("material",),
        "loads.contact": ("clamped",),
        "loads.friction": (None,),
        "loads.friction_model": ("capstan",),
        "loads.lift_off": (False,),
        "loads.air_drag": (0.0,),
    },
    instead={
        "run.start.whirl": "leave it out, or compute one line by itself",
        "run.accuracy": "write step, or leave accuracy out",
        "run.sample": "write every, which is the interval of all output",
        "lines.law.kind": "give an axial_stiffness with law hooke",
        "loads.travel.kind": "give a speed",
    },
    more=(_beside_others, _over_sheaves, _on_nets),
)
AT_REST = replace(
    MOTION,
    what=f"{_NETWORKS}, at rest or in slow motion",
    only={**MOTION.only, "loads.kind": ("force", "mass"), "loads.travel.margin": (None,)},
    instead={**MOTION.instead, "loads.kind": "ask for kind: dynamic, or write kind: force with its weight as force"},
)
