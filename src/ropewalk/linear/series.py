"""A force on any course along one line in the linear theory: the series of its sine modes, each in exact steps."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError
from ropewalk.linear.chord import Chord
from ropewalk.mechanics.chain import Array
from ropewalk.solve.crossings import CLOSE, LOOKS, crossings
from ropewalk.solve.modal import Complex, ModalStep, alone
from ropewalk.solve.radau_iia import C as STAGES

_LEFT_OUT = 1e-6  # of the deflection under a force at rest in the middle
_MOST = 2000  # modes
_TURN = 0.5  # by which the argument of the highest sine changes in a step


class Series:
    """Deflections of a line at rest at first, under one force.

    Args:
        chord: the line.
        path: places of the force in m at times in s; beyond the ends it does not act.
        force: sizes in N at times in s.
        jumps: s, where speeds or forces jump.
        until: s.
        modes: how many; None: until those left out are a millionth.

    Raises:
        RopewalkError: too many would be needed.
    """

    def __init__(
        self, chord: Chord, path: Callable[[Array], Array], force: Callable[[Array], Array], jumps: Array, until: float,
        modes: int | None,
    ) -> None:  # fmt: skip
        self._chord, self._path, self._force = chord, path, force
        self._k, self._rate, self._driven = wave_numbers_and_rates(chord, modes)
        self._times = self._boundaries(jumps, until)
        self._z: Complex = np.zeros((self._times.size, self._rate.size), dtype=np.complex128)
        lengths = np.diff(self._times)
        stages = self._times[:-1, None] + lengths[:, None] * STAGES
        places, sizes = (of(stages.ravel()).reshape(stages.shape) for of in (self._path, self._force))
        steps: dict[float, ModalStep] = {}
        for i, h in enumerate(lengths):
            key = float(f"{h:.9e}")
            steps.setdefault(key, ModalStep(self._rate, float(h)))
            self._z[i + 1] = self._go(steps[key], self._z[i], places[i], sizes[i])

    def _boundaries(self, jumps: Array, until: float) -> Array:
        """Instants between steps: at jumps, as a force comes and goes, and so close that its place changes little."""
        looks = np.linspace(0.0, until, LOOKS + 1)
        seen = self._is_on(looks)[:, None]
        comings = crossings(looks, seen, lambda t: self._is_on(np.array([t])), CLOSE * until)
        events = [0.0, until, *jumps[(jumps > 0.0) & (jumps < until)], *comings]
        found, instants = [np.zeros(1)], np.unique(np.array(events))
        for begin, end in pairwise(instants):
            turns = float(np.abs(np.diff(self._path(np.linspace(begin, end, 33)))).sum() * self._k.max())
            found.append(np.linspace(begin, end, max(2, int(np.ceil(turns / _TURN))) + 1)[1:])
        return np.concatenate(found)

    def _is_on(self, t: Array) -> NDArray[np.bool_]:
        x = self._path(t)
        return (x >= 0.0) & (x <= self._chord.length)

    def _go(self, step: ModalStep, z: Complex, places: Array, sizes: Array) -> Complex:
        """One step of all modes, with places and sizes of the force at its stages."""
        out = step.decay[2] * z
        for k in range(STAGES.size):
            if 0.0 <= places[k] <= self._chord.length:
                out = out + step.weight[2, k] * (self._driven * (sizes[k] * np.sin(self._k * places[k])))
        return np.asarray(out)

    def deflection(self, x: Array, t: Array) -> Array:
        """Deflection in m at places and times; x and t broadcast as (1, place) and (time, 1)."""
        rows = []
        for instant in np.ravel(t):
            i = max(int(np.searchsorted(self._times, instant, side="right")) - 1, 0)
            h = float(instant) - float(self._times[i])
            z = self._z[i]
            if h > 0.0:
                stages = self._times[i] + h * STAGES
                z = self._go(ModalStep(self._rate, h), z, self._path(stages), self._force(stages))
            rows.append(z.real)
        amplitude = np.array(rows) * 2.0 / (self._chord.mass * self._chord.length)
        return np.asarray(amplitude @ np.sin(np.outer(self._k, np.ravel(x))))


def wave_numbers_and_rates(chord: Chord, modes: int | None) -> tuple[Array, Complex, Complex]:
    """Wave numbers of sine modes in 1/m, their rates in 1/s, and how forces drive them, see `solve/modal.py`.

    They are kept: the same line under other loads, or the same loads at another speed, has the same modes.

    Args:
        chord: the line.
        modes: how many; None: until those left out are a millionth.

    Raises:
        RopewalkError: too many would be needed.
    """
    beam = chord.bending_stiffness, chord.tension, chord.foundation
    return _modes(chord.length, *beam, chord.mass, chord.damping, chord.retardation, modes)


@lru_cache(maxsize=64)
def _modes(
    length: float, bending_stiffness: float, tension: float, foundation: float, mass: float, damping: float,
    retardation: float, modes: int | None,
) -> tuple[Array, Complex, Complex]:  # fmt: skip
    def stiffness(k: Array) -> Array:
        return np.asarray(bending_stiffness * k**4 + tension * k**2 + foundation)

    k = _wave_numbers(length, modes or _enough(length, stiffness))
    w = np.sqrt(stiffness(k) / mass)
    rate, which, driven = alone(w, damping / mass + retardation * w**2)
    found = k[which], rate, driven
    for array in found:
        array.setflags(write=False)
    return found


def _wave_numbers(length: float, count: int) -> Array:
    return np.arange(1.0, count + 1.0, dtype=np.float64) * (np.pi / length)


def _enough(length: float, stiffness: Callable[[Array], Array]) -> int:
    """How many modes are enough.

    Raises:
        RopewalkError: they are too many.
    """
    flexible = 1.0 / stiffness(_wave_numbers(length, 20 * _MOST))
    left = 1.0 - np.cumsum(flexible) / flexible.sum()
    found = int(np.argmax(left < _LEFT_OUT)) + 1
    if found > _MOST:
        raise RopewalkError(
            f"run.modes: the series of a line with so little bending stiffness needs more than {_MOST} modes; write a "
            "number of modes, or leave bending_stiffness out"
        )
    return found
