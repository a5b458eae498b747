"""Loads: what travels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, Variants, report
from ropewalk.model.axles import Axles
from ropewalk.model.carriage import Carriage
from ropewalk.model.contact import FrictionModel
from ropewalk.model.crowd import Crowd
from ropewalk.model.fmu import Fmu
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.history import ForceHistory, rows
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.quantity import FrictionCoefficient
from ropewalk.model.run import Linear
from ropewalk.model.stepper import Stepper
from ropewalk.model.train import Train
from ropewalk.model.travel import Place, Travel, prescribed_only
from ropewalk.model.trolley import Trolley
from ropewalk.model.vehicle import Vehicle
from ropewalk.model.walker import Walker

Contact = Literal["clamped", "frictionless", "coulomb", "dragged"]
RUBBING = ("coulomb", "dragged")
"""Contacts whose prescribed travel rubs."""


class MovingForce(Declaration):
    """A given force that travels along a line.

    What holds it at its place along the line is its contact. `clamped`: the line feels the given force alone and its
    tension jumps at the load. `frictionless`: a horizontal hold force is added that keeps the tension equal on both
    sides. `coulomb`: it stands by friction, and where that does not suffice the least hold force is added. `dragged`:
    it slides all the time, friction acts in full against its travel, and the hold force does the rest. On nets all of
    this is along its path, which guides it to the side as a rail would, and friction is that of a point.
    """

    kind: Literal["force"] = "force"
    on: str = Field(description="name of the line")
    force: ForceHistory = Field(description="[Fx, Fz] or [Fx, Fy, Fz], or a table {time, value} of them")
    travel: Annotated[Travel, prescribed_only("a force without mass cannot travel freely")] = Field(
        description="motion along the line"
    )
    contact: Contact = Field(
        default="clamped",
        description="clamped: the line feels the force alone; frictionless: equal tension on both sides; "
        "coulomb: friction holds it as far as it can, a horizontal force does the rest; dragged: friction acts in "
        "full against its travel",
    )
    friction: FrictionCoefficient | None = Field(
        default=None, description="coefficient, needed by coulomb and dragged; of a clamped load: is it enough?"
    )
    friction_model: FrictionModel = Field(
        default="capstan",
        description="capstan: the line bends around the contact, T2/T1 = exp(mu angle); "
        "block: a point, |T2 - T1| = mu (T1 + T2) tan(angle/2)",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if self.contact in RUBBING and self.friction is None:
            remedy = "add friction: its coefficient, for example 0.3"
            findings.append(Finding(("friction",), f"is required by contact {self.contact}", remedy=remedy))
        if self.contact == "frictionless" and self.friction:
            remedy = "leave friction out, or write contact: coulomb"
            findings.append(Finding(("friction",), "contact frictionless has none", f"{self.friction:g}", remedy))
        report("load", findings)
        return self

    def starts(self) -> list[Place]:
        """List where it stands at the beginning."""
        return [Place("", self.travel.measured, self.travel.start)]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by."""
        yield from rows(self.force)


GivenForces = MovingForce | Axles
"""The loads that are nothing but given forces which travel as prescribed."""
Travelling = MovingForce | Axles | MovingMass | Oscillator | Trolley | Carriage | Vehicle | Train | Matrices
"""The loads that have a travel; the others have a gait or a will of their own."""
Rolling = MovingMass | Oscillator | Trolley | Carriage | Vehicle | Train | Matrices
"""The loads with wheels, which follow a profile."""
ExternalModel = Stepper | Fmu
"""The loads that are external models."""
AnyLoad = Travelling | Footsteps | Walker | Crowd | ExternalModel | Pantograph
Load = Annotated[
    MovingForce
    | Axles
    | MovingMass
    | Oscillator
    | Trolley
    | Carriage
    | Vehicle
    | Train
    | Matrices
    | Footsteps
    | Walker
    | Crowd
    | Stepper
    | Fmu
    | Pantograph,
    Variants("load"),
]
"""Any load."""


def assembled(loads: Mapping[str, Any], run: object) -> dict[str, Any]:
    """Loads with trains as the vehicles that they are made of, each a load; for the linear theory as one vehicle each.

    Lines of that have one load with a mass.
    """
    found = dict[str, Any]()
    for name, load in loads.items():
        if not isinstance(load, Train):
            found[name] = load
        elif isinstance(run, Linear):
            found[name] = load.whole
        else:
            found |= load.sections(name)
    return found
