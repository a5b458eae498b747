"""A run compared, frame by frame, with the same on coarser meshes."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array
from ropewalk.meshes.estimate import Estimate
from ropewalk.meshes.samples import Samples, places_of
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Layout, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.running import Run

Start = Callable[[Scenario, RunInfo], Run]
"""Gives a run of a scenario, and fills in how it goes."""


@dataclass(frozen=True)
class MeshRun:
    """Stored part of a run on one mesh.

    Args:
        size: of its links, in parts of all lines, or of its cells, in parts of a net.
        places: what its nodes are on any mesh.
        samples: where points were.
        contacts: their number.
    """

    size: float
    places: dict[Hashable, int]
    samples: Samples
    contacts: int

    @classmethod
    def of(cls, layout: Layout, scenario: Scenario, coarser: Sequence[MeshRun]) -> MeshRun:
        """A mesh before its run.

        Args:
            layout: of the run.
            scenario: of the run.
            coarser: the first of them has the nodes that are the points; without any it is itself.
        """
        links, cells = len(layout.link_line), len(layout.cell)
        places = places_of(layout, scenario)
        samples = Samples.at(coarser[0].places if coarser else places, places)
        return cls(1.0 / links if links else cells**-0.5, places, samples, len(layout.contact_load))


def computed(scenario: Scenario, start: Start, coarser: Sequence[MeshRun]) -> MeshRun:
    """Run a scenario and keep of it what estimates need.

    Args:
        scenario: on a mesh.
        start: gives its run.
        coarser: meshes that are known, the coarsest first.

    Raises:
        RopewalkError: it cannot begin.
    """
    run = start(scenario, RunInfo())
    mesh = MeshRun.of(run.layout, scenario, coarser)
    for frames in run.blocks():
        for frame in frames:
            mesh.samples.add(frame)
    return mesh


def estimates(meshes: Sequence[MeshRun]) -> tuple[Estimate, Estimate | None]:
    """The errors of the finest of meshes, by the last three: of all points, and of contacts alone.

    Points are nodes of the coarsest, contacts and bodies.
    """
    coarse, middle, fine = meshes[-3:]
    sizes = coarse.size, middle.size, fine.size
    first, second = middle.samples.less(coarse.samples), fine.samples.less(middle.samples)
    nodes = fine.samples.nodes.size
    contacts = slice(nodes, nodes + fine.contacts)
    own = Estimate.of(sizes, first[:, contacts], second[:, contacts]) if fine.contacts else None
    found, until = Estimate.of(sizes, first, second), len(first) + 1
    if own is not None:
        found = replace(found, error=max(found.error, own.error))
    if until < min(len(middle.samples.outputs), len(fine.samples.outputs)):
        early = f"on a coarser mesh the run ends after {until - 1} outputs: the error is that until then"
        found = replace(found, doubt=found.doubt or early)
    return found, own


class Compared:
    """A run that is compared as it ends.

    Args:
        run: on the finest mesh.
        mesh: of it, before its run.
        coarser: of the run before, None where there is none.
        conclude: called at the end.
    """

    def __init__(self, run: Run, mesh: MeshRun, coarser: MeshRun | None, conclude: Callable[[], None]) -> None:
        self.layout, self.total = run.layout, run.total
        if coarser is not None:
            self.layout = replace(run.layout, compared=run.layout.contact_load)
        self._run, self._mesh, self._coarser, self._conclude = run, mesh, coarser, conclude

    def get_state(self) -> None:
        """Nothing to go on from.

        Raises:
            RopewalkError: always, to say why.
        """
        raise RopewalkError("the error of its mesh is that of a run from its beginning; run it again")

    def blocks(self) -> Iterator[Frames]:
        """All frames."""
        try:
            for frames in self._run.blocks():
                changes = []
                for frame in frames:
                    self._mesh.samples.add(frame)
                    if self._coarser is not None:
                        changes.append(self._change(self._coarser))
                yield replace(frames, of={**frames.of, "contact_change": np.array(changes)}) if changes else frames
        finally:
            self._conclude()

    def _change(self, coarser: MeshRun) -> Array:
        """(contact, axis) m, of the contacts in the last frame: NaN where the coarser mesh has none any more."""
        now, before = self._mesh.samples, coarser.samples
        contacts = slice(now.nodes.size, now.nodes.size + self._mesh.contacts)
        i = len(now.outputs) - 1
        if i >= len(before.outputs):
            return np.full_like(now.outputs[i][contacts], np.nan)
        change: Array = now.outputs[i][contacts] - before.outputs[i][contacts]
        return change
