"""Films in messages: every frame once, the first one alone, and a shared page that takes them one after the other."""

from __future__ import annotations

import base64
import re
from pathlib import Path

import numpy as np
import pytest

from ropewalk.results.frame import Contacts, Layout
from ropewalk.results.labelled import of_frames
from ropewalk.studio import streams
from ropewalk.studio.share import filled
from studio_server import unpacked

FRAMES, NODES = 11, 3
LINKS = NODES - 1
LAYOUT = Layout(("x", "z"), ("rope",) * NODES, np.arange(NODES), ("rope",) * LINKS, np.zeros(LINKS), (), ())
PATH = np.arange(FRAMES) / 8.0
POSITION = np.arange(FRAMES * NODES * 2, dtype=float).reshape(FRAMES, NODES, 2)


@pytest.mark.parametrize(("most", "kept"), [(10**9, slice(None)), (500, slice(None, None, 2))])
def test_every_frame_comes_once_and_the_first_one_alone(
    monkeypatch: pytest.MonkeyPatch, most: int, kept: slice
) -> None:
    """Of what is too large, every second one."""
    monkeypatch.setattr(streams, "MOST_BYTES", most)
    monkeypatch.setattr(streams, "_BLOCK_BYTES", 4 * 24)  # four frames
    still = Contacts(FRAMES, 0, 2).fields()
    others = {"body_position": np.zeros((FRAMES, 0, 2)), "tension": np.zeros((FRAMES, LINKS))}
    result = of_frames(LAYOUT, PATH, {"position": POSITION, **others, **still}, {})
    head, *blocks = map(unpacked, streams.of_result(result, {"id": 7}))
    assert head[0] | {"id": 7, "event": "layout", "total": FRAMES} == head[0]
    assert blocks[0][1]["path"].tolist() == [0.0]
    for name, values in (("path", PATH), ("position", POSITION)):
        np.testing.assert_array_equal(np.concatenate([arrays[name] for _, arrays in blocks]), values[kept])


def test_a_shared_page_takes_each_block_as_it_is_read(tmp_path: Path) -> None:
    """What is told by somebody cannot end the element that it stands in."""
    (tmp_path / "share.html").write_text("<body><!--ropewalk-data--></body>")
    page = filled(tmp_path / "share.html", [b"layout", b"frames"], {"title": "</script><script>alert()"})
    blocks = re.findall(r'<script type="text/plain">([^<]*)</script><script>ropewalk\(\)</script>', page)
    assert [base64.b64decode(block) for block in blocks[1:]] == [b"layout", b"frames"]
    assert len(blocks) == 3
    assert page.count("<script") == 6
