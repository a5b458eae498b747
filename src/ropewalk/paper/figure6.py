"""Figure 6: a rope under a travelling force in motion, and the same rope perfectly damped, at three quarters.

The paper gives L = 20 m, V = 10 m/s and t = 1.5 s, but neither span, mass, stiffness nor force, so that its curves
cannot be reproduced. The values chosen here are printed in the figure. With V measured as the slip speed (the paper's
eq. 13), the load's material coordinate at 1.5 s is a little less than 15 m.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ropewalk.model import Dynamic, Line, MovingForce, Quasistatic, Scenario, Travel
from ropewalk.results.style import BLUE, FAINT, LABEL, NOTE, RED, dress
from ropewalk.simulate import simulate

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LENGTH, SPAN, MASS, STIFFNESS, FORCE, SPEED, TIME = 20.0, 20.0, 1.0, 1e5, 700.0, 10.0, 1.5
INSTANTS = (0.3, 0.6, 0.9, 1.2, TIME)


def scenario(elements: int = 200) -> Scenario:
    """The rope in motion: at rest under its weight until the force sets out from the left support."""
    return Scenario(
        title="Figure 6",
        lines={
            "rope": Line(
                start=(0.0, 0.0),
                end=(SPAN, 0.0),
                length=LENGTH,
                mass=MASS,
                axial_stiffness=STIFFNESS,
                elements=elements,
            )
        },
        loads={
            "force": MovingForce(on="rope", force=(0.0, -FORCE), travel=Travel(speed=SPEED, measured="slip")),
        },
        run=Dynamic(until=TIME, every=0.005),
    )


def damped(motion: Scenario) -> xr.Dataset:
    """The same rope perfectly damped: at rest with the force at every place of its path."""
    return simulate(motion.model_copy(update={"run": Quasistatic(positions=401)}))


def shape_at(slow: xr.Dataset, path: float) -> xr.Dataset:
    """The rest shape with the load this far along its path (between two computed ones a fortieth of a metre apart)."""
    return slow.drop_vars([name for name in slow.variables if slow[name].dtype.kind in "OSUT"]).interp(load_path=path)


def draw() -> Figure:
    """Compute both ropes and draw them."""
    from matplotlib.figure import Figure

    motion = scenario()
    fast, slow = simulate(motion), damped(motion)
    figure = Figure(figsize=(8.5, 6.4), layout="constrained")
    shapes, paths = figure.subplots(2, 1, height_ratios=(1.25, 1.0))
    _shapes(shapes, fast, slow)
    _tensions(paths, fast, slow)
    note = (
        f"L = {LENGTH:g} m, X = {SPAN:g} m, rho = {MASS:g} kg/m, EA = {STIFFNESS / 1e3:g} kN, "
        f"F = {FORCE:g} N, V = {SPEED:g} m/s (slip), no damping, {motion.lines['rope'].elements} links"
    )
    figure.supxlabel(note, fontsize=NOTE, color=FAINT)
    return figure


def _shapes(ax: Axes, fast: xr.Dataset, slow: xr.Dataset) -> None:
    dress(ax, f"Rope at t = {TIME:g} s, load after {SPEED * TIME:g} m of its path", "x (m)", "z (m)")
    for time in INSTANTS:
        last = time == TIME
        now, rest = fast.sel(time=time, method="nearest"), shape_at(slow, SPEED * time)
        for data, colour, name in ((now, BLUE, "in motion"), (rest, RED, "perfectly damped")):
            place, load = data.position.values, data.contact_position.values[0]
            width, alpha = (1.6, 1.0) if last else (0.8, 0.3)
            ax.plot(*place.T, color=colour, lw=width, alpha=alpha, label=name if last else None)
            ax.plot(*load, "o", color=colour, ms=6 if last else 3, alpha=1.0 if last else 0.4)
    ax.legend(frameon=False, fontsize=LABEL, loc="upper center", ncols=2)
    ax.margins(y=0.15)


def _tensions(ax: Axes, fast: xr.Dataset, slow: xr.Dataset) -> None:
    dress(ax, "Tension behind (full) and ahead (dashed) of the load", "path of the load (m)", "tension (N)")
    until = slow.load_path.values <= SPEED * TIME
    for side, style in (("behind", "-"), ("ahead", "--")):
        ax.plot(fast.time * SPEED, fast.contact_tension.sel(side=side)[:, 0], style, color=BLUE, lw=1.0)
        rest = slow.contact_tension.sel(side=side).values[until, 0]
        ax.plot(slow.load_path.values[until], rest, style, color=RED, lw=1.3)
    ax.set_xlim(0.0, SPEED * TIME)
    ax.set_ylim(bottom=min(0.0, float(np.nanmin(fast.contact_tension))))
