"""Results as messages: runs while they go on, and results that are there already."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contract import path_name
from ropewalk.results.drawn import BENT, Bends, drawn_position
from ropewalk.results.frame import ENERGY_FORMS, Array, Doubt, Layout, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.studio.messages import described, packed

if TYPE_CHECKING:
    import xarray as xr

DISPLAYED = (
    "position", "tension", "cell_tension", "contact_position", "contact_force", "hold_force", "contact_tension",
    "contact_friction", "contact_xi", "reaction", "body_position", "energy",
)  # fmt: skip
MOST_BYTES = 150_000_000  # of one result on a page; of more, every second frame is shown, or every third
_BLOCK_BYTES = 2_000_000
_INSTANT = re.compile(r"\bt = (\d[\d.]*(?:e[+-]?\d+)?) s\b")


def remark_of(doubt: str) -> dict[str, Any]:
    """A reason not to trust a run, with the instant and the key of the scenario that it names.

    Args:
        doubt: as results keep it, see `Doubt`.
    """
    instant = _INSTANT.search(doubt)
    return {"text": doubt, "time": float(instant[1]) if instant else None, "key": Doubt.key_in(doubt)}


def state_of_run(run_info: RunInfo) -> dict[str, Any]:
    """How a run goes."""
    return {
        "outcome": run_info.outcome, "advice": run_info.advice, "method": run_info.method, "reason": run_info.reason,
        "doubts": [remark_of(str(doubt)) for doubt in run_info.doubts], "warnings": list(run_info.warnings),
    }  # fmt: skip


class Streamed:
    """What looks at a run and sends what it sees.

    Args:
        send: takes a message.
        head: goes in front of all, as {"id": 7}.
        total: how many frames the run will have.
        loads: of each load the lines that it is `on` and `also_on`.
    """

    def __init__(
        self, send: Callable[[bytes], None], head: dict[str, Any], total: int, loads: Mapping[str, Any]
    ) -> None:
        self._send, self._head, self._total, self._loads = send, head, total, loads
        self._step, self._seen, self._begun = 1, 0, False

    def __call__(self, layout: Layout, frames: Frames, run_info: RunInfo) -> None:
        """Send some frames."""
        if not self._begun:
            self._begun = True
            each = 4 * sum(int(frames.of[name][0].size) for name in DISPLAYED if name in frames.of)
            self._step = 1 + int(each * self._total // MOST_BYTES)
            head = {**self._head, "event": "layout", "total": self._total, "step": self._step}
            self._send(packed({**head, "layout": described(layout), "energies": ENERGY_FORMS}, {}))
            self._bends = Bends(layout.node_line, layout.node_xi, layout.contact_load, self._loads)
        first = -self._seen % self._step
        self._seen += len(frames)
        rows = slice(first, None, self._step)
        if first >= len(frames):
            return
        arrays = {"path": frames.path[rows], **{name: frames.of[name][rows] for name in DISPLAYED if name in frames.of}}
        arrays["position"] = self._bends.drawn(*(frames.of[name][rows] for name in BENT))
        self._send(packed({**self._head, "event": "frames", "run": state_of_run(run_info)}, arrays))


def of_result(dataset: xr.Dataset, head: dict[str, Any]) -> Iterator[bytes]:
    """The messages that a run would have sent whose result this is."""
    layout = _layout_of(dataset)
    names = [name for name in DISPLAYED if name in dataset and dataset[name].dims[0] == layout.path]
    title = str(dataset.attrs.get("title", ""))
    arrays = {name: _Drawn(dataset) if name == "position" else dataset[name] for name in names}
    return film(layout, dataset[layout.path], arrays, {**head, "title": title})


class _Drawn:
    """Positions of nodes as they are drawn, of the frames that are asked for."""

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset, self.size = dataset, int(dataset["position"].size)

    def __getitem__(self, frames: slice) -> Array:
        return drawn_position(self._dataset.isel({path_name(self._dataset): frames}))


def film(layout: Layout, path: Any, arrays: Mapping[str, Any], head: dict[str, Any]) -> Iterator[bytes]:
    """Frames that are there as messages, the first frame alone: a picture of it need not wait for all.

    Args:
        layout: of the frames.
        path: (frame) where they are on it.
        arrays: (frame, ...) by name; arrays of NumPy or xarray.
        head: goes in front of all.
    """
    count = int(path.size)
    each = 4 * sum(int(array.size) for array in arrays.values()) // max(count, 1)
    step = 1 + int(each * count // MOST_BYTES)
    first = {**head, "event": "layout", "total": count, "step": step}
    yield packed({**first, "layout": described(layout), "energies": ENERGY_FORMS}, {})
    rows = max(1, _BLOCK_BYTES // max(each, 1)) * step
    begins = [0, *range(step, count, rows), count]
    for begin, end in pairwise(begins):
        given = {"path": path, **arrays}
        part = {name: np.asarray(array[begin:end:step], dtype=float) for name, array in given.items()}
        yield packed({**head, "event": "frames"}, part)


def stored(dataset: xr.Dataset) -> dict[str, Any]:
    """How the run of a result has ended, as a page shows it."""
    from ropewalk.results import named_numbers, summary, text

    found = summary(dataset)
    numbers = {name: [value, unit] for name, (value, unit) in named_numbers(dataset).items() if value is not None}
    ending = {key: found[key] for key in ("title", "outcome", "advice", "doubts", "warnings")}
    ending["doubts"] = [remark_of(str(doubt)) for doubt in ending["doubts"]]
    return {"event": "ended", "summary": text(found), "numbers": numbers, **ending}


def _layout_of(dataset: xr.Dataset) -> Layout:
    """What a result tells of its layout."""

    def names(key: str) -> tuple[str, ...]:
        return tuple(str(name) for name in dataset[key].values) if key in dataset.variables else ()

    cells = dataset["cell_node"].values if "cell_node" in dataset.variables else np.zeros((0, 3))
    return Layout(
        axes=names("axis"), node_line=names("line"), node_xi=np.zeros(0), link_line=names("link_line"),
        link_xi=np.zeros(0), contact_load=names("load"), support=names("support"), body=names("body"),
        cell=tuple((int(a), int(b), int(c)) for a, b, c in cells), path=path_name(dataset),
    )  # fmt: skip
