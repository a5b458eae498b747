"""Explicit steps that are too long for the vibration of a line on its foundation."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ropewalk.results.frame import RunInfo

if TYPE_CHECKING:
    from ropewalk.model import Scenario

_LEAD = 0.1  # rad, by which the computed vibration may lead the exact one


def phase_warnings(scenario: Scenario, run_info: RunInfo) -> Iterator[str]:
    """Warn of lines whose vibration on the foundation an explicit method computes with a phase error.

    Stoermer's method has the frequency w (1 + (w h)^2/24) for w, which is at least that of a rigid line on its
    foundation, sqrt(k/m). Damping ends the vibration, and with it the growth of the error.

    Args:
        scenario: of the run.
        run_info: with its method and step.
    """
    run, h = scenario.run, run_info.step
    if run.kind != "dynamic" or run_info.method != "explicit" or not h:
        return
    for name, line in scenario.lines.items():
        if not line.foundation:
            continue
        w = math.sqrt(line.foundation / line.mass)
        lasts, rate = run.until, 0.5 * (line.alpha + line.beta * w**2)
        if rate > 0.0:
            lasts = min(lasts, 1.0 / rate)
        lead = w * lasts * (w * h) ** 2 / 24.0
        if lead > _LEAD:
            enough = 0.9 * h * math.sqrt(_LEAD / lead)
            yield (
                f"line {name}: vibration on its foundation at {w / (2.0 * math.pi):.3g} Hz and more is computed with a "
                f"phase error of {lead:.2g} rad in steps of {h:.3g} s, and contact and support forces with it; "
                f"write run.step: {enough:.2g} s or less"
            )
