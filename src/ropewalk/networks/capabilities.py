"""What the engine of joined lines, ropes on inner supports and lines in wind supports at rest."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.capabilities import Capabilities
from ropewalk.model.missing import missing
from ropewalk.model.parts import Parts

_NETWORKS = "joined lines, sheaves, ropes on inner supports and lines in wind, at rest or quasi-static"


def _beside_others(parts: Parts) -> Iterator[Finding]:
    if parts.overhead:
        yield missing(("overhead_lines",), _NETWORKS, remedy="compute them in a scenario of their own")


def _on_nets(parts: Parts) -> Iterator[Finding]:
    for name, load in parts.loads.items():
        if load is not None and load.on in parts.nets:
            yield missing(
                ("loads", name, "on"), _NETWORKS, load.on, "let it travel on a line", feature="a load on a net"
            )


AT_REST = Capabilities(
    _NETWORKS,
    only={
        "run.kind": ("quasistatic", "equilibrium"),
        "lines.law.kind": ("hooke", "tension_only", "second_piola_kirchhoff", "polynomial", "table", "webbing"),
        "lines.bending_stiffness": (0.0,),
        "lines.foundation": (0.0,),
        "loads.kind": ("force", "mass"),
        "loads.travel.kind": ("prescribed",),
        "loads.travel.measured": ("material",),
        "loads.travel.margin": (None,),
        "loads.contact": ("clamped",),
        "loads.friction": (None,),
        "loads.friction_model": ("capstan",),
        "loads.lift_off": (False,),
        "loads.air_drag": (0.0,),
    },
    instead={
        "lines.law.kind": "give an axial_stiffness with law hooke",
        "loads.travel.kind": "give a speed",
        "loads.kind": "ask for kind: dynamic, or write kind: force with its weight as force",
    },
    more=(_beside_others, _on_nets),
)
