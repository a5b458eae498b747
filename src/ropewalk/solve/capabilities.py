"""What the engine of plain ropes supports."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.capabilities import LAWS_OF_STRAIN, WITHOUT_KIND, Capabilities, without_retardation
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.load import ExternalModel, MovingForce
from ropewalk.model.missing import missing
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic
from ropewalk.model.support import Elastic, Guided, Support, stands_still

_ROPES = "the motion of ropes"


def _methods(parts: Parts) -> Iterator[Finding]:
    """Methods that rest on what loads, supports or damping take away from them."""
    if not isinstance(parts.run, Dynamic):
        return
    check = {"implicit": _not_implicit, "rkn6": _not_of_sixth_order}.get(parts.run.method)
    if check is not None and (found := next(check(parts), None)) is not None:
        feature, otherwise = found
        given, remedy = parts.run.method, f"use auto or verlet, or {otherwise}"
        yield missing(("run", "method"), _ROPES, given, remedy, feature=f"{given} with {feature}")


def _supports(parts: Parts) -> list[Support]:
    return [support for line in parts.lines.values() if line is not None for _, support in line.ends()]


def _not_implicit(parts: Parts) -> Iterator[tuple[str, str]]:
    for load in parts.loads.values():
        if isinstance(load, Footsteps | ExternalModel):
            yield "a load with a controller", "kind: force"
        elif load is not None and not isinstance(load, MovingForce):
            yield "a load with a mass", "kind: force"
        elif load is not None and load.contact == "frictionless":
            yield "a frictionless contact", "contact: clamped"
    if not all(map(stands_still, _supports(parts))):
        yield "a support that yields or moves", "fixed supports"


def _not_of_sixth_order(parts: Parts) -> Iterator[tuple[str, str]]:
    if any(line is not None and line.axial_damping for line in parts.lines.values()):
        yield "Kelvin-Voigt damping", "leave axial_damping out"
    if any(support.damping not in (0.0, (0.0, 0.0), (0.0, 0.0, 0.0)) for support in _supports(parts)
           if isinstance(support, Elastic | Guided)):  # fmt: skip
        yield "dampers at supports", "leave their damping out"
    for load in parts.loads.values():
        weightless = isinstance(load, MovingForce | Footsteps) or (
            isinstance(load, ExternalModel) and not (load.exchange.stiffness or load.exchange.damping)
        )
        if load is not None and not weightless:
            yield "moving masses", "kind: force"


def margin_without_mass(load: str, margin: float) -> Finding:
    """A margin for a contact that has no mass of its own beside loads that have one; some borrow of the mesh."""
    feature, path = "a margin for a contact without mass", ("loads", load, "travel", "margin")
    return missing(path, _ROPES, f"{margin:g} m", "leave margin out", feature=feature)


MOTION = Capabilities(
    _ROPES,
    only={
        "run.geometry": ("nonlinear",),
        "run.sample": (None,),
        "run.axial_inertia": (1.0,),
        "lines.law.kind": LAWS_OF_STRAIN,
        "loads.contact": ("clamped", "frictionless"),
    },
    instead={
        "run.sample": "write every, which is the interval of all output",
        "lines.law.kind": "ask for kind: quasistatic or equilibrium, or give an axial_stiffness with law hooke",
        "loads.contact": "ask for kind: quasistatic, or write clamped or frictionless",
    },
    more=(_methods, without_retardation(_ROPES, "use axial_damping, or one frequency")),
)
AT_REST = Capabilities(
    "equilibria and quasi-static runs of ropes",
    only={
        "loads.kind": ("force", "mass", "oscillator", "trolley", "vehicle", "train", "matrices"),
        "loads.travel.margin": (None,),
    },
    instead={"loads.kind": WITHOUT_KIND},
)
