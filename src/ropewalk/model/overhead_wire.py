"""Wires of overhead lines: contact wire, messenger, stitch wires."""

from __future__ import annotations

from pydantic import Field

from ropewalk.model._base import Declaration
from ropewalk.model.quantity import (
    BendingStiffness,
    Mass,
    MassPerLength,
    PositiveForce,
    PositiveLength,
    Rate,
    Retardation,
)


class OverheadWire(Declaration):
    """A wire of an overhead line, at constant tension at rest."""

    mass: MassPerLength = Field(description="per length")
    tension: PositiveForce = Field(description="along the line, in equilibrium")
    bending_stiffness: BendingStiffness = Field(default=0.0, description="EI")
    axial_stiffness: PositiveForce = Field(default=17e6, description="EA; not used by linearised motion")
    drag: Rate = Field(default=0.0, description="alpha of Rayleigh damping: force -drag * mass * velocity")
    retardation: Retardation = Field(default=0.0, description="beta of Rayleigh damping, in proportion to stiffness")


class ContactWire(OverheadWire):
    """The wire that pantographs touch; an omitted value is that of the EN 50318 reference models."""

    mass: MassPerLength = Field(default=1.35, description="per length")
    tension: PositiveForce = Field(default=20e3, description="along the line, in equilibrium")
    bending_stiffness: BendingStiffness = Field(default=195.0, description="EI")


class MessengerWire(OverheadWire):
    """The wire that carries the contact wire; an omitted value is that of the EN 50318:2002 reference model."""

    mass: MassPerLength = Field(default=1.07, description="per length")
    tension: PositiveForce = Field(default=16e3, description="along the line, in equilibrium")
    bending_stiffness: BendingStiffness = Field(default=131.7, description="EI")
    axial_stiffness: PositiveForce = Field(default=14e6, description="EA; not used by linearised motion")


class StitchWire(OverheadWire):
    """An auxiliary wire, clamped to the messenger on both sides of each support; droppers below it hang from it.

    Between its clamps the messenger has so much less tension as the stitch wire has, for both pull at each clamp.
    """

    length: PositiveLength = Field(default=14.0, description="from clamp to clamp, half on each side of a support")
    mass: MassPerLength = Field(default=0.31, description="per length")
    tension: PositiveForce = Field(default=2.5e3, description="along the line, in equilibrium")
    axial_stiffness: PositiveForce = Field(default=4e6, description="EA")
    clamp: Mass = Field(default=0.0, description="mass of each clamp on the messenger")
