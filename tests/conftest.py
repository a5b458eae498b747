"""Set-up of all tests."""

import hashlib
import os
import tempfile
from pathlib import Path

from hypothesis import settings

# The same examples in every run, so that a green tree stays green; HYPOTHESIS_PROFILE=default looks for new ones.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))

# Numba's cache looks at the file of a kernel only, not at the kernels that it calls. A cache of its own for every
# state of the sources keeps a changed kernel from being tested in its old form.
_SOURCES = sorted(Path(__file__).parent.parent.glob("src/ropewalk/**/*.py"))
_STOREYS = {"mechanics", "solve", "wires", "webs"}
_KERNELS = hashlib.sha256(b"".join(p.read_bytes() for p in _SOURCES if _STOREYS & set(p.parts)))
if "NUMBA_CACHE_DIR" not in os.environ:
    os.environ["NUMBA_CACHE_DIR"] = str(Path(tempfile.gettempdir()) / f"ropewalk-kernels-{_KERNELS.hexdigest()[:16]}")
