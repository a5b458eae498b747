"""Unknown values of a scenario from measured ones: least squares, with covariances and intervals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ropewalk.designs.measurements import Measurements
from ropewalk.designs.variables import Space
from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array
from ropewalk.model import Scenario
from ropewalk.scenario import dump, varying
from ropewalk.sweeps.parameters import refuse, setting

CONFIDENCE = 0.95
STEP = 1e-3  # of parts of the ways between the bounds, for central differences: frequencies are known to 1e-7 or so
CLEAR = 1e-5  # of the largest slope: smaller ones are of differences, not of the model
CLOSE = 1e-10  # relative changes at which the search ends


@dataclass(frozen=True)
class Fit:
    """What was found.

    Args:
        space: what was unknown.
        point: (variable,) the best point.
        covariance: (variable, variable) of the values in SI units; NaN where data do not determine them.
        freedom: data beyond unknowns.
        residual: root of the mean square of the remainder, each in its deviation; in SI units where none is given.
        modelled: (datum,) values of the model at the end, in SI units.
        measured: (datum,) the data.
        runs: computed.
        base: the scenario that was varied.
    """

    space: Space
    point: Array
    covariance: Array
    freedom: int
    residual: float
    modelled: Array
    measured: Array
    runs: int
    base: Scenario

    @property
    def values(self) -> dict[str, str]:
        """The values by key, as a file has them."""
        return self.space.settings(self.point)

    @property
    def numbers(self) -> dict[str, tuple[float, str]]:
        """The same in SI units, with these."""
        return {one.key: self.space.amount(k, self.point) for k, one in enumerate(self.space.variables)}

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviations by key, SI units."""
        found = np.sqrt(np.diag(self.covariance))
        return {one.key: float(found[k]) for k, one in enumerate(self.space.variables)}

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Intervals of 95 % by key in SI units, by Student's distribution; linear about the best point."""
        from scipy.stats import t

        times = float(t.ppf(0.5 + 0.5 * CONFIDENCE, self.freedom)) if self.freedom > 0 else np.nan
        return {
            key: (value - times * self.deviations[key], value + times * self.deviations[key])
            for key, (value, _) in self.numbers.items()
        }

    @property
    def at_bounds(self) -> list[str]:
        """Keys whose values are at a bound: the best ones may lie beyond."""
        pairs = zip(self.space.variables, self.point, strict=True)
        return [one.key for one, part in pairs if min(part, 1.0 - part) < 1e-6]

    @property
    def scenario(self) -> Scenario:
        """The scenario with the values."""
        return varying(dump(self.base), "the fit")([setting(key, value) for key, value in self.values.items()])

    def as_dict(self) -> dict[str, Any]:
        """As plain values that fit into JSON."""

        def plain(value: float) -> float | None:
            return float(value) if np.isfinite(value) else None

        return {
            "values": self.values,
            "deviations": {key: plain(value) for key, value in self.deviations.items()},
            "intervals": {key: [plain(end) for end in ends] for key, ends in self.intervals.items()},
            "units": {key: unit for key, (_, unit) in self.numbers.items()},
            "covariance": [[plain(value) for value in row] for row in self.covariance],
            "residual": self.residual, "data": int(self.measured.size), "runs": self.runs, "at_bounds": self.at_bounds,
        }  # fmt: skip


def fit(scenario: Scenario, vary: Mapping[str, Any], data: Any) -> Fit:
    """Find the values of some keys with which a run comes closest to measured values.

    Least squares between bounds (`scipy.optimize.least_squares`: M. A. Branch, T. F. Coleman and Y. Li, SIAM Journal
    on Scientific Computing 21, 1999). The covariance is s^2 (J' J)^-1, with the slopes J of the model at the best point
    and the mean square s^2 of what is left over the degrees of freedom; with deviations given, each datum counts in its
    own, and s^2 is 1.

    Args:
        scenario: the model.
        vary: what is unknown, bounds by key: {"lines.rope.tension": "5:40 kN"}.
        data: a CSV file: columns `quantity`, `value` and perhaps `deviation`, or a column `time [s]` and columns of the
            table of series; or the same as a mapping, {"frequency 1": "2.3 Hz"}.

    Raises:
        ScenarioError: bounds, a key or a quantity cannot be.
        ResultError: the file cannot be read.
        RopewalkError: the run at the values that the search begins with fails.
    """
    from scipy.optimize import least_squares

    scenario = scenario.model_copy(update={"sweep": None})
    space, wanted = Space.of(scenario, vary), Measurements.read(data)
    if wanted.values.size < len(vary):
        remedy = "measure more, or leave keys out"
        refuse("data", "there are fewer data than unknowns", f"{wanted.values.size} and {len(vary)}", remedy)
    make, known = varying(dump(scenario), "the fit"), dict[bytes, Array]()

    def model(point: Array) -> Array:
        key = np.asarray(point).tobytes()
        if key not in known:
            known[key] = wanted.of(make([setting(name, value) for name, value in space.settings(point).items()]))
        return known[key]

    def left(point: Array) -> Array:
        try:
            return (model(point) - wanted.values) / wanted.deviations
        except RopewalkError:
            if not known:
                raise
            return np.full(wanted.values.size, 1e3 * size)  # no such run: turn back

    start = np.clip(space.own, 0.01, 0.99)
    size = float(np.abs(left(start)).max()) or 1.0
    found = least_squares(
        left,
        start,
        bounds=(0.0, 1.0),
        method="trf",
        jac="3-point",
        diff_step=STEP,
        x_scale="jac",
        xtol=CLOSE,
        ftol=CLOSE,
        gtol=CLOSE,
    )
    freedom = wanted.values.size - len(vary)
    ways = np.array([one.si(one.high, unit) - one.si(one.low, unit) for one, unit in
                     zip(space.variables, space.units, strict=True)])  # fmt: skip
    slopes = found.jac / ways
    variance = 1.0 if wanted.is_weighted else float(found.fun @ found.fun) / freedom if freedom else np.nan
    covariance = np.full((ways.size, ways.size), np.nan)
    if np.linalg.matrix_rank(found.jac, rtol=CLEAR) == ways.size:
        covariance = variance * np.linalg.inv(slopes.T @ slopes)
    residual = float(np.sqrt(np.mean(found.fun**2)))
    return Fit(
        space, found.x, covariance, freedom, residual, model(found.x), wanted.values, len(known), scenario
    )  # fmt: skip
