"""The figures of the paper "Walking the Line. Traveling Forces vs Moving Masses", computed and drawn anew."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path

AVAILABLE = (2, 3, 4, 5, 6, 7)
"""Numbers of the figures that can be drawn."""


def figures(
    directory: Path, only: Sequence[int] | None = None, progress: Callable[[float], None] | None = None
) -> list[Path]:
    """Compute and draw figures of the paper as PNG files.

    Args:
        directory: folder to write to; made if it does not exist.
        only: out of AVAILABLE; None means all.
        progress: called with the part that is done, 0 to 1.

    Returns:
        The files written.
    """
    directory.mkdir(parents=True, exist_ok=True)
    wanted, written = list(only) if only is not None else list(AVAILABLE), []
    for done, name in enumerate(wanted):
        figure = import_module(f"ropewalk.paper.figure{name}").draw()
        path = directory / f"figure-{name}.png"
        figure.savefig(path)
        written.append(path)
        if progress is not None:
            progress((done + 1) / len(wanted))
    return written
