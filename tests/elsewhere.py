"""Runs Python as on another machine: `python tests/elsewhere.py -m pytest tests/theory`.

Where rounding decides, it decides otherwise there. What is pretended: an older processor for OpenBLAS, whose kernels
sum in another order; a generic one for Numba, without wide vectors and fused operations; NumPy without the loops that
it has for this processor; the C library's functions without fused operations. What is set already stays, so that
`OPENBLAS_CORETYPE=Nehalem make test-elsewhere` is a third machine. Names that a machine does not know are not used, or
mean nothing to it. OpenBLAS has two threads, which divide what it sums. Kernels that are kept for this machine are not
compiled anew for the other: the same code before all that knows a processor is optimised and made machine code for that
one (mechanics/kernel_parts.py).
"""

from __future__ import annotations

import os
import platform
import shlex
import subprocess
import sys

import numpy as np


def elsewhere() -> dict[str, str]:
    """Environment variables with which this machine computes like another."""
    found: list[str] = np.show_config(mode="dicts").get("SIMD Extensions", {}).get("found", [])  # type: ignore[union-attr]
    other = {"NUMBA_CPU_NAME": "generic", "NPY_DISABLE_CPU_FEATURES": " ".join(found), "OPENBLAS_NUM_THREADS": "2"}
    machine = platform.machine().lower()
    if machine in ("x86_64", "amd64"):
        wide = any("512" in name or name == "X86_V4" for name in found)
        other["OPENBLAS_CORETYPE"] = "Haswell" if wide else "Prescott"  # not the one that it is
        other["GLIBC_TUNABLES"] = "glibc.cpu.hwcaps=-AVX2,-AVX2_Usable,-FMA,-FMA_Usable,-FMA4,-FMA4_Usable"
    elif machine in ("aarch64", "arm64"):
        other["OPENBLAS_CORETYPE"] = "ARMV8"
    return {name: os.environ.get(name, value) for name, value in other.items()}


if __name__ == "__main__":
    other = elsewhere()
    print("As on another machine:", *(f"{name}={shlex.quote(value)}" for name, value in other.items()), flush=True)
    sys.exit(subprocess.call([sys.executable, *sys.argv[1:]], env={**os.environ, **other}))
