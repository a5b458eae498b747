"""Payloads of trolleys: where they are when a motion begins."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ropewalk.mechanics.contact_points import ContactPoint
from ropewalk.mechanics.multibody_system import hung
from ropewalk.model.scenario import Scenario
from ropewalk.model.trolley import Trolley
from ropewalk.system.elements.structure import SystemState


def place_payloads(
    scenario: Scenario, wheels: Sequence[ContactPoint], contacts: Any, tethers: Any, state: SystemState,
    *, displaced: bool = False,
) -> None:  # fmt: skip
    """Place payloads below their trolleys as declared, and let them move along.

    Args:
        scenario: what is declared.
        wheels: of the contacts.
        contacts: records.
        tethers: records of the ropes of payloads.
        state: coordinates of payloads and their velocities are changed.
        displaced: only those with a position or an angle of their own; others stay in equilibrium.
    """
    dim = state.r.shape[0]
    axes = ("x", "z") if dim == 2 else ("x", "y", "z")
    for tether in tethers:
        load = scenario.loads[wheels[tether["contact"]].load]
        if not isinstance(load, Trolley) or (displaced and load.payload.at is None and not load.payload.swing):
            continue
        first, above = int(tether["first"]), int(contacts[tether["contact"]]["first"])
        below = hung(load.payload, float(tether["stiffness"]), scenario.gravity, axes)
        state.u[first : first + dim] = state.u[above : above + dim] + below
        state.w[first : first + dim] = state.w[above : above + dim]
