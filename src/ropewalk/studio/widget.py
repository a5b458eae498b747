"""A run in a notebook: played, scrubbed, over another one; from the same source as the page that is shared."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ropewalk.errors import RopewalkError
from ropewalk.studio.share import MOST_BYTES, built
from ropewalk.studio.streams import of_result, stored

if TYPE_CHECKING:
    import xarray as xr


def view(result: xr.Dataset, beside: xr.Dataset | None = None, height: int = 620) -> Any:
    """A result as a widget of a notebook, with play, pause, time, speed and exaggeration; it needs no server.

    Args:
        result: of a run, as `simulate` or `open_result` give it.
        beside: another one, drawn faintly over it at the same instants.
        height: of the widget, pixels on the page.

    Returns:
        An `anywidget.AnyWidget` with its data inside: a notebook that is saved with its widgets shows it offline.

    Raises:
        RopewalkError: anywidget is not installed, the front end has not been built, a result is too large for a page or
            none of a single run.
    """
    if find_spec("anywidget") is None:
        raise RopewalkError("ropewalk.view needs anywidget, which is not installed: pip install 'ropewalk[notebook]'")
    messages, ended = _given(result)
    others, other_ended = ([], {}) if beside is None else _given(beside)
    if sum(map(len, [*messages, *others])) > MOST_BYTES:
        raise RopewalkError("this is too large for a notebook; run it with a larger run.every")
    made = _widget(built("widget/widget.js"))
    return made(messages=messages, ended=ended, beside_messages=others, beside_ended=other_ended, height=height)


def _given(result: xr.Dataset) -> tuple[list[bytes], dict[str, Any]]:
    if "position" not in result or not {"time", "load_path"} & set(result.dims):
        raise RopewalkError("ropewalk.view shows the result of one run, as simulate or open_result give it")
    return [*of_result(result, {"id": 1})], stored(result)


@cache
def _widget(module: Path) -> type[Any]:
    """The class of the widget, which exists only where anywidget does."""
    import anywidget
    import traitlets

    class View(anywidget.AnyWidget):
        """What the browser is given: see `Model` in studio/src/widget.ts."""

        _esm = module.read_text(encoding="utf-8")
        messages = traitlets.List(traitlets.Bytes()).tag(sync=True)
        ended = traitlets.Dict().tag(sync=True)
        beside_messages = traitlets.List(traitlets.Bytes()).tag(sync=True)
        beside_ended = traitlets.Dict().tag(sync=True)
        height = traitlets.Int(620, min=200).tag(sync=True)

    return View
