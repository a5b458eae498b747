"""Results as messages: runs while they go on, and results that are there already."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ropewalk import results
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import DisplayUnits
from ropewalk.results.frame import ENERGY_FORMS, Array, Doubt
from ropewalk.results.line_response import histories
from ropewalk.results.picture import Picture
from ropewalk.studio.messages import described, packed

if TYPE_CHECKING:
    import xarray as xr

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


class Stream:
    """Messages of frames, one block of them after the other.

    Args:
        head: goes in front of all, as {"id": 7}.
        total: how many frames there will be.
    """

    def __init__(self, head: dict[str, Any], total: int) -> None:
        self._head, self._total, self._seen = head, total, 0
        self.step = 1  # every how many frames one is sent; more where all would be too large
        self._picture: Picture | None = None

    def messages(self, block: xr.Dataset, **about: Any) -> Iterator[bytes]:
        """Return the message of the next frames, and before the first ones that of the layout.

        Args:
            block: the frames.
            about: goes in front of them.
        """
        path = path_name(block)
        if self._picture is None:
            self._picture = Picture(block)
            self.step = 1 + int(_bytes(block) * self._total // MOST_BYTES)
            layout = {"layout": described(block), "picture": self._picture.described(), "energies": ENERGY_FORMS}
            head = {**self._head, "event": "layout", "total": self._total, "step": self.step, **layout}
            yield packed(head, {"reference": self._picture.reference})
        drawn = {"path": block[path].values, **self._picture.add(block)}
        drawn |= {name: block[name].values for name in DISPLAYED if name in block and block[name].dims[0] == path}
        rows = slice(-self._seen % self.step, None, self.step)
        self._seen += block.sizes[path]
        head = {**self._head, **about, "event": "frames", "state": self._picture.state()}
        yield packed(head, {name: array[rows] for name, array in drawn.items()})


def of_result(dataset: xr.Dataset, head: dict[str, Any]) -> Iterator[bytes]:
    """Return the messages of a result as of a run: the first frame alone, so that a picture need not wait for all.

    Args:
        dataset: a result.
        head: goes in front of all.
    """
    name, count = path_name(dataset), dataset.sizes[path_name(dataset)]
    stream = Stream(head, count)
    yield from stream.messages(dataset.isel({name: slice(0, 1)}))
    rows = stream.step * max(1, _BLOCK_BYTES // max(_bytes(dataset), 1))
    for begin in range(1, count, rows):
        yield from stream.messages(dataset.isel({name: slice(begin, begin + rows)}))


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


def _bytes(dataset: xr.Dataset) -> int:
    """Return about how many bytes a frame takes in a message."""
    sizes = dataset.sizes
    return 4 * (sizes["node"] * (sizes["axis"] + 2) + sizes["link"] + sizes.get("cell", 0) + 14 * sizes["contact"])


def stored(dataset: xr.Dataset) -> dict[str, Any]:
    """How the run of a result has ended, as a page shows it."""
    found, named = results.summary(dataset), results.named_numbers(dataset)
    numbers = {name: [value, unit] for name, (value, unit) in named.items() if value is not None}
    ending = {key: found[key] for key in ("title", "outcome", "advice", "doubts", "warnings")}
    ending["doubts"] = [remark_of(str(doubt)) for doubt in ending["doubts"]]
    return {
        "event": "ended",
        "summary": results.text(found),
        "numbers": numbers,
        "curves": curves_of(dataset),
        **ending,
    }


def curves_of(dataset: xr.Dataset) -> dict[str, Any]:
    """Return the curves of the places that the scenario names: `path`, and by quantity the unit and values by place."""
    rows = slice(None, None, 1 + dataset.sizes[path_name(dataset)] // MOST_POINTS)
    found, units = dict[str, dict[str, Array]](), dict[str, str]()
    for name, values, unit in histories(dataset):
        place, _, quantity = name.rpartition(".")
        found.setdefault(quantity, {})[place], units[quantity] = values[rows], unit
    groups = []
    for quantity, curves in found.items():
        displayed = DisplayUnits.read(None).of(units[quantity], [*curves.values()])
        known = {at: [v if v == v else None for v in (y / displayed.size).tolist()] for at, y in curves.items()}
        groups.append({"quantity": quantity.replace("_", " "), "unit": displayed.symbol, "curves": known})
    return {"path": dataset[path_name(dataset)].values[rows].tolist() if groups else [], "groups": groups}
