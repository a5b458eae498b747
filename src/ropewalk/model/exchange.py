"""Exchange: how a line and an external model take turns."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import Count, Factor, Stiffness, Viscosity

Scheme = Literal["sequential", "parallel", "iterated"]


class Exchange(Declaration):
    """The way in which forces and motions are handed over, once in every interval of an external model.

    - sequential: the line goes ahead with forces extrapolated from what they were, then the model follows its motion.
    - parallel: both go ahead at once, the model with the motion of the line extrapolated.
    - iterated: both repeat the interval until they agree on the forces at its end; the model must be able to go back.

    A spring and a damper of the interface act at every step of the line between it and the place where the model's
    contact has got to. A model that gives its motion needs them; one that gives a force is kept stable by the damper:
    it acts on what the line's speed has come to differ from what was foreseen, and vanishes with the interval.
    """

    scheme: Scheme = Field(default="sequential", description="order of line and model, and whether they iterate")
    order: Annotated[int, Count(0, 2)] | None = Field(
        default=None,
        description="of the extrapolation of forces (and of motions, parallel): 0 holds the last value; iterated: 0 "
        "holds the next one over the interval, which damps, 1 interpolates linearly (default: 0; iterated: 1)",
    )
    stiffness: Stiffness = Field(default=0.0, description="of a spring between both, for models that give motion")
    damping: Viscosity = Field(default=0.0, description="of the damper between the line and the model")
    tolerance: Factor = Field(default=1e-8, description="iterated: change of the forces, as a part of them, to stop at")
    iterations: Annotated[int, Count(1, 1000)] = Field(default=30, description="iterated: the most in one interval")
    warn: Factor = Field(
        default=0.01, description="limit of the energy error over the exchanged work, above which a warning is printed"
    )

    @model_validator(mode="after")
    def _iterates(self) -> Self:
        findings = []
        for key in ("tolerance", "iterations"):
            value = getattr(self, key)
            if self.scheme != "iterated" and value != type(self).model_fields[key].default:
                remedy = f"leave {key} out, or write scheme: iterated"
                findings.append(Finding((key,), "is for scheme: iterated only", f"{value:g}", remedy))
        report("exchange", findings)
        return self

    @property
    def degree(self) -> int:
        """The order as given, or its default."""
        if self.order is not None:
            return self.order
        return 1 if self.scheme == "iterated" else 0
