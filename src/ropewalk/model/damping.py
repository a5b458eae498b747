"""Damping of a line by the ratio of its modes, which Rayleigh's two constants give."""

from __future__ import annotations

import math
from typing import Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import Frequencies, Share


class Damping(Declaration):
    """A damping ratio of the modes of a line.

    With two frequencies it is Rayleigh damping that has the ratio there, less between and more beyond them. With one it
    is a drag: the ratio there, and half of it at twice the frequency.
    """

    ratio: Share = Field(description="of the damping of a mode to its critical one")
    at: Frequencies = Field(description="one or two natural frequencies in rising order at which the ratio holds")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if len(self.at) > 2 or any(not b > a for a, b in zip(self.at, self.at[1:], strict=False)):
            given = ", ".join(f"{f:g} Hz" for f in self.at)
            remedy = "write one frequency, or two in rising order"
            findings.append(Finding(("at",), "Rayleigh's two constants hold a ratio at two frequencies", given, remedy))
        if self.ratio >= 1.0:
            remedy = "write for example 1 %"
            findings.append(Finding(("ratio",), "no mode would swing", f"{self.ratio:g}", remedy))
        report("damping", findings)
        return self

    @property
    def alpha(self) -> float:
        """Rayleigh's constant in proportion to mass, 1/s: 2 zeta w1 w2 / (w1 + w2), or 2 zeta w1."""
        w = [2.0 * math.pi * f for f in self.at]
        return 2.0 * self.ratio * (w[0] if len(w) == 1 else w[0] * w[1] / (w[0] + w[1]))

    @property
    def beta(self) -> float:
        """Rayleigh's constant in proportion to stiffness, s: 2 zeta / (w1 + w2), or none."""
        w = [2.0 * math.pi * f for f in self.at]
        return 0.0 if len(w) == 1 else 2.0 * self.ratio / (w[0] + w[1])
