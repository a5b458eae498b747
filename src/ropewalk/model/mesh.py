"""The mesh: what its error, or a number of elements that is to be found, does not go with."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.load import ExternalModel
from ropewalk.model.net import Net
from ropewalk.model.parts import Parts
from ropewalk.model.quantity import AUTO, Auto
from ropewalk.model.run import Dynamic, Linear, Quasistatic

PARTS = 4
"""How many times the elements of the coarsest mesh the finest has: the number has to be divided by it."""
FEWEST, OF_BEAMS = 2, 5
"""Links, or cells, of the coarsest mesh; of lines with bending stiffness, whose splines go through six nodes."""


def is_asked_for(parts: Parts) -> bool:
    """Whether a scenario asks for the error of its mesh, or for a mesh."""
    run = parts.run
    return run is not None and not isinstance(run, Linear) and (run.mesh_error or parts.is_auto)


def check_mesh(parts: Parts) -> Iterator[Finding]:
    """Find what asks for the error of a mesh, or for an accuracy, and cannot have it."""
    run = parts.run
    if run is None or None in parts.lines.values():
        return
    if parts.is_auto:
        yield from _auto(parts)
    elif not isinstance(run, Dynamic | Linear) and run.accuracy is not None:
        remedy = f"write elements: {AUTO} of all lines, or leave it out"
        yield Finding(("run", "accuracy"), f"is for elements: {AUTO}", f"{run.accuracy:g} m", remedy)
    if parts.is_auto or (not isinstance(run, Linear) and run.mesh_error):
        yield from _alone(parts)
    if not isinstance(run, Linear) and run.mesh_error and not parts.is_auto:
        yield from _subdivided(parts)


def _auto(parts: Parts) -> Iterator[Finding]:
    """What elements: auto needs, and what it leaves alone."""
    run, lines = parts.run, parts.lines
    if isinstance(run, Linear):
        wrong, remedy = "is determined from geometrically nonlinear equilibria and motions", "write a number"
        for name in _with_auto(parts):
            yield Finding(("lines", name, "elements"), wrong, AUTO, remedy)
    elif run is not None and run.accuracy is None:
        remedy = "add accuracy (target for positions, compared with the continuum, in m)"
        yield Finding(("run", "accuracy"), f"is required by elements: {AUTO}", remedy=remedy)
    for name, line in lines.items():
        if line is not None and not isinstance(line.elements, Auto):
            wrong, remedy = f"is a number where that of others is {AUTO}", f"write {AUTO} for all lines or for none"
            yield Finding(("lines", name, "elements"), wrong, str(line.elements), remedy)
    for block, there in (("nets", parts.nets), ("overhead_lines", parts.overhead)):
        if there:
            wrong, remedy = f"have no elements: {AUTO}", "write numbers for all lines, and mesh_error: true"
            yield Finding((block,), wrong, ", ".join(there), remedy)


def _with_auto(parts: Parts) -> Iterator[str]:
    return (name for name, line in parts.lines.items() if line is not None and isinstance(line.elements, Auto))


def _alone(parts: Parts) -> Iterator[Finding]:
    """What cannot be computed on several meshes."""
    run, what = parts.run, "is not computed on several meshes"
    for name, load in parts.loads.items():
        if isinstance(load, ExternalModel):
            remedy = "write elements as a number, and leave mesh_error out"
            yield Finding(("loads", name, "kind"), f"an external model {what}", load.kind, remedy)
    if isinstance(run, Dynamic) and run.start.kind == "result":
        remedy = "write elements as a number, leave mesh_error out, or begin in equilibrium"
        yield Finding(("run", "start", "kind"), f"a state that is on one mesh {what}", "result", remedy)
    if isinstance(run, Quasistatic) and run.turn is not None:
        remedy = "leave turn out, or write elements as a number and leave mesh_error out"
        yield Finding(("run", "turn"), f"a path with mesh-dependent positions {what}", f"{run.turn:g}", remedy)


def _subdivided(parts: Parts) -> Iterator[Finding]:
    """Numbers of elements that have no half and no quarter."""
    for name, line in parts.lines.items():
        if line is not None:
            yield from _one(
                ("lines", name, "elements"), line.elements, OF_BEAMS if line.has_bending_stiffness else FEWEST
            )
    for name, net in parts.nets.items():
        if net is None:
            continue
        if net.cells is None:
            wrong = "is required by mesh_error" if net.boundary is None else "an outline has one mesh only"
            remedy = "add cells (along both sides)" if net.boundary is None else "leave mesh_error out"
            yield Finding(("nets", name, "cells" if net.boundary is None else "boundary"), wrong, remedy=remedy)
            continue
        for cells in net.cells:
            yield from _one(("nets", name, "cells"), cells, FEWEST)
        if isinstance(net, Net) and net.mesh is None:
            wrong = "is required: without it threads coincide with the edges of cells, which cannot be refined"
            yield Finding(("nets", name, "mesh"), wrong, remedy="add mesh (distance of the threads), or no mesh_error")


def _one(path: tuple[str, ...], number: int, coarsest: int) -> Iterator[Finding]:
    least = coarsest * PARTS
    if number % PARTS or number < least:
        near = max(least, number - number % PARTS)
        remedy = f"write {near} or {near + PARTS}, or leave mesh_error out"
        yield Finding(path, f"mesh_error needs a number that {PARTS} divides, {least} or more", str(number), remedy)
