"""ropewalk: what travels along slender flexible structures.

A scenario says what is there and what is asked; `simulate` answers with a labelled dataset:

    import ropewalk
    scenario = ropewalk.load("examples/moving-force.yaml")
    result = ropewalk.simulate(scenario)

==============  ======================================================================================
what is there   `Scenario` of `Line`s and of loads; `ForceTable`, `SpeedTable`, `DriveTable` and
                `DisplacementTable` for what changes in time
loads           `MovingForce`, `MovingMass`, `Oscillator`, `Trolley` with its `Payload`; `Carriage` with
                `Cabin` and `Haul` with `CounterRope` and `DriveSheave`; `Vehicle` of `RigidBody`, `Wheel` and
                `Spring`, or of `Matrices` with `MatrixWheel`; `Footsteps` with `Harmonic`s, `Walker`, both with a
                `Balance`; `Crowd` with its `MassSpread`, `FrequencySpread` and `LengthSpread`; `Stepper` for a
                user-defined model, `Fmu` with `FmuContact`s and `FmuTravel` for one of another program; their
                `Exchange` with the line
overhead lines  `OverheadLine` of `ContactWire`, `MessengerWire`, `StitchWire`, `Droppers`, `SteadyArms`,
                `MessengerSupports`, `Spans`, `Condition` and `Limits`; `Pantograph` with its `PantographTravel`
                and its `PantographHead`, which may have a `HeadRotation` or two
travel          `Travel` as prescribed, `FreeTravel` with `Driver` and `Brake`
axial laws      `Hooke`, `TensionOnly`, `SecondPiolaKirchhoff`, `Polynomial`, `Tabulated`, `Webbing`, `Inextensible`;
                `Hysteresis`, what unloading gives back less
cuts            `Cut` of a line that fails
supports        `Fixed`, `Elastic`, `Guided`, `Moving`; `Joined` to a `Joint`, a line or a net; `Sheave`s on the way;
                between the ends `InnerFixed`, `InnerElastic`, `InnerGuided`, `InnerMoving`
nets            `Net` and `Membrane` with a `ClampedEdge`, a `SoftEdge` or a `CableEdge`; `Wind`
what is asked   `Dynamic` (from a `Start`), `Quasistatic`, `Equilibrium`, `Linear`
files           `load` and `save` a scenario, `open_result`; `export_fmu` writes a line or a vehicle as an FMU
answers         `simulate`, `resume`, `spectrum`; `feedback` gives a `Comparison` with a run `without_feedback`,
                `model_hierarchy` a `ModelHierarchy` of simpler models, `adequacy` an `AdequacyMap` over two `Axis`es;
                `summary`, `tables`, `figure`, `film` of a result, in notebooks `view`; paths of contacts `extrapolated`
                from two meshes;
                `contact_statistics` and `html_report` of overhead lines
many runs       `sweep` gives one dataset over what varies (`Sweep`), `sweep_figure` and `sweep_table` are of it;
                `design` gives the `Design` that limits allow, `fit` the `Fit` of unknown values to measured ones,
                `gradient` derivatives with their errors
calculators     `calc`: given any sufficient set of quantities of a span, a highline, a zip line, the others
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
from ropewalk.importing import lightly

if TYPE_CHECKING:
    from ropewalk import calc as calc
    from ropewalk import theory as theory
    from ropewalk.compare import ModelHierarchy as ModelHierarchy
    from ropewalk.compare import model_hierarchy as model_hierarchy
    from ropewalk.compare.adequacy import AdequacyMap as AdequacyMap
    from ropewalk.compare.adequacy import adequacy as adequacy
    from ropewalk.compare.axes import Axis as Axis
    from ropewalk.cosim.export import export as export_fmu  # noqa: F401
    from ropewalk.coupling import Comparison as Comparison
    from ropewalk.coupling import feedback as feedback
    from ropewalk.decouple import without_feedback as without_feedback
    from ropewalk.designs.designing import design as design
    from ropewalk.designs.fitting import Fit as Fit
    from ropewalk.designs.fitting import fit as fit
    from ropewalk.designs.gradient import gradient as gradient
    from ropewalk.designs.result import Design as Design
    from ropewalk.errors import EquilibriumError as EquilibriumError
    from ropewalk.errors import RopewalkError as RopewalkError
    from ropewalk.errors import ScenarioError as ScenarioError
    from ropewalk.model import *  # noqa: F403
    from ropewalk.results import ResultError as ResultError
    from ropewalk.results import extrapolated as extrapolated
    from ropewalk.results import figure as figure
    from ropewalk.results import film as film
    from ropewalk.results import html_report as html_report
    from ropewalk.results import open_result as open_result
    from ropewalk.results import summary as summary
    from ropewalk.results import tables as tables
    from ropewalk.results.contact_statistics import contact_statistics as contact_statistics
    from ropewalk.resuming import resume as resume
    from ropewalk.scenario import load as load
    from ropewalk.scenario import save as save
    from ropewalk.simulate import simulate as simulate
    from ropewalk.simulate import spectrum_of as spectrum  # noqa: F401
    from ropewalk.studio.widget import view as view
    from ropewalk.sweeps.dataset import sweep_table as sweep_table
    from ropewalk.sweeps.figure import sweep_figure as sweep_figure
    from ropewalk.sweeps.sweeping import sweep as sweep


__version__ = "0.2.0"

# Where functions and results are; declarations are in `model`.
_HOME = {
    "AdequacyMap": "compare.adequacy",
    "Axis": "compare.axes",
    "Comparison": "coupling",
    "EquilibriumError": "errors",
    "ModelHierarchy": "compare",
    "ResultError": "results",
    "RopewalkError": "errors",
    "ScenarioError": "errors",
    "adequacy": "compare.adequacy",
    "Design": "designs.result",
    "design": "designs.designing",
    "Fit": "designs.fitting",
    "fit": "designs.fitting",
    "gradient": "designs.gradient",
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
    "view": "studio.widget",
    "without_feedback": "decouple",
}
_PACKAGES = ("calc", "theory")
_RENAMED = {"Ladder": "ModelHierarchy", "ladder": "model_hierarchy"}
_NAME_AT_HOME = {"export_fmu": "export", "spectrum": "spectrum_of"}


hooks.problems = lambda *given: import_module("ropewalk.scenario.problems").in_declaration(*given)
hooks.unsupported = lambda parts: import_module("ropewalk.capabilities").unsupported(parts)


@lightly()
def __getattr__(name: str) -> Any:
    if name in _PACKAGES:
        return import_module(f"ropewalk.{name}")
    if name in _RENAMED:
        import_module("ropewalk.renamed").warn_renamed(f"ropewalk.{name}", f"ropewalk.{_RENAMED[name]}")
        return getattr(import_module(__name__), _RENAMED[name])
    if name in _HOME:
        return getattr(import_module(f"ropewalk.{_HOME[name]}"), _NAME_AT_HOME.get(name, name))
    if name == "__all__":
        return sorted({*_HOME, *_PACKAGES, "simulate", *import_module("ropewalk.model").DECLARATIONS})
    if name[:1].isupper() and name in (model := import_module("ropewalk.model")).DECLARATIONS:
        return getattr(model, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__getattr__("__all__")})


class _Package(ModuleType):
    """The package itself. Python sets the module `ropewalk.simulate` as an attribute of it whenever that is imported;

    the public name is the function in it, so what is set there is not taken.
    """

    @property
    @lightly()
    def simulate(self) -> Any:
        return import_module("ropewalk.simulate").simulate

    @simulate.setter
    def simulate(self, _: Any) -> None:
        pass


sys.modules[__name__].__class__ = _Package
