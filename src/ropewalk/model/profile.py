"""Profiles: how high wheels run above a line."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import Count, Lengths

Spectrum = Literal[
    "ISO 8608 A",
    "ISO 8608 B",
    "ISO 8608 C",
    "ISO 8608 D",
    "ISO 8608 E",
    "ISO 8608 F",
    "ISO 8608 G",
    "ISO 8608 H",
    "FRA 1",
    "FRA 2",
    "FRA 3",
    "FRA 4",
    "FRA 5",
    "FRA 6",
    "German low",
    "German high",
]
"""Roads from very good to very poor, track of classes 1 (worst) to 6 of the USA, track of low and high disturbance."""


class Profile(Declaration):
    """The profile of a road or track on a line and before and behind it: camber, roughness, irregularities.

    Wheels of masses, oscillators, trolleys and vehicles follow it, feet of walkers stand on it, and user-defined models
    see the line with it; given forces do not feel it.
    """

    file: str | None = Field(
        default=None,
        description="name of a file with rows `x, z` in m: height of the surface above the line at x along it from "
        "its start; a natural cubic spline in between, level beyond; or give `spectrum`",
    )
    spectrum: Spectrum | None = Field(
        default=None, description="power spectral density that a profile is generated from; or give `file`"
    )
    seed: Annotated[int, Count(0, 2**31 - 1)] = Field(default=1, description="of the random phases of the waves")
    wavelengths: Lengths | None = Field(
        default=None,
        description="the shortest and the longest of the waves (default: 0.35 m and 90 m of roads, 1.524 m and 304.8 m "
        "of FRA, 3 m and 150 m of German track)",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        report("profile", self._contradictions())
        return self

    def _contradictions(self) -> Iterator[Finding]:
        if self.file is not None and self.spectrum is not None:
            remedy = "give a file (rows of x, z) or a spectrum, not both"
            yield Finding(("spectrum",), "file and spectrum exclude each other", self.spectrum, remedy)
        elif self.file is None and self.spectrum is None:
            yield Finding((), "the profile is not determined", remedy="add file or spectrum")
        elif self.file is not None:
            for key in ("seed", "wavelengths"):
                if (value := getattr(self, key)) != type(self).model_fields[key].default:
                    yield Finding((key,), "the profile is read from a file", str(value), f"leave {key} out")
        if self.wavelengths is not None and not (
            len(self.wavelengths) == 2 and self.wavelengths[0] < self.wavelengths[1]
        ):
            given = f"{list(self.wavelengths)} m"
            yield Finding(("wavelengths",), "is not a shorter and a longer one", given, "write [0.5 m, 50 m]")
