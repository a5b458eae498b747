"""Figure 3: a load led slowly along a rope without weight that is longer than its span.

Inextensible, the load runs on an ellipse about the supports. A vertical force, clamped, leaves it where the part ahead
hangs vertically, and goes up to the support with the part behind slack. A frictionless load stays on it and runs on
beyond the support (the paper's v > X), against a hold force that grows without bounds. The elastic rope gives a path
outside the ellipse. The paper gives no numbers; those chosen here are printed in the figure.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ropewalk.paper.slow_walk import Rope
from ropewalk.paper.walk_figure import draw_walks, walks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROPE = Rope(span=20.0, length=22.0)
ELASTIC = Rope(span=20.0, length=22.0, axial_stiffness=1e4)


def draw() -> Figure:
    """Compute the walks on both ropes and draw them."""
    title = "Figure 3. A slow walk on a rope without weight, longer than its span"
    return draw_walks(title, walks(ROPE, "inextensible"), walks(ELASTIC, "elastic", second=True), depth=7.0, window=6.0)
