"""What several cases measure in a result."""

from __future__ import annotations

from typing import Any

import numpy as np


def deflection(result: Any, place: float, time: float | None = None) -> float:
    """How deep the particle at a material place in m is at an instant in s, or at last, m."""
    z = result.position.sel(axis="z").to_numpy()
    row = z[-1] if time is None else np.array([np.interp(time, result.time, column) for column in z.T])
    return -float(np.interp(place, result.xi, row))


def deepest(result: Any, place: float) -> float:
    """How deep the particle at a material place in m comes, m."""
    z = result.position.sel(axis="z").to_numpy()
    return -float(min(np.interp(place, result.xi, row) for row in z))


def contact_force(result: Any, time: float, contact: int = 0) -> float:
    """Force downwards of a contact on its line at an instant in s, N."""
    return float(np.interp(time, result.time, -result.contact_force.sel(axis="z", contact=contact)))


def contact_depth(result: Any, time: float, contact: int = 0) -> float:
    """How deep a contact is at an instant in s, m."""
    return float(np.interp(time, result.time, -result.contact_position.sel(axis="z", contact=contact)))


def of_line(result: Any, owner: str, quantity: str, which: str = "max") -> float:
    """A largest value that the summary tells of a line or a place."""
    from ropewalk.results import summary

    found = summary(result)["lines"][owner][quantity][which]
    return float(found["value"] if isinstance(found, dict) else found)


def acceleration(result: Any, coordinate: int = 0) -> Any:
    """Acceleration up of a coordinate of the first body, from differences of the second order, m/s^2."""
    place = result.coordinate.to_numpy()[:, coordinate] if "coordinate" in result else result.body_position.to_numpy()
    dt = float(result.time[1] - result.time[0])
    return (place[2:] - 2.0 * place[1:-1] + place[:-2]) / dt**2
