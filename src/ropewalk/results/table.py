"""The summary as a short table for people: one line for each question, with unit, place and instant."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from ropewalk.results.statistics import Summary

Row = tuple[str, str, str]
"""What, how much, where and when."""

SUPPORTS, LARGEST = 8, 3  # with more supports than this only so many of them get a row
ROUND_OFF = 1e-9  # m: what is no further aside has not left its plane, what is lifted no higher is at rest
ENERGY_LABELS = {
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


def _millimetres(length: float) -> str:
    return f"{number(1e3 * length if abs(length) > ROUND_OFF else 0.0, 3)} mm"


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
    doubts = [f"doubt: {doubt}" for doubt in found["doubts"]]
    return "\n".join([head, *([f"advice: {found['advice']}"] if found["advice"] else []), *doubts])


def rows(found: Summary) -> Iterator[Row]:
    """Rows of the table; a row without a value is a heading."""
    if found["largest_tension"] is not None or not found["nets"]:
        yield "Line", "", ""
        yield _quantity("largest tension", found["largest_tension"])
        yield _quantity("smallest tension", found["smallest_tension"])
        yield _quantity("largest strain", found["largest_strain"])
        yield _quantity("smallest strain", found["smallest_strain"])
        yield _quantity("largest sag", found["largest_sag"])
        aside = found["largest_sideways"]
        if aside is not None and aside["value"] > ROUND_OFF:
            yield _quantity("largest way sideways", aside)
    for name, net in found["nets"].items():
        yield from _net_rows(name, net)
    if found["supports"]:
        yield "Supports", "", ""
        yield from _support_rows(found["supports"])
    for name, contact in found["contacts"].items():
        if name in found["pantographs"]:
            yield from _pantograph_rows(name, found["pantographs"][name])
        else:
            yield from _contact_rows(name, contact)
    for name, line in found["overhead_lines"].items():
        yield from _overhead_rows(name, line)
    for name, exchange in found["exchanges"].items():
        yield from _exchange_rows(name, exchange)
    yield from _energy_rows(found["energy"])
    yield from _method_rows(found["method"])


def _quantity(what: str, found: Summary | None) -> Row:
    if found is None:
        return what, "–", ""
    unit = "" if found["unit"] == "1" else f" {found['unit']}"
    where = f"{found['line']} at xi = {number(found['xi'])} m"
    return what, f"{number(found['value'])}{unit}", "  ".join((where, *_when(found)))


def _net_rows(name: str, net: Summary) -> Iterator[Row]:
    yield f"Net {name}", "", ""
    for key, what in (("largest_tension", "largest"), ("smallest_tension", "smallest")):
        if net[key] is not None:
            yield f"{what} tension per width", f"{number(net[key]['value'])} N/m", _place(net[key])
    if net["slack"] is not None and net["slack"]["value"]:
        told = "of the triangles pull in one direction at most"
        yield "slack, at most", f"{number(100 * net['slack']['value'], 2)} %", "  ".join((told, *_when(net["slack"])))
    if net["largest_sag"] is not None:
        yield "largest sag", f"{number(net['largest_sag']['value'])} m", _place(net["largest_sag"])
    yield "nodes", f"{net['nodes']}", f"{net['cells']} triangles"


def _place(found: Summary) -> str:
    where = ", ".join(f"{axis} = {number(found[axis])}" for axis in "xyz")
    return "  ".join((f"at {where} m", *_when(found)))


def _when(found: Summary) -> Iterator[str]:
    if found.get("time") is not None:
        yield f"t = {number(found['time'])} s"
    if found.get("load_path") is not None:
        yield f"load path = {number(found['load_path'])} m"


def _components(force: Summary) -> Iterator[str]:
    for axis, span in force["components"].items():
        if span["min"] is not None:
            yield f"{axis}: {number(span['min'])} to {number(span['max'])} N"


def _support_rows(supports: Summary) -> Iterator[Row]:
    """All supports, or the largest forces and the range of many."""
    many = len(supports) > SUPPORTS
    order = sorted(supports, key=lambda name: -(supports[name]["value"] or 0.0))[:LARGEST] if many else list(supports)
    for name in order:
        force = supports[name]
        yield name, f"{number(force['value'])} N", "  ".join((*_when(force), *_components(force)))
    if many:
        sizes = [force["value"] for force in supports.values() if force["value"] is not None]
        span = f"{number(min(sizes))} to {number(max(sizes))} N" if sizes else "–"
        yield f"all {len(supports)}", span, "largest of each"


def _pantograph_rows(name: str, found: Summary) -> Iterator[Row]:
    yield f"Pantograph {name}", "", ""
    value = {key: entry["value"] for key, entry in found.items() if isinstance(entry, dict) and "value" in entry}
    if value["mean"] is None:
        yield "contact force", "–", "it was not in the analysed spans"
        return
    spans, limit, between = found["analysed_spans"], found["filter"]["limit"], found["filter"]["between"]
    where = [] if spans is None else [f"spans {spans[0]} to {spans[1]}" if spans[0] < spans[1] else f"span {spans[0]}"]
    where.append(f"at {number(3.6 * value['speed'])} km/h")
    if not found["complete"]:
        where.append("not from end to end")
    yield "analysed", f"{number(value['first'])} to {number(value['last'])} m", "  ".join(where)
    if value["fastest"] < limit:
        told = f"too far apart for {limit:g} Hz, the force is not filtered: write a smaller run.sample"
        yield "samples", f"every {number(500.0 / value['fastest'], 3)} ms", told
    target = ""
    if value["target"] is not None:
        target = f"{number(value['target_ratio'], 3)} of the {number(value['target'])} N asked for"
    yield "mean contact force Fm", f"{number(value['mean'])} N", target
    low, high = number(value["deviation_low"], 3), number(value["deviation_high"], 3)
    bands = f"0-{between:g} Hz: {low} N  {between:g}-{limit:g} Hz: {high} N"
    yield f"sigma, 0-{limit:g} Hz", f"{number(value['deviation'], 3)} N", bands
    yield "sigma / Fm", number(value["relative_deviation"], 3), ""
    extremes = number(value["statistical_minimum"], 3), number(value["statistical_maximum"], 3)
    yield "Fm - 3 sigma, Fm + 3 sigma", f"{extremes[0]} to {extremes[1]} N", ""
    for key, what in (("maximum", "largest"), ("minimum", "smallest")):
        yield f"{what} force", f"{number(value[key])} N", f"at {number(value[f'{key}_at'])} m"
    raw = f"sigma {number(value['raw_deviation'], 3)} N"
    yield "unfiltered force", f"{number(value['raw_minimum'], 3)} to {number(value['raw_maximum'], 3)} N", raw
    yield "without contact", f"{number(100 * value['loss'], 2)} %", "of the time"
    heights = f"{number(1e3 * value['lowest'], 3)} to {number(1e3 * value['highest'], 3)} mm"
    yield "range of contact heights", f"{number(1e3 * value['height_range'], 3)} mm", heights
    if value["uplift"] is not None:
        yield "largest uplift of a support", _millimetres(value["uplift"]), "while it is the closest pantograph"
    if found["acceptance"] is not None:
        yield from _acceptance_rows(found["acceptance"])


def _acceptance_rows(found: Summary) -> Iterator[Row]:
    yield found["title"], "", ""
    for check in found["checks"]:
        verdict = "inside" if check["inside"] else "OUTSIDE"
        bounds = f"{check['low']:g} to {check['high']:g} {check['unit']} [{check['mark']}]"
        yield check["what"], f"{number(check['value'])} {check['unit']}", f"{verdict} {bounds}"
    inside = sum(check["inside"] for check in found["checks"])
    yield "inside", f"{inside} of {len(found['checks'])}", found["remark"]


def _overhead_rows(name: str, found: Summary) -> Iterator[Row]:
    yield f"Overhead line {name}", "", ""
    supports = {key: entry for key, entry in found["supports"].items() if entry["uplift"] is not None}
    shown = [key for key, entry in supports.items() if entry["analysed"]]
    if len(shown) > SUPPORTS:
        shown = sorted(shown, key=lambda key: -float(supports[key]["uplift"]))[:LARGEST]
    largest = max(supports, key=lambda key: float(supports[key]["uplift"]), default=None)
    if largest is not None and largest not in shown:
        shown.append(largest)
    for key in shown:
        entry = supports[key]
        note = "" if entry["analysed"] else "  largest of all, beside the analysed spans"
        yield f"uplift at {key}", _millimetres(entry["uplift"]), f"{number(entry['station'])} m{note}"
    pull, slack, count = found["largest_dropper_force"], found["most_slack"], len(found["droppers"])
    if pull is not None and pull["value"] is not None:
        where = f"{pull['dropper']} at {number(pull['station'])} m"
        yield "largest dropper force", f"{number(pull['value'])} N", where
    if slack is not None and slack["value"]:
        where = f"of the time, {slack['dropper']} at {number(slack['station'])} m"
        yield "longest slack dropper", f"{number(100 * slack['value'], 2)} %", where
    if count:
        yield "droppers that slacken", f"{found['slackened']} of {count}", "whole line"


def _contact_rows(name: str, contact: Summary) -> Iterator[Row]:
    yield f"Load {name}", "", ""
    share = contact["share_on_line"]
    if not share:
        yield "on the line", "never", ""
        return
    size = contact["force"]["magnitude"]
    spread = f"std {number(size['std'])} N  {number(size['min'])} to {number(size['max'])} N"
    yield "contact force, mean", f"{number(size['mean'])} N", spread
    for how, blow in contact["impulses"].items():
        if blow is not None:
            told = "  ".join((*_when(blow), "an impulse over one step, left out of the statistics"))
            yield f"blow when {how}", f"{number(blow['value'])} N", told
    jump = contact["tension_jump"]
    if jump["value"] is not None:  # loads on nets have no two sides
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


def _exchange_rows(name: str, exchange: Summary) -> Iterator[Row]:
    yield f"Exchange with {name}", "", ""
    yield "work to and fro", f"{number(exchange['work'])} J", ""
    share = "" if exchange["relative"] is None else f"{number(100 * exchange['relative'], 2)} % of it"
    peak = exchange["peak"]
    most = "  ".join((f"at most {number(peak['value'], 2)} J in one interval", *_when(peak)))
    yield "energy that it made", f"{number(exchange['made'], 3)} J", "  ".join(filter(None, (share, most)))


def _energy_rows(energy: Summary) -> Iterator[Row]:
    if energy["audit"]:
        yield "Energy", "", ""
        yield "audit", "none", energy["audit"]
        return
    yield "Energy at the end", "", ""
    for form, label in ENERGY_LABELS.items():
        if form not in energy["always_zero"]:
            yield label, f"{number(energy['final'].get(form))} J", ""
    worst: dict[str, Any] | None = energy["largest_imbalance"]
    if worst is not None and "load_path" in worst:  # what stands still has no audit
        return
    yield "energy turned over", f"{number(energy['turnover'])} J", "half the sum of all changes above since the start"
    if worst is None:
        yield "largest imbalance", "unknown", "no audit was kept"
        return
    share = "" if worst["relative"] is None else f"{number(100 * worst['relative'], 2)} % of the energy turned over"
    yield "largest imbalance", f"{number(worst['value'])} J", "  ".join(filter(None, (share, *_when(worst))))


def _method_rows(method: Summary) -> Iterator[Row]:
    yield "Method", "", ""
    yield "method", method["name"] or "–", method["reason"]
    if method["step"]["value"] is not None:
        yield "largest step", f"{number(method['step']['value'])} s", f"{method['steps']} steps"
    if method["wall"]["value"] is not None:
        factor = method["real_time_factor"]
        pace = "" if factor is None else f"{number(factor, 3)} times real time"
        yield "time taken", f"{number(method['wall']['value'], 3)} s", pace
