"""Droppers that fail on the way: at a time, or torn by their force, against statics, energy and runs of whole lines."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from pydantic import ValidationError

from overhead_cases import EN_2002
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

DROPPERS = {**EN_2002["droppers"]}
LINE: dict[str, Any] = {**EN_2002, "spans": {"count": 3, "length": "60 m"}, "analysed_spans": [2, 2], "element": 1.0}
GENTLE = {  # a head of 2 kg that presses by next to nothing
    "kind": "pantograph", "on": "line", "masses": [1.0, 1.0], "stiffness": [50.0, 1e3], "damping": [20.0, 20.0],
    "static_force": "1 mN", "travel": {"speed": 0.0, "from": "10 m"},
}  # fmt: skip
MIDDLE = {"droppers": [[2, 5]], "time": 0.5}


def simulated(geometry: str, until: float, *, drag: float = 0.0, step: float | None = None, **line: Any) -> xr.Dataset:
    wires = {key: {**LINE[key], "drag": drag} for key in ("contact_wire", "messenger_wire")}
    run = {"kind": "dynamic", "geometry": geometry, "until": until, "every": 0.05, "step": step}
    tree = {"overhead_lines": {"line": {**LINE, **wires, **line}}, "loads": {"head": GENTLE}, "run": run}
    return simulate(Scenario.model_validate(tree))


def with_droppers(**more: Any) -> dict[str, Any]:
    return {"droppers": {**DROPPERS, **more}}


def imbalance(result: xr.Dataset) -> float:
    return float(abs(result.energy.sel(form="imbalance")).max())


def rests_apart(geometry: str, element: float) -> tuple[float, float]:
    """How far a line whose dropper failed rests from one that lacks it, m, and how far forces of droppers are, N."""
    failed = simulated(geometry, 2.5, drag=6.0, element=element, **with_droppers(cut=MIDDLE))
    other = simulated(geometry, 0.05, element=element, condition={"missing_droppers": [[2, 5]]})
    gone = failed.tie.values.tolist().index("line.2.5")
    z, rest = (r.position.sel(axis="z").values for r in (failed, other))
    assert np.abs(z[0] - rest[0]).max() > 0.017
    pull, wanted = failed.tie_force.values, other.tie_force.values[0]
    assert pull[10:, gone].tolist() == [0.0] * (len(pull) - 10)
    # It bore 6.5 m of wire, which was level.
    assert pull[9, gone] == pytest.approx(1.35 * 6.5 * 9.81, rel=2e-4)
    return float(np.abs(z[-1] - rest[0]).max()), float(np.abs(np.delete(pull[-1], gone) - wanted).max())


def test_what_swings_in_rests_as_the_line_that_never_had_the_dropper() -> None:
    """But for its clamps and the kinks that it made: splines round these off, a first-order error of the mesh.

    What is left swings out by exp(-drag t / 2) = 2e-3 of 17 mm.
    """
    (coarse, _), (fine, force) = (rests_apart("linearised", element) for element in (2.0, 1.0))
    assert fine < 0.04 * 0.017
    assert force < 0.005 * 86.0
    assert coarse / fine == pytest.approx(2.0, abs=0.15)
    large, more = rests_apart("nonlinear", 1.0)
    assert large == pytest.approx(fine, rel=0.05)
    assert more == pytest.approx(force, rel=0.1)


@pytest.mark.parametrize(("geometry", "part"), [("linearised", 1e-3), ("nonlinear", 6e-3)])
def test_a_dropper_that_fails_loses_what_it_had_stored(geometry: str, part: float) -> None:
    """F^2/(2 k), and the audit closes: where droppers slacken its error is of the second order in the step."""
    runs = [simulated(geometry, 0.8, step=step, **with_droppers(cut=MIDDLE)) for step in (1e-3, 2.5e-4)]
    for run in runs:
        force = float(run.tie_force.sel(tie="line.2.5")[9])
        assert float(run.energy.sel(form="line_damping")[-1]) == pytest.approx(force**2 / 2e5, rel=1e-3)
    kinetic = float(runs[1].energy.sel(form="kinetic").max())
    assert kinetic > 1.0
    assert imbalance(runs[1]) < part / 8.0 * kinetic
    assert imbalance(runs[0]) / imbalance(runs[1]) > 8.0


@pytest.mark.parametrize("geometry", ["linearised", "nonlinear"])
def test_a_dropper_is_torn_where_the_whole_line_first_exceeds_its_strength(geometry: str) -> None:
    """Beside a failed one; before, nothing differs from the line whose droppers bear all."""
    strong = simulated(geometry, 0.7, **with_droppers(cut=MIDDLE))
    recorded = strong.sampled_tie_force.values.reshape(-1, strong.tie.size)  # (sample, tie) N, every millisecond
    strength = 97.0
    first, which = np.argwhere(recorded > strength)[0]
    before = float(strong.time[0]) - 0.05 + 1e-3 * first
    torn = simulated(geometry, 0.7, **with_droppers(cut=MIDDLE, strength=strength))
    messages = torn.attrs["warnings"].splitlines()
    assert messages[0] == "at t = 0.5 s line.2.5 failed under 86.08 N"
    assert {message.split()[5] for message in messages[1:3]} == {"line.2.4", "line.2.6"}
    assert strong.tie.values[which] in ("line.2.4", "line.2.6")
    time, force = (float(messages[1].split()[i]) for i in (3, -2))
    assert time == pytest.approx(before, abs=1.5e-3)
    assert strength < force < strength + 2.5  # what a millisecond adds
    assert strong.attrs["warnings"].count("failed") == 1
    assert imbalance(torn) < 0.05 * float(torn.energy.sel(form="kinetic").max())


@pytest.mark.parametrize(
    ("droppers", "run", "message"),
    [
        ({"cut": {"droppers": [[4, 1]], "time": 1.0}}, {}, "no such span.*1 to 3"),
        ({"cut": {"droppers": [[2, 10]], "time": 1.0}}, {}, "no such dropper.*1 to 9"),
        ({"cut": {"droppers": [[2, 1], [2, 1]], "time": 1.0}}, {}, "named twice"),
        ({"cut": {"droppers": [[1, 1]], "time": 1.0}}, {}, "also in condition.missing_droppers"),
        ({"cut": {"droppers": [], "time": 1.0}}, {}, "names none"),
        ({"cut": {"droppers": [[2, 1]], "time": 0.0}}, {}, "time"),
        ({"strength": 0.0}, {}, "strength"),
    ],
)
def test_failures_that_cannot_be_are_refused(droppers: dict[str, Any], run: dict[str, Any], message: str) -> None:
    line = {**LINE, "condition": {"missing_droppers": [[1, 1]]}, **with_droppers(**droppers)}
    motion = {"kind": "dynamic", "geometry": "linearised", "until": 2.0} if "kind" not in run else {}
    tree = {"overhead_lines": {"line": line}, "loads": {"head": GENTLE}, "run": {**motion, **run}}
    with pytest.raises(ValidationError, match=message):
        Scenario.model_validate(tree)
