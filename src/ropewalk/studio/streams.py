"""Results as messages: runs while they go on, and results that are there already."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ropewalk.results.contract import path_name, run_info_attributes
from ropewalk.results.display_units import DisplayUnits
from ropewalk.results.frame import ENERGY_FORMS, Array, Doubt, Layout, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.labelled import of_frames
from ropewalk.results.line_response import histories
from ropewalk.results.picture import Picture
from ropewalk.studio.messages import described, packed

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.studio.poses import Pose

DISPLAYED = (
    "contact_force", "hold_force", "contact_tension", "contact_friction", "reaction", "energy",
)  # fmt: skip
"""Arrays of results that pages show besides those of `Picture.add`."""
MOST_BYTES = 150_000_000  # of one result on a page; of more, every second frame is shown, or every third
MOST_POINTS = 4000  # of the curve of a place
_BLOCK_BYTES = 2_000_000
_INSTANT = re.compile(r"\bt = (\d[\d.]*(?:e[+-]?\d+)?) s\b")


def remark_of(doubt: str) -> dict[str, Any]:
    """A reason not to trust a run, with the instant and the key of the scenario that it names.

    Args:
        doubt: as results keep it, see `Doubt`.
    """
    instant = _INSTANT.search(doubt)
    return {"text": doubt, "time": float(instant[1]) if instant else None, "key": Doubt.key_in(doubt)}


class Streamed:
    """Sends the frames of a run as they come.

    Args:
        send: takes a message.
        head: goes in front of all, as {"id": 7}.
        total: how many frames the run will have.
        attributes: of the result, its scenario among them.
    """

    def __init__(
        self, send: Callable[[bytes], None], head: dict[str, Any], total: int, attributes: Mapping[str, Any]
    ) -> None:
        self._send, self._head, self._total, self._attributes = send, head, total, attributes
        self._step, self._seen = 1, 0
        self._picture: Picture | None = None

    def __call__(self, layout: Layout, frames: Frames, run_info: RunInfo) -> None:
        """Send some frames."""
        block = of_frames(layout, frames.path, frames.of, {**self._attributes, **run_info_attributes(run_info)})
        if self._picture is None:
            self._picture = Picture(block)
            self._step = _step(block, self._total)
            self._send(_opening(self._picture, block, self._total, self._step, self._head))
        first = -self._seen % self._step
        self._seen += len(frames)
        doubts = [remark_of(str(doubt)) for doubt in run_info.doubts]
        head = {**self._head, "run": {"doubts": doubts, "warnings": list(run_info.warnings)}}
        self._send(_frames(self._picture, block, slice(first, None, self._step), head))


def of_result(dataset: xr.Dataset, head: dict[str, Any]) -> Iterator[bytes]:
    """Return the messages of a result as of a run: the first frame alone, so that a picture need not wait for all.

    Args:
        dataset: a result.
        head: goes in front of all.
    """
    name, picture = path_name(dataset), Picture(dataset.isel({path_name(dataset): slice(0, 1)}))
    count = dataset.sizes[name]
    step = _step(dataset, count)
    yield _opening(picture, dataset, count, step, {**head, "title": str(dataset.attrs.get("title", ""))})
    rows = max(1, _BLOCK_BYTES // max(_bytes(dataset), 1)) * step
    for begin, end in pairwise([0, *range(step, count, rows), count]):
        yield _frames(picture, dataset.isel({name: slice(begin, end)}), slice(None, None, step), head)


def of_pose(pose: Pose, attributes: Mapping[str, Any], head: dict[str, Any]) -> bytes:
    """Return the message of an equilibrium while a load is dragged, with its description.

    Args:
        pose: the equilibrium.
        attributes: of its scenario.
        head: goes in front.
    """
    frames = Frames.together([pose.frame])
    block = of_frames(pose.layout, frames.path, frames.of, attributes)
    return of_frame(block, head, **({} if pose.linear is None else {"ghost": pose.linear}))


def of_frame(block: xr.Dataset, head: dict[str, Any], **more: Array) -> bytes:
    """Return the message of one frame with its description.

    Args:
        block: the frame.
        head: goes in front.
        more: further arrays.
    """
    picture = Picture(block, is_static=True)
    drawn = picture.add(block) | {name: block[name].values for name in DISPLAYED if name in block}
    state = picture.state() | ({} if picture.beams else {"factor": 1.0})  # only the sag of ropes is known
    about = {"layout": described(block), "picture": picture.described(), "state": state}
    arrays = {name: array[0] for name, array in drawn.items()}
    return packed({**head, **about}, {**arrays, "reference": picture.reference, **more})


def _opening(picture: Picture, dataset: xr.Dataset, total: int, step: int, head: dict[str, Any]) -> bytes:
    about = {"layout": described(dataset), "picture": picture.described(), "energies": ENERGY_FORMS}
    return packed({**head, "event": "layout", "total": total, "step": step, **about}, {"reference": picture.reference})


def _frames(picture: Picture, block: xr.Dataset, rows: slice, head: dict[str, Any]) -> bytes:
    """Pack some rows of the next frames of a run."""
    drawn = {"path": block[path_name(block)].values, **picture.add(block)}
    others = {
        name: block[name].values for name in DISPLAYED if name in block and block[name].dims[0] == path_name(block)
    }
    arrays = {name: array[rows] for name, array in (drawn | others).items()}
    return packed({**head, "event": "frames", "state": picture.state()}, arrays)


def _bytes(dataset: xr.Dataset) -> int:
    """Return about how many bytes a frame takes in a message."""
    sizes = dataset.sizes
    return 4 * (sizes["node"] * (sizes["axis"] + 2) + sizes["link"] + sizes.get("cell", 0) + 14 * sizes["contact"])


def _step(dataset: xr.Dataset, total: int) -> int:
    """Return every how many frames one is sent."""
    return 1 + int(_bytes(dataset) * total // MOST_BYTES)


def stored(dataset: xr.Dataset) -> dict[str, Any]:
    """How the run of a result has ended, as a page shows it."""
    from ropewalk.results import named_numbers, summary, text

    found = summary(dataset)
    numbers = {name: [value, unit] for name, (value, unit) in named_numbers(dataset).items() if value is not None}
    ending = {key: found[key] for key in ("title", "outcome", "advice", "doubts", "warnings")}
    ending["doubts"] = [remark_of(str(doubt)) for doubt in ending["doubts"]]
    return {"event": "ended", "summary": text(found), "numbers": numbers, "curves": curves_of(dataset), **ending}


def curves_of(dataset: xr.Dataset) -> dict[str, Any]:
    """Return the curves of the places that the scenario names: `path`, and by quantity the unit and values by place."""
    rows = slice(None, None, 1 + dataset.sizes[path_name(dataset)] // MOST_POINTS)
    found: dict[str, list[tuple[str, Any, str]]] = {}
    for name, values, unit in histories(dataset):
        place, _, quantity = name.rpartition(".")
        found.setdefault(quantity, []).append((place, values[rows], unit))
    groups = []
    for quantity, curves in found.items():
        displayed = DisplayUnits.read(None).of(curves[0][2], [values for _, values, _ in curves])
        known = {
            place: [v if v == v else None for v in (values / displayed.size).tolist()] for place, values, _ in curves
        }
        groups.append({"quantity": quantity.replace("_", " "), "unit": displayed.symbol, "curves": known})
    return {"path": dataset[path_name(dataset)].values[rows].tolist() if groups else [], "groups": groups}
