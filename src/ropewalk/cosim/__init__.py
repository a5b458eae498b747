"""Co-simulation from outside: lines and vehicles of ropewalk moved step by step, and packed as FMUs for other tools."""

from ropewalk.cosim.export import export
from ropewalk.cosim.master import FmuPart, Link, Master, RidePart
from ropewalk.cosim.outside import Outside, Sight, Stepwise
from ropewalk.cosim.stepwise import stepwise
from ropewalk.cosim.vehicle import Ride, alone

__all__ = [
    "FmuPart",
    "Link",
    "Master",
    "Outside",
    "Ride",
    "RidePart",
    "Sight",
    "Stepwise",
    "alone",
    "export",
    "stepwise",
]
