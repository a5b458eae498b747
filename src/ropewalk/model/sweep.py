"""A sweep: what varies over many runs of a scenario, and what is kept of each."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import Count

Combine = Literal["grid", "zip", "one_at_a_time", "latin_hypercube", "sobol", "random", "morris", "saltelli"]
ONE_AT_A_TIME = "one_at_a_time"
FOR_EFFECTS = ("morris", "saltelli")
"""Ways to draw cases from which the effects of parameters follow."""
DRAWN = ("latin_hypercube", "sobol", "random", *FOR_EFFECTS)
"""Ways to combine values that draw a number of cases."""


class Sweep(Declaration):
    """Many runs of this scenario in one command: `ropewalk sweep FILE`. `ropewalk run` takes no notice of it."""

    over: dict[str, Any] = Field(
        description="varied values, by key: a list of values, or text: `100:350:5 km/h` (from, to, step), "
        "`linear(100 km/h, 350 km/h, 11)`, `log(1 N, 1 kN, 4)` (equal factors), `550 kN, 600 kN`; to draw from: "
        "`uniform(LOW, HIGH)`, `loguniform(LOW, HIGH)`, `normal(MEAN, STD)`, `lognormal(MEDIAN, STD of the logarithm)`"
    )
    derived: dict[str, str] = Field(
        default_factory=dict,
        description="dependent values, by key: expressions as `bridge.length / speed + 2 s`",
    )
    combine: Combine = Field(
        default="grid",
        description="each value with each, the first with the first, each while all others stay as written, or "
        "`count` cases drawn from distributions; morris and saltelli draw `count` groups of cases for "
        "the sensitivity to each parameter",
    )
    count: Annotated[int, Count(1, 1_000_000)] | None = Field(
        default=None, description="number of cases that are drawn"
    )
    seed: Annotated[int, Count(0, 2**31 - 1)] = Field(
        default=0, description="of drawing: the same seed, the same cases"
    )
    record: tuple[str, ...] = Field(
        default=("largest_tension", "smallest_tension", "largest_strain", "largest_sag"),
        description="recorded quantities of each run: names of its summary, or `max`, `min`, `mean` or `std` of a "
        "time series",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if not self.over:
            findings.append(Finding(("over",), "nothing varies", remedy="write  KEY: values  in it"))
        for key, values in self.over.items():
            if not isinstance(values, str | list | tuple) or not values:
                remedy = "write a list, or text such as 100:350:5 km/h"
                findings.append(Finding(("over", key), "are no values", str(values)[:60], remedy))
        drawn = self.combine in DRAWN
        if drawn and self.count is None:
            findings.append(Finding(("count",), "is required: number of sampled cases", remedy="write for example 100"))
        elif self.count is not None and not drawn:
            remedy = f"leave it out, or write combine: {' | '.join(DRAWN)}"
            findings.append(Finding(("count",), f"does not go with combine: {self.combine}", str(self.count), remedy))
        if not self.record:
            findings.append(
                Finding(("record",), "no quantity is recorded", remedy="name a quantity, for example largest_tension")
            )
        report("sweep", findings)
        return self
