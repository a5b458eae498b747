"""Co-simulation from outside: lines and vehicles of ropewalk moved step by step, and packed as FMUs for other tools."""

from typing import Any

from ropewalk.cosim.export import export
from ropewalk.cosim.outside import ContactOutput, Outside, Stepwise
from ropewalk.cosim.stepwise import stepwise
from ropewalk.cosim.vehicle import LoneVehicle, alone
from ropewalk.renamed import warn_renamed

__all__ = [
    "ContactOutput",
    "LoneVehicle",
    "Outside",
    "Stepwise",
    "alone",
    "export",
    "stepwise",
]

_RENAMED = {"Ride": "LoneVehicle", "Sight": "ContactOutput"}


def __getattr__(name: str) -> Any:
    if name not in _RENAMED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warn_renamed(name, _RENAMED[name])
    return globals()[_RENAMED[name]]
