"""Lines as the linear theory sees them: strings or beams along their chords."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.law import tension as tension_of
from ropewalk.model.line import Line
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.solve.start import PreparedRun
from ropewalk.theory import beam

# A line that hangs further through than this part of its chord is none of small deflections.
_SHALLOW = 1.0 / 8.0
# Terms of the series for the sag of a beam under its own weight: they fall with the fifth power.
_SAG_TERMS = 201


@dataclass(frozen=True)
class Chord:
    """A line as the theory sees it."""

    start: Array  # (axis,) m
    along: Array  # (axis,) unit vector
    across: Array  # (axis - 1, axis) unit vectors, the first one downwards
    length: float  # m, of the chord
    material: float  # m, unstrained
    tension: float  # N
    mass: float  # kg/m, per length of the chord
    bending_stiffness: float  # N m^2
    foundation: float  # N/m^2
    damping: float  # N s/m^2
    retardation: float = 0.0  # s, beta of Rayleigh damping

    @property
    def is_string(self) -> bool:
        return self.bending_stiffness == 0.0

    @property
    def beam(self) -> dict[str, Any]:
        """The arguments that describe it as a beam."""
        return {
            "length": self.length, "bending_stiffness": self.bending_stiffness, "mass": self.mass,
            "tension": self.tension, "foundation": self.foundation, "damping": self.damping,
        }  # fmt: skip

    def sag(self, x: Array, gravity: Array) -> Array:
        """Deflection under its own weight across the chord, (place, axis) m."""
        weight = self.mass * float(gravity @ self.across[0])
        if weight == 0.0:
            return np.zeros((x.size, self.along.size))
        if self.is_string:
            depth = weight * x * (self.length - x) / (2.0 * self.tension)
        else:
            k, amplitude = self._sag_of_beam(weight)
            depth = amplitude @ np.sin(np.outer(k, x))
        return np.asarray(depth[:, None] * self.across[0])

    def _sag_of_beam(self, weight: float) -> tuple[Array, Array]:
        """Wave numbers and amplitudes of the sag under a weight per length."""
        k: Array = np.asarray(np.arange(1, _SAG_TERMS + 1, 2) * np.pi / self.length)
        stiffness = self.bending_stiffness * k**4 + self.tension * k**2 + self.foundation
        return k, 4.0 * weight / (self.length * k * stiffness)

    def strain(self, gravity: Array) -> float:
        """Mean strain of a beam with its sag."""
        k, amplitude = self._sag_of_beam(self.mass * float(gravity @ self.across[0]))
        return self.length / self.material * (1.0 + 0.25 * float(((amplitude * k) ** 2).sum())) - 1.0

    def point(self, x: Array, gravity: Array) -> Array:
        """Places on the chord with its sag, (place, axis) m."""
        return np.asarray(self.start + x[:, None] * self.along + self.sag(x, gravity))


def chords(setting: PreparedRun, scenario: Scenario, run_info: RunInfo) -> list[Chord]:
    """The lines as strings or beams along their chords; remarks go to the account.

    Raises:
        EquilibriumError: a line is slack: it has no tension to work with.
    """
    found = []
    for s, (name, line) in enumerate(scenario.lines.items()):
        rest = setting.bare[s]
        start, end = setting.ends[s].place
        length = float(np.linalg.norm(end - start))
        material = float(setting.strands.links[s] * setting.strands.h[s])
        tension = float(rest.tension.mean()) if rest is not None else 0.0
        if line.bending_stiffness == 0.0 and not tension > 0.0:
            raise EquilibriumError(
                f"line {name}: the linear theory requires a tension in equilibrium; write tension, or a shorter length"
            )
        along = (end - start) / length
        down = np.zeros_like(along)
        down[-1] = -1.0
        down -= (down @ along) * along
        if np.linalg.norm(down) < 1e-9:
            down[0] = 1.0  # a vertical line: across it is sideways
        across = [down / np.linalg.norm(down)]
        if along.size == 3:
            across.append(np.cross(along, across[0]))
        mass = float(setting.strands.rho[s]) * material / length
        chord = Chord(
            start, along, np.array(across), length, material, tension, mass, line.bending_stiffness, line.foundation,
            mass * line.alpha,
            line.beta,
        )  # fmt: skip
        if not chord.is_string:
            chord = replace(chord, tension=_tension_of_beam(setting, s, name, line, chord))
        found.append(chord)
        depth = float(np.abs(found[-1].sag(np.array([0.5 * length]), setting.strands.gravity)).max())
        if depth > _SHALLOW * length:
            run_info.warnings.append(
                f"line {name} hangs {depth:.3g} m through over {length:.3g} m: too far for small deflections"
            )
        if found[-1].is_string and (line.foundation or line.alpha or line.beta):
            run_info.warnings.append(
                f"line {name}: foundation and damping of a string are left out; give bending_stiffness"
            )
    return found


def _tension_of_beam(setting: PreparedRun, s: int, name: str, line: Line, chord: Chord) -> float:
    """Tension of a beam that bears its weight: as given, or that of its length along its sag."""
    if line.tension is not None:
        return line.tension
    law, gravity = setting.strands.law[s], setting.strands.gravity

    def excess(tension: float) -> float:
        return float(tension_of(law, replace(chord, tension=tension).strain(gravity))) - tension

    straight = float(tension_of(law, chord.length / chord.material - 1.0))
    limit = beam.buckling_force(
        length=chord.length, bending_stiffness=chord.bending_stiffness, foundation=chord.foundation
    )
    if excess(straight) <= 1e-12 * limit:  # nothing sags
        if straight <= -limit:
            raise EquilibriumError(f"line {name} buckles: its compression is {-straight:.4g} N; give less length")
        return straight
    low, step = max(straight, -limit * (1.0 - 1e-9)), limit
    while excess(low + step) > 0.0:
        step *= 2.0
    return float(brentq(excess, low, low + step, xtol=1e-12 * limit, rtol=1e-14))
