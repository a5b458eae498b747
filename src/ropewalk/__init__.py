"""ropewalk: what travels along slender flexible structures.

A scenario says what is there and what is asked; `simulate` answers with a labelled dataset:

    import ropewalk
    scenario = ropewalk.load("examples/moving-force.yaml")
    result = ropewalk.simulate(scenario)

==============  ======================================================================================
what is there   `Scenario` of `Line`s and of loads; `ForceTable`, `SpeedTable`, `DriveTable` and
                `DisplacementTable` for what changes in time
loads           `MovingForce`, `MovingMass`, `Oscillator`, `Trolley` with its `Payload`; `Vehicle` of
                `RigidBody`, `Wheel` and `Spring`, or of `Matrices` with `MatrixWheel`; `Footsteps` with
                `Harmonic`s, `Walker` with her `Balance`; `Stepper` for a model of one's own, `Fmu` with
                `FmuContact`s and `FmuTravel` for one of another program; their `Exchange` with the line
overhead lines  `OverheadLine` of `ContactWire`, `MessengerWire`, `StitchWire`, `Droppers`, `SteadyArms`,
                `MessengerSupports` and `Spans`; `Pantograph` with its `PantographTravel`
travel          `Travel` as prescribed, `FreeTravel` with `Driver` and `Brake`
axial laws      `Hooke`, `TensionOnly`, `SecondPiolaKirchhoff`, `Polynomial`, `Tabulated`, `Inextensible`
supports        `Fixed`, `Elastic`, `Guided`, `Moving`; `Joined` to a `Joint`, a line or a net; `Sheave`s on the way;
                between the ends `InnerFixed`, `InnerElastic`, `InnerGuided`, `InnerMoving`
nets            `Net` and `Membrane` with a `ClampedEdge`, a `SoftEdge` or a `CableEdge`; `Wind`
what is asked   `Dynamic` (from a `Start`), `Quasistatic`, `Equilibrium`, `Linear`
files           `load` and `save` a scenario, `open_result`; `export_fmu` writes a line or a vehicle as an FMU
answers         `simulate`, `resume`, `spectrum`; `feedback` gives a `Comparison` with a run `without_feedback`,
                `model_hierarchy` a `ModelHierarchy` of simpler models, `adequacy` an `AdequacyMap` over two `Axis`es;
                `summary`, `tables`, `figure` and `film` of a result, paths of contacts `extrapolated` from two meshes;
                `contact_statistics` and `html_report` of overhead lines
many runs       `sweep` gives one dataset over what varies (`Sweep`), `sweep_figure` and `sweep_table` are of it
closed forms    `theory`: what the simulation is checked against
errors          `RopewalkError`, and of its kind `ScenarioError`, `EquilibriumError`, `ResultError`
==============  ======================================================================================

Below these names the package is a house whose imports run downwards only (docs/overview.md): `scenario`, `simulate`,
`results`, `solve`, `mechanics`, `theory`, `model`. Everything is imported when it is first used.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from ropewalk import hooks

if TYPE_CHECKING:
    from ropewalk import theory
    from ropewalk.compare import ModelHierarchy, model_hierarchy
    from ropewalk.compare.adequacy import AdequacyMap, adequacy
    from ropewalk.compare.axes import Axis
    from ropewalk.cosim.export import export as export_fmu
    from ropewalk.coupling import Comparison, feedback
    from ropewalk.decouple import without_feedback
    from ropewalk.errors import EquilibriumError, RopewalkError, ScenarioError
    from ropewalk.model import (
        Balance,
        Brake,
        CableEdge,
        ClampedEdge,
        ContactWire,
        DisplacementTable,
        Driver,
        DriveTable,
        Droppers,
        Dynamic,
        Elastic,
        Equilibrium,
        Exchange,
        Fixed,
        Fmu,
        FmuContact,
        FmuTravel,
        Footsteps,
        ForceTable,
        FreeTravel,
        Guided,
        Harmonic,
        Hooke,
        Inextensible,
        InnerElastic,
        InnerFixed,
        InnerGuided,
        InnerMoving,
        Joined,
        Joint,
        Line,
        Linear,
        Matrices,
        MatrixWheel,
        Membrane,
        MessengerSupports,
        MessengerWire,
        Moving,
        MovingForce,
        MovingMass,
        Net,
        Oscillator,
        OverheadLine,
        Pantograph,
        PantographTravel,
        Payload,
        Polynomial,
        Quasistatic,
        RigidBody,
        Scenario,
        SecondPiolaKirchhoff,
        Sheave,
        SoftEdge,
        Spans,
        SpeedTable,
        Spring,
        Start,
        SteadyArms,
        Stepper,
        StitchWire,
        Sweep,
        Tabulated,
        TensionOnly,
        Travel,
        Trolley,
        Vehicle,
        Walker,
        Wheel,
        Wind,
    )
    from ropewalk.results import ResultError, extrapolated, figure, film, html_report, open_result, summary, tables
    from ropewalk.results.contact_statistics import contact_statistics
    from ropewalk.resuming import resume
    from ropewalk.scenario import load, save
    from ropewalk.simulate import simulate
    from ropewalk.simulate import spectrum_of as spectrum
    from ropewalk.sweeps.dataset import sweep_table
    from ropewalk.sweeps.figure import sweep_figure
    from ropewalk.sweeps.sweeping import sweep

__version__ = "0.1.0"

__all__ = [
    "AdequacyMap",
    "Axis",
    "Balance",
    "Brake",
    "CableEdge",
    "ClampedEdge",
    "Comparison",
    "ContactWire",
    "DisplacementTable",
    "DriveTable",
    "Driver",
    "Droppers",
    "Dynamic",
    "Elastic",
    "Equilibrium",
    "EquilibriumError",
    "Exchange",
    "Fixed",
    "Fmu",
    "FmuContact",
    "FmuTravel",
    "Footsteps",
    "ForceTable",
    "FreeTravel",
    "Guided",
    "Harmonic",
    "Hooke",
    "Inextensible",
    "InnerElastic",
    "InnerFixed",
    "InnerGuided",
    "InnerMoving",
    "Joined",
    "Joint",
    "Line",
    "Linear",
    "Matrices",
    "MatrixWheel",
    "Membrane",
    "MessengerSupports",
    "MessengerWire",
    "ModelHierarchy",
    "Moving",
    "MovingForce",
    "MovingMass",
    "Net",
    "Oscillator",
    "OverheadLine",
    "Pantograph",
    "PantographTravel",
    "Payload",
    "Polynomial",
    "Quasistatic",
    "ResultError",
    "RigidBody",
    "RopewalkError",
    "Scenario",
    "ScenarioError",
    "SecondPiolaKirchhoff",
    "Sheave",
    "SoftEdge",
    "Spans",
    "SpeedTable",
    "Spring",
    "Start",
    "SteadyArms",
    "Stepper",
    "StitchWire",
    "Sweep",
    "Tabulated",
    "TensionOnly",
    "Travel",
    "Trolley",
    "Vehicle",
    "Walker",
    "Wheel",
    "Wind",
    "adequacy",
    "contact_statistics",
    "export_fmu",
    "extrapolated",
    "feedback",
    "figure",
    "film",
    "html_report",
    "load",
    "model_hierarchy",
    "open_result",
    "resume",
    "save",
    "simulate",
    "spectrum",
    "summary",
    "sweep",
    "sweep_figure",
    "sweep_table",
    "tables",
    "theory",
    "without_feedback",
]

_HOME = {
    "AdequacyMap": "compare.adequacy",
    "Axis": "compare.axes",
    "Balance": "model",
    "Brake": "model",
    "CableEdge": "model",
    "ClampedEdge": "model",
    "Comparison": "coupling",
    "ContactWire": "model",
    "DisplacementTable": "model",
    "DriveTable": "model",
    "Driver": "model",
    "Droppers": "model",
    "Dynamic": "model",
    "Elastic": "model",
    "Equilibrium": "model",
    "EquilibriumError": "errors",
    "Exchange": "model",
    "Fixed": "model",
    "Fmu": "model",
    "FmuContact": "model",
    "FmuTravel": "model",
    "Footsteps": "model",
    "ForceTable": "model",
    "FreeTravel": "model",
    "Guided": "model",
    "Harmonic": "model",
    "Hooke": "model",
    "Inextensible": "model",
    "InnerElastic": "model",
    "InnerFixed": "model",
    "InnerGuided": "model",
    "InnerMoving": "model",
    "Joined": "model",
    "Joint": "model",
    "ModelHierarchy": "compare",
    "Line": "model",
    "Linear": "model",
    "Matrices": "model",
    "MatrixWheel": "model",
    "Membrane": "model",
    "MessengerSupports": "model",
    "MessengerWire": "model",
    "Moving": "model",
    "MovingForce": "model",
    "MovingMass": "model",
    "Net": "model",
    "Oscillator": "model",
    "OverheadLine": "model",
    "Pantograph": "model",
    "PantographTravel": "model",
    "Payload": "model",
    "Polynomial": "model",
    "Quasistatic": "model",
    "ResultError": "results",
    "RigidBody": "model",
    "RopewalkError": "errors",
    "Scenario": "model",
    "ScenarioError": "errors",
    "SecondPiolaKirchhoff": "model",
    "Sheave": "model",
    "SoftEdge": "model",
    "Spans": "model",
    "SpeedTable": "model",
    "Spring": "model",
    "Start": "model",
    "SteadyArms": "model",
    "Stepper": "model",
    "StitchWire": "model",
    "Sweep": "model",
    "Tabulated": "model",
    "TensionOnly": "model",
    "Travel": "model",
    "Trolley": "model",
    "Vehicle": "model",
    "Walker": "model",
    "Wheel": "model",
    "Wind": "model",
    "adequacy": "compare.adequacy",
    "contact_statistics": "results.contact_statistics",
    "export_fmu": "cosim.export",
    "extrapolated": "results",
    "feedback": "coupling",
    "figure": "results",
    "film": "results",
    "html_report": "results",
    "model_hierarchy": "compare",
    "load": "scenario",
    "open_result": "results",
    "resume": "resuming",
    "save": "scenario",
    "spectrum": "simulate",
    "summary": "results",
    "sweep": "sweeps.sweeping",
    "sweep_figure": "sweeps.figure",
    "sweep_table": "sweeps.dataset",
    "tables": "results",
    "without_feedback": "decouple",
}
_RENAMED = {"Ladder": "ModelHierarchy", "ladder": "model_hierarchy"}
_NAME_AT_HOME = {"export_fmu": "export", "spectrum": "spectrum_of"}


hooks.unsupported = lambda parts: import_module("ropewalk.capabilities").unsupported(parts)


def __getattr__(name: str) -> Any:
    if name == "theory":
        return import_module("ropewalk.theory")
    if name in _RENAMED:
        import_module("ropewalk.renamed").warn_renamed(f"ropewalk.{name}", f"ropewalk.{_RENAMED[name]}")
        return getattr(import_module(__name__), _RENAMED[name])
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"ropewalk.{_HOME[name]}"), _NAME_AT_HOME.get(name, name))


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class _Package(ModuleType):
    """The package itself. Python sets the module `ropewalk.simulate` as an attribute of it whenever that is imported;

    the public name is the function in it, so what is set there is not taken.
    """

    @property
    def simulate(self) -> Any:
        return import_module("ropewalk.simulate").simulate

    @simulate.setter
    def simulate(self, _: Any) -> None:
        pass


sys.modules[__name__].__class__ = _Package
