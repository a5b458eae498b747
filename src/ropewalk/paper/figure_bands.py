"""Waves on periodically supported lines: what passes, what stops (Floquet), for a string and for a beam.

Two waves of the line without its supports cross where a span holds a whole number of half waves; elastic supports open
a gap there, and below the first pass band nothing travels at all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.style import BLUE, FAINT, INK, LABEL, NOTE, RED, dress
from ropewalk.theory import periodic

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STRING: dict[str, Any] = {"spacing": 1.0, "mass": 1.0, "tension": 1.0, "support_stiffness": 4.0}
BEAM: dict[str, Any] = {"spacing": 1.0, "mass": 1.0, "bending_stiffness": 1.0, "support_stiffness": 50.0}


def draw() -> Figure:
    """Compute and draw the bands and the attenuation of both lines."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.5, 7.6), layout="constrained")
    rows = figure.subplots(2, 2, width_ratios=(1.25, 1.0))
    _line(rows[0], "String", STRING, bands=4)
    _line(rows[1], "Beam", BEAM, bands=3)
    note = (
        "spacing d = 1 m, 1 kg/m; string: P = 1 N, springs of 4 N/m; beam: EI = 1 N m², springs of 50 N/m\n"
        "shaded: pass bands; thin: the line without supports; decay: of the wave that goes furthest"
    )
    figure.supxlabel(note, fontsize=NOTE, color=FAINT)
    return figure


def _line(axes: tuple[Axes, Axes], name: str, line: dict[str, Any], bands: int) -> None:
    waves, decay = axes
    diagram = periodic.band_diagram(bands=bands, **line)
    top = 1.08 * float(diagram.frequency.max())
    dress(waves, f"{name} on springs: free waves", "phase from support to support (rad)", "frequency (rad/s)")
    dress(decay, "Decay in the stop bands", "decay from support to support (Np)", "")
    for low, high in diagram.pass_bands:
        for ax in axes:
            ax.axhspan(low, high, color=BLUE, alpha=0.09, lw=0)
    phase = diagram.propagation
    for n in range(bands + 2):
        k = (phase + np.pi * n) if n % 2 == 0 else (np.pi * (n + 1) - phase)
        bare = k if name == "String" else k**2
        waves.plot(phase, bare, color=FAINT, lw=0.7)
    waves.plot(phase, np.asarray(diagram.frequency), color=BLUE, lw=1.6)
    frequency = np.linspace(1e-3, top, 1200)
    mu = periodic.propagation_constant(frequency, **line)
    least = np.abs(np.imag(mu)).reshape(frequency.size, -1).min(axis=1)
    decay.plot(least, frequency, color=RED, lw=1.4)
    decay.set_xlim(0.0, 1.05 * float(least.max()))
    for ax in axes:
        ax.set_ylim(0.0, top)
    waves.set_xlim(0.0, np.pi)
    waves.set_xticks([0.0, np.pi / 2.0, np.pi], ["0", "π/2", "π"])
    first = float(diagram.pass_bands[0][0])
    waves.text(0.06, 0.5 * first, "nothing travels", color=INK, fontsize=LABEL, va="center")
