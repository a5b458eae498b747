"""The effect of the coupling: a run beside the same one whose loads are nothing but their forces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.capabilities import ROPES, engine_of
from ropewalk.decouple import cut
from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array
from ropewalk.model.run import Dynamic, Equilibrium
from ropewalk.model.scenario import Scenario
from ropewalk.results.contract import doubts_of
from ropewalk.results.display_units import number
from ropewalk.results.extremes import Summary
from ropewalk.results.nets import net_names
from ropewalk.results.statistics import lines, summary
from ropewalk.simulate import simulate
from ropewalk.solve.start import setting_of

if TYPE_CHECKING:
    import xarray as xr

# Differences up to this part are called small: measured loads and stiffnesses are rarely known better.
SMALL = 0.05


@dataclass(frozen=True)
class Comparison:
    """What feedback changes: both results, the numbers, and a verdict."""

    coupled: xr.Dataset
    without: xr.Dataset
    lines: dict[str, Summary]  # of each line: largest deflection (m) and tension (N), of each net the first
    supports: dict[str, Summary]  # largest force
    wheels: dict[str, Summary]  # of each wheel: contact force (N), speed at which it leaves or stops (m/s)

    @property
    def verdict(self) -> str:
        """Whether the loads may be replaced by their forces, in one sentence; first what must not be trusted."""
        doubts = [
            f"the run {which} feedback is doubtful: {doubt}\n"
            for result, which in ((self.coupled, "with"), (self.without, "without"))
            for doubt in doubts_of(result)
        ]
        return f"{''.join(doubts)}{'apart from that, ' if doubts else ''}{self._judgement}"

    @property
    def _judgement(self) -> str:
        if not self.wheels:
            return "nothing here has a mass: the loads are forces already"
        name = max(self.wheels, key=lambda wheel: self.wheels[wheel]["contact_force"]["largest_difference"]["relative"])
        force = self.wheels[name]["contact_force"]
        most, typical = force["largest_difference"]["relative"], force["rms_difference"]["relative"]
        changes = [abs(line[what]["relative"] or 0.0) for line in self.lines.values() for what in line]
        worst = max(changes)
        may = "may" if worst <= SMALL else "must not"
        return (
            f"the force that {name} exerts differs by up to {percent(most)} from that on rigid ground (rms "
            f"{percent(typical)}); without feedback the largest deflections and tensions are wrong by up to "
            f"{percent(worst)}: for these, loads {may} be replaced by their forces where {percent(SMALL)} are allowed"
        )

    def as_dict(self) -> Summary:
        """The numbers as plain values that fit into JSON."""
        return {
            "title": self.coupled.attrs.get("title", ""),
            "lines": self.lines,
            "supports": self.supports,
            "wheels": self.wheels,
            "verdict": self.verdict,
        }

    def table(self) -> list[tuple[str, str, str, str]]:
        """Rows of a table: what, with feedback, without it, and by how much the latter differs or where it is."""
        rows = [("", "with feedback", "without", "")]
        for line, found in self.lines.items():
            rows.append(_row(f"largest deflection of {line}", found["largest_deflection"], "m"))
            if "largest_tension" in found:
                rows.append(_row(f"largest tension of {line}", found["largest_tension"], "N"))
        rows += [_row(f"largest force at {support}", found, "N") for support, found in self.supports.items()]
        for wheel, found in self.wheels.items():
            force = found["contact_force"]
            rows.append(_row(f"contact force of {wheel}, mean", force["mean"], "N"))
            rows.append(_row(f"contact force of {wheel}, largest", force["largest"], "N"))
            for what, label in (("rms_difference", "rms"), ("largest_difference", "at most")):
                off = force[what]
                when = f"t = {number(off['time'])} s" if "time" in off else ""
                change = f"{percent(off['relative'])}  {when}".rstrip()
                rows.append((f"its difference, {label}", f"{number(off['value'])} N", "", change))
            if found["last_speed"]["with"] is not None:
                rows.append(_row(f"last speed of {wheel}", found["last_speed"], "m/s"))
        return rows


def feedback(scenario: Scenario) -> Comparison:
    """Run a scenario with its loads and with the forces that these exert on rigid ground, and compare.

    Args:
        scenario: with a run in time.

    Raises:
        ScenarioError: the run continues from a stored result.
        RopewalkError: it is no run in time, or one of the runs does not come to its end.
    """
    if scenario.run.kind not in ("dynamic", "linear"):
        raise RopewalkError(
            f"run.kind: {scenario.run.kind} has no masses that move; feedback supports dynamic and linear"
        )
    alone, names = cut(scenario)
    coupled, without = simulate(scenario), simulate(alone)
    for result, which in ((coupled, "with"), (without, "without")):
        if result.attrs["outcome"] not in ("completed", "doubtful"):
            metadata = f"{result.attrs['outcome']}: {result.attrs['advice']}"
            raise RopewalkError(f"the run {which} feedback stopped early ({metadata})")
    both = (summary(coupled), summary(without))
    supports = {
        name: _pair(*({k: found["supports"][name][k] for k in ("value", "time")} for found in both))
        for name in both[0]["supports"]
    }
    wheels = {wheel: _wheel(coupled, without, wheel, own, both) for wheel, own in names.items()}
    return Comparison(coupled, without, _lines(scenario, coupled, without), supports, wheels)


def _lines(scenario: Scenario, coupled: xr.Dataset, without: xr.Dataset) -> dict[str, Summary]:
    found, bare = {}, _bare(scenario)
    for name in (*lines(coupled), *net_names(coupled)):
        here = np.flatnonzero(coupled["line"].values == name)
        links = np.flatnonzero(coupled["link_line"].values == name)
        level = bare.get(name, coupled["position"].values[0, here, -1])
        xi, middle, time = (coupled[key].values for key in ("xi", "link_xi", "time"))
        deflection, tension = [], []
        for result in (coupled, without):
            moved = level - result["position"].values[:, here, -1]
            upwards = bool(scenario.overhead_lines)  # as pantographs press
            deflection.append(largest(np.abs(moved) if upwards else moved, xi[here], time))
            if links.size:
                tension.append(largest(result["tension"].values[:, links], middle[links], time))
        if not links.size:  # a net: its nodes have no place along it, and it pulls per width
            found[name] = {"largest_deflection": _pair(*({**one, "xi": None} for one in deflection))}
            continue
        found[name] = {"largest_deflection": _pair(*deflection), "largest_tension": _pair(*tension)}
    return found


def _bare(scenario: Scenario) -> dict[str, Array]:
    """Heights at rest without loads, by line; of other lines the run itself begins with them."""
    if not isinstance(scenario.run, Dynamic) or not scenario.run.start.with_loads:
        return {}
    if engine_of(scenario) is ROPES:
        setting = setting_of(scenario, 0.0)
        pairs = zip(setting.lines, setting.bare, strict=True)
        return {name: rest.position[-1] for name, rest in pairs if rest is not None}
    rest = simulate(scenario.model_copy(update={"loads": {}, "run": Equilibrium()}))
    return {
        line: rest["position"].values[0, rest["line"].values == line, -1] for line in (*lines(rest), *net_names(rest))
    }


def largest(values: Array, xi: Array, time: Array) -> Summary:
    """The largest of values (time, place) with its place and instant."""
    frame, place = np.unravel_index(int(np.nanargmax(values)), values.shape)
    return {"value": float(values[frame, place]), "xi": float(xi[place]), "time": float(time[frame])}


def _pair(coupled: Summary, without: Summary) -> Summary:
    """Two values of one quantity, and by what part the second is larger."""
    a, b = coupled["value"], without["value"]
    relative = (b - a) / abs(a) if a and b is not None else None
    return {"with": coupled, "without": without, "relative": relative}


def _wheel(
    coupled: xr.Dataset, without: xr.Dataset, wheel: str, own: tuple[str, ...], both: tuple[Summary, Summary]
) -> Summary:
    time = coupled["time"].values
    forces = []
    for result, names in ((coupled, (wheel,)), (without, own)):
        on = np.isin(result["load"].values, names)
        forces.append(np.nan_to_num(result["contact_force"].values[:, on]).sum(axis=1))
    sizes = [np.linalg.norm(force, axis=1) for force in forces]
    present = (sizes[0] > 0.0) | (sizes[1] > 0.0)
    off = np.linalg.norm(forces[0] - forces[1], axis=1)
    means = [float(size[present].mean()) if present.any() else 0.0 for size in sizes]
    rms = float(np.sqrt((off[present] ** 2).mean())) if present.any() else 0.0
    at, scale = int(off.argmax()), means[1] or 1.0
    largest = [{"value": float(size.max()), "time": float(time[size.argmax()])} for size in sizes]
    speeds = [
        next((found["contacts"][n]["last_speed"] for n in names if found["contacts"][n]["last_speed"]), None)
        for found, names in zip(both, ((wheel,), own), strict=True)
    ]
    a, b = ((speed or {"value": None})["value"] for speed in speeds)
    return {
        "contact_force": {
            "unit": "N",
            "mean": _pair({"value": means[0]}, {"value": means[1]}),
            "largest": _pair(largest[0], largest[1]),
            "rms_difference": {"value": rms, "relative": rms / scale},
            "largest_difference": {
                "value": float(off[at]),
                "relative": float(off[at]) / scale,
                "time": float(time[at]),
            },
        },
        "last_speed": {"unit": "m/s", **_pair({"value": a}, {"value": b}), "with": speeds[0], "without": speeds[1]},
    }


def percent(part: float | None) -> str:
    """A part in per cent, with two digits; a dash for none."""
    return "–" if part is None else f"{number(100.0 * part, 2)} %"


def _row(what: str, pair: Summary, unit: str) -> tuple[str, str, str, str]:
    def metadata(found: Summary | None) -> str:
        return "–" if found is None or found["value"] is None else f"{number(found['value'])} {unit}"

    change = pair["relative"]
    sign = "+" if change is not None and change > 0.0 else ""
    first: dict[str, Any] = pair["with"] or {}
    where = "  ".join(_where(first))
    return what, metadata(pair["with"]), metadata(pair["without"]), f"{sign}{percent(change)}  {where}".rstrip()


def _where(found: Summary) -> Iterator[str]:
    if found.get("xi") is not None:
        yield f"xi = {number(found['xi'])} m"
    if "time" in found:
        yield f"t = {number(found['time'])} s"
