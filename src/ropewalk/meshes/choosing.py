"""A scenario on several meshes: how far it is from the continuum, or on which mesh that is near enough."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from ropewalk.errors import RopewalkError
from ropewalk.meshes.compared import Compared, MeshRun, Start, computed, estimates
from ropewalk.meshes.scaling import begun, links_in, scaled
from ropewalk.model.mesh import PARTS
from ropewalk.model.run import Linear
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.results.running import Run

if TYPE_CHECKING:
    import xarray as xr

Record = Callable[[Scenario, Run, RunInfo], "xr.Dataset"]
"""Lets a run go to its end and gives its result."""

FIRST, MOST_AT_FIRST = 16, 512  # links of the longest line with which trials begin
MOST = 20_000  # links of a mesh that is chosen
PATIENCE = 3  # estimates, one after the other, that promise nothing: no finer mesh is tried then
RATIO = 2  # of the links of a mesh and of the coarser one before it
_ENDED = ("completed", "doubtful")


def result_of(scenario: Scenario, start: Start, record: Record) -> xr.Dataset:
    """Compute a scenario on the mesh that is given, with its error, or on one that is chosen.

    Args:
        scenario: that asks for either.
        start: gives a run.
        record: keeps one; of a mesh that turns out to be too coarse, the next one replaces it.

    Raises:
        RopewalkError: there is no result.
    """
    return _chosen(scenario, start, record) if scenario.parts.is_auto else _estimated(scenario, start, record)


def _estimated(scenario: Scenario, start: Start, record: Record) -> xr.Dataset:
    coarser: list[MeshRun] = []
    try:
        for parts in (PARTS, PARTS // RATIO):
            coarser.append(computed(scaled(scenario, 1.0 / parts), start, coarser))
    except RopewalkError as error:
        return _kept(scenario, start, record, [], None, " ".join(str(error).split()))
    return _kept(scenario, start, record, coarser, None)


def _chosen(scenario: Scenario, start: Start, record: Record) -> xr.Dataset:
    assert not isinstance(scenario.run, Linear)
    wanted, first = scenario.run.accuracy, FIRST
    assert wanted is not None
    meshes: list[MeshRun] = []  # the mesh i has RATIO^i times the elements of the base
    base: Scenario | None = None
    while True:
        try:
            base = base or begun(scenario, first)
            if (level := _level(meshes, wanted, links_in(base))) is None:
                meshes.append(computed(scaled(base, RATIO ** len(meshes)), start, meshes))
                continue
        except RopewalkError:  # too coarse, as long as that is not known to have another reason
            first *= RATIO
            if first > MOST_AT_FIRST:
                raise
            base = None
            meshes.clear()
            continue
        del meshes[level:]
        result = _kept(scaled(base, RATIO**level, mesh_error=True), start, record, meshes, wanted)
        found, ended = estimates(meshes)[0], result.attrs["outcome"] in _ENDED
        if (found.error <= wanted and not found.doubt) or not ended or _is_last(meshes, links_in(base)):
            return result
        result.close()


def _kept(
    scenario: Scenario, start: Start, record: Record, meshes: list[MeshRun], wanted: float | None, unknown: str = ""
) -> xr.Dataset:
    """The result on one mesh, which is put behind the coarser ones; `unknown` says why there are none."""
    run_info = RunInfo()
    run = start(scenario, run_info)
    mesh, before = MeshRun.of(run.layout, scenario, meshes), meshes[-1] if meshes else None
    meshes.append(mesh)
    if unknown:
        what = f"the error of the mesh cannot be estimated: {unknown}"
        run_info.doubt(what, "a coarser mesh cannot be computed", "run.mesh_error", "write more elements")
    return record(scenario, Compared(run, mesh, before, lambda: _tell(meshes, scenario, run_info, wanted)), run_info)


def _level(meshes: Sequence[MeshRun], wanted: float, links: int) -> int | None:
    """The mesh that is to be kept, one of those or the next one; None where another trial is needed to know."""
    if len(meshes) <= PARTS // RATIO:
        return None
    found, last = estimates(meshes)[0], _is_last(meshes, links)
    if (found.error <= wanted and not found.doubt) or links * RATIO ** len(meshes) > MOST:
        return len(meshes) - 1
    return len(meshes) if last or (not found.doubt and found.next(RATIO) <= wanted) else None


def _is_last(meshes: Sequence[MeshRun], links: int) -> bool:
    """Whether no finer mesh is to be tried: it would be too fine, or what is known promises nothing."""
    ends = range(len(meshes), max(len(meshes) - PATIENCE, 2), -1)
    erratic = len(ends) == PATIENCE and all(estimates(meshes[:end])[0].doubt for end in ends)
    return erratic or links * RATIO ** len(meshes) > MOST


def _tell(meshes: Sequence[MeshRun], scenario: Scenario, run_info: RunInfo, wanted: float | None) -> None:
    """Leave in the account of a run what its mesh and those before say of its error."""
    run_info.mesh = {"mesh": _words(scenario, wanted)}
    if len(meshes) <= PARTS // RATIO or not meshes[-1].samples.outputs:
        return
    everywhere, contacts = estimates(meshes)
    run_info.mesh |= {"mesh_error": everywhere.error, "mesh_order": everywhere.order}
    if contacts is not None:
        estimate = {"error": contacts.error, "order": contacts.order, "alike": contacts.alike}
        run_info.mesh |= {f"mesh_{name}_of_contacts": value for name, value in estimate.items()}
    key = next((f"lines.{name}.elements" for name in scenario.lines), "nets")
    if everywhere.doubt:
        cause = "chaos (slack lines, compression without damping), or too coarse meshes"
        run_info.doubt(everywhere.doubt, cause, key, "compare statistics, not paths, or write more elements")
    elif wanted is not None and everywhere.error > wanted:
        what = f"positions are estimated to miss {everywhere.error:.3g} m where {wanted:g} m are requested"
        remedy = "raise accuracy, or write elements as a number and mesh_error: true"
        run_info.doubt(what, f"more than {MOST} links would be needed", "run.accuracy", remedy)


def _words(scenario: Scenario, wanted: float | None) -> str:
    """On which meshes it was computed, and why."""
    links = {name: line.elements for name, line in scenario.lines.items()}
    displayed = ", ".join(f"{n} for {name}" for name, n in links.items())
    if wanted is not None:
        return f"elements: {displayed}, chosen for an accuracy of {wanted:g} m from coarser and coarser meshes"
    return f"compared with {1 / PARTS:g} and {RATIO / PARTS:g} of the elements"
