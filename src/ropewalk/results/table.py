"""The summary as a short table for people: one line for each question, with unit, place and instant."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

from ropewalk.results.after_start import rows_after_start
from ropewalk.results.display_units import NOTHING, Column, DisplayUnit, DisplayUnits, Row, number, quantities
from ropewalk.results.dropper_lengths import length_rows
from ropewalk.results.extremes import Summary
from ropewalk.results.joint_statistics import joint_rows
from ropewalk.results.own_way import place_rows

SUPPORTS, LARGEST = 8, 3  # with more supports than this only so many of them get a row
ROUND_OFF = 1e-9  # m: what is no further aside has not left its plane, what is lifted no higher is at rest
ZERO = 1e-9  # of the largest of its kind: what is no larger is rounding, and written as zero
_PULLS = 0.01  # of the largest one, from which on a force upwards is distinguished
_MOST_FRICTION = 2.0  # coefficient above which no two surfaces rub
ENERGY_LABELS = {
    "kinetic": "kinetic",
    "elastic": "elastic",
    "gravitational": "gravitational",
    "line_damping": "dissipated in lines and supports",
    "load_work": "work of the loads",
    "hold_work": "work of the hold forces",
    "contact_dissipation": "dissipated at the contacts",
    "support_work": "work of moving supports",
    "load_kinetic": "kinetic, of the loads",
    "load_potential": "potential, of the loads",
    "load_damping": "dissipated in loads and air",
    "friction": "dissipated by friction",
    "hysteresis": "dissipated by hysteresis",
    "drive_work": "work of drives",
}


def text(found: Summary, units: DisplayUnits | None = None) -> str:
    """The table as lines of text, in aligned columns.

    Args:
        found: what `summary` gives.
        units: that numbers are written in (default: of engineering, by their size).
    """
    body = list(rows(found, units))
    first, second = (max((len(row[k]) for row in body if row[1]), default=0) for k in (0, 1))
    lines = [_headline(found, units or DisplayUnits.read(None))]
    for what, value, where in body:
        lines.append(f"{what:{first}}  {value:>{second}}  {where}".rstrip() if value else f"\n{what}")
    lines += [f"warning: {warning}" for warning in found["warnings"]]
    return "\n".join(lines)


def _headline(found: Summary, units: DisplayUnits) -> str:
    outcome = found["outcome"]
    if outcome == "running":
        outcome = "incomplete (still running, or killed)"
    simulated = found["simulated"]
    unit = units.place if simulated["unit"] == "m" else DisplayUnit(simulated["unit"], 1.0)
    length = f"{number(simulated['value'] / unit.size)} {unit.symbol}"
    head = f"{found['title']}: {outcome}, {length}, {found['frames']} frames"
    doubts = [f"doubt: {doubt}" for doubt in found["doubts"]]
    return "\n".join([head, *([f"advice: {found['advice']}"] if found["advice"] else []), *doubts])


def rows(found: Summary, units: DisplayUnits | None = None) -> Iterator[Row]:
    """Rows of the table; a row without a value is a heading.

    Args:
        found: what `summary` gives.
        units: that numbers are written in.
    """
    units = units or DisplayUnits.read(None)
    extremes = [found[key] for key in _EXTREMES]
    pulls = [abs(v) for unit, v in quantities({"a": extremes[:2], "b": found["supports"], "c": found["contacts"]})
             if unit == "N"]  # fmt: skip
    largest = max(pulls, default=0.0)
    floor = {"N": ZERO * largest, "m": ROUND_OFF}

    def column(*parts: Any) -> Column:
        return Column(units, *parts, floor=floor)

    lines = column(*extremes[:2], *found["supports"].values(), found["largest_sag"], found["largest_sideways"])
    if any(extremes) or (not found["nets"] and found["largest_sag"] is not None):
        yield "Lines", "", ""
        for key in _EXTREMES:
            pair = [found[f"{end}_{key.partition('_')[2]}"] for end in ("largest", "smallest")]
            if found[key] is not None and any(one["value"] for one in pair):  # zero all along gets no row
                yield _quantity(key.replace("_", " "), found[key], lines, "strain" if "strain" in key else "")
        for name, most in found["tension_over_strength"].items():
            where = f"{name} at xi = {lines.place(most['xi'])}"
            yield "largest tension over strength", number(most["value"], 3), "  ".join((where, *lines.when(most)))
        if found["largest_sag"] is not None:
            yield _quantity("largest sag", found["largest_sag"], lines)
        aside = found["largest_sideways"]
        if aside is not None and aside["value"] > ROUND_OFF:
            yield _quantity("largest sideways deflection", aside, lines)
    for name, line in found["lines"].items():
        yield from _response_rows(name, line, units, floor)
    for name, net in found["nets"].items():
        yield from _net_rows(name, net, column(net))
    if found["supports"]:
        yield "Supports", "", ""
        yield from _support_rows(found["supports"], lines)
    yield from joint_rows(found["joints"], column(*(joint["force"] for joint in found["joints"].values())))
    for name, contact in found["contacts"].items():
        if name in found["pantographs"]:
            yield from _pantograph_rows(name, found["pantographs"][name], column(found["pantographs"][name]))
        elif name.partition(".")[0] not in found["pantographs"]:  # of lines that overlap, shares of the former
            yield from _contact_rows(name, contact, column(contact["force"], contact["hold_force"]), largest)
    for name, train in found["trains"].items():
        yield from _train_rows(name, train, column(train["load"]))
    for name, crowd in found["crowds"].items():
        say = column(crowd["load"])
        yield f"Crowd {name}", "", ""
        yield "people", str(crowd["people"]), f"at most {crowd['most_on_line']} of them on the line"
        yield "load on the line, mean", say(crowd["load"]["mean"], "N"), f"at most {say(crowd['load']['max'], 'N')}"
    for name, payload in found["payloads"].items():
        yield from _payload_rows(name, payload, column(payload | {"lowest_place": None}))
    for name, carriage in found["carriages"].items():
        yield from _carriage_rows(name, carriage, column(carriage))
    for name, saddle in found["saddles"].items():
        say, angle = column(saddle), saddle["deflection"]
        yield f"Saddle {name}", "", ""
        yield "deflection of the rope", say.span(angle["min"]["value"], angle["max"]["value"], "rad"), ""
    if found["clearance"]:
        yield "Clearance of the ground", "", ""
    for name, least in found["clearance"].items():
        say = column(least)
        yield name, say(least["value"], "m"), "  ".join((f"at x = {say.place(least['x'])}", *say.when(least)))
    for name, line in found["overhead_lines"].items():
        uplifts = [{"value": support["uplift"], "unit": "m"} for support in line["supports"].values()]
        say = column(line["largest_dropper_force"], *uplifts)
        yield from _overhead_rows(name, line, say)
        if not line["supports"]:
            yield from length_rows(line["droppers"], say)
    for name, exchange in found["exchanges"].items():
        yield from _exchange_rows(name, exchange, column(exchange))
    yield from rows_after_start(found, partial(rows, units=units))
    yield from _energy_rows(
        found["energy"], column({"unit": "J", **found["energy"]["final"], "turnover": found["energy"]["turnover"]})
    )
    if found["mesh"] is not None:
        yield from _mesh_rows(found["mesh"], column(found["mesh"]))
    yield from _method_rows(found["method"], column())


_EXTREMES = ("largest_tension", "smallest_tension", "largest_strain", "smallest_strain")


def _quantity(what: str, found: Summary, say: Column, unit: str = "") -> Row:
    place = ", ".join(f"{name} = {say.place(found[name])}" for name in (*"xyz", "xi") if found.get(name) is not None)
    where = f"{found['line']} at {place}"
    return what, say(found["value"], unit or found["unit"]), "  ".join((where, *say.when(found)))


def _net_rows(name: str, net: Summary, say: Column) -> Iterator[Row]:
    yield f"Net {name}", "", ""
    for key, what in (("largest_tension", "largest"), ("smallest_tension", "smallest")):
        if net[key] is not None:
            yield f"{what} tension per width", say(net[key]["value"], "N/m"), _place(net[key], say)
    if net["slack"] is not None and net["slack"]["value"]:
        where = "  ".join(("of the triangles pull in one direction at most", *say.when(net["slack"])))
        yield "slack, at most", f"{number(100 * net['slack']['value'], 2)} %", where
    if net["largest_sag"] is not None:
        yield "largest sag", say(net["largest_sag"]["value"], "m"), _place(net["largest_sag"], say)
    yield "nodes", f"{net['nodes']}", f"{net['cells']} triangles"


def _place(found: Summary, say: Column) -> str:
    where = ", ".join(f"{axis} = {say.place(found[axis], with_unit=axis == 'z')}" for axis in "xyz")
    return "  ".join((f"at {where}", *say.when(found)))


def _support_rows(supports: Summary, say: Column) -> Iterator[Row]:
    """All supports, or the largest forces and the range of many."""
    many = len(supports) > SUPPORTS
    order = sorted(supports, key=lambda name: -(supports[name]["value"] or 0.0))[:LARGEST] if many else list(supports)
    for name in order:
        force = supports[name]
        yield name, say(force["value"], "N"), say.instant_and_components(force)
    if many:
        sizes = [force["value"] for force in supports.values() if force["value"] is not None]
        least, most = min(sizes, default=None), max(sizes, default=None)
        yield f"all {len(supports)}", say.span(least, most, "N"), "largest of each"


def _pantograph_rows(name: str, found: Summary, say: Column) -> Iterator[Row]:
    yield f"Pantograph {name}", "", ""
    value = {key: entry["value"] for key, entry in found.items() if isinstance(entry, dict) and "value" in entry}
    uplift = "largest uplift of a support", say(value["uplift"], "m"), "while it is the closest pantograph"
    if value["mean"] is None:
        yield "contact force", "–", "it was not in the analysed spans"
        if value["uplift"] is not None:
            yield uplift
        return
    spans, limit, between = found["analysed_spans"], found["filter"]["limit"], found["filter"]["between"]
    where = [] if spans is None else [f"spans {spans[0]} to {spans[1]}" if spans[0] < spans[1] else f"span {spans[0]}"]
    where.append(f"at {say(value['speed'], 'm/s')}")
    if not found["complete"]:
        where.append("not from end to end")
    yield "analysed", f"{say.place(value['first'], with_unit=False)} to {say.place(value['last'])}", "  ".join(where)
    if value["fastest"] < limit:
        sentence = f"too far apart for {limit:g} Hz, the force is not filtered: write a smaller run.sample"
        yield "samples", f"every {say(0.5 / value['fastest'], 's', 3)}", sentence
    target = ""
    if value["target"] is not None:
        target = f"{number(value['target_ratio'], 3)} of the target {say(value['target'], 'N')}"
    yield "mean contact force Fm", say(value["mean"], "N"), target
    sigma, low, high = (say(value[f"deviation{band}"], "N", 3) for band in ("", "_low", "_high"))
    yield f"sigma, 0-{limit:g} Hz", sigma, f"0-{between:g} Hz: {low}  {between:g}-{limit:g} Hz: {high}"
    yield "sigma / Fm", number(value["relative_deviation"], 3), ""
    yield "Fm - 3 sigma, Fm + 3 sigma", say.span(value["statistical_minimum"], value["statistical_maximum"], "N"), ""
    for key, what in (("maximum", "largest"), ("minimum", "smallest")):
        yield f"{what} force", say(value[key], "N"), f"at {say.place(value[f'{key}_at'])}"
    raw = f"sigma {say(value['raw_deviation'], 'N', 3)}"
    yield "unfiltered force", say.span(value["raw_minimum"], value["raw_maximum"], "N"), raw
    yield "loss of contact", f"{number(100 * value['loss'], 2)} %", "of the time"
    heights = say.span(value["lowest"], value["highest"], "m")
    yield "range of contact heights", say(value["height_range"], "m", 3), heights
    if value["uplift"] is not None:
        yield uplift
    for strip, own in found["strips"].items():
        mean, sigma = (say(own[key]["value"], "N", 3) for key in ("mean", "deviation"))
        force = say.span(own["minimum"]["value"], own["maximum"]["value"], "N")
        lost = f"without contact {number(100 * own['loss']['value'], 2)} % of the time"
        yield f"{strip} strip, mean", mean, f"sigma {sigma}  {force}  {lost}"
    for rotation, ends in found["rotations"].items():
        angle = say.span(ends["min"]["value"], ends["max"]["value"], "rad")
        yield f"{rotation} of the head", angle, "at the output instants"
    for passed in found["overlaps"]:
        both = f"on both wires from {say.place(passed['first'], with_unit=False)} to {say.place(passed['last'])}"
        sentence = f"{both}, {say(passed['together'], 's', 3)} in all"
        lines = f"from {passed['from_line']} to {passed['to_line']}"
        yield lines, say(passed["last"] - passed["first"], "m", 3), sentence
    if found["acceptance"] is not None:
        yield from _acceptance_rows(found["acceptance"])
    if found["limits"] is not None:
        yield from _limit_rows(name, found["limits"])


def _limit_rows(name: str, found: Summary) -> Iterator[Row]:
    yield f"{found['title']}: {name}", "", ""
    for check in found["checks"]:
        low, high, unit = check["low"], check["high"], check["unit"]
        bounds = f"{number(low)} to {number(high)} {unit}" if None not in (low, high) else (
            f"at most {number(high)} {unit}" if low is None else f"above {number(low)} {unit}")  # fmt: skip
        sentence = f"{check['verdict']}  {bounds} [{check['mark']}] ({check['why']})"
        yield check["what"], f"{number(check['value'])} {unit}", sentence
    yield "verdict", found["verdict"], "; ".join(filter(None, (found["broken"], found["remark"])))


def _acceptance_rows(found: Summary) -> Iterator[Row]:
    yield found["title"], "", ""
    for check in found["checks"]:
        verdict = "inside" if check["inside"] else "OUTSIDE"
        bounds = f"{check['low']:g} to {check['high']:g} {check['unit']} [{check['mark']}]"
        yield check["what"], f"{number(check['value'])} {check['unit']}", f"{verdict} {bounds}"
    inside = sum(check["inside"] for check in found["checks"])
    yield "inside", f"{inside} of {len(found['checks'])}", found["remark"]


def _overhead_rows(name: str, found: Summary, say: Column) -> Iterator[Row]:
    yield f"Overhead line {name}", "", ""
    supports = {key: entry for key, entry in found["supports"].items() if entry["uplift"] is not None}
    displayed = [key for key, entry in supports.items() if entry["analysed"]]
    if len(displayed) > SUPPORTS:
        displayed = sorted(displayed, key=lambda key: -float(supports[key]["uplift"]))[:LARGEST]
    largest = max(supports, key=lambda key: float(supports[key]["uplift"]), default=None)
    if largest is not None and largest not in displayed:
        displayed.append(largest)
    for key in displayed:
        entry = supports[key]
        note = "" if entry["analysed"] else "  largest of all spans"
        yield f"uplift at {key}", say(entry["uplift"], "m", 3), f"{say.place(entry['station'])}{note}"
    pull, slack, count = found["largest_dropper_force"], found["most_slack"], len(found["droppers"])
    if pull is not None and pull["value"] is not None:
        where = f"{pull['dropper']} at {say.place(pull['station'])}"
        yield "largest dropper force", say(pull["value"], "N"), where
    if slack is not None and slack["value"]:
        where = f"of the time, {slack['dropper']} at {say.place(slack['station'])}"
        yield "longest slack dropper", f"{number(100 * slack['value'], 2)} %", where
    if count:
        yield "droppers that slacken", f"{found['slackened']} of {count}", "whole line"


def _contact_rows(name: str, contact: Summary, say: Column, largest: float) -> Iterator[Row]:
    """What a load does; `largest` is the largest force of the result, compared with which others may be nothing."""
    yield f"Load {name}", "", ""
    share = contact["share_on_line"]
    if not share:
        yield "on the line", "never", ""
        return
    size, up = contact["force"]["magnitude"], contact["force"].get("z", {"max": None})
    if size["max"] is not None and size["max"] - size["min"] > NOTHING * size["max"]:
        spread = f"std {say(size['std'], 'N')}  {say.span(size['min'], size['max'], 'N')}"
        yield "contact force, mean", say(size["mean"], "N"), spread
    else:
        yield "contact force", say(size["mean"], "N"), "constant"
    if up["max"] is not None and up["min"] < 0.0 < up["max"] - _PULLS * size["max"]:
        yield "of it downwards, mean", say(-up["mean"], "N"), say.span(-up["max"], -up["min"], "N")
    for how, impulse in contact["impulses"].items():
        if impulse is not None:
            sentence = "  ".join((*say.when(impulse), "an impulse over one step, left out of the statistics"))
            yield f"impact when {how}", say(impulse["value"], "N"), sentence
    jump = contact["tension_jump"]
    if jump["value"] is not None and abs(jump["value"]) > NOTHING * largest:  # loads on nets have no two sides
        yield "largest tension jump", say(jump["value"], "N"), "  ".join(say.when(jump))
    hold = contact["hold_force"]
    if (hold["value"] or 0.0) > NOTHING * largest:
        yield "largest hold force", say(hold["value"], "N"), say.instant_and_components(hold)
    if ((needed := contact["friction_needed"])["value"] or 0.0) > NOTHING:
        beyond = ("larger than for dry surfaces: requires a clamp",) if needed["value"] > _MOST_FRICTION else ()
        yield "friction coefficient needed", number(needed["value"], 3), "  ".join((*say.when(needed), *beyond))
    if contact["share_in_air"]:
        yield "in the air", f"{number(100 * contact['share_in_air'], 2)} %", "of its time"
    if contact["friction_power"]["value"]:
        power = contact["friction_power"]
        yield "largest friction power", say(power["value"], "W"), "  ".join(say.when(power))
    if contact["last_speed"] is not None:
        speed = contact["last_speed"]
        yield "last speed", say(speed["value"], "m/s"), "  ".join((*say.when(speed), "before it leaves or stops"))
    yield from place_rows(contact, say)
    if share < 1.0:
        yield "on the line", f"{100 * share:.0f} %", "of the output instants"


_RESPONSES = {
    "deflection": "largest deflection", "acceleration": "largest acceleration",
    "lateral_deflection": "largest lateral deflection", "lateral_acceleration": "largest lateral acceleration",
    "moment": "largest bending moment", "shear": "largest shear",
}  # fmt: skip


def _response_rows(name: str, line: Summary, units: DisplayUnits, floor: dict[str, float]) -> Iterator[Row]:
    """What a line or a place along it goes through."""
    yield (f"Place {name}" if "xi" in line else f"Line {name}"), "", ""
    for quantity, what in _RESPONSES.items():
        entry = line.get(quantity)
        if entry is None:
            continue
        if entry["largest"] is None:
            yield what, "–", "output instants are too few, or too far apart for the filter: write a shorter run.every"
            continue
        say = Column(units, entry, floor=floor)
        where = list(say.when(entry["largest"]))
        if quantity in ("deflection", "lateral_deflection", "moment"):
            where.append(say.span(entry["min"], entry["max"], entry["unit"]))
        if entry.get("impact") is not None:
            static = say(entry["static"], entry["unit"])
            where.append(f"{number(entry['impact']['value'], 4)} times the static {static}")
        yield what, say(entry["largest"]["value"], entry["unit"]), "  ".join(where)


def _train_rows(name: str, train: Summary, say: Column) -> Iterator[Row]:
    yield f"Train {name}", "", ""
    yield "axles", str(train["axles"]), f"at most {train['most_on_line']} of them on the line"
    yield "largest load on the line", say(train["load"]["max"], "N"), ""
    for what, key in (("largest contact force", "largest_force"), ("least contact force", "least_force")):
        if (entry := train.get(key)) is not None:
            yield what, say(entry["value"], "N"), "  ".join((entry["of"], *say.when(entry)))
    if (entry := train.get("unloading")) is not None:
        yield "largest unloading", number(entry["value"], 4), f"of the static force  {entry['of']}"
    if (entry := train.get("acceleration")) is not None:
        value = f"{number(entry['value'], 4)} {entry['unit']}"
        yield "largest acceleration of a body", value, "  ".join((entry["of"], *say.when(entry)))
    first, last = train["first"], train["last"]
    if first["value"] is not None:
        span = f"{number(first['value'])} to {number(last['value'])} {first['unit']}"
        yield "on the line", span, "from its first axle to its last one"


def _payload_rows(name: str, payload: Summary, say: Column) -> Iterator[Row]:
    yield f"Payload of {name}", "", ""
    sway, swing = payload["sway"], payload["swing"]
    if sway is not None and sway["value"] > ROUND_OFF:
        yield "largest sway", say(sway["value"], "m"), "  ".join(say.when(sway))
    if swing is not None and sway["value"] > ROUND_OFF:
        yield "largest angle from the vertical", say(swing["value"], "rad", 3), "  ".join(say.when(swing))
    speed = payload["speed"]
    if speed is not None and speed["value"]:
        yield "largest speed", say(speed["value"], "m/s"), "  ".join(say.when(speed))
    pull, slack = payload["pull"], payload["slack"]["value"]
    if pull is not None:
        sentences = [f"slack at {number(100 * slack, 2)} % of the output instants"] if slack else []
        yield "largest pull of its rope", say(pull["value"], "N"), "  ".join((*say.when(pull), *sentences))
    yield from place_rows(payload, say)


def _carriage_rows(name: str, carriage: Summary, say: Column) -> Iterator[Row]:
    yield f"Carriage {name}", "", ""
    for key, what in (("max", "largest wheel load"), ("min", "least wheel load")):
        if (entry := carriage["wheel_load"]) is not None:
            yield what, say(entry[key]["value"], "N"), "  ".join((f"wheel {entry[key]['of']}", *say.when(entry[key])))
    if (least := carriage["tension_ratio"]) is not None:
        where = "  ".join((f"wheel {least['of']}", *say.when(least)))
        yield "least tension over wheel load", number(least["value"], 3), where
    if (least := carriage["transverse_ratio"]) is not None:
        yield "least tension over transverse force", number(least["value"], 3), "  ".join(say.when(least))
    for key, what in (("sway", "sway along the line"), ("side_sway", "sway to the side"), ("slip", "slip of the rope")):
        if (entry := carriage.get(key)) is not None:
            yield what, say.span(entry["min"]["value"], entry["max"]["value"], entry["unit"]), ""
    pulls = {"pull": "pull of the hauling rope", "drive_tension": "tension at the drive"}
    for key, what in {**pulls, "counter_pull": "pull of the counter rope"}.items():
        if (entry := carriage.get(key)) is not None:
            when = f"largest at {''.join(say.when(entry['max']))}"
            yield what, say.span(entry["min"]["value"], entry["max"]["value"], "N"), when
    if (most := carriage.get("drive_ratio")) is not None:
        bears = f"friction bears {number(most['friction_bears'], 3)}"
        yield "largest ratio at the drive", number(most["value"], 3), "  ".join((bears, *say.when(most)))


def _exchange_rows(name: str, exchange: Summary, say: Column) -> Iterator[Row]:
    yield f"Exchange with {name}", "", ""
    yield "work exchanged", say(exchange["work"], "J"), ""
    share = "" if exchange["relative"] is None else f"{percent(exchange['relative'])} of it"
    peak = exchange["peak"]
    most = "  ".join((f"at most {say(peak['value'], 'J', 2)} in one interval", *say.when(peak)))
    yield "energy error of the exchange", say(exchange["made"], "J", 3), "  ".join(filter(None, (share, most)))


def percent(part: float) -> str:
    """A small part; what is of no interest is not spelt out."""
    return f"{number(100 * part, 2)} %" if abs(part) >= NOTHING or not part else f"less than {100 * NOTHING:g} %"


def _energy_rows(energy: Summary, say: Column) -> Iterator[Row]:
    if energy["audit"]:
        yield "Energy", "", ""
        yield "audit", "none", energy["audit"]
        return
    final = {form: energy["final"].get(form) for form in ENERGY_LABELS if form not in energy["always_zero"]}
    largest = max((abs(value) for value in (*final.values(), energy["turnover"]) if value is not None), default=0.0)
    final = {form: value for form, value in final.items() if value is None or abs(value) > NOTHING * largest}
    worst: dict[str, Any] | None = energy["largest_imbalance"]
    stands = worst is not None and ("load_path" in worst or not energy["turnover"])  # that has no audit
    if final or not stands:
        yield "Energy at the end", "", ""
    for form, value in final.items():
        yield ENERGY_LABELS[form], say(value, "J"), ""
    if stands:
        return
    yield "energy throughput", say(energy["turnover"], "J"), "half the sum of all changes above since the start"
    if worst is None:
        yield "largest energy residual", "unknown", "no audit was kept"
        return
    share = "" if worst["relative"] is None else f"{percent(worst['relative'])} of the energy throughput"
    yield "largest energy residual", say(worst["value"], "J"), "  ".join(filter(None, (share, *say.when(worst))))


def _mesh_rows(mesh: Summary, say: Column) -> Iterator[Row]:
    order = "" if mesh["order"] is None else f"order {number(mesh['order'], 2)}; "
    yield "Mesh", "", ""
    for key, what, more in (("error", "estimated error", f"{order}{mesh['told']}"), ("of_contacts", "of contacts", "")):
        yield what, "–" if mesh[key]["value"] is None else say(mesh[key]["value"], "m"), more


def _method_rows(method: Summary, say: Column) -> Iterator[Row]:
    yield "Method", "", ""
    yield "method", method["name"] or "–", method["reason"]
    if method["step"]["value"] is not None:
        yield "largest step", say(method["step"]["value"], "s"), f"{method['steps']} steps" if method["steps"] else ""
    if method["wall"]["value"] is not None:
        factor = method["real_time_factor"]
        timing = "" if factor is None else f"{number(factor, 3)} times real time"
        wall, compiled = method["wall"]["value"], method["compiling"]["value"] or 0.0
        yield "time taken", say(wall - compiled, "s", 3), timing
        if compiled > 0.0:
            yield "compilation", say(compiled, "s", 3), "once; kernels are then cached"
