"""A result in a notebook: what Python hands over, and what the browser makes of it."""

from __future__ import annotations

import base64
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import ropewalk
from ropewalk.errors import RopewalkError
from ropewalk.results.picture import drawn_position
from ropewalk.scenario import loads
from ropewalk.studio import widget
from ropewalk.studio.share import PAGE
from studio_browser import FRONT, LACKING, NODE
from studio_server import SHORT, unpacked

MODULE = PAGE / "widget" / "widget.js"
needs_build = pytest.mark.skipif(not MODULE.is_file(), reason="the front end is not built: make studio")


@pytest.fixture(scope="module")
def result() -> xr.Dataset:
    return ropewalk.simulate(loads(SHORT))


@needs_build
def test_the_data_are_inside(result: xr.Dataset) -> None:
    pytest.importorskip("anywidget")
    shown = ropewalk.view(result, height=500)
    state = shown.get_state()
    arrays = [unpacked(message)[1] for message in state["messages"][1:]]
    shapes = np.concatenate([one["position"] for one in arrays])
    np.testing.assert_array_equal(shapes, drawn_position(result).astype("f4"))
    assert state["ended"]["outcome"] == result.attrs["outcome"] == "completed"
    assert (state["height"], state["beside_messages"]) == (500, [])
    assert "http" not in shown._esm.replace("http://www.w3.org", "")  # nothing is asked of anywhere


def test_without_anywidget_it_says_what_to_install(result: xr.Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(RopewalkError, match=r"pip install 'ropewalk\[notebook\]'"):
        ropewalk.view(result)


@needs_build
def test_what_is_no_run_or_too_large_is_refused(result: xr.Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("anywidget")
    with pytest.raises(RopewalkError, match="result of one run"):
        ropewalk.view(result[["energy"]])
    monkeypatch.setattr(widget, "MOST_BYTES", 100)
    with pytest.raises(RopewalkError, match=r"run\.every"):
        ropewalk.view(result)


@needs_build
@pytest.mark.skipif(bool(LACKING), reason=LACKING)
def test_in_a_browser(result: xr.Dataset, tmp_path: Path) -> None:
    pytest.importorskip("anywidget")
    other = ropewalk.simulate(loads(SHORT.replace("-800 N", "-400 N")))
    state = ropewalk.view(result, beside=other).get_state()
    for name in ("messages", "beside_messages"):
        state[name] = [base64.b64encode(message).decode() for message in state[name]]
    given = tmp_path / "state.json"
    given.write_text(json.dumps({name: state[name] for name in
                                 ("messages", "ended", "beside_messages", "beside_ended", "height")}))  # fmt: skip
    assert NODE is not None
    command = [NODE, "tests/widget.mjs", str(MODULE), str(given), os.environ.get("STUDIO_PICTURES", "")]
    said = subprocess.run(command, cwd=FRONT, capture_output=True, text=True, timeout=120)
    assert said.stdout == "all as it should be\n", said.stdout + said.stderr
