"""The state of the sources, as hashes: what was computed from another one counts no more."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parent.parent


def digest(files: Iterable[Path]) -> str:
    """Of the contents of files."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:16]


def program() -> list[Path]:
    """All modules of the package."""
    return sorted(ROOT.glob("src/ropewalk/**/*.py"))
