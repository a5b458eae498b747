"""Rigid overhead lines: contact forces of pantographs below lines that do not move.

Wires are so taut that they hardly give way, and so heavy that their waves are slow enough for the steps.
"""

from __future__ import annotations

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array
from ropewalk.model.history import ForceTable, SpeedTable
from ropewalk.model.load import MovingForce
from ropewalk.model.overhead import OverheadLine
from ropewalk.model.overhead_wire import OverheadWire
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.run import Dynamic, every_of
from ropewalk.model.scenario import Scenario
from ropewalk.model.travel import Travel
from ropewalk.results.contract import doubts_of
from ropewalk.simulate import simulate

TAUT, HEAVY = 1e9, 100.0  # N and kg/m: 300 N in the middle of 60 m raise it by 5e-6 m
LINK = 2.0  # m, at least: what is straight needs no short ones
SAMPLES = 2000  # of a force history, at least


def forces_of_pantograph(scenario: Scenario, name: str) -> dict[str, MovingForce]:
    """The forces that a pantograph exerts on rigid contact wires, by the names of its contacts in a result.

    Args:
        scenario: with a motion in time.
        name: of the pantograph.

    Raises:
        RopewalkError: it does not come to the end of its run.
    """
    run, load = scenario.run, scenario.loads[name]
    assert isinstance(run, Dynamic)
    assert isinstance(load, Pantograph)
    every = min(every_of(run), run.until / SAMPLES)
    alone = Scenario(
        gravity=scenario.gravity,
        overhead_lines={key: _rigid(line) for key, line in scenario.overhead_lines.items()},
        loads={name: load}, run=Dynamic(until=run.until, every=every, geometry="linearised"),
    )  # fmt: skip
    result = simulate(alone)
    if result.attrs["outcome"] != "completed":
        text = f"{result.attrs['outcome']}: {'; '.join(doubts_of(result)) or result.attrs['advice']}"
        raise RopewalkError(f"the run of {name} below rigid wires stopped early ({text})")
    found, time = {}, result["time"].values
    for k, contact in enumerate(result["load"].values.tolist()):
        place, force = result["contact_xi"].values[:, k], result["contact_force"].values[:, k, -1]
        line = next((part for part in contact.split(".")[1:] if part in scenario.overhead_lines), load.on)
        length = scenario.overhead_lines[line].length
        on = np.isfinite(place) & (place >= 0.0) & (place <= length)
        if on.any() and force[on].any():
            found[contact] = _as_force(load, line, time, place, np.where(on, force, 0.0), on)
    return found


def _rigid(line: OverheadLine) -> OverheadLine:
    """The same line with wires that do not move, as it is drawn."""

    def taut(wire: OverheadWire) -> OverheadWire:
        own = {"tension": TAUT, "mass": HEAVY, "axial_stiffness": 1e3 * TAUT, "retardation": 0.0}
        return wire.model_copy(update=own)

    whole = line.droppers.model_copy(update={"strength": None, "cut": None})
    kept = {"contact_wire": taut(line.contact_wire), "messenger_wire": taut(line.messenger_wire), "droppers": whole}
    gone = dict.fromkeys(("pre_sag", "stitch_wire", "condition", "limits"))
    return line.model_copy(update={**kept, **gone, "element": max(line.element, LINK)})


def _as_force(load: Pantograph, line: str, time: Array, place: Array, force: Array, on: Array) -> MovingForce:
    """The upward force of a contact at places (time,) in m along a line, where it is on that."""
    first = int(on.argmax())
    speed: float | SpeedTable = load.travel.speed  # type: ignore[assignment]
    if first > 0:  # it waits for its turn where it comes to the line
        moved = np.diff(place[first:]) / np.diff(time[first:])
        moved = np.where(np.isfinite(moved), moved, moved[0])
        instants = np.concatenate([[0.0, time[first]], np.repeat(time[first:], 2)[1:-1]])
        values = np.concatenate([[0.0, 0.0], np.repeat(moved, 2)])
        speed = SpeedTable(time=tuple(instants.tolist()), value=tuple(values.tolist()))
    travel = Travel(speed=speed, measured="horizontal", start=float(place[first]), at_end="leave")
    table = ForceTable(time=tuple(time.tolist()), value=tuple((0.0, own) for own in force.tolist()))
    return MovingForce(on=line, force=table, travel=travel)
