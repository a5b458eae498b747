"""Overhead lines: the reference model of EN 50318:2002, sag, temperature."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.scenario.examples import examples
from ropewalk.validation.known_case import KnownCase
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.publication import Publication

EN50318 = Publication(
    "EN 50318:2002, annex A, the ranges of the reference model, as public secondary sources and comparisons of "
    "programs "
    "give them; the standard itself is not open",
    "number, title and that EN 50318:2018 supersedes it; the ranges from memory of secondary sources",
)
Range = tuple[float, float]
PUSHED = ("loads.pantograph.static_force=160 N",)
LIGHT = ("loads.pantograph.static_force=60 N",)
PUSHING = ("overhead_lines.line.droppers.pushes=100 kN/m",)
RANGES: dict[str, tuple[str, str, Range, Range, tuple[str, ...]]] = {
    "mean": ("mean contact force", "N", (110.0, 120.0), (110.0, 120.0), PUSHED),
    "deviation": ("standard deviation, 0 to 20 Hz", "N", (26.0, 31.0), (32.0, 40.0), PUSHING),
    "highest": ("mean and three deviations", "N", (190.0, 210.0), (210.0, 230.0), PUSHED),
    "lowest": ("mean less three deviations", "N", (20.0, 40.0), (-5.0, 20.0), PUSHING),
    "maximum": ("largest contact force", "N", (175.0, 210.0), (190.0, 225.0), PUSHED),
    "minimum": ("smallest contact force", "N", (50.0, 75.0), (30.0, 55.0), LIGHT),
    "uplift": ("largest uplift at a support", "mm", (48.0, 55.0), (55.0, 65.0), PUSHED),
    "loss": ("part of the time without contact", "%", (0.0, 0.0), (0.0, 0.0), ("loads.pantograph.static_force=15 N",)),
}


def collected(result: Any, name: str) -> float:
    """A statistic of the pantograph, in the unit of its row."""
    from ropewalk.results.contact_statistics import contact_statistics

    found = contact_statistics(result)["pantograph"]
    if name in ("highest", "lowest"):
        return found.mean + (3.0 if name == "highest" else -3.0) * found.deviation
    return float(getattr(found, name)) * {"uplift": 1e3, "loss": 100.0}.get(name, 1.0)


def box(name: str, column: int) -> KnownNumber:
    """A row whose reference is a range."""
    what, unit, *ranges, fault = RANGES[name]
    inside: Any = ranges[column]
    reason = "within the range"
    return KnownNumber(
        name, what, unit, "published range", lambda: inside, lambda r: collected(r, name), reason, fault=fault
    )  # fmt: skip


def sag_in_the_gap(result: Any) -> float:
    """How much lower than next to it the contact wire hangs in the gap of the missing dropper, m."""
    place = result.position.isel(time=0, node=np.flatnonzero(result.line.values == "line.contact")).values
    low, middle, high = np.interp([323.5, 330.0, 336.5], place[:, 0], place[:, -1])
    return 0.5 * float(low + high) - float(middle)


def tension_in_the_middle(result: Any) -> float:
    """Of the contact wire at the first instant, N."""
    own = result.tension.isel(time=0).values[result.link_line.values == "line.contact"]
    return float(own[own.size // 2])


CASES = (
    *(
        KnownCase(
            f"overhead-en50318-{speed}", f"The reference model of EN 50318:2002 at {speed} km/h", EN50318,
            lambda speed=speed: examples()[f"en50318-2002-{speed}"],  # type: ignore[misc]
            tuple(box(name, column) for name in RANGES), fault=PUSHED,
        )
        for column, speed in enumerate((250, 300))
    ),
    KnownCase(
        "overhead-missing-dropper", "The contact wire sags where a dropper is missing, worn by 10 %",
        Publication("a string under its weight, q L^2/(8 T)", "elementary"),
        lambda: examples()["overhead-line-missing-dropper"],
        (
            KnownNumber("sag", "sag in the gap of 13 m at rest", "m", "closed form",
                lambda: 0.9 * 1.35 * 9.81 * 13.0**2 / (8.0 * 20e3), sag_in_the_gap,
                "the bending stiffness rounds the ends of the gap off", absolute=6e-4),
        ),
        settings=("run.until=0.05 s",), fault=("overhead_lines.line.contact_wire.tension=18 kN",),
    ),
    KnownCase(
        "overhead-cold", "A line with fixed terminations becomes 30 K colder",
        Publication("a level wire that may not shorten: T + EA alpha dT", "elementary"),
        lambda: examples()["overhead-line-cold"],
        (
            KnownNumber("tension", "tension of the contact wire", "N", "closed form",
                lambda: 10e3 + 12e6 * 1.7e-5 * 30.0,
                tension_in_the_middle, "the messenger, which sags less, pulls it up a little", absolute=60.0),
        ),
        settings=("run.until=0.05 s",), fault=("overhead_lines.line.condition.temperature_rise=-33",),
    ),
)  # fmt: skip
