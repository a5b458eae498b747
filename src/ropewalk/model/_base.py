"""The common base of all declarations: frozen, unknown keys refused, numbers finite."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Declaration(BaseModel):
    """A frozen, self-checking statement of what is there; it holds no numerics."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True, arbitrary_types_allowed=True
    )
