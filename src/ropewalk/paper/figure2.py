"""Figure 2: a load led slowly along an elastic rope that is straight without it, as long as its span.

The paper gives no numbers; those chosen here are printed in the figure. Without a pre-tension the linear string has no
answer of its own (its deflection W x (X - x)/(P X) is infinite): it is drawn with the tension that the rope gets.

The path of the frictionless load ends half a metre beyond the support: pushed on, it stretches the rope so much that it
comes back along it, and a material coordinate does not say any more where it stands.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ropewalk.paper.slow_walk import Rope
from ropewalk.paper.walk_figure import draw_walks, walks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROPE = Rope(span=20.0, length=20.0, axial_stiffness=1e4)


def draw() -> Figure:
    """Compute both walks and draw them."""
    title = "Figure 2. A slow walk on a straight elastic rope without weight or pre-tension"
    return draw_walks(title, walks(ROPE), depth=6.2, window=5.0)
