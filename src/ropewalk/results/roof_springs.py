"""Pantographs whose lowest spring, which stands on the roof, is as stiff as those of heads are."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ropewalk.model.pantograph import Pantograph

if TYPE_CHECKING:
    from ropewalk.model import Scenario

# Frames have 0 to some 200 N/m there, heads 2 to 20 kN/m. With 1 kN/m a wire 10 cm higher is pressed by 100 N less.
_STIFF = 1e3  # N/m


def stiff_below(scenario: Scenario) -> Iterator[str]:
    """The pantographs of a scenario that stand on such a spring, in words."""
    for name, load in scenario.loads.items():
        if isinstance(load, Pantograph) and load.stiffness and load.stiffness[0] >= _STIFF:
            yield (
                f"pantograph {name} stands on a spring of {load.stiffness[0]:.4g} N/m on the roof, the first of its "
                "stiffness: its contact force decreases with the height of the wire, and its mean force is not the "
                "static one; write 0 to some 200 N/m there, as frames have, and the spring of the head last"
            )
