"""How kernels are compiled: in one place, so that all agree.

`error_model="numpy"` lets loops with a square root or a division vectorise (no exception for a zero divisor); what
is not finite is found by the callers.
"""

from __future__ import annotations

from typing import Any

import numba

njit: Any = numba.njit  # its stubs do not know the wrapper options

kernel: Any = njit(cache=True, error_model="numpy", no_cfunc_wrapper=True)
# Called by other kernels only: without the wrapper for Python calls it compiles in half the time.
inner: Any = njit(cache=True, error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=True)
# Sums may be re-ordered so that loops with a sum vectorise; nothing may rely on the order.
summing: Any = njit(cache=True, error_model="numpy", no_cfunc_wrapper=True, fastmath={"reassoc", "contract", "nsz"})
