"""Whether there is a browser to test in, and what is lacking otherwise."""

from __future__ import annotations

import shutil
from pathlib import Path

FRONT = Path(__file__).parents[1] / "studio"
BROWSERS = ("/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome")
NODE = shutil.which("node")
LACKING = (
    "there is no Chromium" if not any(Path(one).exists() for one in BROWSERS)
    else "there is no Node" if NODE is None
    else "the front end is not built: make studio" if not (FRONT / "node_modules" / "axe-core").is_dir()
    else ""
)  # fmt: skip
