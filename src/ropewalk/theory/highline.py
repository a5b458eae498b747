"""Highline: an elastic webbing without weight, taut between level anchors, and a person who stands on it.

The webbing is two straight pieces. Its data are those of the sport: the stretch at a tension of 10 kN, and the standing
tension, that of the line with nobody on it. Small vibrations of the standing person, a mass clamped to the webbing:
each piece gives ``T'/l`` along it with ``T' l_0 = EA``, l_0 its unstrained length, and ``T/l`` across it. Derived here.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.theory import _arguments, rope

__all__ = ["Stance", "axial_stiffness", "stand", "unstrained_length"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Stance:
    """A person standing: ``position`` (x, z) in m from the first anchor, z upwards, ``tensions`` behind and ahead in N.

    The frequencies in Hz are of small vibrations: ``bounce_frequency`` mostly up and down, ``surge_frequency`` mostly
    along the line, ``sway_frequency`` to the side, as a pendulum about the line through the anchors. ``bounce_mode`` is
    the direction (x, z) of the bounce, of length 1, upwards.
    """

    position: FloatArray
    tensions: FloatArray
    bounce_frequency: float
    surge_frequency: float
    sway_frequency: float
    bounce_mode: FloatArray

    @property
    def sag(self) -> float:
        """Return how far the person stands below the anchors, in m."""
        return float(-self.position[1])


def axial_stiffness(stretch: float, *, at: float = 10e3) -> float:
    """Return EA in N of a webbing that is longer by the share ``stretch`` (0.18 for 18 %) at the tension ``at`` in N.

    `ValueError` unless both are positive. Linear from zero; real webbings are stiffer in quick motion than at rest.
    """
    _arguments.positive(stretch=stretch, at=at)
    return at / stretch


def unstrained_length(*, span: float, standing_tension: float, stiffness: float) -> float:
    """Return the length of the webbing without tension in m, ``span/(1 + standing_tension/EA)``.

    ``span`` in m, ``standing_tension`` in N, 0 or more, ``stiffness`` EA in N. `ValueError` out of range.
    """
    _arguments.positive(span=span, stiffness=stiffness)
    _arguments.not_negative(standing_tension=standing_tension)
    return span / (1.0 + standing_tension / stiffness)


def stand(
    *,
    span: float,
    standing_tension: float,
    stiffness: float,
    mass: float,
    place: float = 0.5,
    gravity: float = 9.81,
) -> Stance:
    """Return how a person of ``mass`` (kg) stands on a highline, and the frequencies of small vibrations.

    Args:
        span: between the anchors, m.
        standing_tension: of the line with nobody on it, N, 0 or more.
        stiffness: EA of the webbing in N, see `axial_stiffness`.
        mass: kg; the webbing has none.
        place: share of the webbing behind the person, between 0 and 1; 0.5 in the middle.
        gravity: m/s^2.

    Returns:
        The stance. The feet are clamped: away from the middle the tensions differ and friction holds the difference.
        No piece is ever slack, as the webbing is no longer than the span.

    Raises:
        ValueError: an argument out of range.
    """
    _arguments.positive(mass=mass, gravity=gravity)
    length = unstrained_length(span=span, standing_tension=standing_tension, stiffness=stiffness)
    if not 0.0 < place < 1.0:
        raise ValueError(f"place must lie between 0 and 1, not {place}")
    weight = mass * gravity
    resting = rope.weightless_elastic(
        span=span, length=length, axial_stiffness=stiffness, loads=[(place * length, (0.0, -weight))]
    )
    position, tensions = resting.load_positions[0], resting.load_tensions[0]
    segments = np.array([position, [span, 0.0] - position])
    lengths = np.hypot(segments[:, 0], segments[:, 1])
    tangents = segments / lengths[:, np.newaxis]
    along, across = stiffness / (length * np.array([place, 1.0 - place])), tensions / lengths
    dyads = tangents[:, :, np.newaxis] * tangents[:, np.newaxis, :]
    matrix = np.tensordot(across, np.eye(2) - dyads, 1) + np.tensordot(along, dyads, 1)
    squares, modes = np.linalg.eigh(matrix / mass)
    frequencies = np.sqrt(squares) / (2.0 * np.pi)
    bounce = int(np.argmax(np.abs(modes[1])))
    return Stance(
        position=position,
        tensions=tensions,
        bounce_frequency=float(frequencies[bounce]),
        surge_frequency=float(frequencies[1 - bounce]),
        sway_frequency=float(np.sqrt(np.sum(across) / mass) / (2.0 * np.pi)),
        bounce_mode=modes[:, bounce] * np.sign(modes[1, bounce]),
    )
