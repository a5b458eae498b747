"""What is there: frozen declarations without numerics, in SI units (text with units is read at the edge)."""

from ropewalk.model.history import DisplacementTable, ForceTable, SpeedTable
from ropewalk.model.law import Hooke, Inextensible, Law, Polynomial, SecondPiolaKirchhoff, Tabulated, TensionOnly
from ropewalk.model.line import Line
from ropewalk.model.load import Load, MovingForce
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Quasistatic, Run, Start
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Elastic, Fixed, Guided, Moving, Support
from ropewalk.model.travel import Travel

__all__ = [
    "DisplacementTable",
    "Dynamic",
    "Elastic",
    "Equilibrium",
    "Fixed",
    "ForceTable",
    "Guided",
    "Hooke",
    "Inextensible",
    "Law",
    "Line",
    "Linear",
    "Load",
    "Moving",
    "MovingForce",
    "Polynomial",
    "Quasistatic",
    "Run",
    "Scenario",
    "SecondPiolaKirchhoff",
    "SpeedTable",
    "Start",
    "Support",
    "Tabulated",
    "TensionOnly",
    "Travel",
]
