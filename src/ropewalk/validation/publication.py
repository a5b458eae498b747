"""Where a number is known from."""

from __future__ import annotations

from dataclasses import dataclass

ELEMENTARY = "elementary"
"""What is in every textbook: there is nothing to look up."""


@dataclass(frozen=True)
class Publication:
    """A publication.

    Args:
        text: as it is cited.
        seen: where the citation was compared with a second source; `ELEMENTARY`; empty: it is from memory.
    """

    text: str
    seen: str = ""

    def __str__(self) -> str:
        if self.seen == ELEMENTARY:
            return f"{self.text} (elementary)"
        return f"{self.text} ({f'citation checked: {self.seen}' if self.seen else 'from memory, not checked'})"
