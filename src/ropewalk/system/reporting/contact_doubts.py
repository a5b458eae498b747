"""What must not be trusted of single contacts: those faster than waves, and those that friction does not hold."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.checkpoint import Arrays
from ropewalk.mechanics.chain import CLAMPED, COULOMB, Array
from ropewalk.mechanics.loading import Loading
from ropewalk.results.frame import RunInfo
from ropewalk.results.frames import Frames
from ropewalk.system.contact.contact_record import BODY, ON, PRESCRIBED
from ropewalk.system.contact.contacts import FASTEST
from ropewalk.system.elements.segments import mass_of
from ropewalk.system.elements.structure import Structure
from ropewalk.system.reporting.hold_forces import on_friction

# Part of a run for which a load may be faster than the waves of its line, as where that is slack for a while.
LONG = 0.2


class ContactDoubts:
    """What has been said of the contacts of a motion, and what is counted before it is."""

    def __init__(
        self, loading: Loading, contacts: Any, structure: Structure, run_info: RunInfo,
        instants: int,
    ) -> None:  # fmt: skip
        self.loading, self.structure, self.run_info, self._instants = loading, structure, run_info, instants
        self._fast = np.zeros(contacts.size, dtype=np.int64)  # frames in which each was faster than waves
        self._slipped = np.zeros(contacts.size, dtype=np.int64)  # 1: it has been said that friction is not enough
        clamped, coulomb = loading.loads.contact == CLAMPED, loading.loads.contact == COULOMB
        self._may_slip = (clamped & (contacts["friction"] > 0.0)) | coulomb

    def changing(self) -> Arrays:
        """What changes."""
        return {"fast": self._fast, "slipped": self._slipped}

    def doubt_speeds(self, path: Array, contacts: Any) -> None:
        """Doubt kinks that are carried along faster than transverse waves."""
        runs, run = self.structure.runs, np.where(contacts["state"] == ON, contacts["run"], 0)
        kinked = (contacts["state"] == ON) & (contacts["kind"] == BODY) & (runs.bending[run] == 0.0)
        square = mass_of(self.structure, contacts) * contacts["speed"] ** 2
        fast = kinked & (square > FASTEST * np.maximum(contacts["tension"], 0.0)) & (square > 0.0)
        before, count = self._fast.copy(), np.cumsum(fast, axis=0)
        self._fast += count[-1]
        for k in np.flatnonzero((before <= LONG * self._instants) & (self._fast > LONG * self._instants)):
            i = int(np.argmax(fast[:, k] & (before[k] + count[:, k] > LONG * self._instants)))
            wheel = self.loading.wheels[k]
            self._doubt(wheel.name, wheel.load, float(contacts["speed"][i, k]), float(path[i]))

    def ask_friction(self, frames: Frames, contacts: Any) -> None:
        """Note once where the friction of a prescribed travel is not enough."""
        needed, asked = frames.of["contact_friction"], (contacts["state"] == ON) & (contacts["travel"] == PRESCRIBED)
        for i, k in zip(*np.nonzero(asked & self._may_slip & (self._slipped == 0)), strict=True):
            kind, contact = int(self.loading.loads.contact[k]), contacts[i, k]
            found = on_friction(self.loading.wheels[k].name, kind, contact, float(needed[i, k]))
            if found and not self._slipped[k]:
                self._slipped[k] = 1
                self.run_info.warnings.append(f"at t = {frames.path[i]:.4g} s, {found}")

    def _doubt(self, name: str, load: str, speed: float, t: float) -> None:
        if any(doubt.key == f"loads.{load}.travel.speed" for doubt in self.run_info.doubts):
            return
        self.run_info.doubt(
            f"load {name}: a mass at {speed:.4g} m/s reaches the speed of the transverse waves of its line at t = "
            f"{t:.4g} s",
            "its contact force is wrong once it is as fast as the waves", f"loads.{load}.travel.speed",
            "let it go slower, or give the line more tension",
        )  # fmt: skip
