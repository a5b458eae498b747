"""Runs: the question asked of a structure."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ropewalk.model._base import Declaration
from ropewalk.units import Length, Time

Method = Literal["auto", "explicit", "verlet", "rkn6", "implicit"]


class Start(Declaration):
    """The state at the beginning of a motion: rest under gravity (with or without the loads) or a stored result."""

    kind: Literal["rest", "result"] = "rest"
    with_loads: bool = Field(default=False, description="rest: let the loads rest on the line at their start, too")
    file: str | None = Field(default=None, description="result: a NetCDF file written by an earlier run")
    time: Time | None = Field(default=None, description="result: the instant to start from (default: the last)")


class Dynamic(Declaration):
    """Motion in time."""

    kind: Literal["dynamic"] = "dynamic"
    until: Time = Field(gt=0.0, description="end of the run")
    every: Time | None = Field(default=None, gt=0.0, description="interval of output (default: until / 100)")
    method: Method = Field(default="auto", description="auto reads the spectrum and says what it chose")
    step: Time | None = Field(default=None, gt=0.0, description="largest time step (default: from accuracy)")
    accuracy: Length = Field(default=1e-3, gt=0.0, description="wanted accuracy in time of the positions")
    start: Start = Field(default=Start())


class Quasistatic(Declaration):
    """Slow motion: the rest shape for positions of the loads at equal steps of their path."""

    kind: Literal["quasistatic"] = "quasistatic"
    positions: int = Field(default=201, ge=2, le=1_000_000)


class Equilibrium(Declaration):
    """The rest shape under gravity and the loads at their start."""

    kind: Literal["equilibrium"] = "equilibrium"


Run = Annotated[Dynamic | Quasistatic | Equilibrium, Field(discriminator="kind")]
"""Any run."""
