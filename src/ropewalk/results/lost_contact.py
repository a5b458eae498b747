"""Whether loads that may not leave their lines pull at them: a wheel that runs on a line can only press."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.results.frame import RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

_MUCH = 0.01  # part of the largest push, from which on a pull counts
_ON_WHEELS = ("mass", "oscillator", "vehicle", "matrices", "train")  # trolleys and carriages hold on to their ropes


class LostContactWatch(Watch):
    """Watches loads with weight and without `lift_off` for what they pull their lines up with.

    What holds a load along its line is left out: on a steep one it may point upwards.
    """

    def _prepare(self) -> None:
        self._on = [self.scenario.loads.get(name) for name in self.loads]
        moves = self.scenario.run.kind == "dynamic" and self.scenario.gravity > 0.0
        self._contacts = [
            k for k, load in enumerate(self._on)
            if moves and load is not None and load.kind in _ON_WHEELS and getattr(load, "lift_off", None) is False
        ]  # fmt: skip
        self._push, self._pull = np.zeros(len(self._on)), np.zeros(len(self._on))  # the largest, N
        self._since = np.full(len(self._on), np.inf)  # s, when each pulled at first

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        if not self._contacts:
            return
        force = frames.of["contact_force"][..., -1] - np.nan_to_num(frames.of["hold_force"][..., -1])
        for k in self._contacts:
            up = np.nan_to_num(force[:, k])
            push = np.maximum(np.maximum.accumulate(-up), self._push[k])  # up to each instant
            self._push[k], self._pull[k] = push[-1], max(self._pull[k], up.max())
            if np.isinf(self._since[k]) and (pulls := (up > _MUCH * push) & (push > 0.0)).any():
                self._since[k] = float(frames.path[pulls.argmax()])

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """The loads that pull, when they begin to, and with what at most."""
        for k in self._contacts:
            if self._pull[k] > _MUCH * self._push[k] > 0.0 and np.isfinite(self._since[k]):
                load, when = self._on[k], f"from t = {self._since[k]:.4g} s on"
                assert load is not None
                yield (
                    f"load {self.layout.contact_load[k]}: contact is lost {when}: it pulls {load.on} up with up to "
                    f"{self._pull[k]:.4g} N, which a wheel cannot do; write lift_off: true to let it leave the line"
                )
