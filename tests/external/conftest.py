"""Models of other packages are examples of the documentation, which tests of this folder import."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "docs" / "external"))
