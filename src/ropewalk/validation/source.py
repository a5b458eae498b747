"""Where a number is known from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Source:
    """A publication.

    Args:
        text: as it is cited.
        seen: where the citation was compared with a second source; empty: it is from memory.
    """

    text: str
    seen: str = ""

    def __str__(self) -> str:
        return f"{self.text} ({f'citation checked: {self.seen}' if self.seen else 'from memory, not checked'})"
