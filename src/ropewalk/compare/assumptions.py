"""Assumptions of the simpler models, measured on the full scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.compare.stretches import Reach
from ropewalk.compare.trace import Level, Trace
from ropewalk.coupling import largest, percent
from ropewalk.mechanics.chain import Array
from ropewalk.model.overhead import CONTACT_WIRE
from ropewalk.model.scenario import Scenario
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import number
from ropewalk.results.extremes import Summary
from ropewalk.results.statistics import lines

if TYPE_CHECKING:
    import xarray as xr

STEEPEST = 1e3  # slopes beyond are vertical


@dataclass(frozen=True)
class Assumptions:
    """What the linear theory, constant forces and rigid masses take for small, in the full scenario."""

    slope: Summary | None  # largest, of links against their chord: value (tangent), angle (deg), line, xi, instant
    slope_at_rest: float  # the same without loads
    strain: Summary | None  # largest: value, line, xi, instant
    tension_jump: float | None  # largest difference of the tensions ahead of and behind a load, over their mean
    horizontal_force: float | None  # largest hold force, over the weight
    mach_transverse: float | None  # largest speed of a load over that of transverse waves at rest
    mach_at_load: float | None  # the same with the tension ahead of the load when it gets there
    mach_longitudinal: float | None
    feedback_rms: float | None  # contact force less its static value, over that
    feedback_largest: float | None
    linear: dict[str, Reach]  # where along the path of each wheel the linear theory holds

    def as_dict(self) -> Summary:
        """Plain values that fit into JSON."""
        return {**asdict(self), "linear": {wheel: reach.as_dict() for wheel, reach in self.linear.items()}}

    def table(self) -> list[tuple[str, str]]:
        """Rows of what, and how much."""
        rows = []
        if self.slope is not None:
            slope = self.slope
            text = "vertical" if slope["value"] is None else number(slope["value"], 3)
            rest = f", without loads {number(self.slope_at_rest, 3)}"
            rows.append(("largest slope against the chord", f"{text} ({number(slope['angle'], 3)} deg){rest}"))
        if self.strain is not None:
            rows.append(("largest strain", f"{percent(self.strain['value'])} ({self.strain['line']})"))
        for what, part in (
            ("tension jump at the load, over the mean", self.tension_jump),
            ("hold force along the line, over the weight", self.horizontal_force),
        ):
            rows.append((what, percent(part)))
        for what, value in (
            ("V over transverse waves, static", self.mach_transverse),
            ("V over transverse waves, ahead of the load", self.mach_at_load),
            ("V over longitudinal waves", self.mach_longitudinal),
        ):
            rows.append((what, number(value, 3)))
        text = f"rms {percent(self.feedback_rms)}, at most {percent(self.feedback_largest)}"
        rows.append(("feedback force over the weight", text))
        return rows


def assumptions_of(
    scenario: Scenario,
    result: xr.Dataset,
    level: Level,
    found: Mapping[str, Trace],
    static: Mapping[str, float | None],
    linear: Mapping[str, Reach],
) -> Assumptions:
    """Measure them.

    Args:
        scenario: the full one.
        result: of it.
        level: where its lines rest.
        found: its wheels.
        static: of each wheel, the force with which it presses at rest, N; None: it is a given force.
        linear: where the linear theory holds.
    """
    slope, rest = _slope(result, level)
    jumps = [_ratio(np.abs(np.diff(t.tension, axis=1))[:, 0], np.abs(t.tension).mean(axis=1)) for t in found.values()]
    holds = [_ratio(t.hold, np.full(t.hold.size, _mean(t))) for t in found.values()]
    machs = [_machs(scenario, result, trace) for trace in found.values()]
    feedback = [_feedback(trace, static[name]) for name, trace in found.items()]
    return Assumptions(
        slope=slope, slope_at_rest=rest, strain=_strain(result), tension_jump=_most(jumps),
        horizontal_force=_most(holds), mach_transverse=_most(mach[0] for mach in machs),
        mach_at_load=_most(mach[1] for mach in machs), mach_longitudinal=_most(mach[2] for mach in machs),
        feedback_rms=_most(off[0] for off in feedback), feedback_largest=_most(off[1] for off in feedback),
        linear=dict(linear),
    )  # fmt: skip


def _slope(result: xr.Dataset, level: Level) -> tuple[Summary | None, float]:
    """The steepest link, and the steepest one at rest (tangent)."""
    best: Summary | None = None
    rest, path = 0.0, result[path_name(result)].values
    for line in lines(result):
        place = result["position"].values[:, result["line"].values == line]
        tilt = _tilt(place)
        rest = max(rest, float(_tilt(level.place[line][None]).max()))
        if not np.isfinite(tilt).any():
            continue
        steepest = largest(tilt, result["link_xi"].values[result["link_line"].values == line], path)
        if best is None or steepest["value"] > best["angle"]:
            angle = steepest.pop("value")
            tangent = float(np.tan(angle)) if angle < np.arctan(STEEPEST) else None
            where = {path_name(result) if key == "time" else key: value for key, value in steepest.items()}
            best = {"value": tangent, "angle": angle, "line": line, **where}
    if best is not None:
        best["angle"] = float(np.degrees(best["angle"]))
    return best, float(min(np.tan(min(rest, np.arctan(STEEPEST))), STEEPEST))


def _tilt(place: Array) -> Array:
    """Angles between links and chord, (frame, link) rad; from places (frame, node, axis)."""
    d = np.diff(place, axis=1)
    chord = place[:, -1:] - place[:, :1]
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = (d * chord).sum(axis=2) / (np.linalg.norm(d, axis=2) * np.linalg.norm(chord, axis=2))
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _strain(result: xr.Dataset) -> Summary | None:
    strain, path = result["strain"].values, result[path_name(result)].values
    if not np.isfinite(strain).any():
        return None
    found = largest(np.abs(strain), result["link_xi"].values, path)
    frame = int(np.argmin(np.abs(path - found["time"])))
    at = int(np.nanargmax(np.abs(strain[frame])))
    found["line"] = str(result["link_line"].values[at])
    return {path_name(result) if key == "time" else key: value for key, value in found.items()}


def _machs(scenario: Scenario, result: xr.Dataset, trace: Trace) -> tuple[float | None, float | None, float | None]:
    """Largest speed of a wheel over those of transverse waves (at rest, ahead of the load) and of longitudinal ones."""
    if path_name(result) != "time":
        return None, None, None
    if trace.line in scenario.nets:  # waves of a net have no one direction
        return None, None, None
    name = trace.line.removesuffix(f".{CONTACT_WIRE}")
    if name in scenario.overhead_lines:
        wire: Any = scenario.overhead_lines[name].contact_wire
        mass, EA, EI, bed, length = wire.mass, None, wire.bending_stiffness or 0.0, 0.0, np.inf
    else:
        line = scenario.lines[trace.line]
        mass, EA, EI, bed = line.mass, line.axial_stiffness, line.bending_stiffness, line.foundation
        length = line.length or line.distance
    on = np.isfinite(trace.xi)
    if on.sum() < 2 or not mass:
        return None, None, None
    # Material speeds and waves: `rho` is the mass of an unstrained metre, and a stretch scales all of them alike.
    rate = np.gradient(trace.xi[on], trace.time[on])
    speed = float(np.abs(rate).max())
    mine = result["link_line"].values == trace.line
    tension = float(result["tension"].values[0, mine].mean())
    stretch = 1.0 + float(result["strain"].values[0, mine].mean())
    wave = _wave(tension, mass * stretch, EI, bed, length)
    ahead = np.where(rate >= 0.0, trace.tension[on, 1], trace.tension[on, 0])
    at_load = None
    if not EI and not bed and np.isfinite(ahead).all():
        own = np.sqrt(np.maximum(ahead, 0.0) / (mass * stretch))
        at_load = _most([float(a) for a in np.abs(rate[own > 0.0]) / own[own > 0.0]])
    along = np.sqrt(EA / mass) if EA else 0.0
    return (speed / wave if wave > 0.0 else None), at_load, (speed / float(along) if along else None)


def _wave(tension: float, mass: float, EI: float, bed: float, length: float) -> float:
    """Speed of the slowest transverse wave, m/s: of a beam between supports, that of one of its modes."""
    if not EI and not bed:
        return float(np.sqrt(max(tension, 0.0) / mass))
    k = np.pi / min(length, 1e4) * np.arange(1, 2001)
    square = (EI * k**4 + tension * k**2 + bed) / mass / k**2
    return float(np.sqrt(max(float(square.min()), 0.0)))


def _feedback(trace: Trace, static: float | None) -> tuple[float | None, float | None]:
    size = trace.size[np.isfinite(trace.size)]
    if static is None or not static > 0.0 or not size.size:
        return None, None
    off = size / static - 1.0
    return float(np.sqrt((off**2).mean())), float(np.abs(off).max())


def _mean(trace: Trace) -> float:
    size = trace.size[np.isfinite(trace.size)]
    return float(size.mean()) if size.size else 0.0


def _ratio(part: Array, whole: Array) -> float | None:
    known = np.isfinite(part) & np.isfinite(whole) & (whole > 0.0)
    return float((part[known] / whole[known]).max()) if known.any() else None


def _most(values: Any) -> float | None:
    return max((value for value in values if value is not None), default=None)
