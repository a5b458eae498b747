"""The state of the sources, as hashes: what was computed or compiled from another one counts no more."""

import hashlib
import os
import tempfile
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parent.parent
KERNELS = {"mechanics", "solve", "wires", "webs"}
"""Folders that hold compiled kernels."""


def digest(files: Iterable[Path]) -> str:
    """Of the contents of files."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:16]


def program() -> list[Path]:
    """All modules of the package."""
    return sorted(ROOT.glob("src/ropewalk/**/*.py"))


def keep_kernels_apart() -> None:
    """Give this process and its children a Numba cache of their own for every state of the kernels.

    Numba's cache looks at the file of a kernel only, not at the kernels that it calls: a changed kernel would be run in
    its old form.
    """
    if "NUMBA_CACHE_DIR" not in os.environ:
        kernels = digest(path for path in program() if KERNELS & set(path.parts))
        os.environ["NUMBA_CACHE_DIR"] = str(Path(tempfile.gettempdir()) / f"ropewalk-kernels-{kernels}")
