"""What is handed over of a spectrum: eigenvalues, frequencies, damping ratios, shapes of modes and their names."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.frame import Array

_SMALL = 0.05  # of the largest displacement: smaller ones count for no half-wave
_CLEAR = 2.0 / 3.0  # share of the squared displacement from which on one direction names a mode
_APART = 5.0  # times the usual distance of nodes that follow one another: beyond, they are the rows of a net
_SAME = 1e-3  # of the length of the structure: nodes at one place along x


@dataclass(frozen=True, eq=False)
class Modes:
    """The lowest modes of a structure."""

    frequency: Array
    """(mode,) natural angular frequencies, rad/s, ascending."""
    ratio: Array
    """(mode,) damping ratios."""
    shape: Array = field(default_factory=lambda: np.zeros((0, 0, 3)))
    """(mode, node, 3) displacements in x, y, z; the largest is 1."""
    position: Array = field(default_factory=lambda: np.zeros((0, 3)))
    """(node, 3) m, at rest."""
    line: tuple[str, ...] = ()
    """Line or net of each node."""


def mode_names(modes: Modes) -> list[str]:
    """Name every mode by its shape, such as "vertical, 2 half-waves of deck".

    The direction holds at least two thirds of the squared displacement of all nodes: `axial` is along the lines,
    `lateral` level across them, `vertical` the remaining one; `torsional` is vertical in opposite directions at nodes
    next to each other. A half-wave lies between two changes of sign along the line that moves most. Shapes of nets are
    named by their direction only: `vertical`, or `level`.

    Args:
        modes: with shapes (mode, node, 3) and positions (node, 3) in m.
    """
    if not modes.shape.size:
        return [""] * len(modes.frequency)
    lines = np.array(modes.line)
    names = list(dict.fromkeys(modes.line))
    along, across, up = _directions(modes.position, lines, names)
    return [_name(shape, (along, across, up), lines, names, modes.position) for shape in modes.shape]


def _name(shape: Array, axes: tuple[Array, Array, Array], lines: Array, names: list[str], place: Array) -> str:
    parts = [(shape * axis).sum(axis=1) for axis in axes]
    share = np.array([(part**2).sum() for part in parts]) / max(float((shape**2).sum()), 1e-300)
    k = int(share.argmax())
    direction = ("axial", "lateral", "vertical")[k] if share[k] >= _CLEAR else "mixed directions"
    moving = max(names, key=lambda name: float((parts[k][lines == name] ** 2).sum()))
    if not _is_line(place[lines == moving]):
        return ("vertical" if direction == "vertical" else "level") + (f", {moving}" if len(names) > 1 else "")
    if direction == "vertical" and _is_torsional(parts[k], place, place[lines == moving]):
        direction = "torsional"
    count = _half_waves(parts[k][lines == moving])
    waves = f"{count} half-wave{'s' if count > 1 else ''}"
    return f"{direction}, {waves}" + (f" of {moving}" if len(names) > 1 else "")


def _directions(place: Array, lines: Array, names: list[str]) -> tuple[Array, Array, Array]:
    """Unit vectors (node, 3) along the lines, level across them, and across both; of a vertical line y is across."""
    along = np.zeros_like(place)
    for name in names:
        own = np.flatnonzero(lines == name)
        along[own] = np.gradient(place[own], axis=0) if _is_line(place[own]) else (1.0, 0.0, 0.0)
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length > 0.0, along / np.where(length > 0.0, length, 1.0), (1.0, 0.0, 0.0))
    across = np.stack([-along[:, 1], along[:, 0], np.zeros(len(along))], axis=1)
    level = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(level > 1e-9, across / np.where(level > 0.0, level, 1.0), (0.0, 1.0, 0.0))
    return along, across, np.cross(along, across)


def _is_line(place: Array) -> bool:
    """Whether nodes follow one another, as on a line; on a net the first node of a row is far from the one before."""
    steps = np.linalg.norm(np.diff(place, axis=0), axis=1)
    return steps.size > 0 and bool(steps.max() <= _APART * np.median(steps))


def _is_torsional(vertical: Array, place: Array, line: Array) -> bool:
    """Whether nodes at one place along a line move in opposite directions on both sides, more than together."""
    extent = float(np.ptp(place, axis=0).max())
    together, apart = 0.0, 0.0
    way = (line[-1] - line[0])[:2]
    level = float(np.hypot(*way))
    c, s = way / level if level > _SAME * extent else (1.0, 0.0)
    station, aside = np.round((c * place[:, 0] + s * place[:, 1]) / (_SAME * extent)), c * place[:, 1] - s * place[:, 0]
    for x in np.unique(station):
        own = np.flatnonzero(station == x)
        if np.ptp(aside[own]) > _SAME * extent:
            mean = vertical[own].mean()
            together += own.size * mean**2
            apart += float(((vertical[own] - mean) ** 2).sum())
    return apart > together


def _half_waves(values: Array) -> int:
    """Number of stretches of one sign, without those of hardly any displacement."""
    signs = np.sign(values[np.abs(values) > _SMALL * np.abs(values).max(initial=0.0)])
    return 1 + int(np.count_nonzero(np.diff(signs)))


LISTED = 12  # modes in the table for people
ROUNDING = 1e-9  # damping ratios below are rounding errors


@dataclass(frozen=True, eq=False)
class Spectrum:
    """The spectrum of one line, or of several together (`lines` then holds that of each)."""

    name: str
    unknowns: int
    """Size of J."""
    lowest_frequency: float
    """Smallest natural (undamped) angular frequency that is not zero, rad/s; 0 if there is none."""
    highest_frequency: float
    """Largest natural angular frequency, rad/s."""
    slowest_damping_ratio: float
    """Damping ratio of the mode of the lowest frequency; above 1 a mode does not oscillate."""
    fastest_damping_ratio: float
    """Damping ratio of the mode of the highest frequency."""
    largest_damping_ratio: float
    """Largest damping ratio of the modes computed."""
    smallest_eigenvalue: float
    """Smallest |lambda| that is not zero, 1/s."""
    largest_eigenvalue: float
    """Largest |lambda|, 1/s."""
    imaginary: bool
    """Whether nothing is damped: every eigenvalue is imaginary, but for those of an unstable line."""
    real_branches: bool
    """Whether some modes are damped beyond oscillation."""
    unstable: int
    """Number of eigenvalues with a positive real part: directions in which the line, in compression, yields."""
    growth_rate: float
    """Largest positive real part, 1/s; 0 if stable."""
    neutral: int
    """Number of modes without any stiffness: slack."""
    damping_rate: float
    """Largest eigenvalue of (mass matrix)^-1 (Kelvin-Voigt matrix), 1/s."""
    eigenvalues: NDArray[np.complex128]
    """spec(J) in 1/s by size: all of it if `complete`, else the ends."""
    complete: bool
    """Whether `eigenvalues` is the whole of spec(J)."""
    method: str
    """How the eigenvalues were found."""
    lines: tuple[Spectrum, ...] = ()
    """The spectrum of each line, where this one is of several."""
    modes: Modes | None = None
    """The lowest modes with their shapes, where they were asked for."""

    @property
    def stiffness_ratio(self) -> float:
        """Largest by smallest |lambda|; NaN if there is none."""
        return self.largest_eigenvalue / self.smallest_eigenvalue if self.smallest_eigenvalue > 0.0 else math.nan

    @property
    def stable_step(self) -> float:
        """Largest stable step of the Verlet method of splitting.py, s: (omega dt)^2 / 4 + damping_rate dt = 1.

        That is 2 / omega without Kelvin-Voigt damping, whose force is taken at extrapolated velocities, and
        1 / damping_rate where it prevails. Drag costs nothing. A load that comes to ride on a node makes links as short
        as half a link, which raises omega by up to 13 % and the damping rate by up to 28 %.
        """
        rate = self.damping_rate + math.hypot(self.damping_rate, self.highest_frequency)
        return 2.0 / rate if rate > 0.0 else math.inf

    @property
    def character(self) -> str:
        """In a word: oscillatory-stiff, damped, dissipatively stiff; or unstable; or empty."""
        if not self.unknowns:
            return "empty"
        if self.unstable:
            return "unstable"
        if self.imaginary:
            return "oscillatory-stiff"
        return "dissipatively stiff" if self.fastest_damping_ratio >= 1.0 else "damped"

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain numbers with units in the names, for JSON; None for values that are not finite."""
        ratio, step = self.stiffness_ratio, self.stable_step
        out: dict[str, Any] = {
            "line": self.name,
            "unknowns": self.unknowns,
            "character": self.character,
            "lowest_frequency_rad_per_s": self.lowest_frequency,
            "lowest_frequency_hz": self.lowest_frequency / math.tau,
            "highest_frequency_rad_per_s": self.highest_frequency,
            "highest_frequency_hz": self.highest_frequency / math.tau,
            "slowest_damping_ratio": self.slowest_damping_ratio,
            "fastest_damping_ratio": self.fastest_damping_ratio,
            "largest_damping_ratio": self.largest_damping_ratio,
            "smallest_eigenvalue_per_s": self.smallest_eigenvalue,
            "largest_eigenvalue_per_s": self.largest_eigenvalue,
            "stiffness_ratio": ratio if math.isfinite(ratio) else None,
            "imaginary": self.imaginary,
            "real_branches": self.real_branches,
            "unstable_eigenvalues": self.unstable,
            "growth_rate_per_s": self.growth_rate,
            "neutral_modes": self.neutral,
            "damping_rate_per_s": self.damping_rate,
            "stable_verlet_step_s": step if math.isfinite(step) else None,
            "eigenvalues_are_complete": self.complete,
            "eigenvalues_per_s": {"real": self.eigenvalues.real.tolist(), "imaginary": self.eigenvalues.imag.tolist()},
            "method": self.method,
        }
        if self.modes is not None:
            out["modes"] = [
                {"frequency_rad_per_s": omega, "frequency_hz": omega / math.tau, "damping_ratio": ratio, "shape": name}
                for omega, ratio, name in self._named_modes()
            ]
        if self.lines:
            out["lines"] = [line.as_dict() for line in self.lines]
        return out

    def table(self) -> list[tuple[str, str]]:
        """What to print: names and values with units."""
        said = {
            "unstable": f"unstable (compression): {self.unstable} growing, the fastest with {self.growth_rate:.5g} 1/s",
            "oscillatory-stiff": "imaginary: undamped, oscillatory-stiff",
            "damped": "damped oscillations" + (", some modes do not oscillate" if self.real_branches else ""),
            "dissipatively stiff": "real negative branches: dissipatively stiff",
            "empty": "empty: no node is free",
        }
        rows = [
            ("line", self.name),
            ("unknowns of J", f"{self.unknowns}"),
            ("spectrum", said[self.character]),
            ("lowest frequency", _frequency(self.lowest_frequency)),
            ("highest frequency", _frequency(self.highest_frequency)),
            ("damping ratio of the slowest mode", f"{self.slowest_damping_ratio:.5g}"),
            ("damping ratio of the fastest mode", f"{self.fastest_damping_ratio:.5g}"),
            ("largest damping ratio", f"{self.largest_damping_ratio:.5g}"),
            ("stiffness ratio", f"{self.stiffness_ratio:.5g}"),
            ("largest damping rate", f"{self.damping_rate:.5g} 1/s"),
            ("stable Verlet step", f"{self.stable_step:.5g} s"),
            ("method", self.method),
        ]
        if self.neutral:
            rows.insert(3, ("modes without stiffness", f"{self.neutral}"))
        rows += self._mode_rows()
        for line in self.lines:
            rows += [("", ""), *line.table()]
        return rows

    def _named_modes(self) -> list[tuple[float, float, str]]:
        """Angular frequency in rad/s, damping ratio and name of every mode with a shape."""
        assert self.modes is not None
        found = zip(self.modes.frequency.tolist(), self.modes.ratio.tolist(), mode_names(self.modes), strict=True)
        return list(found)

    def _mode_rows(self) -> list[tuple[str, str]]:
        """The lowest modes, one in each row."""
        if self.modes is None or not len(self.modes.frequency):
            return []
        named = self._named_modes()
        rows = [("", ""), ("mode", f"{'frequency':>12}  {'period':>12}  {'damping ratio':>13}  shape")]
        for number, (omega, ratio, name) in enumerate(named[:LISTED], 1):
            period = f"{math.tau / omega:.5g} s" if omega > 0.0 else "–"
            damping = ratio if ratio > ROUNDING else 0.0
            row = f"{f'{omega / math.tau:.5g} Hz':>12}  {period:>12}  {damping:>13.3g}  {name}"
            rows.append((str(number), row.rstrip()))
        if len(named) > LISTED:
            rows.append(("", f"the lowest {LISTED} of {len(named)} modes computed; --json lists all of them"))
        return rows


def _frequency(omega: float) -> str:
    return f"{omega:.6g} rad/s = {omega / math.tau:.6g} Hz"
