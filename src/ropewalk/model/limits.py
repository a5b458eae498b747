"""Limits of current collection that an overhead line is judged by."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import PositiveForce, PositiveLength

System = Literal["ac", "dc_3kv", "dc_1.5kv"]


class Limits(Declaration):
    """Limits of EN 50367, EN 50119 and the TSI Energy, compared with the statistics of each pantograph.

    They change nothing of a run. Their numbers were recalled, and not checked against the text of the standards.
    """

    system: System = Field(description="kind of current, which decides about mean force, largest force and arcing")
    uplift_space: PositiveLength | None = Field(
        default=None,
        description="space for the uplift of the contact wire at the supports before it, or its arm, collides",
    )
    uplift_limited: bool = Field(
        default=False,
        description="whether the design of the line limits the uplift there: 1.5 times the computed uplift must have "
        "space then, instead of twice",
    )
    maximum_force: PositiveForce | None = Field(
        default=None, description="largest contact force (default: that of EN 50119 for the system and the speed)"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if self.uplift_limited and self.uplift_space is None:
            wrong, remedy = "the uplift has no limit to compare with", "add uplift_space, for example 120 mm"
            findings.append(Finding(("uplift_limited",), wrong, "true", remedy))
        report("limits", findings)
        return self
