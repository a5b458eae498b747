"""What the tests of this folder share stands in blocks.py beside them."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
