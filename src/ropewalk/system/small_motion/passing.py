"""Loads that pass over a structure which stands still: where they touch it at any instant, and how firm it is there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import ARC, HORIZONTAL, SLIP, Array
from ropewalk.mechanics.compiled import lean
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.solve.superposition import ContactsAtInstant
from ropewalk.system.contact.contact_record import AWAY, ON
from ropewalk.system.contact.contacts import sit, stiffen
from ropewalk.system.contact.tables import Tables
from ropewalk.system.contact.travel import place
from ropewalk.system.elements.compliance import compliances
from ropewalk.system.elements.profile import height_at
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import LoadedStructure

_BEYOND = 1e-9  # of its line: a contact that is as far past an end stands there


@lean
def _pass_over(structure, buffers, contacts, tables, state, on, table, out):
    """Put contacts where they are at the time of the state, those that are on their lines as told within these."""
    place(structure, buffers, contacts, tables, state)
    for k in range(contacts.size):
        first, count = contacts[k].speed_first, contacts[k].speed_count
        speed = look_up(tables.speed_time, tables.speed_value, first, count, state.t[0])
        if on[k] == 0:
            contacts[k].state, contacts[k].speed = AWAY, speed
            if contacts[k].rolls == 1:
                contacts[k].rough, contacts[k].steep = height_at(structure.lines.profiles, contacts[k].line, state.s[k])
            continue
        length = structure.lines.length[contacts[k].line]
        s = min(max(state.s[k], 0.0), length)
        stops = abs(s - state.s[k]) > _BEYOND * length
        state.s[k], contacts[k].state = s, ON
        sit(structure, contacts, state, k, s)
        stretch = 1.0
        if contacts[k].measure == HORIZONTAL:
            stretch = contacts[k].along[0]
        elif contacts[k].measure == ARC:
            square = 0.0
            for a in range(state.r.shape[0]):
                way = contacts[k].along[a] - (contacts[k].steep if a == state.r.shape[0] - 1 else 0.0)
                square += way**2
            stretch = np.sqrt(square)
        contacts[k].measured = 0.0 if stops else speed
        contacts[k].speed = contacts[k].measured / stretch
        stiffen(structure, buffers, contacts, state, table, out, k)


class Passing:
    """Contacts that travel as prescribed over a structure at rest.

    Args:
        structure: linearised about rest.
        loaded: what stands on it, at rest.
        tables: histories of its contacts.
        names: (contact,) of the loads that they belong to.
    """

    def __init__(
        self, structure: Structure, loaded: LoadedStructure, potential: SystemPotential, tables: Tables,
        names: Sequence[str],
    ) -> None:  # fmt: skip
        self.structure, self.loaded, self._tables = structure, loaded, tables
        self.contacts, self._names = loaded.contacts, names
        self._buffers, self._table, self._out = potential.buffers, compliances(), np.zeros(4)
        self.state = loaded.state.copy()
        self.contacts["measure"][self.contacts["measure"] == SLIP] = ARC  # along what stands still

    def place(self, t: float, on: NDArray[np.bool_]) -> Array:
        """Put contacts where they are at time t in s, those that are on their lines as told; where they would be, m."""
        self.state.t[0] = t
        _pass_over(
            self.structure.for_kernels, self._buffers.for_kernels(self.structure), self.contacts, self._tables,
            self.state, on.astype(np.int64), self._table, self._out,
        )  # fmt: skip
        return self.state.s

    def at(self, t: float, on: NDArray[np.bool_]) -> ContactsAtInstant:
        """Those that are on their lines, as said."""
        self.place(t, on)
        self._refuse_sheaves(t)
        here, dim = np.flatnonzero(on), self.state.r.shape[0]
        contacts: Any = self.contacts[here]
        force = contacts["given"][:, :dim].copy()
        along, restrained = contacts["along"][:, :dim], contacts["frictionless"] == 1
        if restrained.any():  # a horizontal force holds it across its line at rest
            level = self.structure.runs.ahead[contacts["run"][restrained]]
            hold = (force[restrained] * along[restrained]).sum(axis=1) / (level * along[restrained]).sum(axis=1)
            force[restrained] -= hold[:, None] * level
        return ContactsAtInstant(
            here, contacts["near"].copy(), contacts["weight"].copy(), 1.0 / contacts["moving"],
            contacts["p"][:, :dim].copy(), contacts["speed"][:, None] * along, force,
        )  # fmt: skip

    def _refuse_sheaves(self, t: float) -> None:
        """Refuse contacts on the link over which a sheave stands."""
        sheaves, runs, lines = self.structure.sheaves, self.structure.runs, self.structure.lines
        for run in () if sheaves is None else sheaves.run.tolist():
            low, high = lines.begin[run] + runs.links[run] * runs.h[run], lines.begin[run + 1]
            line = int(np.searchsorted(lines.first, run, side="right")) - 1
            on = (self.contacts["state"] == ON) & (self.contacts["line"] == line)
            if (k := np.flatnonzero(on & (low < self.state.s) & (self.state.s < high))).size:
                raise RopewalkError(
                    f"loads.{self._names[k[0]]}.travel: the load reaches a sheave at t = {t:.4g} s, which it "
                    "cannot pass; let it turn back before, or end the run there"
                )

    def beside(self, t: float, on: NDArray[np.bool_]) -> Array:
        """Velocities (contact, axis) with which the ground moves those that are not on their lines, m/s."""
        self.place(t, on)
        out = np.zeros((self.contacts.size, self.state.r.shape[0]))
        off = ~on & (self.contacts["rolls"] == 1)
        out[off, -1] = self.contacts["steep"][off] * self.contacts["speed"][off]
        return out

    def whether_on(self, t: float, been: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Which contacts are on their lines at time t in s, of which some have been there before."""
        none_on = np.zeros(self.contacts.size, dtype=np.bool_)
        s = self.place(t, none_on).copy()
        length = self.structure.lines.length[self.contacts["line"]]
        stays = (self.contacts["stays"] == 1) & been
        return np.asarray(stays | ((s >= -_BEYOND * length) & (s <= length * (1.0 + _BEYOND))))
