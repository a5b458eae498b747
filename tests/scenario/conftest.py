"""The contract example, as text to change."""

from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "moving-force.yaml"


@pytest.fixture
def example() -> str:
    return EXAMPLE.read_text(encoding="utf-8")
