"""Is the simpler model good enough here? A scenario climbs the ladder from the linear theory to full feedback."""

from ropewalk.compare.climbing import distances, ladder
from ropewalk.compare.quantities import QUANTITIES
from ropewalk.compare.result import Ladder
from ropewalk.compare.rungs import RUNGS

__all__ = ["QUANTITIES", "RUNGS", "Ladder", "distances", "ladder"]
