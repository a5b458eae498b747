"""How a motion is computed: keys of a run that its lines and loads leave no sense."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.load import ExternalModel
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic

FINEST = 1e-10
"""Part of the length of a line to which its motion can be asked for: rounding adds up to less in millions of steps."""


def check_settings(parts: Parts) -> Iterator[Finding]:
    """Find keys of a dynamic run that would be passed over."""
    run = parts.run
    if not isinstance(run, Dynamic) or not parts.is_complete or None in parts.lines.values():
        return
    if not (parts.has_bending_stiffness or parts.is_network):
        yield from _accuracy(parts, run)
    if run.start.with_loads and all(isinstance(load, ExternalModel) for load in parts.loads.values()):
        wrong = "with_loads needs loads" if parts.loads else "there are no loads"
        yield Finding(("run", "start", "with_loads"), wrong, "true", "leave it out")
    if run.start.in_wind and not parts.is_airy:
        wrong, remedy = "no wind acts on a line or load", "add wind and wind_drag of a line, or leave it out"
        yield Finding(("run", "start", "in_wind"), wrong, "true", remedy)


def _accuracy(parts: Parts, run: Dynamic) -> Iterator[Finding]:
    """An accuracy beyond rounding, or coarser than the lines are long."""
    lengths = [line.length or line.distance for line in parts.lines.values() if line is not None]
    if run.accuracy is None or not lengths:
        return
    finest, coarsest = FINEST * max(lengths), max(lengths)
    if not finest <= run.accuracy <= coarsest:
        small = run.accuracy < finest
        wrong = "finer than rounding lets positions be" if small else "coarser than the longest line is long"
        remedy = f"write {finest:.3g} m to {coarsest:.3g} m"
        yield Finding(("run", "accuracy"), wrong, f"{run.accuracy:g} m", remedy)
