"""The figures of the paper "Walking the Line. Traveling Forces vs Moving Masses", computed and drawn anew."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path

AVAILABLE: tuple[int | str, ...] = (2, 3, 4, 5, 6, 7, "bands", "softness", "linear-limits")
"""Numbers of the paper's figures that can be drawn, and names of our own."""


def figures(
    directory: Path, only: Sequence[int | str] | None = None, progress: Callable[[float], None] | None = None
) -> list[Path]:
    """Compute and draw figures of the paper, and some that go with them, as PNG files.

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
        figure = import_module(f"ropewalk.paper.{_module(name)}").draw()
        path = directory / f"figure-{name}.png"
        figure.savefig(path)
        written.append(path)
        if progress is not None:
            progress((done + 1) / len(wanted))
    return written


def _module(name: int | str) -> str:
    return f"figure{name}" if isinstance(name, int) else f"figure_{name.replace('-', '_')}"
