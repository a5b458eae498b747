"""Nets and lines in space, in a real browser, which draws them to scale; made by hand: their sizes are known."""

from __future__ import annotations

import base64
import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ropewalk.results.frame import Contacts, Layout
from ropewalk.results.labelled import of_frames
from ropewalk.studio.share import PAGE
from ropewalk.studio.streams import of_result
from studio_browser import FRONT, LACKING, NODE

MODULE = PAGE / "widget" / "widget.js"
N, M = 12, 8  # cells of the net along its sides of 6 m and 4 m


def written(file: Path, layout: Layout, **arrays: Any) -> Path:
    """The state of a widget with these frames, at 0 s, 0.5 s and 1 s."""
    still = Contacts(3, len(layout.contact_load), 3).fields() | {"body_position": np.zeros((3, 0, 3))}
    several = {name: np.asarray(array, dtype=float) for name, array in arrays.items()}
    messages = [*of_result(of_frames(layout, np.array([0.0, 0.5, 1.0]), {**still, **several}, {}), {})]
    ended = {"title": file.stem, "outcome": "completed", "summary": "by hand", "doubts": []}
    texts = [base64.b64encode(message).decode() for message in messages]
    state = {"messages": texts, "ended": ended, "beside_messages": [], "beside_ended": {}, "height": 700}
    file.write_text(json.dumps(state))
    return file


def layout(node_line: tuple[str, ...], link_line: tuple[str, ...], **more: Any) -> Layout:
    return Layout(("x", "y", "z"), node_line, np.zeros(len(node_line)), link_line, np.zeros(len(link_line)), **more)


def net(file: Path) -> Path:
    """6 m x 4 m, 1 m deep in the middle at 1 s, flat at 0 s; tensions grow towards one corner."""
    u, v = (part.ravel() for part in np.meshgrid(np.linspace(0, 6, N + 1), np.linspace(0, 4, M + 1)))
    sag = np.sin(np.pi * u / 6) * np.sin(np.pi * v / 4)
    position = [np.column_stack((u, v, -t * sag)) for t in (0.0, 0.5, 1.0)]
    first = [i + (N + 1) * j for j in range(M) for i in range(N)]
    cells = [cell for a in first for cell in ((a, a + 1, a + N + 2), (a, a + N + 2, a + N + 1))]
    tension = np.linspace(100.0, 900.0, 2 * N * M)
    return written(
        file, layout(("net",) * u.size, (), contact_load=(), support=("net.edge",), cell=tuple(cells),
                     cell_net=("net",) * len(cells)),
        position=position, cell_tension=[np.column_stack((tension, tension / 2))] * 3, reaction=np.zeros((3, 1, 3)),
    )  # fmt: skip


def ropes(file: Path) -> Path:
    """Two that cross, with other tensions."""
    s = np.linspace(0, 1, 41)
    one = np.column_stack((10 * s, 0 * s, -4 * s * (1 - s)))
    other = np.column_stack((5 + 0 * s, 10 * s - 5, 1 - 4 * s * (1 - s)))
    names = ("long",) * 41 + ("cross",) * 41
    supports = ("long.start", "long.end", "cross.start", "cross.end")
    return written(
        file, layout(names, ("long",) * 40 + ("cross",) * 40, contact_load=(), support=supports),
        position=[np.vstack((one, other + np.array([0, 0, t]))) for t in (0.0, 0.5, 1.0)],
        tension=np.tile(np.repeat([500.0, 2000.0], 40), (3, 1)), reaction=np.ones((3, 4, 3)) * 100.0,
    )  # fmt: skip


@pytest.mark.skipif(bool(LACKING), reason=LACKING)
@pytest.mark.skipif(not MODULE.is_file(), reason="the front end is not built: make studio")
def test_in_a_browser(tmp_path: Path) -> None:
    assert NODE is not None
    given = [str(net(tmp_path / "net.json")), str(ropes(tmp_path / "ropes.json"))]
    command = [NODE, "tests/space.mjs", str(MODULE), *given, os.environ.get("STUDIO_PICTURES", "")]
    said = subprocess.run(command, cwd=FRONT, capture_output=True, text=True, timeout=120)
    assert said.stdout == "all as it should be\n", said.stdout + said.stderr
