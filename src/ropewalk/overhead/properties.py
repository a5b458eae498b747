"""What an overhead line is good for before anything runs along it: elasticity, factors of its waves, blow-off.

With wave speeds c, tensions T and masses per length m of contact wire (c) and messenger (m), in the usual notation:

    non-uniformity    u = (e_max - e_min) / (e_max + e_min), of the elasticities along a span
    reflection        r = sqrt(T_m m_m) / (sqrt(T_c m_c) + sqrt(T_m m_m)), of a wave at a dropper that pulls
    Doppler factor    D = (c - v) / (c + v), of a pantograph's speed v
    amplification     r / D

Source: F. Kiessling, R. Puschmann, A. Schmieder, E. Schneider, Contact Lines for Electric Railways (from memory).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.scenario import Scenario
from ropewalk.overhead.lateral import blown_off, on_the_strip, radial_forces
from ropewalk.overhead.plan_view import CONTACT, MESSENGER
from ropewalk.overhead.section import Section, elasticity, section_of
from ropewalk.wires.plan import Array, Wire

STATIONS = 25  # along a span


@dataclass(frozen=True)
class Elasticity:
    """Rise of the contact wire per force along a span."""

    force: float  # N
    station: Array  # m
    value: Array  # (station,) m/N

    @property
    def least(self) -> float:
        """The least along the span, m/N."""
        return float(self.value.min())

    @property
    def largest(self) -> float:
        """The largest along the span, m/N."""
        return float(self.value.max())

    @property
    def non_uniformity(self) -> float:
        """Half of their difference over their mean."""
        return (self.largest - self.least) / (self.largest + self.least)


def elasticity_of(section: Section, force: float = 100.0, span: int | None = None) -> Elasticity:
    """Find the elasticity along a span, wires at constant tension, droppers slackening as they are relieved.

    Args:
        section: the line at rest.
        force: upwards on the contact wire, N.
        span: counted from 1 (default: the first analysed one).

    Raises:
        EquilibriumError: the line has no rest, or no such span.
    """
    count = section.supports.size - 1
    span = int(np.searchsorted(section.supports, section.analysed[0])) + 1 if span is None else span
    if not 1 <= span <= count:
        raise EquilibriumError(f"overhead line {section.name} has no span {span}; write 1 to {count}")
    begin, end = section.supports[span - 1], section.supports[span]
    inner = np.linspace(begin, end, STATIONS)[int(span == 1) : STATIONS - int(span == count)]  # ends do not move
    return Elasticity(force, *elasticity(section, force, stations=inner))


def wave_speed(wire: Wire) -> float:
    """Speed of long waves, sqrt(T / m), m/s."""
    return math.sqrt(wire.tension / wire.mass)


def reflection(contact: Wire, messenger: Wire) -> float:
    """Reflection coefficient of a wave along the contact wire at a dropper that pulls."""
    below, above = (math.sqrt(wire.tension * wire.mass) for wire in (contact, messenger))
    return above / (below + above)


def doppler_factor(contact: Wire, speed: float) -> float:
    """Doppler factor of a pantograph; negative if it is faster than the waves.

    Args:
        contact: the contact wire.
        speed: m/s.
    """
    c = wave_speed(contact)
    return (c - abs(speed)) / (c + abs(speed))


def properties(
    scenario: Scenario, force: float = 100.0, span: int | None = None, load: float = 0.0
) -> dict[str, dict[str, Any]]:
    """Give what is known of every overhead line of a scenario, by name, in SI units, as plain values for JSON.

    Args:
        scenario: with overhead lines.
        force: of the elasticity, N.
        span: along which it is found, counted from 1 (default: the first analysed one).
        load: of the wind on the contact wire, level and across it, N/m; 0: none.
    """
    out: dict[str, dict[str, Any]] = {}
    for name, line in scenario.overhead_lines.items():
        section = section_of(name, line, scenario.gravity)
        contact, messenger = section.plan.wires[CONTACT], section.plan.wires[MESSENGER]
        found, r = elasticity_of(section, force, span), reflection(contact, messenger)
        speeds = {
            key: abs(p.travel.speed)
            for key, p in scenario.loads.items()
            if isinstance(p, Pantograph) and p.on == name and isinstance(p.travel.speed, float)
        }
        factors = {key: doppler_factor(contact, v) for key, v in speeds.items()}
        edges, share = on_the_strip(line)
        out[name] = {
            "elasticity": {
                "force": force, "station": found.station.tolist(), "value": found.value.tolist(),
                "least": found.least, "largest": found.largest, "non_uniformity": found.non_uniformity,
            },
            "wave_speed": {"contact": wave_speed(contact), "messenger": wave_speed(messenger)},
            "tension": {"contact": contact.tension, "messenger": messenger.tension},
            "reflection": r,
            "pantographs": {
                key: {"speed": speeds[key], "doppler": D, "amplification": r / D if D > 0.0 else None}
                for key, D in factors.items()
            },
            "wind_deflection": {"load": load, "value": blown_off(line, load)},
            "strip": {"edges": edges.tolist(), "share": share.tolist()},
            "arms": {f"{name}.arm.{i}": float(F) for i, F in enumerate(radial_forces(line), start=1)},
        }  # fmt: skip
    return out
