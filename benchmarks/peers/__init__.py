"""How other packages solve the rope of the design page: one small module per peer, one problem, one table.

``python -m benchmarks.peers`` prints errors and CPU seconds of the peers that are installed; `measure` gives
the same as values.
"""

import os

# CPU seconds are compared for one core; heeded only if NumPy has not been imported before
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

from . import exudyn, moordyn, ropewalk, scipy_ivp, sundials  # noqa: E402
from .interface import Failed, Peer, Setting  # noqa: E402
from .measure import Row, cheapest, measure  # noqa: E402
from .problem import Rope, output_times, rest_shape  # noqa: E402

PEERS: tuple[Peer, ...] = (ropewalk, scipy_ivp, sundials, moordyn, exudyn)

__all__ = [
    "PEERS",
    "Failed",
    "Peer",
    "Rope",
    "Row",
    "Setting",
    "cheapest",
    "measure",
    "output_times",
    "rest_shape",
]
