"""The studio as its user meets it: opened, dragged, run, edited, saved, shared, in a real browser."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import pytest

from studio_browser import FRONT, LACKING, NODE
from studio_server import SHORT, serving

pytest.importorskip("uvicorn")


@pytest.mark.skipif(bool(LACKING), reason=LACKING)
def test_the_page_around_the_picture(tmp_path: Path) -> None:
    """Check exports, states, keyboard, touch, accessibility (axe), reload, stop and killed workers.

    STUDIO_CYCLES=200: so many cycles of open, run and stop, whose memory must not grow.
    """
    (tmp_path / "rope.yaml").write_text(SHORT)
    with serving(tmp_path, "rope.yaml", "--workers", "0") as server:
        assert NODE is not None
        pictures = os.environ.get("STUDIO_PICTURES", "")
        command = [NODE, "tests/shell.mjs", server.address, str(tmp_path), str(server.process.pid), pictures]
        said = subprocess.run(command, cwd=FRONT, capture_output=True, text=True, timeout=1800)
    assert said.stdout.endswith("all as it should be\n"), said.stdout + said.stderr


@pytest.mark.skipif(bool(LACKING), reason=LACKING)
def test_in_a_browser(tmp_path: Path) -> None:
    """Fails on any page error, and on any request beyond this machine; the server is killed and started again."""
    (tmp_path / "rope.yaml").write_text(SHORT)
    pictures = os.environ.get("STUDIO_PICTURES", "")
    options = ("rope.yaml", "--workers", "0")
    with serving(tmp_path, *options) as first:
        assert NODE is not None
        command = [NODE, "tests/browser.mjs", first.address, str(tmp_path), pictures]
        said = list[str]()
        with subprocess.Popen(
            command, cwd=FRONT, stdout=subprocess.PIPE, text=True, env={**os.environ, "STUDIO_RESTARTS": "1"}
        ) as browser:
            assert browser.stdout is not None
            second = None
            for line in browser.stdout:
                said.append(line)
                if line == "KILL\n":
                    first.end(signal.SIGKILL)
                if line == "START\n":
                    second = serving(tmp_path, *options, "--port", str(first.port), token=first.token)
                    second.__enter__()
        if second is not None:
            second.__exit__(None, None, None)
    assert browser.returncode == 0, "".join(said)
    assert said[-1] == "all as it should be\n"
