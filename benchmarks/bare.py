"""A bare loop in C over links in the plane: what one writes by hand in an afternoon, for comparison.

Hooke's law with a root and a division for each link, kick and drift; no load, no account. Damped, velocities are
extrapolated to the instant of the new positions, without which the order would be one.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
import time as clock
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from build_core.compiler import system_compiler

CODE = """
#include <cmath>
#define R double *__restrict
static inline __attribute__((always_inline)) void run(bool damped, long steps, long n, R x, R z, R u, R w, R fx, R fz,
                                                      R p, R q) {
  const double EA = 1e5, c = 50.0, h = 20.0 / n, dt = 1e-4 * h;
  for (long step = 0; step < steps; step++) {
    for (long i = 0; i < n; i++) {
      const double dx = x[i + 1] - x[i], dz = z[i + 1] - z[i], per_length = 1.0 / std::sqrt(dx * dx + dz * dz);
      double pull = EA * (1.0 / h - per_length);
      if (damped) pull += c * (dx * (p[i + 1] - p[i]) + dz * (q[i + 1] - q[i])) * per_length / h * per_length;
      fx[i] = pull * dx, fz[i] = pull * dz;
    }
    for (long i = 1; i < n; i++) {
      const double a = dt / h * (fx[i] - fx[i - 1]), b = dt / h * (fz[i] - fz[i - 1]) - 9.81 * dt;
      u[i] += a, w[i] += b, x[i] += dt * u[i], z[i] += dt * w[i];
      if (damped) p[i] = u[i] + 0.5 * a, q[i] = w[i] + 0.5 * b;
    }
  }
}
#define ROWS(k) s + k * m
extern "C" void bare(long damped, long steps, long n, long m, double *s) {
  if (damped) run(true, steps, n, ROWS(0), ROWS(1), ROWS(2), ROWS(3), ROWS(4), ROWS(5), ROWS(6), ROWS(7));
  else run(false, steps, n, ROWS(0), ROWS(1), ROWS(2), ROWS(3), ROWS(4), ROWS(5), ROWS(6), ROWS(7));
}
"""


@cache
def _library(march: str) -> ctypes.CDLL:
    compiler = system_compiler()
    if compiler is None:
        raise RuntimeError("the bare loop needs a compiler for C++, such as g++")
    folder = tempfile.TemporaryDirectory()
    source = Path(folder.name, "bare.cpp")
    source.write_text(CODE, encoding="utf-8")
    flags = ["-O3", f"-march={march}", "-fno-math-errno", "-fno-trapping-math", "-shared", "-fPIC"]
    subprocess.run([*compiler, *flags, str(source), "-o", str(source.with_suffix(".so"))], check=True)
    library = ctypes.CDLL(str(source.with_suffix(".so")))
    library.bare.argtypes, library.bare.restype = [ctypes.c_long] * 4 + [ctypes.c_void_p], None
    return library


def bare_loop(links: int, steps: int, *, damped: bool = False, march: str = "native") -> Callable[[], float]:
    """Return what runs the loop from its start: CPU seconds of so many steps.

    Args:
        links: number of links.
        steps: number of steps.
        damped: with dampers.
        march: instruction set, as GCC names it.
    """
    library, stride = _library(march), -(-(links + 1) // 8) * 8 + 8
    state = np.zeros((8, stride))

    def repeat() -> float:
        state[:] = 0.0
        state[0, : links + 1] = np.linspace(0.0, 20.2, links + 1)
        start = clock.process_time()
        library.bare(int(damped), steps, links, stride, state.ctypes.data)
        return clock.process_time() - start

    return repeat
