"""What is there: frozen declarations without numerics, in SI units (text with units is read at the edge)."""

from ropewalk.model.axles import Axles, Coaches, TrainTravel
from ropewalk.model.balance import Balance
from ropewalk.model.carriage import Cabin, Carriage, CounterRope, DriveSheave, Haul
from ropewalk.model.condition import Condition
from ropewalk.model.crowd import Crowd
from ropewalk.model.cut import Cut
from ropewalk.model.damping import Damping
from ropewalk.model.exchange import Exchange
from ropewalk.model.fmu import Fmu, FmuContact, FmuTravel
from ropewalk.model.footsteps import Footsteps, Harmonic
from ropewalk.model.hangers import Hangers
from ropewalk.model.head import HeadRotation, PantographHead
from ropewalk.model.history import DisplacementTable, DriveTable, ForceTable, SpeedTable
from ropewalk.model.hysteresis import Hysteresis
from ropewalk.model.inner_support import InnerElastic, InnerFixed, InnerGuided, InnerMoving
from ropewalk.model.joint import Joined, Joint, Sheave
from ropewalk.model.law import (
    Hooke,
    Inextensible,
    Law,
    Polynomial,
    SecondPiolaKirchhoff,
    Tabulated,
    TensionOnly,
    Webbing,
)
from ropewalk.model.limits import Limits
from ropewalk.model.line import Line
from ropewalk.model.load import AnyLoad, Load, MovingForce, Travelling
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices, MatrixWheel
from ropewalk.model.net import AnyNet, CableEdge, ClampedEdge, Membrane, Net, SoftEdge
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.outputs import LinePlace, Outputs
from ropewalk.model.overhead import (
    Droppers,
    MessengerSupports,
    OverheadLine,
    SteadyArms,
)
from ropewalk.model.overhead_wire import ContactWire, MessengerWire, StitchWire
from ropewalk.model.pantograph import Pantograph, PantographTravel
from ropewalk.model.profile import Profile
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Quasistatic, Run, Start
from ropewalk.model.saddle import Saddle
from ropewalk.model.scenario import Scenario
from ropewalk.model.segment import Segment
from ropewalk.model.spans import Spans
from ropewalk.model.spread import FrequencySpread, LengthSpread, MassSpread
from ropewalk.model.stepper import Stepper
from ropewalk.model.support import Elastic, Fixed, Guided, Moving, Support, Winch
from ropewalk.model.sweep import Sweep
from ropewalk.model.track import Ballast, Pads, Sleepers, Subgrade, Track
from ropewalk.model.train import Train, TrainVehicle
from ropewalk.model.travel import AnyTravel, Brake, Driver, FreeTravel, Travel
from ropewalk.model.trolley import Payload, Trolley
from ropewalk.model.vehicle import RigidBody, Spring, Vehicle, Wheel
from ropewalk.model.walker import Walker
from ropewalk.model.wind import Wind

__all__ = [
    "AnyLoad",
    "AnyNet",
    "AnyTravel",
    "Axles",
    "Balance",
    "Ballast",
    "Brake",
    "Cabin",
    "CableEdge",
    "Carriage",
    "ClampedEdge",
    "Coaches",
    "Condition",
    "ContactWire",
    "CounterRope",
    "Crowd",
    "Cut",
    "Damping",
    "DisplacementTable",
    "DriveSheave",
    "DriveTable",
    "Driver",
    "Droppers",
    "Dynamic",
    "Elastic",
    "Equilibrium",
    "Exchange",
    "Fixed",
    "Fmu",
    "FmuContact",
    "FmuTravel",
    "Footsteps",
    "ForceTable",
    "FreeTravel",
    "FrequencySpread",
    "Guided",
    "Hangers",
    "Harmonic",
    "Haul",
    "HeadRotation",
    "Hooke",
    "Hysteresis",
    "Inextensible",
    "InnerElastic",
    "InnerFixed",
    "InnerGuided",
    "InnerMoving",
    "Joined",
    "Joint",
    "Law",
    "LengthSpread",
    "Limits",
    "Line",
    "LinePlace",
    "Linear",
    "Load",
    "MassSpread",
    "Matrices",
    "MatrixWheel",
    "Membrane",
    "MessengerSupports",
    "MessengerWire",
    "Moving",
    "MovingForce",
    "MovingMass",
    "Net",
    "Oscillator",
    "Outputs",
    "OverheadLine",
    "Pads",
    "Pantograph",
    "PantographHead",
    "PantographTravel",
    "Payload",
    "Polynomial",
    "Profile",
    "Quasistatic",
    "RigidBody",
    "Run",
    "Saddle",
    "Scenario",
    "SecondPiolaKirchhoff",
    "Segment",
    "Sheave",
    "Sleepers",
    "SoftEdge",
    "Spans",
    "SpeedTable",
    "Spring",
    "Start",
    "SteadyArms",
    "Stepper",
    "StitchWire",
    "Subgrade",
    "Support",
    "Sweep",
    "Tabulated",
    "TensionOnly",
    "Track",
    "Train",
    "TrainTravel",
    "TrainVehicle",
    "Travel",
    "Travelling",
    "Trolley",
    "Vehicle",
    "Walker",
    "Webbing",
    "Wheel",
    "Winch",
    "Wind",
]

DECLARATIONS = tuple(name for name in __all__ if isinstance(globals()[name], type))
"""Names of all that can be declared, public in `ropewalk`."""
