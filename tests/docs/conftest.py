"""Tests of this folder share blocks.py; docs/pictures.py is imported from the site."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "docs")]
