"""The reference for splines: cubic Hermite elements, implicit, which share the plan with them and no more."""

from .motion import Record, State, StepInputs, run
from .rest import HermiteModel, Rest, elasticity, height, rest_of, tie_forces

__all__ = [
    "HermiteModel",
    "Record",
    "Rest",
    "State",
    "StepInputs",
    "elasticity",
    "height",
    "rest_of",
    "run",
    "tie_forces",
]
