"""Heads of pantographs as rigid bodies: with strips one behind the other, that pitch and roll."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import PositiveInertia, PositiveLength


class HeadRotation(Declaration):
    """A rotation of a head, against the spring below it, which stands in equal halves at two places.

    With their distance d, the stiffness k of the spring is k d^2 / 4 in N*m per rad, and so is its damping.
    """

    inertia: PositiveInertia = Field(description="moment of inertia of the head about its centre")
    spring_spacing: PositiveLength = Field(description="distance between the two halves of the spring below the head")


class PantographHead(Declaration):
    """The head as a rigid body, whose mass is the last of the masses, on the last of the springs.

    Each strip presses on the contact wire through a `contact_stiffness` of its own. The strips are one behind the other
    along the track, and so long that the wire stays on them; where it runs aside of the middle it presses there.
    """

    strips: Literal[1, 2] = Field(default=2, description="number of collector strips")
    spacing: PositiveLength | None = Field(default=None, description="distance between two strips along the track")
    pitch: HeadRotation | None = Field(
        default=None,
        description="rotation about the axis across the track, one strip up and the other one down; its springs stand "
        "one behind the other (default: it does not pitch)",
    )
    roll: HeadRotation | None = Field(
        default=None,
        description="rotation about the axis along the track, which a wire with stagger causes; its springs stand side "
        "by side, at the horns (default: it does not roll)",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if self.strips == 2 and self.spacing is None:
            findings.append(Finding(("spacing",), "is required with two strips", remedy="add it, such as 540 mm"))
        if self.strips == 1:
            alone = "one strip is in the middle of the head"
            if self.spacing is not None:
                findings.append(Finding(("spacing",), alone, f"{self.spacing:g} m", "write strips: 2, or leave it out"))
            if self.pitch is not None:
                wrong = f"{alone}, and has no pitching moment"
                findings.append(Finding(("pitch",), wrong, remedy="write strips: 2, or leave it out"))
            if self.roll is None and not findings:
                wrong, remedy = "one strip that does not roll is a point", "leave head out, or add roll or strips: 2"
                findings.append(Finding(("strips",), wrong, "1", remedy))
        report("head", findings)
        return self

    @property
    def ends(self) -> dict[str, float]:
        """Distance of the two places that a rotation moves up and down, m: of strips, of the springs at the horns."""
        ends = dict[str, float]()
        if self.pitch is not None and self.spacing is not None:
            ends["pitch"] = self.spacing
        if self.roll is not None:
            ends["roll"] = self.roll.spring_spacing
        return ends
