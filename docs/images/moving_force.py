"""Draws moving-force.png and .gif, the pictures of the site and of the README, from the result of `make demo`."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

import ropewalk
from ropewalk.results.shape_views import shapes

HERE = Path(__file__).parent

if __name__ == "__main__":
    result = ropewalk.open_result(HERE.parent.parent / "out" / "moving-force.nc")
    fig = Figure(figsize=(7.2, 2.3), dpi=110, layout="constrained")
    shapes(result, fig.add_subplot())
    fig.savefig(HERE / "moving-force.png", pil_kwargs={"optimize": True}, metadata={"Software": None})
    ropewalk.film(result, HERE / "moving-force.gif", size="800x310")
