"""What is there: frozen declarations without numerics, in SI units (text with units is read at the edge)."""

from ropewalk.model.history import ForceTable, SpeedTable
from ropewalk.model.law import Hooke, Law, Polynomial, SecondPiolaKirchhoff, Tabulated, TensionOnly
from ropewalk.model.line import Line
from ropewalk.model.load import Load, MovingForce
from ropewalk.model.run import Dynamic, Equilibrium, Quasistatic, Run, Start
from ropewalk.model.scenario import Scenario
from ropewalk.model.travel import Travel

__all__ = [
    "Dynamic",
    "Equilibrium",
    "ForceTable",
    "Hooke",
    "Law",
    "Line",
    "Load",
    "MovingForce",
    "Polynomial",
    "Quasistatic",
    "Run",
    "Scenario",
    "SecondPiolaKirchhoff",
    "SpeedTable",
    "Start",
    "Tabulated",
    "TensionOnly",
    "Travel",
]
