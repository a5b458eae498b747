"""Axial laws: tension as a function of strain."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, Variants, report
from ropewalk.model.quantity import Factor, TableForce, TableStrain


class Hooke(Declaration):
    """T = EA eps, in tension and in compression."""

    kind: Literal["hooke"] = "hooke"


class TensionOnly(Declaration):
    """T = EA eps where eps > 0, nothing where the link is slack."""

    kind: Literal["tension_only"] = "tension_only"


class SecondPiolaKirchhoff(Declaration):
    """T = EA eps (1 + eps): the paper's eqs. 6-7 to the letter, sigma the second Piola-Kirchhoff stress."""

    kind: Literal["second_piola_kirchhoff"] = "second_piola_kirchhoff"


class Polynomial(Declaration):
    """T = c1 eps + c2 eps^2 + c3 eps^3 + ..., with its own stiffness (no `axial_stiffness`)."""

    kind: Literal["polynomial"] = "polynomial"
    coefficients: tuple[TableForce, ...] = Field(min_length=1, max_length=8, description="c1, c2, ... up to c8")

    @model_validator(mode="after")
    def _pulls(self) -> Self:
        if self.coefficients[0] <= 0.0:
            wrong = "the first coefficient is the stiffness at strain 0 and must be positive"
            given, remedy = f"{self.coefficients[0]:g} N", "write EA first, for example 100 kN"
            report("polynomial", [Finding(("coefficients", 0), wrong, given, remedy)])
        return self


class Tabulated(Declaration):
    """T linear between points, continued with the end slopes, without `axial_stiffness`."""

    kind: Literal["table"] = "table"
    strain: tuple[TableStrain, ...] = Field(min_length=2, description="rising strains (0.01 or 1 %)")
    tension: tuple[TableForce, ...] = Field(min_length=2, description="tension at each strain, not falling")

    @model_validator(mode="after")
    def _rises(self) -> Self:
        findings = []
        if len(self.strain) != len(self.tension):
            wrong = f"{len(self.strain)} strains do not go with {len(self.tension)} tensions"
            findings.append(Finding((), wrong, remedy="give one tension for each strain"))
        for index, (a, b) in enumerate(pairwise(self.strain), start=1):
            if b <= a:
                given, remedy = f"{b:g} after {a:g}", "sort the entries by strain and give each strain once"
                findings.append(Finding(("strain", index), "the strains must rise", given, remedy))
                break
        for index, (a, b) in enumerate(pairwise(self.tension), start=1):
            if b < a:
                given, remedy = f"{b:g} N after {a:g} N", "a falling tension would make the line snap through"
                findings.append(Finding(("tension", index), "the tensions must not fall", given, remedy))
                break
        if not findings and not self.tension[-1] > self.tension[-2]:
            wrong, given = "the last two tensions must rise", f"{self.tension[-1]:g} N twice"
            remedy = "the law is continued with their slope: add a point or leave the last one out"
            findings.append(Finding(("tension", len(self.tension) - 1), wrong, given, remedy))
        report("table", findings)
        return self


WEBBINGS = {"pinkTube": 0.18, "halfMarathon": 0.04}
"""Stretch of webbings at 10 kN as slacktivity.com prints it on the page "Forces in Highlining"."""
REFERENCE_TENSION = 10e3  # N, tension at which riggers tell how far webbing stretches


class Webbing(Declaration):
    """T = 10 kN eps/stretch where eps > 0, as riggers specify it; without `axial_stiffness`.

    By `name`: pinkTube 18 %, halfMarathon 4 % (slacktivity.com, Forces in Highlining). Others by their `stretch`.
    """

    kind: Literal["webbing"] = "webbing"
    stretch: Factor | None = Field(default=None, description="strain at 10 kN (0.18 or 18 %)")
    name: Literal["pinkTube", "halfMarathon"] | None = Field(
        default=None, description="of a webbing on the market, instead of its stretch"
    )

    @model_validator(mode="after")
    def _known(self) -> Self:
        findings = []
        if self.stretch is None and self.name is None:
            remedy = f"add stretch, for example 18 %, or a name: {', '.join(WEBBINGS)}"
            findings.append(Finding((), "there is no stretch at 10 kN", remedy=remedy))
        if self.stretch is not None and self.name is not None:
            findings.append(Finding(("stretch",), "stretch and name exclude each other", remedy="give one of them"))
        report("webbing", findings)
        return self

    @property
    def axial_stiffness(self) -> float:
        """EA in N."""
        return REFERENCE_TENSION / (self.stretch if self.name is None else WEBBINGS[self.name])  # type: ignore[operator]


class Inextensible(Declaration):
    """eps = 0 wherever the line pulls: the tension is what keeps it so. Lines without bending stiffness."""

    kind: Literal["inextensible"] = "inextensible"


Law = Annotated[
    Hooke | TensionOnly | SecondPiolaKirchhoff | Polynomial | Tabulated | Webbing | Inextensible, Variants("law")
]
"""Any axial law."""

LAWS_WITH_OWN_STIFFNESS = (Polynomial, Tabulated, Webbing, Inextensible)
