"""Values of lines that differ by orders of magnitude from those of ropes, wires and beams: likely unit mistakes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from ropewalk.model.law import Polynomial, Tabulated, Webbing
from ropewalk.model.line import Line

if TYPE_CHECKING:
    from ropewalk.model.scenario import Scenario

METAL, FASTEST = 2.7e3, 2e4  # m/s; axial waves move at 2.8 to 5 km/s in steel ropes and bars, 18 km/s in diamond
RUBBER = 200.0  # m/s; of rubber and springs they are slower
_HEAVY = 0.1  # strain by the own weight of a line that hangs vertically; less than 0.01 for ropes of 1 km
_LOOSE = 0.5  # sag over span at the given tension; lines that are given by their tension have less than 0.2
_TAUT, _TAUT_METAL = 0.5, 0.05  # given tension over axial stiffness; more than 0.1 only in rubber, 0.01 in steel
_FIRM = 1e-5  # given tension over axial stiffness; ropes have 1e-4 to 0.1
_THICK = 0.3  # radius of gyration over length; of slender beams below 0.05
_FAR = 50.0  # height of lines over the ground, over their extent in x


class StrainRange(NamedTuple):
    """Strains between which an axial law describes a line, and why."""

    low: float
    high: float
    reason: str


def strain_range(line: Line) -> StrainRange:
    """Return the strains between which the law of a line describes it."""
    law = line.law
    if isinstance(law, Tabulated):
        return StrainRange(-math.inf, law.strain[-1], "the last point of its table")
    if isinstance(law, Webbing):
        high = 3.0 * 1e4 / law.axial_stiffness
        return StrainRange(-math.inf, high, "the strain at 30 kN, where webbing breaks")
    if isinstance(law, Polynomial):
        return StrainRange(*_turning_points(law), "at which its polynomial has its maximum and the tension falls")
    if line.axial_stiffness is None:  # inextensible
        return StrainRange(-math.inf, math.inf, "")
    high, reason = known_strain(math.sqrt(line.axial_stiffness / line.mass))
    low = -math.inf if law.kind == "tension_only" else -high
    return StrainRange(max(low, -0.5) if law.kind == "second_piola_kirchhoff" else low, high, reason)


def known_strain(speed: float) -> tuple[float, str]:
    """Return the strain up to which a linear law holds, and why.

    Args:
        speed: of axial waves, root of axial stiffness over mass, m/s, which tells the kind of material.
    """
    if METAL <= speed <= FASTEST:
        return 0.01, "up to which steel is elastic; EA/mass is that of steel or stiffer fibres"
    if speed >= RUBBER:
        return 0.3, "at which textile ropes and belts break"
    return 3.0, "up to which rubber is elastic"


def _turning_points(law: Polynomial) -> tuple[float, float]:
    """Return the strains next to zero at which the tension stops rising."""
    slopes = [number * c for number, c in enumerate(law.coefficients, start=1)]

    def slope(strain: float) -> float:
        return sum(c * strain**power for power, c in enumerate(slopes))

    def turning(sign: float) -> float:
        grid = (sign * 10.0 ** (-4.0 + 0.005 * i) for i in range(1001))
        return next((strain for strain in grid if slope(strain) <= 0.0), sign * math.inf)

    return turning(-1.0), turning(1.0)


def implausible(scenario: Scenario) -> Iterator[str]:
    """Yield warnings about values with likely mistakes of units, with the key and the remedy."""
    run = scenario.run
    small = run.kind == "linear" or (run.kind == "dynamic" and run.geometry == "linearised")
    for name, line in scenario.lines.items():
        if not (small and line.has_bending_stiffness):  # whose axial stiffness is not used
            yield from (f"lines.{name}.{text}" for text in _of_line(line, scenario.gravity))
    if run.kind == "dynamic" or run.kind == "linear":
        yield from _of_waves(scenario)
    yield from _of_ground(scenario)


def _of_line(line: Line, gravity: float) -> Iterator[str]:
    """Yield warnings about a line that begin with its key."""
    EA, length = _axial_stiffness(line), line.length or line.distance
    weight, tension = line.mass * gravity * length, line.tension
    if EA is not None:
        strain, speed = (tension or 0.0) / EA, math.sqrt(EA / line.mass)
        if strain > (_TAUT_METAL if METAL <= speed <= FASTEST else _TAUT):
            yield (
                f"tension: {tension:.4g} N stretches the line by {100.0 * strain:.3g} %, for its axial stiffness is "
                f"{EA:.4g} N; check the units of tension and axial_stiffness (N, kN or MN)"
            )
        if weight > _HEAVY * EA:
            yield (
                f"mass: hung up vertically the line would stretch by {100.0 * weight / EA:.3g} % under its own weight "
                f"of {weight:.4g} N; check the units of mass (g/m or kg/m) and axial_stiffness (N, kN or MN)"
            )
        if tension is not None and not line.has_bending_stiffness and speed > 1e4 and tension < _FIRM * EA:
            yield (
                f"axial_stiffness: {EA:.4g} N is {EA / tension:.3g} times the tension, and axial waves would move at "
                f"{1e-3 * speed:.3g} km/s, in steel at 5 km/s; check the units of axial_stiffness, mass and tension"
            )
        if line.bending_stiffness and (radius := math.sqrt(line.bending_stiffness / EA)) > _THICK * length:
            yield (
                f"bending_stiffness: with EA = {EA:.4g} N the radius of gyration is {radius:.3g} m on a length of "
                f"{length:.4g} m; check the units of bending_stiffness (N*m^2) and axial_stiffness (N)"
            )
    if tension is not None and not line.has_bending_stiffness and weight > 8.0 * _LOOSE * tension:
        yield (
            f"tension: {tension:.4g} N bears a weight of {weight:.4g} N only with a sag of about "
            f"{weight / (8.0 * tension):.3g} times the span; check the units of tension (N, kN) and mass (g/m, kg/m)"
        )


def _of_waves(scenario: Scenario) -> Iterator[str]:
    """Yield warnings about lines and hangers in which waves are faster than in any material."""
    lines = {f"lines.{name}": (_axial_stiffness(line), line.mass) for name, line in scenario.lines.items()}
    rows = {f"hangers.{name}": (row.axial_stiffness, row.mass) for name, row in scenario.hangers.items()}
    for key, (EA, mass) in (lines | rows).items():
        if EA is not None and (speed := math.sqrt(EA / mass)) > FASTEST:
            yield (
                f"{key}.mass: with {mass:.4g} kg/m and an axial stiffness of {EA:.4g} N axial waves would move at "
                f"{1e-3 * speed:.3g} km/s, in steel at 5 km/s and in no material above 20 km/s; check the units of "
                "mass (g/m or kg/m) and axial_stiffness (N, kN or MN), unless a line without mass or strain is meant"
            )


def _axial_stiffness(line: Line) -> float | None:
    """Return EA in N, of a table that up to its last point; None of an inextensible line."""
    if isinstance(line.law, Webbing):
        return line.law.axial_stiffness
    if isinstance(line.law, Tabulated):
        strain, tension = line.law.strain[-1], line.law.tension[-1]
        return tension / strain if tension > 0.0 and strain > 0.0 else None
    return line.law.coefficients[0] if isinstance(line.law, Polynomial) else line.axial_stiffness


def _of_ground(scenario: Scenario) -> Iterator[str]:
    ends = [end for line in scenario.lines.values() for end in (line.start, line.end)]
    if not scenario.outputs.ground or not ends:
        return
    extent = max(end[0] for end in ends) - min(end[0] for end in ends)
    over = min(end[-1] for end in ends) - max(point[-1] for point in scenario.outputs.ground)
    if over > _FAR * extent > 0.0:
        yield (
            f"outputs.ground: lines of {extent:.4g} m are {over:.4g} m or more above the ground; check the unit: x and "
            "z are in m (divide values in mm by 1000)"
        )
