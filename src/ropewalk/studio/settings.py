"""How the studio was opened: what its server and its workers are given."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Settings:
    """How the studio was opened."""

    folder: Path
    file: str = ""  # of the scenario or result to begin with
    allow_code: bool = False
    memory: int = 4_000_000_000  # bytes of data of each worker; 0: no limit
    most: int = 4  # pages that compute at the same time
    seconds: float = 3600.0  # of the longest run
    workers: int | None = None  # processes of a sweep; None: one for each core
    disk: int = 20_000_000_000  # bytes of scenarios and results in the folder; 0: no limit
