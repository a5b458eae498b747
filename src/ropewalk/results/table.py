"""The summary as a short table for people: one line for each question, with unit, place and instant."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from ropewalk.results.statistics import Summary

Row = tuple[str, str, str]
"""What, how much, where and when."""

_ENERGY = {
    "kinetic": "kinetic",
    "elastic": "elastic",
    "gravitational": "gravitational",
    "line_damping": "damped in lines and supports",
    "load_work": "work of the loads",
    "hold_work": "work of the hold forces",
    "contact_dissipation": "lost at the contacts",
    "support_work": "work of moving supports",
    "load_kinetic": "kinetic, of the loads",
    "load_potential": "potential, of the loads",
    "load_damping": "damped in loads and air",
    "friction": "lost to friction",
    "drive_work": "work of drives",
}


def number(value: float | None, digits: int = 4) -> str:
    """A number with so many significant digits, or a dash for none."""
    if value is None:
        return "–"
    if value == 0.0:
        return "0"
    if not 1e-4 <= abs(value) < 1e6:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{max(digits - 1 - math.floor(math.log10(abs(value))), 0)}f}"


def text(found: Summary) -> str:
    """The table as lines of text, in aligned columns.

    Args:
        found: what `summary` gives.
    """
    body = list(rows(found))
    first, second = (max((len(row[k]) for row in body if row[1]), default=0) for k in (0, 1))
    lines = [_headline(found)]
    for what, value, where in body:
        lines.append(f"{what:{first}}  {value:>{second}}  {where}".rstrip() if value else f"\n{what}")
    lines += [f"warning: {warning}" for warning in found["warnings"]]
    return "\n".join(lines)


def _headline(found: Summary) -> str:
    outcome = found["outcome"]
    if outcome == "running":
        outcome = "unfinished (still running, or killed)"
    simulated = found["simulated"]
    head = f"{found['title']}: {outcome}, {number(simulated['value'])} {simulated['unit']}, {found['frames']} frames"
    return f"{head}\nadvice: {found['advice']}" if found["advice"] else head


def rows(found: Summary) -> Iterator[Row]:
    """Rows of the table; a row without a value is a heading."""
    yield "Line", "", ""
    yield _quantity("largest tension", found["largest_tension"])
    yield _quantity("smallest tension", found["smallest_tension"])
    yield _quantity("largest strain", found["largest_strain"])
    yield _quantity("smallest strain", found["smallest_strain"])
    yield _quantity("largest sag", found["largest_sag"])
    yield "Supports", "", ""
    for name, force in found["supports"].items():
        yield name, f"{number(force['value'])} N", "  ".join((*_when(force), *_components(force)))
    for name, contact in found["contacts"].items():
        yield from _contact_rows(name, contact)
    yield from _energy_rows(found["energy"])
    yield from _method_rows(found["method"])


def _quantity(what: str, found: Summary | None) -> Row:
    if found is None:
        return what, "–", ""
    unit = "" if found["unit"] == "1" else f" {found['unit']}"
    where = f"{found['line']} at xi = {number(found['xi'])} m"
    return what, f"{number(found['value'])}{unit}", "  ".join((where, *_when(found)))


def _when(found: Summary) -> Iterator[str]:
    if found.get("time") is not None:
        yield f"t = {number(found['time'])} s"
    if found.get("load_path") is not None:
        yield f"load path = {number(found['load_path'])} m"


def _components(force: Summary) -> Iterator[str]:
    for axis, span in force["components"].items():
        if span["min"] is not None:
            yield f"{axis}: {number(span['min'])} to {number(span['max'])} N"


def _contact_rows(name: str, contact: Summary) -> Iterator[Row]:
    yield f"Load {name}", "", ""
    share = contact["share_on_line"]
    if not share:
        yield "on the line", "never", ""
        return
    size = contact["force"]["magnitude"]
    spread = f"std {number(size['std'])} N  {number(size['min'])} to {number(size['max'])} N"
    yield "contact force, mean", f"{number(size['mean'])} N", spread
    jump = contact["tension_jump"]
    yield "largest tension jump", f"{number(jump['value'])} N", "  ".join(_when(jump))
    hold = contact["hold_force"]
    if hold["value"]:
        yield "largest hold force", f"{number(hold['value'])} N", "  ".join((*_when(hold), *_components(hold)))
    needed = contact["friction_needed"]
    if needed["value"] is not None:
        yield "friction coefficient needed", number(needed["value"], 3), "  ".join(_when(needed))
    if contact["share_in_air"]:
        yield "in the air", f"{number(100 * contact['share_in_air'], 2)} %", "of its time"
    if contact["friction_power"]["value"]:
        power = contact["friction_power"]
        yield "largest friction power", f"{number(power['value'])} W", "  ".join(_when(power))
    if contact["last_speed"] is not None:
        speed = contact["last_speed"]
        yield "last speed", f"{number(speed['value'])} m/s", "  ".join((*_when(speed), "before it leaves or stops"))
    if share < 1.0:
        yield "on the line", f"{100 * share:.0f} %", "of the output instants"


def _energy_rows(energy: Summary) -> Iterator[Row]:
    yield "Energy at the end", "", ""
    for form, label in _ENERGY.items():
        if form not in energy["always_zero"]:
            yield label, f"{number(energy['final'].get(form))} J", ""
    worst: dict[str, Any] | None = energy["largest_imbalance"]
    if worst is not None and "load_path" not in worst:  # what stands still has no audit
        share = "" if worst["relative"] is None else f"{number(100 * worst['relative'], 2)} % of the energy turned over"
        yield (
            "largest imbalance",
            f"{number(worst['value'])} J",
            "  ".join(filter(None, (share, *_when(worst)))),
        )


def _method_rows(method: Summary) -> Iterator[Row]:
    yield "Method", "", ""
    yield "method", method["name"] or "–", method["reason"]
    if method["step"]["value"] is not None:
        yield "largest step", f"{number(method['step']['value'])} s", f"{method['steps']} steps"
    if method["wall"]["value"] is not None:
        factor = method["real_time_factor"]
        pace = "" if factor is None else f"{number(factor, 3)} times real time"
        yield "time taken", f"{number(method['wall']['value'], 3)} s", pace
