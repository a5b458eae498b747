"""Balance: how people keep upright to the side."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import PositiveLength

LOWEST = 0.01  # m, of a pendulum: a lower one falls by more than e^100 within a step
SIDEWAYS = (0.0, 1.0, 0.0)


class Balance(Declaration):
    """Lateral balance: a body above feet that are placed next to its extrapolated position.

    Seen from the line, the body y over a foot at u obeys y'' = g/height (y - u), and with it the line feels
    m g/height (u - y). A foot that lands stands at u = y + y'/sqrt(g/height), further out by `width`; it bears alone
    until the next one lands (Hof, Hum. Mov. Sci. 27, 112, 2008; Macdonald, Proc. R. Soc. A 465, 1055, 2009).

    The line is narrow, and feet that stand next to it need a deck that is carried by it: the force acts on the line
    itself, and what would turn it about its axis is left to the deck. On a light rope that yields to the side more
    easily than m g/height nobody keeps upright in this way.
    """

    height: PositiveLength = Field(
        default=1.17, description="of the pendulum with the same frequency as the body over its feet"
    )
    width: PositiveLength = Field(default=0.0157, description="offset of a foot beyond the extrapolated centre of mass")

    @model_validator(mode="after")
    def _plausible(self) -> Self:
        if self.height < LOWEST:
            remedy = "check its unit; about 1.2 m are usual"
            report("balance", [Finding(("height",), "is too small for a body", f"{self.height:g} m", remedy)])
        return self
