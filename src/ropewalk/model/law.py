"""Axial laws: tension as a function of strain."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration
from ropewalk.units import Force, Strain


class Hooke(Declaration):
    """T = EA eps, in tension and in compression."""

    kind: Literal["hooke"] = "hooke"


class TensionOnly(Declaration):
    """T = EA eps where eps > 0, nothing where the link is slack."""

    kind: Literal["tension_only"] = "tension_only"


class SecondPiolaKirchhoff(Declaration):
    """T = EA eps (1 + eps): the paper's eqs. 6-7 taken to the letter (sigma is the second Piola-Kirchhoff stress)."""

    kind: Literal["second_piola_kirchhoff"] = "second_piola_kirchhoff"


class Polynomial(Declaration):
    """T = c1 eps + c2 eps^2 + c3 eps^3 + ..., with an own stiffness (no `axial_stiffness` beside it)."""

    kind: Literal["polynomial"] = "polynomial"
    coefficients: tuple[Force, ...] = Field(min_length=1, max_length=8, description="c1, c2, ... in N")

    @model_validator(mode="after")
    def _pulls(self) -> Self:
        if self.coefficients[0] <= 0.0:
            raise ValueError("the first coefficient is the stiffness at rest and must be positive")
        return self


class Tabulated(Declaration):
    """Tension interpolated linearly between measured points, continued with the end slopes."""

    kind: Literal["table"] = "table"
    strain: tuple[Strain, ...] = Field(min_length=2)
    tension: tuple[Force, ...] = Field(min_length=2)

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if len(self.strain) != len(self.tension):
            raise ValueError(f"{len(self.strain)} strains but {len(self.tension)} tensions: give one for each")
        if any(b <= a for a, b in pairwise(self.strain)):
            raise ValueError("the strains must rise from entry to entry")
        if any(b < a for a, b in pairwise(self.tension)):
            raise ValueError("the tensions must not fall from entry to entry (the rope would snap through)")
        if not self.tension[-1] > self.tension[-2]:
            raise ValueError("the last two tensions must rise: the law is continued with their slope")
        return self


Law = Annotated[
    Hooke | TensionOnly | SecondPiolaKirchhoff | Polynomial | Tabulated, Field(discriminator="kind")
]
"""Any axial law."""

LAWS_WITH_OWN_STIFFNESS = (Polynomial, Tabulated)
