"""Strips of heads beside the links of the contact wires that they press on."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.overlap import course_of
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts

_LINKS = 2.0
"""Between two strips, at least: nearer by, the one stands in what the mesh leaves out around the other one."""


def check_strips(parts: Parts) -> Iterator[Finding]:
    """Find strips that are so close together that the wire yields to each as if the other one were not there."""
    for name, load in parts.loads.items():
        spacing = load.head.spacing if isinstance(load, Pantograph) and load.head is not None else None
        if load is None or spacing is None or load.on not in parts.overhead:
            continue
        for key in course_of(parts.overhead, load.on):
            line = parts.overhead[key]
            if line is not None and spacing < _LINKS * line.element * (1.0 - 1e-9):
                wrong = f"the strips are less than {_LINKS:g} links of the contact wire of {key} apart"
                remedy = f"write overhead_lines.{key}.element: {spacing / _LINKS:.4g} m or less"
                yield Finding(("loads", name, "head", "spacing"), wrong, f"{spacing:g} m", remedy)
