"""Published pantographs and the mean contact forces that standards ask for, by name.

Where a number comes from: F, found in a public secondary source; R, recalled, not seen in the standard's own text.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Published:
    """Masses on springs, from the base to the head, and the force that goes with them."""

    masses: tuple[float, ...]  # kg
    stiffness: tuple[float, ...]  # N/m, of the spring below each mass
    damping: tuple[float, ...]  # N s/m, parallel to each spring
    contact_stiffness: float  # N/m
    force: float | str  # N, static force on the lowest mass, or the name of a mean force
    source: str


PUBLISHED = {
    "en50318-2002": Published(
        (15.0, 7.2), (50.0, 4200.0), (90.0, 10.0), 50e3, 120.0,
        "EN 50318:2002 reference model (F; static force R, checked by an independent calculation)",
    ),
    "simple-ac": Published(
        (6.0, 9.0, 7.5), (160.0, 15500.0, 7000.0), (100.0, 0.1, 45.0), 50e3, "ac",
        "benchmark of Bruni et al. (2015), taken up by EN 50318:2018 (masses and springs F; dampers and contact R)",
    ),
}  # fmt: skip

_GROWTH = 0.00097  # N/(km/h)^2
TARGETS = {"ac": 70.0, "dc_3kv": 110.0, "dc_1.5kv": 140.0}
"""Mean contact force at standstill in N, by the kind of current (F)."""


def mean_force(target: str, speed: float) -> float:
    """Wanted mean contact force in N: 0.00097 v^2 + constant, with v in km/h.

    For AC it is stated above 200 km/h only; it is used below as well.

    Args:
        target: a key of TARGETS.
        speed: m/s.
    """
    return _GROWTH * (3.6 * speed) ** 2 + TARGETS[target]
