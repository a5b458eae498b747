"""One page that holds a run: data inside, opens offline, needs no server."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ropewalk.errors import RopewalkError
from ropewalk.studio.streams import of_result, stored

if TYPE_CHECKING:
    import xarray as xr

PAGE = Path(__file__).parent / "page"  # where the build of studio/ is
MOST_BYTES = 60_000_000


def built(name: str) -> Path:
    """A file of the build.

    Raises:
        RopewalkError: the front end has not been built.
    """
    file = PAGE / name
    if not file.is_file():
        raise RopewalkError("the front end of the studio is not built: run  make studio")
    return file


def shared(dataset: xr.Dataset) -> str:
    """A result as a page.

    Raises:
        RopewalkError: the front end has not been built, or the result is too large for a page.
    """
    template, messages = built("share/share.html"), [*of_result(dataset, {"id": 1})]
    if sum(map(len, messages)) > MOST_BYTES:
        raise RopewalkError("this result is too large for a page of its own; run it with a larger run.every")
    return filled(template, messages, stored(dataset))


def filled(template: Path, messages: Iterable[bytes], ended: dict[str, Any]) -> str:
    """A page with a run inside, in blocks that are shown as they are read: the picture need not wait for the last one.

    Args:
        template: of the build.
        messages: of the run, see `of_result`.
        ended: how it ended, see `stored`.
    """
    ending = json.dumps(ended).replace("<", "\\u003c")  # nothing in it ends the element that it stands in
    blocks = [ending, *(base64.b64encode(message).decode() for message in messages)]
    data = "\n".join(f'<script type="text/plain">{block}</script><script>ropewalk()</script>' for block in blocks)
    return template.read_text(encoding="utf-8").replace("<!--ropewalk-data-->", data, 1)
