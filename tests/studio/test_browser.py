"""The studio as its user meets it: opened, dragged, run, edited, saved, shared, in a real browser."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

from studio_server import SHORT, serving

pytest.importorskip("uvicorn")
FRONT = Path(__file__).parents[2] / "studio"
BROWSERS = ("/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome")
NODE = shutil.which("node")
LACKING = (
    "there is no Chromium" if not any(Path(one).exists() for one in BROWSERS)
    else "there is no Node" if NODE is None
    else "the front end is not built: make studio" if not (FRONT / "node_modules" / "playwright-core").is_dir()
    else ""
)  # fmt: skip


@pytest.mark.skipif(bool(LACKING), reason=LACKING)
def test_in_a_browser(tmp_path: Path) -> None:
    """Fails on any page error, and on any request beyond this machine; the server is killed and started again."""
    (tmp_path / "rope.yaml").write_text(SHORT)
    pictures = os.environ.get("STUDIO_PICTURES", "")
    options = ("rope.yaml",)
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
