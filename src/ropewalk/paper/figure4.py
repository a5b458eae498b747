"""Figure 4: a load led slowly along a heavy elastic rope, two pieces of catenaries.

Its weight keeps the rope taut on both sides: the vertical segment of Figure 3 is gone, and a vertical force leads up to
the support with a finite slope. The paper gives no numbers; those chosen here are printed in the figure.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ropewalk.paper.slow_walk import Rope
from ropewalk.paper.walk_figure import draw_walks, walks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROPE = Rope(span=20.0, length=22.0, weight=19.62, axial_stiffness=1e5)


def draw() -> Figure:
    """Compute both walks and draw them."""
    return draw_walks("Figure 4. A slow walk on a heavy rope", walks(ROPE), depth=6.8, window=6.0)
